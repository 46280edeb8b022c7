//! Meshes of glTF files as lights.

use crate::support::{Folder, header};

/// A view along +z through an absorbing medium that leaves half of the light after a metre.
const SCENE: &str = r#"
geometry = "lamp.gltf"
[camera]
position = [0, 0, 0]
look_at = [0, 0, 1]
vertical_fov_deg = 53.13010235
[film]
size = [4, 4]
[medium]
scattering = 0
absorption = 0.6931471805599453
phase = { type = "henyey_greenstein", g = 0.5 }
[render]
samples = 1
"#;

/// A square at z = 1 that fills the view and faces the camera.
fn lamp(emission: [f64; 3], strength: f64) -> Folder {
    let folder = Folder::empty();
    folder.write("scene.toml", SCENE);
    let corners =
        [[-9.0, -9.0, 1.0], [-9.0, 9.0, 1.0], [9.0, 9.0, 1.0], [-9.0, -9.0, 1.0], [9.0, 9.0, 1.0], [9.0, -9.0, 1.0]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x: &f32| x.to_le_bytes()).collect();
    folder.write("lamp.bin", &bytes);
    let gltf = serde_json::json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "materials": [{
            "emissiveFactor": emission,
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } }
        }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 6, "min": [-9, -9, 1], "max": [9, 9, 1]
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() }],
        "buffers": [{ "uri": "lamp.bin", "byteLength": bytes.len() }]
    });
    folder.write("lamp.gltf", gltf.to_string());
    folder
}

#[test]
fn a_mesh_that_shines_is_a_light() {
    let folder = lamp([1.0, 0.5, 0.0], 8.0);
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--progress", "none"]);
    let image = folder.image("a.exr");
    for (name, radiance) in [("R", 8.0), ("G", 4.0), ("B", 0.0)] {
        let channel = image.channel(name).expect("a channel");
        // The way to the corner of the view is longer by a quarter.
        for value in channel {
            let share = f64::from(*value) / radiance;
            assert!(radiance == 0.0 && *value == 0.0 || (0.4..0.5).contains(&share), "{name}: {value}");
        }
    }
}

#[test]
fn emission_is_bounded_as_radiance_is() {
    let folder = lamp([1.0, 0.5, 0.0], 3e38);
    folder.refused(&["render", "scene.toml"], 1, "lamp.gltf: material 0: emission is [3e38, 1.5e38, 0.0]\n");
    lamp([1.0, 0.5, 0.0], 1.1e30).refused(&["render", "scene.toml"], 1, "lamp.gltf: material 0: emission is [1.1e30, ");
    lamp([1.0, 0.5, 0.0], 1e30).done(&["info", "scene.toml"]);
}

/// The lamp whose material has this texture but whose mesh has no texture coordinates.
fn textured(slot: &str) -> Folder {
    let folder = lamp([1.0; 3], 8.0);
    let text = std::fs::read_to_string(folder.path("lamp.gltf")).expect("a model");
    let mut gltf: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    gltf["images"] = serde_json::json!([{ "uri": "grey.png" }]);
    gltf["textures"] = serde_json::json!([{ "source": 0 }]);
    let material = &mut gltf["materials"][0];
    let info = serde_json::json!({ "index": 0 });
    match slot {
        "emissiveTexture" => material[slot] = info,
        _ => material["pbrMetallicRoughness"] = serde_json::json!({ "baseColorTexture": info }),
    }
    folder.write("lamp.gltf", gltf.to_string());
    let file = std::fs::File::create(folder.path("grey.png")).expect("a file");
    let mut encoder = png::Encoder::new(file, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&[188; 3])).expect("an image");
    folder
}

#[test]
fn textures_without_texture_coordinates_have_one_texel() {
    for (slot, share) in [("baseColorTexture", 1.0), ("emissiveTexture", 0.5)] {
        let folder = textured(slot);
        let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--progress", "none"]);
        assert!(run.stderr.contains("texture coordinates"), "{run}");
        let image = folder.image("a.exr");
        for value in image.channel("R").expect("red") {
            let seen = f64::from(*value) / (8.0 * share);
            assert!((0.4..0.51).contains(&seen), "{slot}: {value}");
        }
    }
}

#[test]
fn strength_changes_the_hash() {
    let hash = |strength: f64| {
        let folder = lamp([1.0; 3], strength);
        folder.done(&["render", "scene.toml", "-o", "a.exr", "--progress", "none"]);
        header(&folder.image("a.exr"), "scene_hash").to_string()
    };
    assert_eq!(hash(2.0), hash(2.0));
    assert_ne!(hash(2.0), hash(3.0));
}

#[test]
fn a_scene_in_which_nothing_shines_is_refused() {
    let folder = lamp([0.0; 3], 8.0);
    folder.refused(&["render", "scene.toml"], 1, "scene.toml: the scene has no light");
}

#[test]
fn statistics_tell_of_surfaces() {
    let folder = lamp([1.0; 3], 2.0);
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--progress", "none", "--stats", "s.json"]);
    let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    let statistics: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let stages = statistics["stages"].as_array().expect("stages");
    let surface = stages.iter().find(|stage| stage["stage"] == "surface").expect("a stage");
    // Half of the paths or so get to the lamp, which is white.
    assert!(surface["rows"].as_u64().is_some_and(|rows| (1..=16).contains(&rows)), "{surface}");
}
