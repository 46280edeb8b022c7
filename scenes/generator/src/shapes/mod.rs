//! Closed solids with outward normals.

mod lathe;

pub use lathe::lathe;
