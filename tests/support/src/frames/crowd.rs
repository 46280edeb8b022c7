//! Frames of many triangles.

use super::*;
use crate::meshes;

/// `frame` with so many small panels among its surfaces that rays need a tree. The triangles that it has keep their
/// indices.
pub fn crowded(frame: &Frame) -> Frame {
    let own = &frame.surfaces;
    let crowd = meshes::soup(2 * FEW, 0.2, 1).map(|p| DVec3::new(p.x, 1.0 + p.y, 1.5 + 1.5 * p.z)).geometry();
    let triangles = [own.geometry(), &crowd].map(|all| (0..all.len()).map(|i| all.corners(i)));
    let positions: Vec<_> = triangles.into_iter().flatten().flatten().collect();
    let corners: Vec<_> = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let materials = [own.materials(), &[Material::plain([0.8, 0.7, 0.6], true)]].concat();
    let material_of = |i: usize| match i < own.geometry().len() {
        true => own.material_index(i as u32) as u32,
        false => own.materials().len() as u32,
    };
    let material_of = (0..corners.len()).map(material_of).collect();
    let surfaces = Arc::new(Surfaces::new(Geometry::new(positions, corners), materials, material_of));
    Frame { surfaces, ..frame.clone() }
}
