//! glTF files of scenes: their cameras and their lights.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::support::{Folder, Run, header, mean};

const HALF: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// A wall of 4 m x 4 m at z = -3 m that faces +z, a camera at the origin that looks at it, and a spot beside the
/// camera.
pub(super) fn model() -> Value {
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

/// Bytes in a data URI.
pub(super) fn encoded(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
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
pub(super) fn with_model(edit: impl FnOnce(&mut Value)) -> Folder {
    let folder = Folder::empty();
    let mut model = model();
    edit(&mut model);
    folder.write("room.gltf", model.to_string());
    folder
}

/// The same with this scene file beside it.
pub(super) fn with_scene(scene: &str) -> Folder {
    let folder = with_model(|_| {});
    folder.write("scene.toml", scene);
    folder
}

/// Flags that render the bare model small and soon.
pub(super) const SMALL: [&str; 4] = ["--size", "6x4", "--technique", "nee"];

pub(super) fn render(folder: &Folder, args: &[&str]) -> Run {
    folder.done(&[&["render", "room.gltf", "-o", "a.exr", "--progress", "none"], &SMALL[..], args].concat())
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
fn the_place_of_a_model_does_not_show() {
    let at = |place: [f64; 3], scene: &str| {
        let folder = with_model(|model| {
            for node in model["nodes"].as_array_mut().expect("nodes") {
                let own = |axis: usize| node["translation"].get(axis).and_then(Value::as_f64).unwrap_or(0.0);
                node["translation"] = json!([own(0) + place[0], own(1) + place[1], own(2) + place[2]]);
            }
        });
        folder.write("scene.toml", scene);
        folder.done(&["render", "scene.toml", "-o", "a.exr", "--set", "medium.scattering=0.3"]);
        folder.image("a.exr")
    };
    let here = at([0.0; 3], AROUND);
    let far = [1_234_567.0, -7_654_321.0, 250_000.0];
    let table = format!(
        "[camera]\nposition = {far:?}\nlook_at = [{:?}, {:?}, {:?}]\nvertical_fov_deg = {}\n",
        far[0],
        far[1],
        far[2] - 1.0,
        0.5_f64.to_degrees()
    );
    for scene in [AROUND.to_string(), AROUND.replace("camera = \"Eye\"\n", &table)] {
        let there = at(far, &scene);
        assert_eq!(here.channels, there.channels, "{scene}");
        assert_ne!(header(&here, "scene_hash"), header(&there, "scene_hash"));
    }
}

#[test]
fn cameras_look_along_minus_z_of_their_node() {
    // At first the wall fills the image; turned by half a turn about y, the camera sees nothing.
    let seen = |rotation: [f64; 4]| {
        let folder = with_model(|model| model["nodes"][1]["rotation"] = json!(rotation));
        render(&folder, &[]);
        mean(&folder.image("a.exr"), "R")
    };
    assert!(seen([0.0, 0.0, 0.0, 1.0]) > 0.0);
    assert_eq!(seen([0.0, 1.0, 0.0, 0.0]), 0.0);
    assert_eq!(seen([0.0, HALF, 0.0, HALF]), 0.0);
}

/// Radiance of the white wall in front of a light of 30 W/sr at the origin, whose node is turned so.
fn lit(kind: &str, rotation: [f64; 4]) -> f64 {
    let folder = with_model(|model| {
        model["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = json!(kind);
        model["nodes"][2]["rotation"] = json!(rotation);
        model["nodes"][2]["translation"] = json!([0, 0, 0]);
    });
    // The camera is in front of the light.
    let flags = ["--size", "1x1", "--technique", "nee", "--samples", "100000", "--set", "camera.position=[0, 0, -0.5]"];
    let view = ["--set", "camera.look_at=[0, 0, -1]", "--set", "camera.vertical_fov_deg=0.5"];
    folder.done(&[&["render", "room.gltf", "-o", "a.exr"], &flags[..], &view[..]].concat());
    mean(&folder.image("a.exr"), "R")
}

#[test]
fn points_shine_all_around_with_their_intensity() {
    let expected = 30.0 / (core::f64::consts::PI * 9.0);
    for rotation in [[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0]] {
        let ahead = lit("point", rotation);
        // Half of the sphere faces away: the standard error is 0.4 %.
        assert!((ahead / expected - 1.0).abs() < 0.02, "{ahead} instead of {expected}");
    }
}

#[test]
fn spots_shine_along_minus_z_of_their_node_with_their_intensity() {
    let expected = 30.0 / (core::f64::consts::PI * 9.0);
    let ahead = lit("spot", [0.0, 0.0, 0.0, 1.0]);
    assert!((ahead / expected - 1.0).abs() < 0.01, "{ahead} instead of {expected}");
    assert_eq!(lit("spot", [0.0, 1.0, 0.0, 0.0]), 0.0);
}

#[test]
fn a_camera_inside_a_light_is_refused() {
    // The light hangs on the camera's node.
    let folder = |kind: &str, radius: f64, near: f64| {
        with_model(|model| {
            let light = &mut model["extensions"]["KHR_lights_punctual"]["lights"][0];
            (light["type"], light["extras"]["radius"]) = (json!(kind), json!(radius));
            model["cameras"][0]["extras"] = json!({ "near": near });
            let lamp = model["nodes"][2]["extensions"].take();
            model["nodes"][1]["extensions"] = lamp;
            model["nodes"][2] = json!({ "name": "Nothing" });
        })
    };
    let inside = |near: &str| {
        format!(
            "room.gltf: light \"Eye\": center is [0.0, 0.0, 0.0], which puts the camera inside: its rays start {near} m from \
             there, and the radius is 0.05 m\n"
        )
    };
    for (near, says) in [(0.0, "0.0"), (0.04, "0.04")] {
        let run = folder("point", 0.05, near).refused(&["render", "room.gltf"], 1, &inside(says));
        assert!(run.stderr.contains("smaller radius, or set the camera's near beyond it"), "{run}");
    }
    for (kind, radius, near) in [("point", 0.05, 0.06), ("point", 0.03, 0.04), ("spot", 0.05, 0.0)] {
        render(&folder(kind, radius, near), &["--samples", "1"]);
    }
    let scene = Folder::with_edited_scene(
        "type = \"disk\"\ncenter = [0, 0, 3]\nnormal = [0, 0, -1]",
        "type = \"sphere\"\ncenter = [0, 0, 1]",
    );
    let beginning =
        format!("{}: light[0].center is [0.0, 0.0, 1.0], which puts the camera inside: ", scene.place("center"));
    scene.refused(&["render", "scene.toml"], 1, &beginning);
}

#[test]
fn the_near_plane_of_a_camera_is_that_of_its_extras() {
    let wall_behind_near = |extras: Value| {
        let folder = with_model(|model| {
            model["cameras"][0]["extras"] = extras;
            model["cameras"][0]["perspective"]["znear"] = json!(3.5);
        });
        render(&folder, &[]);
        mean(&folder.image("a.exr"), "R") == 0.0
    };
    assert!(!wall_behind_near(json!({ "lens": 35 })), "what glTF clips is not where paths start");
    assert!(wall_behind_near(json!({ "near": 3.5 })));
}

#[test]
fn a_camera_that_is_not_there_is_refused_with_those_that_are() {
    let folder = with_scene(AROUND);
    folder.write("scene.toml", AROUND.replace("\"Eye\"", "\"eye\""));
    let beginning =
        format!("{}: camera is \"eye\", but room.gltf has no camera of that name\n", folder.place("camera"));
    let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
    assert!(run.stderr.contains("help: name one of its cameras: \"Eye\"\n"), "{run}");
    let beginning = "--set camera=Lens: camera is \"Lens\", but room.gltf has no camera of that name\n";
    folder.refused(&["render", "room.gltf", "--set", "camera=Lens"], 2, beginning);

    folder.write("scene.toml", AROUND.replace("geometry = \"room.gltf\"\n", ""));
    let beginning = format!("{}: camera is \"Eye\", but there is no geometry", folder.place("camera"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
    folder.write("scene.toml", AROUND.replace("\"Eye\"", "7"));
    let beginning =
        format!("{}: camera: this is the whole number `7`, expected a table, or the", folder.place("camera"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
}

#[test]
fn a_flag_chooses_among_the_cameras() {
    let folder = with_model(|model| {
        model["nodes"][2]["camera"] = json!(0);
        model["nodes"]
            .as_array_mut()
            .expect("a list")
            .push(json!({ "name": "Back", "camera": 0, "rotation": [0, 1, 0, 0] }));
        model["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    });
    let seen = |args: &[&str]| {
        render(&folder, args);
        mean(&folder.image("a.exr"), "R")
    };
    assert!(seen(&[]) > 0.0);
    assert_eq!(seen(&["--set", "camera=Back"]), 0.0);
}

#[test]
fn a_model_too_large_is_refused_with_its_node_and_mesh() {
    let folder = with_model(|model| model["nodes"][0]["scale"] = json!([1e9, 1, 1]));
    folder.write("scene.toml", AROUND);
    for scene in ["room.gltf", "scene.toml"] {
        let beginning =
            "room.gltf: node 0 \"Wall\", mesh 0: puts vertex [-2.0, -2.0, -3.0] at [-2000000000.0, -2.0, -3.0]\n";
        let run = folder.refused(&["render", scene], 1, beginning);
        assert!(run.stderr.contains("coordinates may be at most 1e9 m"), "{run}");
    }
}

#[test]
fn an_ambiguous_name_is_refused_but_the_first_camera_is_not() {
    let folder = with_model(|model| model["nodes"][0] = json!({ "name": "Eye", "camera": 0 }));
    let beginning = "--set camera=Eye: camera is \"Eye\", but room.gltf has 2 cameras of that name\n";
    folder.refused(&["render", "room.gltf", "--set", "camera=Eye"], 2, beginning);
    render(&folder, &[]);
}

#[test]
fn a_model_without_a_camera_is_refused_with_a_remedy() {
    let folder = with_model(|model| drop(model["nodes"][1].as_object_mut().expect("a node").remove("camera")));
    let run = folder.refused(&["render", "room.gltf"], 1, "room.gltf: has no perspective camera\n");
    assert!(
        run.stderr.contains("help: write a scene.toml with a [camera] table") && run.stderr.contains("--set"),
        "{run}"
    );
    folder.refused(&["info", "room.gltf"], 1, "room.gltf: has no perspective camera\n");
    folder.write("scene.toml", AROUND.replace("camera = \"Eye\"\n", ""));
    let beginning =
        format!("{}: missing key `camera`, and room.gltf has no perspective camera\n", folder.place("geometry"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
    let beginning = "--set camera=Eye: camera is \"Eye\", but room.gltf has no perspective camera\n";
    folder.refused(&["render", "room.gltf", "--set", "camera=Eye"], 2, beginning);
    let view = ["camera.position=[0, 0, 0]", "camera.look_at=[0, 0, -1]", "camera.vertical_fov_deg=30"];
    render(&folder, &["--set", view[0], "--set", view[1], "--set", view[2]]);
    folder.done(&["info", "room.gltf", "--set", view[0], "--set", view[1], "--set", view[2]]);
}

#[test]
fn a_model_without_lights_is_refused() {
    let folder = with_model(|model| drop(model["nodes"][2].as_object_mut().expect("a node").remove("extensions")));
    let run = folder.refused(&["render", "room.gltf"], 1, "room.gltf: the scene has no light\n");
    assert!(run.stderr.contains("--set 'light=[{"), "{run}");
    let light = "light=[{ type = \"disk\", center = [0, 0, 1], normal = [0, 0, -1], radius = 1, radiance = 1 }]";
    render(&folder, &["--set", light]);
}

#[test]
fn a_model_whose_lights_are_all_directional_is_refused_in_fog_with_the_reason() {
    let folder =
        with_model(|model| model["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = json!("directional"));
    let finding = "the scene has no light: nothing arrives from directional lights (suns) through a medium without end: \
                   \"Lamp\"\n";
    let fog = ["--set", "medium.scattering=0.1"];
    let run = folder.refused(&["render", "room.gltf", fog[0], fog[1]], 1, &format!("room.gltf: {finding}"));
    assert!(run.stderr.contains("help: add a point light, a spot light or an emissive material to"), "{run}");
    folder.write("scene.toml", AROUND);
    let run = folder.refused(&["render", "scene.toml", fog[0], fog[1]], 1, &format!("scene.toml: {finding}"));
    assert!(run.stderr.contains("help: add a [[light]] table, an [environment], geometry with a point"), "{run}");
}

#[test]
fn the_hash_follows_the_camera_and_the_lights_of_the_model_but_not_their_names() {
    let hash = |edit: fn(&mut Value)| {
        let folder = with_model(edit);
        render(&folder, &["--samples", "1"]);
        header(&folder.image("a.exr"), "scene_hash").to_string()
    };
    let plain = hash(|_| {});
    let renamed = hash(|model| {
        model["nodes"][1]["name"] = json!("Lens");
        model["nodes"][2]["name"] = json!("Sun");
        model["cameras"][0]["perspective"]["znear"] = json!(0.2);
    });
    assert_eq!(renamed, plain);
    let edits: [fn(&mut Value); 4] = [
        |model| model["nodes"][1]["translation"] = json!([0, 0, 0.1]),
        |model| model["cameras"][0]["perspective"]["yfov"] = json!(0.6),
        |model| model["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!(31),
        |model| model["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"]["radius"] = json!(0.06),
    ];
    for (index, edit) in edits.into_iter().enumerate() {
        assert_ne!(hash(edit), plain, "edit {index}");
    }
}

#[test]
fn extras_that_are_no_lengths_are_refused() {
    let refused = |edit: fn(&mut Value), beginning: &str| {
        with_model(edit).refused(&["render", "room.gltf"], 1, beginning);
    };
    fn light(model: &mut Value) -> &mut Value {
        &mut model["extensions"]["KHR_lights_punctual"]["lights"][0]
    }
    let lamp = "room.gltf: light \"Lamp\": ";
    refused(|model| light(model)["extras"]["radius"] = json!("big"), &format!("{lamp}extras.radius is \"big\"\n"));
    refused(|model| light(model)["extras"]["radius"] = json!(-1), &format!("{lamp}radius is -1.0\n"));
    refused(|model| light(model)["intensity"] = json!(1e40), &format!("{lamp}radiance is "));
    refused(
        |model| model["nodes"][2]["translation"] = json!([1e10, 0, 0]),
        &format!("{lamp}center is [10000000000.0, 0.0"),
    );
    let eye = "room.gltf: camera \"Eye\": ";
    refused(|model| model["cameras"][0]["extras"] = json!({ "near": [] }), &format!("{eye}extras.near is []\n"));
    refused(|model| model["cameras"][0]["extras"] = json!({ "near": -1 }), &format!("{eye}near is -1.0\n"));
    refused(
        |model| model["nodes"][1]["translation"] = json!([0, 1e10, 0]),
        &format!("{eye}position is [0.0, 10000000000.0"),
    );
}
