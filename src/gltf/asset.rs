//! A glTF file in two phases: open, it knows its cameras and what it says beyond glTF; loaded, it is a [`Model`].

use core::ops::Range;
use std::path::Path;

use glam::DVec3;
use serde_json::Value;

use super::accessors::Accessors;
use super::animations::{self, Change};
use super::buffers::{self, Buffers, Sources};
use super::fault::{Checked, InFile};
use super::files::{self, Files};
use super::geometry::Geometry;
use super::limits::Limits;
use super::model::{Camera, Extras, Material, Model, NodeExtras};
use super::nodes::{self, Place};
use super::primitives::Planner;
use super::schema::Root;
use super::textures::Textures;
use super::vertices::Reader;
use super::warnings::Warnings;
use super::{cameras, container, document, images, lights, materials, meshes};
use crate::error::{Error, Result};

/// A glTF file that is open: its buffers are there and its nodes are placed; meshes, lights and images are still to be
/// read.
#[derive(Debug)]
pub struct Asset {
    file: String,
    bytes: Vec<u8>,
    /// Where in `bytes` the buffer without a URI is.
    binary: Option<Range<usize>>,
    root: Root,
    files: Files,
    buffers: Sources,
    places: Vec<Place>,
    cameras: Vec<Camera>,
    warnings: Warnings,
}

impl Asset {
    /// Opens the file at `path`, `.gltf` or `.glb`; which of the two, its content says. Nodes are where its animations
    /// have them at `time` `[s]`; without a time, where the file places them.
    ///
    /// # Errors
    /// If the file or a buffer that it refers to cannot be read, its nodes or cameras are malformed, or it needs what
    /// is not supported.
    pub fn open(path: &Path, time: Option<f64>) -> Result<Self> {
        let remedy = "give the path of a readable .gltf or .glb file";
        let file = path.display().to_string();
        let mut content = files::Content::open(path).map_err(|finding| Error::failure(&file, finding, remedy))?;
        // A large file that is not ours is not worth its memory.
        let start = content.start().map_err(|finding| Error::failure(&file, finding, remedy))?;
        container::check_start(start).in_file(&file)?;
        let bytes = content.all().map_err(|finding| Error::failure(&file, finding, remedy))?;
        Self::parse(&file, bytes, path.parent(), time)
    }

    /// Opens a file from memory; `file` is what errors call it, and files that it refers to are in `folder`.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn parse(file: &str, bytes: Vec<u8>, folder: Option<&Path>, time: Option<f64>) -> Result<Self> {
        let mut warnings = Warnings::default();
        let container = container::open(&bytes, &mut warnings).in_file(file)?;
        let mut root = document::read(file, &container)?;
        let (binary, mut files) = (container.binary, Files::new(folder));
        let content = binary.clone().map(|range| &bytes[range]);
        let opened = open(&mut root, content, &mut files, time, &mut warnings).in_file(file)?;
        let (file, (buffers, places, cameras)) = (file.into(), opened);
        Ok(Self { file, bytes, binary, root, files, buffers, places, cameras, warnings })
    }

    /// What errors call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The perspective cameras of its scene.
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// What its scene says beyond glTF.
    pub fn extras(&self) -> Option<&Value> {
        nodes::scene(&self.root).ok().flatten()?.extras.as_ref()
    }

    /// Reads everything else. Vertices are counted from `origin`: single precision is finest around 0.
    ///
    /// # Errors
    /// If what is left of the file is malformed, or an image cannot be read.
    pub fn load(mut self, origin: DVec3) -> Result<Model> {
        let model = self.model(origin).in_file(&self.file)?;
        let files = self.files.folder().map_or_else(Vec::new, |folder| files::beside(&self.root, folder));
        Ok(Model { cameras: self.cameras, warnings: self.warnings.of_file(&self.file), files, ..model })
    }

    /// The model but for its cameras and warnings.
    fn model(&mut self, origin: DVec3) -> Checked<Model> {
        let Self { bytes, root, files, warnings, .. } = self;
        let mut textures = Textures::new(root);
        let mut materials = materials::read(&root.materials, &mut textures, warnings)?;
        let images = images::open(&root.images, &textures.images, files)?;
        let limits = Limits::new(bytes.len().saturating_add(files.bytes()));
        let binary = self.binary.clone().map(|range| &bytes[range]);
        let buffers = Buffers::new(root, &self.buffers, binary, files)?;

        let placed = nodes::placed(root, &self.places);
        let accessors = Accessors { buffers: &buffers, accessors: &root.accessors };
        let reader = Reader { accessors, quantized: document::is_quantized(root) };
        let used_sets = materials.iter().map(materials::used_sets).collect();
        let planner = Planner { reader, materials: &root.materials, used_sets };
        let (geometry, instances) = meshes::flatten(&root.meshes, &placed, origin, &planner, limits, warnings)?;
        let lights = lights::read(root, &placed, warnings)?;
        let (images, which) = images::decode(&images, &buffers, files, limits)?;

        materials::note_what_is_diffuse(&root.materials, &geometry.triangles, warnings);
        if geometry.triangles.iter().any(|triangle| triangle.material as usize == materials.len()) {
            materials.push(Material::default());
        }
        let mut textures = textures.textures;
        textures.iter_mut().for_each(|texture| texture.image = which[texture.image as usize]);
        let Geometry { positions, texcoords, colors, triangles } = geometry;
        Ok(Model {
            origin: origin.to_array(),
            positions,
            texcoords,
            colors,
            triangles,
            instances,
            hidden: nodes::hidden(root, &self.places)?,
            materials,
            textures,
            images,
            lights,
            animations: animations::about(root, &self.cameras, accessors),
            extras: extras(root, &self.places)?,
            cameras: Vec::new(),
            warnings: Vec::new(),
            files: Vec::new(),
        })
    }
}

/// What the first phase reads: where buffers are, where nodes are at this time, and the cameras.
fn open(
    root: &mut Root,
    binary: Option<&[u8]>,
    files: &mut Files,
    time: Option<f64>,
    warnings: &mut Warnings,
) -> Checked<(Sources, Vec<Place>, Vec<Camera>)> {
    document::check(root, time.is_some(), warnings)?;
    let buffers = buffers::open(root, binary.is_some(), files)?;
    if let Some(time) = time {
        let changes = play(root, &Buffers::new(root, &buffers, binary, files)?, time, warnings)?;
        changes.into_iter().for_each(|change| change.apply(&mut root.nodes));
    }
    let places = nodes::places(root, warnings)?;
    let cameras = cameras::read(&root.cameras, &nodes::placed(root, &places), warnings)?;
    Ok((buffers, places, cameras))
}

/// What the animations of the file change in its nodes at `time` `[s]`.
fn play(root: &Root, buffers: &Buffers<'_>, time: f64, warnings: &mut Warnings) -> Checked<Vec<Change>> {
    let accessors = Accessors { buffers, accessors: &root.accessors };
    animations::changes(&root.animations, &root.nodes, accessors, time, warnings)
}

/// What the scene and its nodes say beyond glTF.
fn extras(root: &Root, places: &[Place]) -> Checked<Extras> {
    let scene = nodes::scene(root)?.and_then(|scene| scene.extras.clone());
    let of_node = |place: &Place| {
        let node = &root.nodes[place.index];
        Some(NodeExtras { node: place.index as u32, name: node.name.clone(), extras: node.extras.clone()? })
    };
    Ok(Extras { scene, nodes: places.iter().filter_map(of_node).collect() })
}
