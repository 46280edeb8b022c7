//! What is under a cumulus and behind it: hills, and the sky of a clear afternoon.

mod hills;
mod sky;

use glam::DVec3;

use crate::{Material, Model, Object};

pub use sky::{SIZE as SKY_SIZE, pixels as sky};

/// Where the camera is `[m]`. The hills reach from there to the horizon.
pub const EYE: DVec3 = DVec3::new(260.0, -330.0, 2300.0);
/// Towards the sun, not of unit length.
pub const TO_SUN: DVec3 = DVec3::new(-0.75, 0.55, 0.38);

/// What grows on the hills.
const GROUNDS: [(&str, Material); 4] = [
    ("meadows", Material::new("grass", [0.125, 0.165, 0.06])),
    ("fields", Material::new("stubble", [0.2, 0.19, 0.085])),
    ("woods", Material::new("leaves", [0.06, 0.085, 0.035])),
    ("ploughland", Material::new("soil", [0.16, 0.135, 0.075])),
];

/// The model.
pub fn model() -> Model {
    let objects = GROUNDS.into_iter().zip(hills::meshes());
    Model {
        name: "cloud-sky",
        objects: objects.map(|((name, material), mesh)| Object::new(name, material, mesh)).collect(),
    }
}
