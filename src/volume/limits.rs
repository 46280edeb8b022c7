//! How much a grid may hold.

use crate::gltf::fault::{Checked, require};

/// Voxels of the leaves of one grid: 8 GiB.
pub const MOST_VOXELS: u64 = 1 << 31;

/// Whether leaves of `count` voxels can be read.
pub fn voxels(count: u64) -> Checked<()> {
    let finding = || format!("has {count} voxels or more, constant regions included; the limit is {MOST_VOXELS}");
    require(count <= MOST_VOXELS, finding, "resample the grid to larger voxels, or remove constant regions")
}
