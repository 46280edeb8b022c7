//! The keys of a scene in the extras of a glTF file that is a scene by itself, beside its geometry, its first camera and its
//! lights: `"extras": {"fogbow": {"medium": {..}, "film": {..}, "render": {..}}}`, as in a scene file.

use std::path::Path;

use glam::DVec3;
use serde_json::Value as Json;
use toml::{Table, Value};

use super::document::{Document, EXTRAS};
use super::origin;
use crate::error::{Error, Result};
use crate::gltf::{self, Model};

/// What was read, or what is wrong with it.
type Read<T> = core::result::Result<T, String>;

/// Whether `path` is called like a glTF file.
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["gltf", "glb"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// The keys of the scene that the file at `path` is, and what it holds.
pub fn read(path: &Path) -> Result<(Document, Model)> {
    let model = gltf::load_from(path, |camera| camera.map_or(DVec3::ZERO, origin::around))?;
    let own = model.extras.scene.as_ref().and_then(|extras| extras.get("fogbow"));
    let keys = own.map_or(Ok(Table::new()), keys).map_err(|finding| {
        let remedy = "write an object with the keys of a scene.toml; fogbow render --help-scene lists them";
        Error::failure(path.display(), format!("{EXTRAS} {finding}"), remedy)
    })?;
    if keys.contains_key("geometry") {
        let finding = format!("{EXTRAS} has the key geometry, but the geometry is this file");
        return Err(Error::failure(path.display(), finding, "leave the key out"));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok((Document::of_model(&path.display().to_string(), &name, keys), model))
}

/// The keys as a scene file would have them, or what is wrong with them.
fn keys(own: &Json) -> Read<Table> {
    match from_json(own, "")? {
        Value::Table(table) => Ok(table),
        _ => Err(format!("is {own}, not an object")),
    }
}

fn from_json(json: &Json, path: &str) -> Read<Value> {
    Ok(match json {
        Json::Null if path.is_empty() => return Err("is null, not an object".into()),
        Json::Null => return Err(format!("has null at {path:?}, which is not allowed")),
        Json::Bool(value) => Value::Boolean(*value),
        Json::Number(number) => match number.as_i64() {
            Some(integer) => Value::Integer(integer),
            None => Value::Float(number.as_f64().unwrap_or(f64::NAN)),
        },
        Json::String(text) => Value::String(text.clone()),
        Json::Array(list) => Value::Array(list.iter().map(|entry| from_json(entry, path)).collect::<Read<_>>()?),
        Json::Object(object) => {
            let one = |(key, value): (&String, &Json)| {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                from_json(value, &path).map(|value| (key.clone(), value))
            };
            Value::Table(object.iter().map(one).collect::<Read<_>>()?)
        }
    })
}
