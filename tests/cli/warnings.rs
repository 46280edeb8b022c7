//! What is not rendered, or not as its glTF file says, is told.

use serde_json::{Value, json};

use super::models::{render, with_model};

#[test]
fn directional_lights_in_fog_leave_a_warning_and_cameras_none() {
    let folder = with_model(|model| {
        let lights = model["extensions"]["KHR_lights_punctual"]["lights"].as_array_mut().expect("a list");
        lights.push(json!({ "type": "directional" }));
        model["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 1 } });
    });
    let run = render(&folder, &["--set", "medium.scattering=0.01"]);
    assert_eq!(run.stderr.matches("warning: ").count(), 1, "{run}");
    let warning = "warning: room.gltf: light \"Wall\": directional lights are left out: nothing arrives from infinity \
                   through a medium without end\n";
    assert!(run.stderr.contains(warning), "{run}");
    let run = render(&folder, &[]);
    assert!(!run.stderr.contains("warning"), "{run}");
}

#[test]
fn a_black_back_in_view_is_told_with_its_material() {
    let turned = |double_sided: bool| {
        with_model(move |model| {
            model["materials"] = json!([{
                "name": "Plaster", "doubleSided": double_sided, "pbrMetallicRoughness": { "metallicFactor": 0 }
            }]);
            model["meshes"][0]["primitives"][0]["material"] = json!(0);
            model["nodes"][0]["rotation"] = json!([0, 1, 0, 0]);
            model["nodes"][0]["translation"] = json!([0, 0, -6]);
        })
    };
    let run = render(&turned(false), &[]);
    let warning = "warning: room.gltf: material 0 \"Plaster\": black backs of surfaces cover 100.0 % of the image; \
                   a doubleSided material is lit on both sides\n";
    assert!(run.stderr.contains(warning), "{run}");
    for folder in [turned(true), with_model(|_| {})] {
        let run = render(&folder, &[]);
        assert!(!run.stderr.contains("warning"), "{run}");
    }
}

#[test]
fn a_warning_reads_well_whatever_the_number_of_its_places() {
    let warned = |count: usize| {
        let folder = with_model(|model| {
            let glossy = json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.5 } });
            model["materials"] = json!(vec![glossy; count]);
            let wall = model["meshes"][0]["primitives"][0].clone();
            let of = |material: usize| {
                let mut wall = wall.clone();
                wall["material"] = json!(material);
                wall
            };
            model["meshes"][0]["primitives"] = (0..count).map(of).collect();
            model["extensionsUsed"] = (0..count).map(|index| json!(format!("EXT_{index}"))).collect();
        });
        render(&folder, &[]).stderr
    };
    let lines = |extensions: &str, materials: &str| {
        format!(
            "warning: room.gltf: {extensions}: extensions that are not supported are ignored\n\
             warning: room.gltf: {materials}: glossy materials are rendered as diffuse, without highlights\n"
        )
    };
    assert_eq!(warned(1), lines("extension \"EXT_0\"", "material 0"));
    let more = "and 2 more (--verbose lists all)";
    let extensions = "extension \"EXT_0\", extension \"EXT_1\", extension \"EXT_2\", extension \"EXT_3\"";
    let materials = "material 0, material 1, material 2, material 3";
    assert_eq!(warned(6), lines(&format!("{extensions} {more}"), &format!("{materials} {more}")));
}

#[test]
fn all_places_of_a_warning_are_listed_for_those_who_ask() {
    let folder = with_model(|model| {
        for _ in 0..6 {
            model["cameras"].as_array_mut().expect("a list").push(json!({
                "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 9, "znear": 1 }
            }));
        }
        for index in 1..7 {
            let nodes = model["nodes"].as_array_mut().expect("a list");
            nodes.push(json!({ "camera": index }));
            model["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(2 + index));
        }
    });
    let short =
        "camera 1, camera 2, camera 3, camera 4 and 2 more (--verbose lists all): orthographic cameras are left out\n";
    let long = "camera 1, camera 2, camera 3, camera 4, camera 5, camera 6: orthographic cameras are left out\n";
    let stats = ["--stats", "s.json"];
    assert!(render(&folder, &stats).stderr.contains(short));
    let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    let statistics: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(statistics["warnings"][0]["places"].as_array().map(Vec::len), Some(6));
    assert!(render(&folder, &["--verbose"]).stderr.contains(long));
    assert!(folder.done(&["info", "room.gltf"]).stdout.contains(short));
    assert!(folder.done(&["info", "room.gltf", "--verbose"]).stdout.contains(long));
}
