//! A red sphere in the beam of a spotlight, over a blue ground.

use core::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::{Material, Mesh, Model, Object, shapes};

/// Middle of the sphere `[m]`.
pub const SPHERE_CENTER: DVec3 = DVec3::new(0.8, 0.8, 4.0);
/// Radius of the sphere, on which all its vertices lie `[m]`.
pub const SPHERE_RADIUS: f64 = 0.38;
/// Bands of the sphere between its poles. With [`SPHERE_SIDES`] the sphere has 2 * 30 * (13 - 1) = 720 triangles, and
/// of all pairs with that number this one makes them most alike: 13.8 by 12 degrees at the equator.
pub const SPHERE_BANDS: u32 = 13;
/// Sides of the sphere around its vertical axis.
pub const SPHERE_SIDES: u32 = 30;
/// Height of the ground `[m]`.
pub const GROUND: f64 = -2.0;
/// How far ground and walls reach `[m]`.
pub const REACH: f64 = 50.0;
/// x of the left wall and z of the back wall `[m]`.
pub const WALLS: [f64; 2] = [-4.0, 8.0];

/// The model. The walls absorb everything; they begin where they meet each other and the ground.
pub fn model() -> Model {
    let black = Material::grey("black", 0.0);
    let corner = DVec3::new(WALLS[0], GROUND, WALLS[1]);
    let up = DVec3::Y * (REACH - GROUND);
    let back = Mesh::parallelogram(corner, up, DVec3::X * (REACH - corner.x));
    let left = Mesh::parallelogram(corner, DVec3::NEG_Z * (REACH + corner.z), up);
    Model {
        name: "spotlight",
        objects: vec![
            Object::new("ground", Material::new("blue", [0.2, 0.2, 0.8]), ground()),
            Object::new("back", black, back),
            Object::new("left", black, left),
            Object::new("sphere", Material::new("red", [1.0, 0.1, 0.1]), sphere()),
        ],
    }
}

fn ground() -> Mesh {
    Mesh::parallelogram(DVec3::new(-REACH, GROUND, -REACH), DVec3::Z * 2.0 * REACH, DVec3::X * 2.0 * REACH)
}

fn sphere() -> Mesh {
    let profile: Vec<DVec2> = (0..=SPHERE_BANDS)
        .map(|i| {
            let (sin, cos) = (PI * f64::from(i) / f64::from(SPHERE_BANDS)).sin_cos();
            // The poles stand on the axis exactly, where the sine of half a turn would miss it.
            let radius = if i % SPHERE_BANDS == 0 { 0.0 } else { sin };
            SPHERE_RADIUS * DVec2::new(radius, -cos)
        })
        .collect();
    shapes::lathe(&profile, SPHERE_SIDES).moved(SPHERE_CENTER)
}
