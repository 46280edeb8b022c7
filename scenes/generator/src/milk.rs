//! A table under a block of milk, a few millimetres small, and a wall behind it.

use glam::DVec3;

use crate::{Material, Mesh, Model, Object};

/// How far table and wall reach to the sides, and the table to the front `[m]`.
pub const REACH: f64 = 0.06;
/// z of the wall behind the block `[m]`.
pub const WALL: f64 = -0.012;

/// The model.
pub fn model() -> Model {
    let across = DVec3::X * 2.0 * REACH;
    let corner = DVec3::new(-REACH, 0.0, WALL);
    Model {
        name: "milk",
        objects: vec![
            Object::new("table", Material::new("slate", [0.09, 0.1, 0.12]), {
                Mesh::parallelogram(corner, DVec3::Z * (REACH - WALL), across)
            }),
            Object::new("wall", Material::new("paint", [0.2, 0.24, 0.3]), {
                Mesh::parallelogram(corner, across, DVec3::Y * REACH)
            }),
        ],
    }
}
