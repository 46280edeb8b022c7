//! Extinction from a grid of densities, 0 outside of it.
//!
//! The density at a point is interpolated between voxels. Nobody knows its integral along a segment, so that free
//! flights are *tracked* and the transmittance of connections is *estimated* ([`tracking`]). Both need bounds, which a
//! coarse field of cells has; and weights need an optical depth that is the same for a segment whoever asks:
//!
//! ```text
//! tau~ = sum of the cells' means at n points of the segment, evenly spread over its part within the grid and a little
//!        beyond, times that part's length / n;       n = the cells it is long, rounded up, at most 64
//! ```
//!
//! **Why images are right whatever tau~ is.** With T the transmittance of what a connection adds and T' any unbiased
//! estimate of it, a candidate counts
//!
//! ```text
//! C = Le throughput F / (reach(n) + sum_i reach(i) r~_i),      F = T' e^{tau~},      F = 1 for light that a walk met
//! ```
//!
//! where `r~_i` is the density of the connection from start i over that of path tracing if its transmittance were
//! e^{-tau~}. Connections do not depend on T, so their `r~_i` are known, and the weights `r~_i / (reach(n) + ..)` of
//! all techniques add up to 1 for every path. Extinctions at vertices are the true ones and cancel. The mean of F is
//! `T e^{tau~}`, so that the mean of C is what it would be if T were known. A bad tau~ makes noise, and nothing else.
//! The stage [`transmittance`](crate::transmittance) finds F.
//!
//! **Techniques.** Bridges look their counts up at tau~ of the axis. MVNEE's seeds are spread along the axis with the
//! mean extinction `tau~ / s`, of which density and count are exact.

mod bricks;
mod cells;
pub mod reference;
mod simd;
pub mod tracking;

use crate::vec3x8::Vec3x8;

pub use bricks::{Bricks, Leaf};
pub use cells::{Cell, Cells};
pub use simd::{GridLanes, GridX8};

/// How densities between voxels are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Between the centres of the eight nearest voxels.
    Trilinear,
    /// That of the voxel that the point is in.
    Nearest,
}

/// A grid in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Densities.
    bricks: Bricks,
    /// Bounds and means of extinctions.
    cells: Cells,
    /// Extinction of density 1 [1/m], > 0.
    unit: f32,
    interpolation: Interpolation,
    /// From the world to voxels, counted from the first one: three rows of an affine map.
    to_voxels: [[f32; 4]; 3],
}

/// Where voxels are: the affine map from the world `[m]` to index coordinates, row by row. Voxel i has its centre at
/// index coordinate i.
pub type ToIndex = [[f64; 4]; 3];

impl Grid {
    /// The densities of `leaves` times `unit` [1/m].
    ///
    /// # Panics
    /// If there is no leaf, or `to_index` has no inverse.
    pub fn new(leaves: &[Leaf], to_index: &ToIndex, unit: f32, interpolation: Interpolation) -> Self {
        let bricks = Bricks::new(leaves);
        // A voxel is half an index coordinate to either side of its centre.
        let smooth = interpolation == Interpolation::Trilinear;
        let half = if smooth { 0.0 } else { 0.5 };
        let mut to_voxels = [[0.0; 4]; 3];
        for ((row, from), origin) in to_voxels.iter_mut().zip(to_index).zip(bricks.origin) {
            *row = [from[0], from[1], from[2], from[3] - f64::from(origin) + half].map(|entry| entry as f32);
        }
        let cells = Cells::new(&bricks, unit, voxel(to_index), smooth);
        Self { bricks, cells, unit, interpolation, to_voxels }
    }

    /// A box of one `extinction` [1/m] from corner `low` to corner `high` `[m]`: a brick of one density, the voxels of
    /// which fill it to its faces. Its transmittance is known, so that nothing is left to chance.
    ///
    /// # Panics
    /// If it has no inside.
    pub fn block([low, high]: [[f64; 3]; 2], extinction: f32) -> Self {
        let side = f64::from(bricks::SIDE);
        let mut to_index = [[0.0; 4]; 3];
        for (axis, row) in to_index.iter_mut().enumerate() {
            assert!(low[axis] < high[axis], "a box has an inside");
            row[axis] = side / (high[axis] - low[axis]);
            row[3] = -low[axis] * row[axis] - 0.5;
        }
        let leaf = Leaf { origin: [0; 3], values: Box::new([1.0; 512]) };
        Self::new(&[leaf], &to_index, extinction, Interpolation::Nearest).with_cells(bricks::SIDE.ilog2(), 1.0, 1.0)
    }

    /// The same with other cells: of 2^`log_side` voxels along each edge, with majorants times `factor` and means times
    /// `mean`. No mean of any image depends on them.
    pub fn with_cells(self, log_side: u32, factor: f32, mean: f32) -> Self {
        let smooth = self.interpolation == Interpolation::Trilinear;
        let cells = Cells::of(&self.bricks, self.unit, log_side, smooth).distorted(factor, mean);
        Self { cells, ..self }
    }

    /// Bounds and means.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Hands everything that extinctions depend on to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(&self.unit.to_le_bytes());
        digest(&[u8::from(self.interpolation == Interpolation::Trilinear)]);
        self.to_voxels.as_flattened().iter().for_each(|entry| digest(&entry.to_le_bytes()));
        self.bricks.digest(digest);
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes() + self.cells.bytes()
    }

    /// A point in cells from the first one on.
    #[inline(always)]
    fn in_cells(&self, at: Vec3x8) -> Vec3x8 {
        self.place(at, 1.0) * wide::f32x8::splat(1.0 / self.cells.side)
    }

    /// A point (`homogeneous` = 1), or a direction (0), in voxels.
    #[inline(always)]
    fn place(&self, at: Vec3x8, homogeneous: f32) -> Vec3x8 {
        let [x, y, z] = self.to_voxels.map(|[a, b, c, d]| {
            let [a, b, c, d] = [a, b, c, d * homogeneous].map(wide::f32x8::splat);
            a.mul_add(at.x, b.mul_add(at.y, c.mul_add(at.z, d)))
        });
        Vec3x8::new(x, y, z)
    }
}

/// Length of the shortest edge of a voxel `[m]`, about.
fn voxel(to_index: &ToIndex) -> f32 {
    let longest = to_index.iter().map(|[a, b, c, _]| (a * a + b * b + c * c).sqrt()).fold(0.0, f64::max);
    (1.0 / longest) as f32
}

#[cfg(test)]
mod tests;
