//! Tracking in f64, one ray after the other.
//!
//! ```text
//! t = where the ray enters the grid
//! repeat: budget = -ln(1 - u)
//!         while budget > rate(cell) (t_next - t): budget -= rate(cell) (t_next - t), t = t_next
//!         t += budget / rate(cell);     collision, or factor, at t
//! ```

use glam::DVec3;

use crate::media::grid::{Cell, Grid};
use crate::random::{self, Stream};

/// Length of the flight of a ray of unit `direction` that starts at `origin` `[m]`; infinite where it leaves the grid.
pub fn flight(grid: &Grid, origin: DVec3, direction: DVec3, stream: Stream) -> f64 {
    fly(grid, origin, direction, stream).0
}

/// The same, and the number of candidates on its way, the collision included.
pub fn fly(grid: &Grid, origin: DVec3, direction: DVec3, stream: Stream) -> (f64, u32) {
    let mut walk = Walk::new(grid, origin, direction, f64::INFINITY);
    let mut candidates = 0;
    let [mut first, ..] = stream.words(0).map(random::uniform);
    while let Some(cell) = walk.advance(-(1.0 - first).ln(), |cell| f64::from(cell.most), |_, _| ()) {
        candidates += 1;
        let [chance, next, ..] = stream.words(candidates).map(random::uniform);
        if chance * f64::from(cell.most) < walk.extinction() {
            return (walk.t, candidates);
        }
        first = next;
    }
    (f64::INFINITY, candidates)
}

/// An estimate of the transmittance from `from` to `to`, as a product and the optical depth of the coarse field.
pub fn transmittance(grid: &Grid, from: DVec3, to: DVec3, stream: Stream) -> (f64, f64) {
    let length = from.distance(to);
    let mut walk = Walk::new(grid, from, to - from, 1.0);
    let mut draws = (0..).map(|k| stream.words(k).map(random::uniform));
    let mut u = || draws.next().expect("streams do not end");
    let (mut product, mut known) = (1.0, 0.0);
    let [mut first, ..] = u();
    loop {
        let rate = |cell: &Cell| f64::from(cell.spread) * length;
        let add = |cell: &Cell, t: f64| known += f64::from(cell.mean) * length * t;
        let Some(cell) = walk.advance(-(1.0 - first).ln(), rate, add) else {
            return (product, known);
        };
        let [_, next, ..] = u();
        product *= (1.0 - (walk.extinction() - f64::from(cell.mean)) / f64::from(cell.spread)).max(0.0);
        if product == 0.0 {
            return (product, known);
        }
        first = next;
    }
}

/// A ray on its way through the cells.
struct Walk<'a> {
    grid: &'a Grid,
    /// In cells.
    origin: DVec3,
    direction: DVec3,
    t: f64,
    exit: f64,
    cell: [i64; 3],
}

impl<'a> Walk<'a> {
    fn new(grid: &'a Grid, origin: DVec3, direction: DVec3, longest: f64) -> Self {
        let side = f64::from(grid.cells().side);
        let start = grid.voxels_at(origin) / side;
        let direction = (grid.voxels_at(origin + direction) - grid.voxels_at(origin)) / side;
        let (t, exit) = grid.part_within(start, direction, [0.0; 2], longest).unwrap_or((0.0, 0.0));
        let cell = grid.cell_at(start + t * direction).map(i64::from);
        Self { grid, origin: start, direction, t, exit, cell }
    }

    fn extinction(&self) -> f64 {
        let at = self.origin + self.t * self.direction;
        self.grid.extinction_at(at * f64::from(self.grid.cells().side))
    }

    /// Goes on until `budget` is spent on `rate`, and gives the cell where that is; none if the ray ends before. Tells
    /// `pass` of every way through a cell.
    fn advance(
        &mut self,
        mut budget: f64,
        rate: impl Fn(&Cell) -> f64,
        mut pass: impl FnMut(&Cell, f64),
    ) -> Option<Cell> {
        while self.t < self.exit {
            let cells = self.grid.cells();
            if (0..3).any(|axis| self.cell[axis] < 0 || self.cell[axis] >= i64::from(cells.dims[axis])) {
                return None;
            }
            let cell = *cells.at(self.cell.map(|index| index as u32));
            let (axis, border) = self.border();
            let length = (border.min(self.exit) - self.t).max(0.0);
            if rate(&cell) * length >= budget {
                let way = budget / rate(&cell);
                pass(&cell, way);
                self.t += way;
                return Some(cell);
            }
            budget -= rate(&cell) * length;
            pass(&cell, length);
            self.t = border.min(self.exit).max(self.t);
            self.cell[axis] += if self.direction[axis] > 0.0 { 1 } else { -1 };
        }
        None
    }

    /// The axis along which the next cell lies, and where it begins.
    fn border(&self) -> (usize, f64) {
        let border_along = |axis: usize| {
            let behind = if self.direction[axis] > 0.0 { 1 } else { 0 };
            ((self.cell[axis] + behind) as f64 - self.origin[axis]) / self.direction[axis]
        };
        let moves = (0..3).filter(|axis| self.direction[*axis] != 0.0).map(|axis| (axis, border_along(axis)));
        moves.fold((0, f64::INFINITY), |near, other| if other.1 < near.1 { other } else { near })
    }
}
