//! Scenes: from a file and flags to a [`Frame`](crate::frame::Frame).

mod backs;
mod boundaries;
mod cameras;
mod check;
pub(crate) mod contents;
pub mod document;
mod environment;
mod extras;
mod filling;
pub mod help;
mod lights;
mod loaded;
mod loading;
mod model;
mod phase;
pub mod presets;
mod punctual;
mod ranges;
pub mod schema;
mod surfaces;
mod volumes;

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use serde::de::IntoDeserializer;

use crate::error::{Error, Result};
use crate::gltf::Asset;
use crate::warning::Warning;
use document::{Document, Override, words};
pub use filling::{Densities, Filling};
pub use lights::ANGULAR_RADIUS;
use lights::{Placed, Shining};
pub use loaded::{Contents, Light, LoadedScene};
pub use loading::{Loading, Look};
use model::Loaded;
use ranges::Owner;
use schema::{Film, Scene, Technique, Techniques};
pub use volumes::too_far_apart;
use volumes::{GridFiles, Sources};

/// Reads the scene at `path`, a TOML file, a folder with a `scene.toml` or a glTF file, and applies `overrides` in
/// order.
///
/// # Errors
/// If the file or its geometry cannot be read, is not TOML or glTF, or has unknown keys, wrong types or values out of
/// range.
pub fn load(path: &Path, overrides: Vec<Override>) -> Result<LoadedScene> {
    load_at(path, overrides, None, &|_| {})
}

/// The same with the nodes of its geometry where animations have them at `time` `[s]`, or else where the file places
/// them; tells `look` now and then how far volumes have been read.
///
/// # Errors
/// As [`load`].
pub fn load_at(path: &Path, overrides: Vec<Override>, time: Option<f64>, look: Look<'_>) -> Result<LoadedScene> {
    let file = file(path)?;
    let is_model = model::is_model(&file);
    let asset = is_model.then(|| Asset::open(&file, time)).transpose()?;
    let mut document = match &asset {
        Some(asset) => extras::document(&file, asset)?,
        None => Document::read(&file)?,
    };
    document.apply_all(overrides)?;
    let mut scene = load_document(name(path), &document, (asset, time), look)?;
    scene.files.insert(0, file);
    scene.file_hashes = contents::of(&scene.files, is_model);
    Ok(scene)
}

/// Parses and checks a scene from memory; `file` is what errors call it.
///
/// # Errors
/// As [`load`].
pub fn parse(file: &str, text: &str) -> Result<LoadedScene> {
    load_document(name(Path::new(file)), &Document::parse(file, text)?, (None, None), &|_| {})
}

/// The scene that `document` describes at a time; the asset is the glTF file that is a scene by itself.
///
/// The camera comes first: it says what positions are counted from, and with that the model's vertices are read.
fn load_document(
    name: String,
    document: &Document,
    (asset, time): (Option<Asset>, Option<f64>),
    look: Look<'_>,
) -> Result<LoadedScene> {
    let mut scene = read(document)?;
    presets::resolve(&mut scene, document)?;
    if !scene.volume.is_empty() && !scene.has_endless_medium() && !document.has("render.technique") {
        scene.render.technique = Techniques(vec![Technique::Nee]);
    }
    let asset = model::open(&scene, document, asset, time)?;
    let chosen = cameras::choose(&scene, document, asset.as_ref())?;
    if let Some(aspect) = chosen.aspect.filter(|_| !document.has("film.size")) {
        scene.film.size = Film::of_aspect(aspect).size;
    }
    let origin = chosen.origin();
    let mut loaded = asset.map(|asset| Loaded::read(asset, origin)).transpose()?;
    let boundaries = volumes::boundaries(&scene, document, loaded.as_mut())?;

    let placed = all_lights(&scene, document, loaded.as_ref())?;
    let has_suns = !scene.has_endless_medium();
    let mut warnings = loaded.as_ref().map_or_else(Vec::new, |loaded| surfaces::warnings(loaded, has_suns));
    warnings.extend(no_medium(document));
    let finding = "nothing moves: there is no geometry, and all frames are alike";
    warnings.extend((time.is_some() && loaded.is_none()).then(|| Warning::new(document.place("geometry"), finding)));
    let contents = loaded.as_ref().map(|loaded| Contents::of(&loaded.model, chosen.of_model)).unwrap_or_default();
    let looks = loaded.as_ref().map(|loaded| (loaded.file.clone(), loaded.model.materials.clone()));
    let beside = loaded.as_ref().map_or_else(Vec::new, |loaded| loaded.model.files.clone());
    let phases = scene.medium.iter().map(|medium| &medium.phase).chain(scene.volume.iter().map(|volume| &volume.phase));
    let tables = phases.filter_map(|phase| phase.file.as_ref());
    let grids = scene.volume.iter().flat_map(|volume| [&volume.grid, &volume.emission_grid]);
    let grids = grids.flatten().map(|grid| &grid.file);
    let named = scene.geometry.iter().chain(tables).chain(grids).map(|file| document.folder().join(file));
    let files = named.chain(environment::file(&scene, document)).chain(beside).collect();
    let sky = environment::source(&scene, document)?;
    warnings.extend(environment::warning(&scene, sky.as_ref()));
    let (shining, model) = (Shining { placed: &placed, sky }, loaded.map(|loaded| loaded.model));
    let told = RefCell::new(Vec::new());
    let warn = |warning| told.borrow_mut().push(warning);
    let sources = Sources { boundaries, files: GridFiles::default(), look, warn: &warn };
    let (frame, fillings) = check::frame(&scene, document, &chosen, &shining, model, &sources, origin)?;
    warnings.extend(told.take());
    warnings.extend(looks.and_then(|(file, looks)| backs::seen(&frame, scene.film.size, &file, &looks)));
    let lights = placed.into_iter().map(|placed| Light { name: placed.name, values: placed.light }).collect();
    let (camera, origin, file_hashes) = (chosen.camera, origin.to_array(), String::new());
    Ok(LoadedScene { name, files, file_hashes, scene, camera, lights, contents, fillings, frame, warnings, origin })
}

/// The lights of `scene`: those of its file first, then those that stand for the punctual ones of its model.
fn all_lights<'a>(scene: &Scene, document: &'a Document, loaded: Option<&Loaded>) -> Result<Vec<Placed<'a>>> {
    let radius = Owner::Table(document, String::new()).radius("punctual_radius", scene.punctual_radius)?;
    let has_suns = !scene.has_endless_medium();
    let of_model = loaded.map_or(Ok(Vec::new()), |loaded| punctual::of_model(loaded, radius, has_suns))?;
    Ok(lights::of_file(scene, document).chain(of_model).collect())
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
pub fn name(path: &Path) -> String {
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
        let words = words(error.inner().message());
        let remedy = remedy_of(&path, document);
        let finding = words.at(if path == "." { "" } else { &path });
        document.error(&path, finding, words.remedy.unwrap_or_else(|| remedy.into()))
    })
}

/// What to do about a value of the wrong type.
fn remedy_of(path: &str, document: &Document) -> &'static str {
    let is_table = |key: &str| document.values.get(key).is_some_and(toml::Value::is_table);
    match path {
        "light" if is_table(path) => "write [[light]]: lights are a list of tables",
        "volume" if is_table(path) => "write [[volume]]: volumes are a list of tables",
        _ if path.starts_with("volume[") && (path.ends_with("].grid") || path.ends_with("].emission_grid")) => {
            "name the file in a table: { file = \"cloud.vdb\" }"
        }
        _ if path.starts_with("volume[") && path.ends_with("].shape") => {
            "write a table: { type = \"sphere\", center = [0, 0, 0], radius = 1 }, or of type box or mesh"
        }
        _ => "see fogbow render --help-scene for every key with its type and range",
    }
}

/// A medium that was meant to be one, but has no coefficients.
fn no_medium(document: &Document) -> Option<Warning> {
    let medium = document.values.get("medium")?.as_table()?;
    let is_empty = ["preset", "scattering", "absorption"].iter().all(|key| !medium.contains_key(*key));
    let finding = "medium has neither scattering nor absorption, so it is vacuum";
    is_empty.then(|| Warning::new(document.place("medium"), finding))
}
