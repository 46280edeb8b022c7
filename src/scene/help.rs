//! The page that documents every key of a scene file, written from the schema itself.

use core::fmt::Write;

use schemars::schema_for;
use serde_json::Value;

use super::schema::Scene;

/// Every key with its type, default and meaning.
pub fn page() -> String {
    let schema = schema_for!(Scene).to_value();
    let mut page = String::from(
        "A scene is a TOML file or a glTF file. A glTF file may have the same keys in the extras of its scene, under \
         \"fogbow\".\n\
         Units are metres, 1/m and W/(m^2 sr). Unknown keys, wrong types and values out of range are errors.\n\
         Every key can be overridden: --set medium.phase.g=0.6, --set light[0].radius=0.1\n",
    );
    for (name, property) in properties(&schema) {
        let (list, table) = match &property["items"] {
            Value::Null => (false, resolve(&schema, property)),
            items => (true, resolve(&schema, items)),
        };
        if !table["properties"].is_object() {
            // A key of its own, which TOML wants before the first table.
            let _ = writeln!(page, "\n{}", entry(&schema, &schema, name, property));
            continue;
        }
        let heading = if list { format!("[[{name}]]") } else { format!("[{name}]") };
        let _ = writeln!(page, "\n{heading}\n    {}", description(property));
        keys(&mut page, &schema, table, "");
    }
    page
}

fn keys(page: &mut String, schema: &Value, table: &Value, prefix: &str) {
    for (key, property) in properties(table) {
        let target = resolve(schema, property);
        let _ = writeln!(page, "{prefix}{}", entry(schema, table, key, property));
        for (value, meaning) in choices(schema, target) {
            let _ = writeln!(page, "      \"{value}\": {meaning}");
        }
        if target["properties"].is_object() {
            keys(page, schema, target, &format!("    {key}."));
        }
    }
}

/// The lines about one key of `table`: how it is written, and what it means.
fn entry(schema: &Value, table: &Value, key: &str, property: &Value) -> String {
    let required = table["required"].as_array().is_some_and(|names| names.contains(&Value::from(key)));
    let default = match &property["default"] {
        _ if required => "required".to_string(),
        Value::Null => "optional".to_string(),
        default => format!("default {default}"),
    };
    format!("{key} = {}  ({default})\n    {}", kind(schema, property), description(property))
}

/// The definition that a property refers to, or the property itself.
fn resolve<'a>(schema: &'a Value, property: &'a Value) -> &'a Value {
    let alternatives = ["anyOf", "allOf"].iter().filter_map(|name| property[*name].as_array()).flatten();
    let mut targets = core::iter::once(property).chain(alternatives);
    let reference = targets.find_map(|target| target["$ref"].as_str());
    reference.and_then(|path| schema.pointer(path.trim_start_matches('#'))).unwrap_or(property)
}

fn properties(table: &Value) -> impl Iterator<Item = (&String, &Value)> {
    table["properties"].as_object().into_iter().flatten()
}

fn description(property: &Value) -> String {
    property["description"].as_str().unwrap_or_default().replace('`', "").replace('\n', "\n    ")
}

/// The named values of a choice, or of a list of choices, with their meanings.
fn choices<'a>(schema: &'a Value, target: &'a Value) -> impl Iterator<Item = (&'a str, &'a str)> {
    let alternatives = target["oneOf"].as_array().or_else(|| resolve(schema, &target["items"])["oneOf"].as_array());
    alternatives
        .into_iter()
        .flatten()
        .filter_map(|choice| Some((choice["const"].as_str()?, choice["description"].as_str().unwrap_or_default())))
}

/// How a value is written.
fn kind<'a>(schema: &'a Value, property: &'a Value) -> &'a str {
    let target = resolve(schema, property);
    let format = property["x-format"].as_str().or_else(|| target["x-format"].as_str());
    format.unwrap_or_else(|| match target["type"].as_str() {
        Some("array") => "[x, y, z]",
        Some("integer") => "whole number",
        Some("object") => "{ .. }",
        Some("string") | None => "name",
        Some(other) => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_schema_is_on_the_page_with_a_meaning() {
        let (schema, page) = (schema_for!(Scene).to_value(), page());
        let tables = schema["$defs"].as_object().expect("definitions").values().chain([&schema]);
        let mut count = 0;
        for (key, property) in tables.flat_map(properties) {
            let line = page.lines().position(|line| {
                let nested = ["phase.", "shape.", "grid.", "emission_grid."].into_iter();
                let line = nested.fold(line.trim(), |line, table| line.trim_start_matches(table));
                line.starts_with(&format!("{key} =")) || line.trim_matches(['[', ']']) == key
            });
            let line = line.unwrap_or_else(|| panic!("{key} is missing on\n{page}"));
            assert!(page.lines().nth(line + 1).is_some_and(|meaning| meaning.trim().len() > 5), "{key} on\n{page}");
            let is_table = resolve(&schema, property)["properties"].is_object() || property["items"].is_object();
            let as_table = page.contains(&format!("[{key}]"));
            assert!(is_table || !as_table, "{key} is a key, not a table, on\n{page}");
            assert!(property["description"].is_string() || property["$ref"].is_string(), "{key} has no description");
            count += 1;
        }
        assert!(count > 20, "only {count} keys");
    }

    #[test]
    fn every_choice_is_on_the_page() {
        let (schema, page) = (schema_for!(Scene).to_value(), page());
        let definitions = schema["$defs"].as_object().expect("definitions").values();
        let alternatives = definitions.filter_map(|definition| definition["oneOf"].as_array()).flatten();
        let names: Vec<_> = alternatives.filter_map(|choice| choice["const"].as_str()).collect();
        assert!(names.contains(&"lis") && names.contains(&"sphere") && names.len() > 12, "{names:?}");
        for name in names {
            assert!(page.contains(&format!("\"{name}\": ")), "{name} is missing on\n{page}");
        }
    }
}
