//! What a frame reads and no stage changes: camera, lights, surfaces.

pub mod camera;
pub mod geometry;
pub mod lights;
pub mod outlines;
pub mod surfaces;
pub mod textures;
