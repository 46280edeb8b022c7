//! A model's part in the hash of its scene: whatever it changes in what is rendered, it changes there.

use fogbow::scene::{self, LoadedScene};
use serde_json::{Value, json};

use super::support::{Builder, COLORS, MOVED, POSITIONS, TEXCOORDS, everything};

/// What is rendered of a file; none if it is refused.
fn loaded(file: &Builder) -> Option<LoadedScene> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.glb");
    std::fs::write(&path, file.glb()).expect("a file");
    scene::load(&path, Vec::new()).ok()
}

/// A file with an object of every kind whose materials differ in everything.
fn model() -> Builder {
    let mut file = everything();
    // Another sampler, a second set of texture coordinates, and lights of every kind that shines.
    file.add("samplers", json!({}));
    let set = file.floats(&[[0.0, 0.5], [1.0, 0.25], [0.5, 1.0], [0.75, 1.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(set);
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(0);
    file.json["materials"][0]["doubleSided"] = json!(false);
    file.json["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"] = json!({ "radius": 0.02 });
    let bulb = json!({ "type": "point", "color": [0.5, 1, 1], "intensity": 3 });
    file.json["extensions"]["KHR_lights_punctual"]["lights"].as_array_mut().expect("lights").push(bulb);
    let node = json!({ "translation": [5, 6, 7], "extensions": { "KHR_lights_punctual": { "light": 1 } } });
    let node = file.add("nodes", node);
    file.json["scenes"][0]["nodes"].as_array_mut().expect("nodes").push(json!(node));
    file.json["cameras"][0]["extras"] = json!({ "near": 0.25 });
    file
}

/// Calls `visit` with the pointers to all numbers and truths in `value`.
fn leaves(pointer: &str, value: &Value, visit: &mut impl FnMut(&str, &Value)) {
    match value {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| leaves(&format!("{pointer}/{key}"), value, visit));
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(index, value)| leaves(&format!("{pointer}/{index}"), value, visit));
        }
        Value::Number(_) | Value::Bool(_) => visit(pointer, value),
        Value::Null | Value::String(_) => {}
    }
}

/// Other values, of which some may be refused.
fn others(value: &Value) -> Vec<Value> {
    match value {
        Value::Bool(truth) => vec![json!(!truth)],
        number => {
            let number = number.as_f64().expect("a number");
            let integer = number.fract() == 0.0;
            let neighbours = [number - 1.0, number + 1.0].map(|other| json!(other as i64));
            let constants = [9728, 9729, 10497, 33071, 33648].map(|constant| json!(constant));
            let fractions = [0.875 * number, 1.125 * number, number + 0.125].map(|other| json!(other));
            let integers = neighbours.into_iter().chain(constants).filter(|_| integer && number >= 0.0);
            integers.chain(fractions).filter(|other| other.as_f64() != Some(number)).collect()
        }
    }
}

/// Numbers that nothing rendered depends on: coverage, metal, and what a rasteriser clips.
fn has_no_effect(pointer: &str) -> bool {
    ["baseColorFactor/3", "metallicFactor", "znear"].iter().any(|end| pointer.ends_with(end))
}

/// Values to try for each number: accepted ones.
const ENOUGH: usize = 2;

/// Tries other values for all numbers in `table`, none of which may change the frame without the hash; calls `visit`
/// with the pointer to each and whether one of them changed the frame.
fn try_all(table: &str, mut visit: impl FnMut(&str, bool)) {
    let file = model();
    let base = loaded(&file).expect("a scene by itself");
    leaves(&format!("/{table}"), &file.json[table], &mut |pointer, value| {
        let edited = |other: &Value| {
            let mut edited = Builder { json: file.json.clone(), binary: file.binary.clone() };
            *edited.json.pointer_mut(pointer).expect("a value") = other.clone();
            Some((other.clone(), loaded(&edited)?))
        };
        let mut seen = false;
        for (other, scene) in others(value).iter().filter_map(edited).take(ENOUGH) {
            let changed = scene.frame != base.frame;
            assert_eq!(
                scene.hash() != base.hash(),
                changed,
                "{pointer}: {other} for {value}, another frame: {changed}"
            );
            seen |= changed;
        }
        visit(pointer, seen);
    });
}

#[test]
fn every_number_about_looks_changes_the_hash() {
    let mut tried = 0;
    for table in ["materials", "samplers", "textures", "cameras", "extensions"] {
        try_all(table, |pointer, seen| {
            assert_eq!(seen, !has_no_effect(pointer), "{pointer}: whether another value changes the frame");
            tried += 1;
        });
    }
    assert!(tried > 35, "only {tried} numbers");
}

#[test]
fn every_place_changes_the_hash() {
    let mut seen = 0;
    // What is where a turn or a scale does not show, or has nothing else to refer to, is not seen.
    for table in ["nodes", "meshes"] {
        try_all(table, |_, changed| seen += u32::from(changed));
    }
    assert!(seen > 15, "only {seen} numbers are seen");
}

#[test]
fn what_stands_in_buffers_changes_the_hash() {
    let file = model();
    let base = loaded(&file).expect("a scene by itself");
    for accessor in [POSITIONS, TEXCOORDS, COLORS, MOVED] {
        let view = file.json["accessors"][accessor]["bufferView"].as_u64().expect("a view") as usize;
        let view = &file.json["bufferViews"][view];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().expect("bytes") as usize);
        for byte in (start..start + length).step_by(4) {
            let mut edited = Builder { json: file.json.clone(), binary: file.binary.clone() };
            // The second byte of a float is part of its fraction; of a colour it is green.
            edited.binary[byte + 1] ^= 0x40;
            let scene = loaded(&edited).expect("still a scene");
            assert!(scene.hash() != base.hash() || scene.frame == base.frame, "accessor {accessor}, byte {byte}");
        }
    }
}
