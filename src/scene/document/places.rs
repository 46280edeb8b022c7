//! Where each value of a document stands: at a line of the file, in the extras of a glTF file, or on the command line.

use std::collections::BTreeMap;

use toml::de::{DeArray, DeTable, DeValue};
use toml::{Spanned, Value};

/// Where the keys of a glTF file stand that is a scene by itself.
pub const EXTRAS: &str = "extras.fogbow of the scene";

/// Where a value comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file, at this byte. Lines are counted when somebody asks: scenes may have thousands of lights.
    Byte(usize),
    /// A flag of the command line.
    Flag(String),
    /// The extras of a glTF file's scene.
    Extras,
}

/// Notes the places of all values of `table`, which stands at `path`.
pub fn note_table(places: &mut BTreeMap<String, Place>, path: &str, table: &DeTable<'_>) {
    for (key, value) in table.iter() {
        let path = if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
        note(places, path, key.span().start, value);
    }
}

fn note_array(places: &mut BTreeMap<String, Place>, path: &str, array: &DeArray<'_>) {
    for (index, value) in array.iter().enumerate() {
        note(places, format!("{path}[{index}]"), value.span().start, value);
    }
}

fn note(places: &mut BTreeMap<String, Place>, path: String, at: usize, value: &Spanned<DeValue<'_>>) {
    match value.get_ref() {
        DeValue::Table(table) => note_table(places, &path, table),
        DeValue::Array(array) => note_array(places, &path, array),
        _ => {}
    }
    places.insert(path, Place::Byte(at));
}

/// Notes all values below `path` as those of the extras.
pub fn note_extras(places: &mut BTreeMap<String, Place>, path: &str, value: &Value) {
    let mut below = |path: String, value: &Value| {
        note_extras(places, &path, value);
        places.insert(path, Place::Extras);
    };
    match value {
        Value::Table(table) if path.is_empty() => table.iter().for_each(|(key, value)| below(key.clone(), value)),
        Value::Table(table) => table.iter().for_each(|(key, value)| below(format!("{path}.{key}"), value)),
        Value::Array(array) => {
            array.iter().enumerate().for_each(|(index, value)| below(format!("{path}[{index}]"), value));
        }
        _ => {}
    }
}

/// `file:line:column` of a byte of its text, counted from 1, columns in characters.
pub fn place_at(file: &str, text: &str, offset: usize) -> String {
    let before = &text[..offset];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let (line, column) = (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1);
    format!("{file}:{line}:{column}")
}
