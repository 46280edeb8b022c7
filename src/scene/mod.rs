//! Scenes: from a file and flags to a [`Frame`].

mod backs;
mod bare;
mod cameras;
mod check;
mod contents;
pub mod document;
pub mod help;
mod lights;
mod model;
mod origin;
mod places;
mod plain;
mod punctual;
pub mod schema;
mod source;
mod surfaces;

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::de::IntoDeserializer;

use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::gltf::Model;
use crate::warning::Warning;
pub use contents::{Contents, Light};
use document::{Document, Override};
use schema::{Camera, CameraOrName, Film, NumberOrAuto, Scene};

/// A scene that was read and found valid.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// What it is called: its folder's or file's name.
    pub name: String,
    /// The files that it was read from: its own, that of its geometry, and those that the geometry refers to.
    pub files: Vec<PathBuf>,
    /// All keys, overrides and defaults included.
    pub scene: Scene,
    /// Its camera, wherever that comes from.
    pub camera: Camera,
    /// Its lights: those of `scene`, then those of its geometry.
    pub lights: Vec<Light>,
    /// What else its geometry holds.
    pub contents: Contents,
    /// The same as the stages read it.
    pub frame: Frame,
    /// What is not rendered, or not as it is written.
    pub warnings: Vec<Warning>,
    /// What positions in `frame` are counted from `[m]`: 0, unless the camera is far away from there.
    pub origin: [f64; 3],
}

/// Reads the scene at `path`, a TOML file, a folder with a `scene.toml` or a glTF file, and applies `overrides` in order.
///
/// # Errors
/// If the file or its geometry cannot be read, is not TOML or glTF, or has unknown keys, wrong types or values out of range.
pub fn load(path: &Path, overrides: Vec<Override>) -> Result<LoadedScene> {
    let file = file(path)?;
    let (mut document, model) = match bare::is_model(&file) {
        true => bare::read(&file).map(|(document, model)| (document, Some(model)))?,
        false => (Document::read(&file)?, None),
    };
    document.apply_all(overrides)?;
    let mut scene = check(name(path), &document, model)?;
    scene.files.insert(0, file);
    Ok(scene)
}

/// Parses and checks a scene from memory; `file` is what errors call it.
///
/// # Errors
/// As [`load`].
pub fn parse(file: &str, text: &str) -> Result<LoadedScene> {
    check(name(Path::new(file)), &Document::parse(file, text)?, None)
}

/// The scene that `document` describes; `model` is that of a glTF file which is a scene by itself.
fn check(name: String, document: &Document, model: Option<Model>) -> Result<LoadedScene> {
    let mut scene = read(document)?;
    let loaded = model::of_scene(&scene, document, model)?;
    let chosen = cameras::choose(&scene, document, loaded.as_ref())?;
    if let Some(aspect) = chosen.aspect.filter(|_| !document.has("film.size")) {
        scene.film.size = Film::of_aspect(aspect).size;
    }
    let placed = lights::all(&scene, document, loaded.as_ref())?;
    let mut warnings = loaded.as_ref().map_or_else(Vec::new, surfaces::warnings);
    warnings.extend(no_medium(document));
    let contents = loaded.as_ref().map_or_else(Contents::default, |loaded| Contents::of(loaded, chosen.of_model));
    let camera = DVec3::from(chosen.camera.position);
    let origin = loaded.as_ref().map_or_else(|| origin::around(camera), |loaded| DVec3::from(loaded.model.origin));
    let geometry = scene.geometry.iter().map(|geometry| document.folder().join(geometry));
    let files = geometry.chain(loaded.iter().flat_map(|loaded| loaded.model.files.clone())).collect();
    let looks = loaded.as_ref().map(|loaded| (loaded.file.clone(), loaded.model.materials.clone()));
    let frame = check::frame(&scene, document, &chosen, &placed, loaded.map(|loaded| loaded.model), origin)?;
    warnings.extend(looks.and_then(|(file, looks)| backs::seen(&frame, scene.film.size, &file, &looks)));
    let lights = placed.into_iter().map(|placed| Light { name: placed.name, values: placed.light }).collect();
    let origin = origin.to_array();
    Ok(LoadedScene { name, files, scene, camera: chosen.camera, lights, contents, frame, warnings, origin })
}

/// The scene file that `path` means.
fn file(path: &Path) -> Result<PathBuf> {
    if !path.is_dir() {
        return Ok(path.to_path_buf());
    }
    let file = path.join("scene.toml");
    if file.exists() {
        return Ok(file);
    }
    let remedy = "give a scene file, a glTF file, or a folder with a scene.toml";
    Err(Error::failure(path.display(), "is a folder without a scene.toml", remedy))
}

/// What the scene at `path` is called: a folder's name, or a file's without its ending; `a/scene.toml` is `a`.
fn name(path: &Path) -> String {
    let path = match path.file_stem() {
        Some(stem) if stem == "scene" && !path.is_dir() => path.parent().unwrap_or(path),
        _ => path,
    };
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
    name.map_or_else(|| "scene".into(), |name| name.to_string_lossy().into_owned())
}

/// Types and names of all keys.
fn read(document: &Document) -> Result<Scene> {
    serde_path_to_error::deserialize(document.values.clone().into_deserializer()).map_err(|error| {
        let path = error.path().to_string();
        let words = plain::words(error.inner().message());
        let remedy = match (path.as_str(), document.values.get("light")) {
            ("light", Some(toml::Value::Table(_))) => "write [[light]]: lights are a list of tables",
            _ => "see fogbow render --help-scene for every key with its type and range",
        };
        let finding = words.at(if path == "." { "" } else { &path });
        document.error(&path, finding, words.remedy.unwrap_or_else(|| remedy.into()))
    })
}

/// A medium that was meant to be one, but has no coefficients.
fn no_medium(document: &Document) -> Option<Warning> {
    let medium = document.values.get("medium")?.as_table()?;
    let is_empty = ["scattering", "absorption"].iter().all(|key| !medium.contains_key(*key));
    let finding = "medium has neither scattering nor absorption, so it is vacuum";
    is_empty.then(|| Warning::new(document.place("medium"), finding))
}

impl LoadedScene {
    /// A hash of everything that the value of a sample depends on: scenes with the same hash have the same samples.
    pub fn hash(&self) -> String {
        let mut scene = self.scene.clone();
        scene.render.samples = 0;
        scene.film.exposure = NumberOrAuto::default();
        // What is taken from the geometry's file counts, not what it is called there.
        scene.geometry = None;
        scene.punctual_radius = 0.0;
        scene.camera = Some(CameraOrName::Table(self.camera));
        scene.light = self.lights.iter().map(|light| light.values.clone()).collect();
        let canonical = serde_json::to_vec(&scene).expect("a scene is made of numbers and names");
        let mut hasher = blake3::Hasher::new();
        hasher.update(&canonical);
        hasher.update(self.origin.map(f64::to_le_bytes).as_flattened());
        let mut digest = |bytes: &[u8]| {
            hasher.update(bytes);
        };
        self.frame.surfaces.digest(&mut digest);
        self.frame.lights.digest(&mut digest);
        hasher.finalize().to_hex()[..32].to_string()
    }

    /// All keys as TOML, overrides and defaults included.
    pub fn to_toml(&self) -> String {
        toml::to_string(&self.scene).expect("a scene is a table of tables")
    }
}
