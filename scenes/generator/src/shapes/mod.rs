//! Closed solids with outward normals.

mod cuboid;
mod lathe;
mod pointed;
mod round;
mod wall;

pub use cuboid::cuboid;
pub use lathe::lathe;
pub use pointed::{Lancet, lancet_band, lancet_ring};
pub use round::{Circle, circle_ring, pierced_wall};
pub use wall::{Arch, arch_band, arch_ring, wall};
