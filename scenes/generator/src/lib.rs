//! The geometry of fogbow's scenes, from a few numbers each.
//!
//! A scene is a function that composes shapes into a [`Model`]; [`glb::encode`] makes a binary glTF file of it. The
//! same program writes the same bytes every time. Cameras and lights stand in the scene's `scene.toml`, not here, but
//! for what shines as a surface.
//!
//! Lengths are in metres, y is up. Triangles are counter-clockwise seen from their front, so that the normal by the
//! right-hand rule points out of solids and towards the side of a sheet that is not black.

pub mod cloud_sky;
pub mod colonnade;
pub mod cornell_fog;
pub mod dense_plate;
pub mod glb;
pub mod godrays;
pub mod mesh;
pub mod milk;
pub mod model;
pub mod shapes;
pub mod smoke_fire;
pub mod spotlight;
pub mod wax;

pub use mesh::Mesh;
pub use model::{Material, Model, Object};

/// All models.
pub fn models() -> [Model; 9] {
    [
        dense_plate::model(),
        cornell_fog::model(),
        spotlight::model(),
        colonnade::model(),
        godrays::model(),
        milk::model(),
        wax::model(),
        smoke_fire::model(),
        cloud_sky::model(),
    ]
}

/// From 0 to 1 where `x` does, without corners.
pub(crate) fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
