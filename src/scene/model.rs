//! The glTF file of a scene.

use std::path::Path;

use glam::DVec3;

use super::document::Document;
use super::ranges::{LARGEST_RADIANCE, Owner};
use super::schema::Scene;
use crate::error::Result;
use crate::gltf::{Asset, Material, Model, label, quoted};

/// Names that an error lists.
const MOST_LISTED: usize = 10;

/// Whether `path` is called like a glTF file.
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["gltf", "glb"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// The file that `scene` names as its geometry, at `time`; `given` is the one that is a scene by itself.
pub fn open(scene: &Scene, document: &Document, given: Option<Asset>, time: Option<f64>) -> Result<Option<Asset>> {
    match (&scene.geometry, given) {
        (None, _) => Ok(None),
        (Some(_), Some(asset)) if !document.is_set_by_flag("geometry") => Ok(Some(asset)),
        (Some(geometry), _) => open_geometry(geometry, document, time).map(Some),
    }
}

fn open_geometry(geometry: &str, document: &Document, time: Option<f64>) -> Result<Asset> {
    let path = document.folder().join(geometry);
    if path.is_file() {
        return Asset::open(&path, time);
    }
    let file = path.display();
    let finding = match path.is_dir() {
        true => format!("geometry is {geometry:?}, but {file} is a folder"),
        false => format!("geometry is {geometry:?}, but there is no file {file}"),
    };
    let remedy = "give the path of a .gltf or .glb file, relative to the folder of the scene";
    Err(document.error("geometry", finding, remedy))
}

/// A model and its file.
#[derive(Debug)]
pub struct Loaded {
    /// What errors call the file.
    pub file: String,
    /// What it holds.
    pub model: Model,
}

impl Loaded {
    /// What `asset` holds, with vertices counted from `origin`.
    pub fn read(asset: Asset, origin: DVec3) -> Result<Self> {
        let file = asset.file().to_string();
        let model = asset.load(origin)?;
        check_emission(&file, &model.materials)?;
        Ok(Self { file, model })
    }
}

/// Emission of materials, within the limits of other lights.
fn check_emission(file: &str, materials: &[Material]) -> Result<()> {
    for (index, material) in materials.iter().enumerate() {
        // In the model's precision: the 32-bit number nearest to the limit is above it.
        let ok = material.emission.iter().all(|x| *x <= LARGEST_RADIANCE as f32);
        let owner = Owner::Object(format!("{file}: {}", label("material", index, material.name.as_deref())));
        let finding = format!("{:?}", material.emission);
        owner.require(ok, "emission", finding, "scale it down to 1e30 W/(m^2 sr) or less")?;
    }
    Ok(())
}

/// Names as an error lists them.
pub fn list<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    let more = names.len().saturating_sub(MOST_LISTED);
    let named = names.take(MOST_LISTED).map(quoted).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{named} and {more} more") } else { named }
}
