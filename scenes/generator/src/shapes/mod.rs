//! Closed solids with outward normals.

mod cuboid;
mod lathe;
mod wall;

pub use cuboid::cuboid;
pub use lathe::lathe;
pub use wall::{Arch, arch_band, arch_ring, wall};
