//! The keys of a scene in the extras of a glTF file that is a scene by itself, beside its geometry, its first camera
//! and its lights: `"extras": {"fogbow": {"medium": {..}, "film": {..}, "render": {..}}}`, as in a scene file.

use std::path::Path;

use serde_json::Value as Json;
use toml::{Table, Value};

use super::document::{Document, EXTRAS};
use crate::error::{Error, Result};
use crate::gltf::Asset;

/// What was read, or what is wrong with it.
type Read<T> = core::result::Result<T, String>;

/// The keys of the scene that `asset`, the file at `path`, is.
pub fn document(path: &Path, asset: &Asset) -> Result<Document> {
    let own = asset.extras().and_then(|extras| extras.get("fogbow"));
    let keys = own.map_or(Ok(Table::new()), keys).map_err(|finding| {
        let remedy = "write an object with the keys of a scene.toml; fogbow render --help-scene lists them";
        Error::failure(asset.file(), format!("{EXTRAS} {finding}"), remedy)
    })?;
    if keys.contains_key("geometry") {
        let finding = format!("{EXTRAS} has the key geometry, but the geometry is this file");
        return Err(Error::failure(asset.file(), finding, "leave the key out"));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok(Document::of_model(asset.file(), &name, keys))
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
