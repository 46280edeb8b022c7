//! A grid in f64.
//!
//! ```text
//! density:  sum over the eight voxels about the point of value * prod over axes of (1 - distance from the voxel)
//! tau~:     midpoint rule over the means of cells, with as many points as the segment is cells long, at most 64, over
//!           its part in a box a little larger than the grid
//! ```
//!
//! Which cell a point is in, and how many points there are, are decisions on the edge of rounding: a twin may decide
//! otherwise for one point in many thousands.

use glam::DVec3;

use super::simd::{ABOVE, BELOW, MOST_POINTS};
use super::{Grid, Interpolation};
use crate::media::reference::Medium;
use crate::phase::reference::Phase;

/// A grid, and where its scattering events send light.
#[derive(Clone, Copy)]
pub struct GridTwin<'a> {
    /// The grid.
    pub grid: &'a Grid,
    /// The phase function.
    pub phase: &'a dyn Phase,
}

impl Grid {
    /// A point in voxels from the first one on.
    pub fn voxels_at(&self, at: DVec3) -> DVec3 {
        let [x, y, z] = self.to_voxels.map(|row| {
            let [a, b, c, d] = row.map(f64::from);
            a * at.x + b * at.y + c * at.z + d
        });
        DVec3::new(x, y, z)
    }

    /// Extinction at a point in voxels from the first one on [1/m].
    pub fn extinction_at(&self, at: DVec3) -> f64 {
        let first = at.floor();
        let value = |offset: DVec3| {
            let place = first + offset;
            self.bricks.value([place.x as i64, place.y as i64, place.z as i64])
        };
        let density = match self.interpolation {
            Interpolation::Nearest => value(DVec3::ZERO),
            Interpolation::Trilinear => {
                let share = at - first;
                let corners = (0..8).map(|corner| DVec3::from([0, 1, 2].map(|axis| f64::from(corner >> axis & 1))));
                corners
                    .map(|corner| {
                        let near = (DVec3::ONE - corner) * (DVec3::ONE - share) + corner * share;
                        near.x * near.y * near.z * value(corner)
                    })
                    .sum()
            }
        };
        density * f64::from(self.unit)
    }

    /// The part of a ray, in cells, up to `end` within all cells and so much more below and above.
    pub fn part_within(&self, from: DVec3, way: DVec3, [below, above]: [f64; 2], end: f64) -> Option<(f64, f64)> {
        let (mut enter, mut exit) = (0.0_f64, end);
        for axis in 0..3 {
            let count = f64::from(self.cells.dims[axis]) + above;
            if way[axis] == 0.0 {
                if from[axis] < -below || from[axis] > count {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-below - from[axis]) / way[axis], (count - from[axis]) / way[axis]);
            (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
        }
        (enter < exit).then_some((enter, exit))
    }

    /// The cell that a point, in cells, is in.
    pub fn cell_at(&self, at: DVec3) -> [u32; 3] {
        [0, 1, 2].map(|axis| at[axis].clamp(0.0, f64::from(self.cells.dims[axis] - 1)) as u32)
    }
}

impl Medium for GridTwin<'_> {
    fn mean_free_path(&self, from: DVec3, to: DVec3) -> f64 {
        from.distance(to) / self.optical_depth(from, to)
    }

    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64 {
        let side = f64::from(self.grid.cells.side);
        let (start, end) = (self.grid.voxels_at(from) / side, self.grid.voxels_at(to) / side);
        let way = end - start;
        let Some((enter, exit)) = self.grid.part_within(start, way, [BELOW, ABOVE].map(f64::from), 1.0) else {
            return 1e-9;
        };
        let points = (way.length() * (exit - enter)).ceil().clamp(1.0, f64::from(MOST_POINTS));
        let mean_at = |i: u32| {
            let at = start + (enter + (exit - enter) * (f64::from(i) + 0.5) / points) * way;
            let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < f64::from(self.grid.cells.dims[axis]));
            if inside { f64::from(self.grid.cells.at(self.grid.cell_at(at)).mean) } else { 0.0 }
        };
        let mean = (0..points as u32).map(mean_at).sum::<f64>() / points;
        (mean * (exit - enter) * from.distance(to)).max(1e-9)
    }

    fn extinction(&self, at: DVec3) -> f64 {
        self.grid.extinction_at(self.grid.voxels_at(at))
    }

    fn phase(&self) -> &dyn Phase {
        self.phase
    }
}
