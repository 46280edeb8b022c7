//! glTF files: their cameras and their lights.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::support::{Folder, header};

/// A wall of 4 m x 4 m at z = -3 m that faces +z, a camera at the origin that looks at it, and a spot beside the camera.
fn model() -> Value {
    let corners = [[-2.0_f32, -2.0, -3.0], [2.0, -2.0, -3.0], [2.0, 2.0, -3.0], [-2.0, 2.0, -3.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": uri, "byteLength": bytes.len() }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4 },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6 },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "cameras": [
            { "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1, "aspectRatio": 1.5 } },
        ],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "spot", "intensity": 30, "spot": { "outerConeAngle": 0.5 }, "extras": { "radius": 0.05 } },
        ] } },
        "nodes": [
            { "name": "Wall", "mesh": 0 },
            { "name": "Eye", "camera": 0 },
            { "name": "Lamp", "translation": [1, 0, 0], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        ],
        "scenes": [{ "nodes": [0, 1, 2] }],
        "scene": 0,
    })
}

/// A scene around the model.
const AROUND: &str = r#"
geometry = "room.gltf"
camera = "Eye"

[film]
size = [6, 4]

[render]
technique = "nee"
samples = 64
"#;

/// A folder with the model, edited.
fn with_model(edit: impl FnOnce(&mut Value)) -> Folder {
    let folder = Folder::empty();
    let mut model = model();
    edit(&mut model);
    folder.write("room.gltf", model.to_string());
    folder
}

/// The same with this scene file beside it.
fn with_scene(scene: &str) -> Folder {
    let folder = with_model(|_| {});
    folder.write("scene.toml", scene);
    folder
}

#[test]
fn a_named_camera_is_the_same_as_its_table() {
    let folder = with_scene(AROUND);
    let degrees = 0.5_f64.to_degrees();
    let table = format!("[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\nvertical_fov_deg = {degrees}\n");
    folder.write("table.toml", AROUND.replace("camera = \"Eye\"\n", &table));
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    folder.done(&["render", "table.toml", "-o", "b.exr"]);
    let [named, written] = ["a.exr", "b.exr"].map(|name| folder.image(name));
    assert_eq!(named.channels, written.channels);
    assert_eq!(header(&named, "scene_hash"), header(&written, "scene_hash"));
    assert!(header(&named, "settings").contains("camera = \"Eye\"\n"));
}

#[test]
fn a_camera_that_is_not_there_is_refused_with_those_that_are() {
    let folder = with_scene(AROUND);
    folder.write("scene.toml", AROUND.replace("\"Eye\"", "\"eye\""));
    let beginning = format!("{}: camera is \"eye\", but room.gltf has none of that name\n", folder.place("camera"));
    let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
    assert!(run.stderr.contains("help: name one of its cameras: \"Eye\"\n"), "{run}");

    folder.write("scene.toml", AROUND.replace("geometry = \"room.gltf\"\n", ""));
    let beginning = format!("{}: camera is \"Eye\", but there is no geometry", folder.place("camera"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
    folder.write("scene.toml", AROUND.replace("\"Eye\"", "7"));
    let beginning =
        format!("{}: camera: this is the whole number `7`, expected a table, or the", folder.place("camera"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
}
