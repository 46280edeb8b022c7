//! glTF 2.0: from a `.gltf` or `.glb` file to a [`Model`], plain data in world space.
//!
//! Only what the scene shows is read: the default scene, or else the first, or else all nodes. Of materials, what a diffuse
//! surface shows; of textures, those in use. What is passed over leaves a warning; what is malformed is an error that names
//! the object, and never a panic, whatever the bytes are. Indices, offsets, counts and sizes are checked where they are used,
//! and memory is taken only after that, in proportion to the size of the file.
//!
//! Read beyond the core: `KHR_lights_punctual`, `KHR_materials_emissive_strength`, `KHR_texture_transform`,
//! `KHR_mesh_quantization`. Files that require other extensions are refused. Data stands in the file, in data URIs, or in
//! files in the model's folder or below it: URIs that lead elsewhere are refused, so that a model cannot read what it was not
//! given.

mod accessors;
mod buffers;
mod cameras;
mod container;
mod decode;
mod document;
mod elements;
mod fault;
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

pub(crate) use fault::{label, quoted};
pub use fogbow_kernels::tables::textures::{Filter, Image, Texture, TextureRef, Wrap};
pub(crate) use geometry::LARGEST_COORDINATE;
pub use model::{Camera, Extras, Instance, Light, LightKind, Material, Model, NodeExtras, Triangle};

use crate::error::{Error, Result};
use accessors::Accessors;
use buffers::Buffers;
use container::Container;
use fault::{Checked, InFile};
use files::Files;
use geometry::Geometry;
use limits::Limits;
use nodes::Placed;
use primitives::Planner;
use schema::Root;
use textures::Textures;
use vertices::Reader;
use warnings::Warnings;

/// Reads the model at `path`, a `.gltf` or `.glb` file; which of the two, its content says.
///
/// # Errors
/// If the file or one that it refers to cannot be read, is malformed, or needs what is not supported.
pub fn load(path: &Path) -> Result<Model> {
    load_from(path, |_| DVec3::ZERO)
}

/// The same with vertices counted from `origin`, a function of where the first camera is, if there is one: single precision
/// is finest around 0.
///
/// # Errors
/// As [`load`].
pub fn load_from(path: &Path, origin: impl Fn(Option<DVec3>) -> DVec3) -> Result<Model> {
    let remedy = "give the path of a readable .gltf or .glb file";
    let file = path.display().to_string();
    let mut content = files::Content::open(path).map_err(|finding| Error::failure(&file, finding, remedy))?;
    // A large file that is none of ours is not worth its memory.
    let start = content.start().map_err(|finding| Error::failure(&file, finding, remedy))?;
    container::check_start(start).in_file(&file)?;
    let bytes = content.all().map_err(|finding| Error::failure(&file, finding, remedy))?;
    parse_from(&file, &bytes, path.parent(), &origin)
}

/// Reads a model from memory; `file` is what errors call it, and files that it refers to are in `folder`.
///
/// # Errors
/// As [`load`].
pub fn parse(file: &str, bytes: &[u8], folder: Option<&Path>) -> Result<Model> {
    parse_from(file, bytes, folder, &|_| DVec3::ZERO)
}

fn parse_from(file: &str, bytes: &[u8], folder: Option<&Path>, origin: Origin<'_>) -> Result<Model> {
    let mut warnings = Warnings::default();
    let container = container::open(bytes, &mut warnings).in_file(file)?;
    let root = document::read(file, &container)?;
    let mut model = model(&root, &container, Files::new(folder), bytes.len(), origin, &mut warnings).in_file(file)?;
    model.warnings = warnings.of_file(file);
    model.files = folder.map_or_else(Vec::new, |folder| files::beside(&root, folder));
    Ok(model)
}

/// What vertices are counted from, by the place of the first camera.
type Origin<'a> = &'a dyn Fn(Option<DVec3>) -> DVec3;

/// The model that `root` describes; `bytes` is the size of the file.
fn model(
    root: &Root,
    container: &Container<'_>,
    mut files: Files<'_>,
    bytes: usize,
    origin: Origin<'_>,
    warnings: &mut Warnings,
) -> Checked<Model> {
    document::check(root, warnings)?;
    let mut textures = Textures::new(root);
    let mut materials = materials::read(&root.materials, &mut textures, warnings)?;
    let sources = buffers::open(root, container.binary.is_some(), &mut files)?;
    let images = images::open(&root.images, &textures.images, &mut files)?;
    let limits = Limits::new(bytes.saturating_add(files.bytes()));
    let buffers = Buffers::new(root, &sources, container.binary, &files)?;

    let placed = nodes::place(root, warnings)?;
    let accessors = Accessors { buffers: &buffers, accessors: &root.accessors };
    let reader = Reader { accessors, quantized: document::is_quantized(root) };
    let used_sets = materials.iter().map(materials::used_sets).collect();
    let planner = Planner { reader, materials: &root.materials, used_sets };
    let origin =
        origin(placed.iter().find(|placed| placed.node.camera.is_some()).map(|placed| placed.world.translation));
    let (geometry, instances) = meshes::flatten(&root.meshes, &placed, origin, &planner, limits, warnings)?;
    let cameras = cameras::read(&root.cameras, &placed, warnings)?;
    let lights = lights::read(root, &placed, warnings)?;
    let (images, which) = images::decode(&images, &buffers, &files, limits)?;

    materials::note_what_is_diffuse(&root.materials, &geometry.triangles, warnings);
    if geometry.triangles.iter().any(|triangle| triangle.material as usize == materials.len()) {
        materials.push(Material::default());
    }
    let mut textures = textures.textures;
    textures.iter_mut().for_each(|texture| texture.image = which[texture.image as usize]);
    let extras = extras(root, &placed)?;
    let Geometry { positions, texcoords, colors, triangles } = geometry;
    let (warnings, files) = (Vec::new(), Vec::new());
    Ok(Model {
        origin: origin.to_array(),
        positions,
        texcoords,
        colors,
        triangles,
        instances,
        materials,
        textures,
        images,
        cameras,
        lights,
        extras,
        warnings,
        files,
    })
}

/// What the scene and its nodes say beyond glTF.
fn extras(root: &Root, placed: &[Placed<'_>]) -> Checked<Extras> {
    let scene = nodes::scene(root)?.and_then(|scene| scene.extras.clone());
    let of_node = |placed: &Placed<'_>| {
        let extras = placed.node.extras.clone()?;
        Some(NodeExtras { node: placed.index as u32, name: placed.node.name.clone(), extras })
    };
    Ok(Extras { scene, nodes: placed.iter().filter_map(of_node).collect() })
}
