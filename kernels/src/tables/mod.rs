//! What a frame reads and no stage changes: camera, medium, lights.

pub mod camera;
pub mod lights;
pub mod media;
