//! What a frame reads and no stage changes: camera, medium, lights, surfaces.

pub mod camera;
pub mod geometry;
pub mod lights;
pub mod media;
pub mod surfaces;
pub mod textures;
