//! The glTF file of a scene.

use super::document::Document;
use super::origin;
use super::ranges::{LARGEST_RADIANCE, Owner};
use super::schema::Scene;
use crate::error::Result;
use crate::gltf::{self, Model, label, quoted};

/// Names that an error lists.
const MOST_LISTED: usize = 10;

/// A model and its file.
#[derive(Debug)]
pub struct Loaded {
    /// What errors call the file.
    pub file: String,
    /// What it holds.
    pub model: Model,
}

/// The model that `scene` names as its geometry; `given` is that of a file which is a scene by itself.
pub fn of_scene(scene: &Scene, document: &Document, given: Option<Model>) -> Result<Option<Loaded>> {
    let Some(geometry) = &scene.geometry else { return Ok(None) };
    let loaded = match given {
        Some(model) if !document.is_set_by_flag("geometry") => Loaded { file: document.file().into(), model },
        _ => load(geometry, scene, document)?,
    };
    check_emission(&loaded)?;
    Ok(Some(loaded))
}

/// Emission of materials, within the limits of other lights.
fn check_emission(loaded: &Loaded) -> Result<()> {
    for (index, material) in loaded.model.materials.iter().enumerate() {
        // In the model's precision: the 32-bit number nearest to the limit is above it.
        let ok = material.emission.iter().all(|x| *x <= LARGEST_RADIANCE as f32);
        let owner = Owner::Object(format!("{}: {}", loaded.file, label("material", index, material.name.as_deref())));
        let finding = format!("{:?}", material.emission);
        owner.require(ok, "emission", finding, "scale it down to 1e30 W/(m^2 sr) or less")?;
    }
    Ok(())
}

fn load(geometry: &str, scene: &Scene, document: &Document) -> Result<Loaded> {
    let path = document.folder().join(geometry);
    let file = path.display().to_string();
    if !path.is_file() {
        let finding = match path.is_dir() {
            true => format!("geometry is {geometry:?}, but {file} is a folder"),
            false => format!("geometry is {geometry:?}, but there is no file {file}"),
        };
        let remedy = "give the path of a .gltf or .glb file, relative to the folder of the scene";
        return Err(document.error("geometry", finding, remedy));
    }
    Ok(Loaded { model: gltf::load_from(&path, |camera| origin::of_scene(scene, camera))?, file })
}

/// Names as an error lists them.
pub fn list<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    let more = names.len().saturating_sub(MOST_LISTED);
    let named = names.take(MOST_LISTED).map(quoted).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{named} and {more} more") } else { named }
}
