//! Where bricks are, and voxels in them.

use super::bricks::SIDE;

/// The bricks of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The first one.
    pub first: [i32; 3],
    /// Bricks along each axis.
    pub dims: [u32; 3],
}

impl Span {
    /// Of these bricks; of one if there is none.
    pub fn around(bricks: impl Iterator<Item = [i32; 3]> + Clone) -> Self {
        let bound = |pick: fn(i32, i32) -> i32| {
            bricks.clone().reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis]))).unwrap_or_default()
        };
        let (first, last) = (bound(i32::min), bound(i32::max));
        Self { first, dims: [0, 1, 2].map(|axis| (last[axis] - first[axis] + 1) as u32) }
    }

    /// The place of one of them, counted from the first.
    pub fn place(&self, brick: [i32; 3]) -> [u32; 3] {
        [0, 1, 2].map(|axis| (brick[axis] - self.first[axis]) as u32)
    }
}

/// The brick of a voxel, and where it is in there.
#[inline(always)]
pub fn split(voxel: [u32; 3]) -> ([u32; 3], [u32; 3]) {
    (voxel.map(|along| along / SIDE), voxel.map(|along| along % SIDE))
}

/// All places of so many `layers` along each axis from `first` on.
pub fn places(first: [u32; 3], layers: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    let along = move |axis: usize| first[axis]..first[axis] + layers[axis];
    let rows = along(2).flat_map(move |z| along(1).map(move |y| [y, z]));
    rows.flat_map(move |[y, z]| along(0).map(move |x| [x, y, z]))
}
