//! Blocks.

use glam::DVec3;

use crate::Mesh;

/// The block between two opposite corners.
///
/// # Panics
/// If it has no volume.
pub fn cuboid(low: DVec3, high: DVec3) -> Mesh {
    assert!(low.cmplt(high).all(), "no volume between {low} and {high}");
    let corner = |i: u32| DVec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), high, low);
    let mut mesh = Mesh { positions: (0..8).map(corner).collect(), triangles: vec![] };
    for face in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        mesh.quad(face);
    }
    mesh
}
