//! Tracking in f64, one ray after the other.
//!
//! ```text
//! t = where the ray enters the cells
//! repeat: budget = -ln(1 - u)
//!         while budget > rate(block) (t_next - t): budget -= rate(block) (t_next - t), t = t_next
//!         t += budget / rate(block);     collision, or factor, at t
//! what ends in the even part where it begins is known
//! ```

use glam::DVec3;

use crate::media::field::Field;
use crate::media::field::blocks::{Block, EDGE};
use crate::media::field::reference::part_in_box;
use crate::media::reference::{depth_until, reach};
use crate::random::{self, Stream};

/// Length of the flight of a ray of unit `direction` that starts at `origin` `[m]`, where extinction is `hue` times that
/// of the field; infinite where it leaves all there is. It has `budget` mean free paths to its first candidate.
pub fn flight(field: &Field, hue: f64, origin: DVec3, direction: DVec3, budget: f64, stream: Stream) -> f64 {
    fly(field, hue, origin, direction, budget, stream).0
}

/// The same, and the number of candidates on its way, the collision included.
pub fn fly(field: &Field, hue: f64, origin: DVec3, direction: DVec3, mut budget: f64, stream: Stream) -> (f64, u32) {
    if field.is_known() {
        return (reach(&field.strata_along(origin, direction, f64::INFINITY), budget / hue), 1);
    }
    if let Some(even) = field.even {
        let end = budget / (f64::from(even.extinction) * hue);
        if field.even_between(origin, origin + end * direction).is_some() {
            return (end, 1);
        }
    }
    let mut walk = Walk::new(field, origin, direction, f64::INFINITY);
    let around = f64::from(field.around()) * hue;
    let mut candidates = 0;
    if around > 0.0 {
        if budget <= around * walk.before {
            return (budget / around, 0);
        }
        budget -= around * walk.before;
    }
    loop {
        let rate = |block: &Block| f64::from(block.most) * hue;
        let (block, left) = walk.advance(budget, rate, |_, _| ());
        let Some(block) = block else {
            return (if around > 0.0 { walk.exit + left / around } else { f64::INFINITY }, candidates);
        };
        candidates += 1;
        let [chance, next, ..] = stream.words(candidates).map(random::uniform);
        if chance * f64::from(block.most) < walk.extinction() {
            return (walk.t, candidates);
        }
        budget = -(1.0 - next).ln();
    }
}

/// An estimate of the transmittances from `from` to `to`, as products, one for each hue, and the optical depth of the
/// coarse field where the hue is 1.
///
/// # Panics
/// If an end is at infinity: rates count in the length of the segment.
pub fn transmittance<const N: usize>(
    field: &Field,
    hues: [f64; N],
    from: DVec3,
    to: DVec3,
    stream: Stream,
) -> ([f64; N], f64) {
    let length = from.distance(to);
    assert!(length.is_finite(), "from {from} to {to}");
    if field.is_known() {
        return ([1.0; N], depth_until(&field.strata_along(from, to - from, 1.0), length));
    }
    if let Some(extinction) = field.even_between(from, to) {
        return ([1.0; N], extinction * length);
    }
    let mut walk = Walk::new(field, from, to - from, 1.0);
    let mut draws = (0..).map(|k| stream.words(k).map(random::uniform));
    let mut u = || draws.next().expect("streams do not end");
    let around = f64::from(field.around()) * length;
    let (mut products, mut known) = ([1.0; N], around * walk.before);
    let [mut first, ..] = u();
    loop {
        let rate = |block: &Block| f64::from(block.residual.spread) * length;
        let add = |block: &Block, t: f64| known += f64::from(block.residual.control) * length * t;
        let (Some(Block { residual, .. }), _) = walk.advance(-(1.0 - first).ln(), rate, add) else {
            let after = if walk.before < 1.0 { 1.0 - walk.exit } else { 0.0 };
            return (products, known + around * after);
        };
        let [_, next, ..] = u();
        let residual = (walk.extinction() - f64::from(residual.control)) / f64::from(residual.spread);
        for (product, hue) in products.iter_mut().zip(hues) {
            *product *= (1.0 - hue * residual).max(0.0);
        }
        if products == [0.0; N] {
            return (products, known);
        }
        first = next;
    }
}

/// A ray on its way through the cells.
struct Walk<'a> {
    field: &'a Field,
    /// In cells.
    origin: DVec3,
    direction: DVec3,
    t: f64,
    /// How far it goes before it comes to the cells: all the way if it misses them.
    before: f64,
    exit: f64,
    block: [i64; 3],
}

impl<'a> Walk<'a> {
    fn new(field: &'a Field, origin: DVec3, direction: DVec3, longest: f64) -> Self {
        let (start, direction) = (field.cells_of(origin), field.cells_along(direction));
        let part = field.part_within(start, direction, [0.0; 2], longest);
        let (t, exit) = part.unwrap_or((longest, longest));
        let block =
            part.map_or([0; 3], |(t, _)| field.cell_at(start + t * direction).map(|cell| i64::from(cell / EDGE)));
        Self { field, origin: start, direction, t, before: t, exit, block }
    }

    fn extinction(&self) -> f64 {
        self.field.extinction_at(self.origin + self.t * self.direction)
    }

    /// Goes on until `budget` is spent on `rate`, and gives the block where that is, or, if the ray ends before, none and
    /// what is left of the budget. Tells `pass` of every way through a block.
    fn advance(
        &mut self,
        mut budget: f64,
        rate: impl Fn(&Block) -> f64,
        mut pass: impl FnMut(&Block, f64),
    ) -> (Option<Block>, f64) {
        while self.t < self.exit {
            let blocks = &self.field.blocks;
            if (0..3).any(|axis| self.block[axis] < 0 || self.block[axis] >= i64::from(blocks.layout.dims[axis])) {
                return (None, budget);
            }
            let index = blocks.layout.index(self.block.map(|index| index as u32));
            let (axis, border) = self.border();
            let (row, piece) = self.piece(index);
            let (block, end) = (blocks.block(row), piece.min(border).min(self.exit));
            let length = (end - self.t).max(0.0);
            if rate(&block) * length >= budget {
                let way = budget / rate(&block);
                pass(&block, way);
                self.t += way;
                return (Some(block), 0.0);
            }
            budget -= rate(&block) * length;
            pass(&block, length);
            self.t = end.max(self.t);
            if piece > border.min(self.exit) {
                self.block[axis] += if self.direction[axis] > 0.0 { 1 } else { -1 };
            }
        }
        (None, budget)
    }

    /// The row of the bounds that hold from t on in the block at `index`, and where they end for its core, if ever.
    fn piece(&self, index: usize) -> (usize, f64) {
        let Some((corners, row)) = self.field.blocks.cores.as_ref().and_then(|cores| cores.at(index)) else {
            return (index, f64::INFINITY);
        };
        match part_in_box(corners, self.origin, self.direction, f64::INFINITY) {
            Some((enters, _)) if self.t < enters => (row + 1, enters),
            Some((_, leaves)) if self.t < leaves => (row, leaves),
            _ => (row + 1, f64::INFINITY),
        }
    }

    /// The axis along which the next block lies, and where it begins.
    fn border(&self) -> (usize, f64) {
        let border_along = |axis: usize| {
            let behind = if self.direction[axis] > 0.0 { 1 } else { 0 };
            ((self.block[axis] + behind) as f64 * f64::from(EDGE) - self.origin[axis]) / self.direction[axis]
        };
        let moves = (0..3).filter(|axis| self.direction[*axis] != 0.0).map(|axis| (axis, border_along(axis)));
        moves.fold((0, f64::INFINITY), |near, other| if other.1 < near.1 { other } else { near })
    }
}
