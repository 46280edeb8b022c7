//! glTF 2.0: from a `.gltf` or `.glb` file to a [`Model`], plain data in world space.
//!
//! There are two phases: an open [`Asset`] knows its cameras; its meshes are read once it is known what their vertices
//! are counted from.
//!
//! Only what the scene shows is read: the default scene, or else the first, or else all nodes. Of materials, what a
//! diffuse surface shows; of textures, those in use. What is passed over leaves a warning; what is malformed is an
//! error that names the object, and never a panic, whatever the bytes are. Indices, offsets, counts and sizes are
//! checked where they are used, and memory is taken only after that, in proportion to the size of the file.
//!
//! Animations of nodes are played where a time is given: translation, rotation and scale, all animations of the file
//! together.
//!
//! Read beyond the core: `KHR_lights_punctual`, `KHR_materials_emissive_strength`, `KHR_texture_transform`,
//! `KHR_mesh_quantization`. Files that require other extensions are refused. Data stands in the file, in data URIs, or
//! in files in the model's folder or below it: URIs that lead elsewhere are refused, so that a model cannot read what
//! it was not given.

mod accessors;
mod animations;
mod asset;
mod buffers;
mod cameras;
mod container;
mod decode;
mod document;
mod element_format;
mod elements;
pub(crate) mod fault;
mod files;
mod geometry;
mod images;
mod lights;
mod limits;
mod materials;
mod meshes;
mod model;
mod nodes;
mod primitives;
mod schema;
mod textures;
mod transforms;
mod uri;
mod vertices;
mod warnings;

use std::path::Path;

use glam::DVec3;

pub use asset::Asset;
pub(crate) use fault::{label, quoted};
pub use fogbow_kernels::tables::textures::{Filter, Image, Texture, TextureRef, Wrap};
pub(crate) use geometry::LARGEST_COORDINATE;
pub use model::{Animated, Camera, Extras, Instance, Light, LightKind, Material, Model, NodeExtras, Triangle};

use crate::error::Result;

/// Reads the model at `path`, a `.gltf` or `.glb` file; which of the two, its content says.
///
/// # Errors
/// If the file or one that it refers to cannot be read, is malformed, or needs what is not supported.
pub fn load(path: &Path) -> Result<Model> {
    Asset::open(path, None)?.load(DVec3::ZERO)
}

/// Reads a model from memory; `file` is what errors call it, and files that it refers to are in `folder`.
///
/// # Errors
/// As [`load`].
pub fn parse(file: &str, bytes: &[u8], folder: Option<&Path>) -> Result<Model> {
    Asset::parse(file, bytes.to_vec(), folder, None)?.load(DVec3::ZERO)
}

/// The same with nodes where the animations of the file have them at `time` `[s]`.
///
/// # Errors
/// As [`load`].
pub fn parse_at(file: &str, bytes: &[u8], folder: Option<&Path>, time: f64) -> Result<Model> {
    Asset::parse(file, bytes.to_vec(), folder, Some(time))?.load(DVec3::ZERO)
}
