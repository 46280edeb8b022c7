//! A box with two coloured walls, open towards the camera.

use glam::DVec3;

use crate::{Material, Mesh, Model, Object};

/// Width (x), height (y) and depth (z) of the box, which begins at the origin `[m]`.
pub const SIZE: DVec3 = DVec3::new(5.56, 5.488, 5.592);

/// The model: five sheets that face inward.
pub fn model() -> Model {
    let [x, y, z] = [DVec3::X * SIZE.x, DVec3::Y * SIZE.y, DVec3::Z * SIZE.z];
    let grey = Material::grey("grey", 0.15);
    let sheet =
        |name, material, corner, along, across| Object::new(name, material, Mesh::parallelogram(corner, along, across));
    Model {
        name: "cornell-fog",
        objects: vec![
            sheet("ceiling", Material::grey("white", 1.0), y, x, z),
            sheet("floor", grey, DVec3::ZERO, z, x),
            sheet("back", grey, z, y, x),
            sheet("left", Material::new("green", [0.05, 0.4, 0.05]), DVec3::ZERO, y, z),
            sheet("right", Material::new("red", [0.4, 0.05, 0.05]), x, z, y),
        ],
    }
}
