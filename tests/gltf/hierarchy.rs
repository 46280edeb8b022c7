//! Nodes: where they put meshes, and which of them a scene has.

use std::time::Instant;

use serde_json::json;

use super::support::{Builder, TRIANGLE, corners, near, normal, warnings};

/// Half the square root of 2: sine and cosine of half a quarter turn.
const HALF: f64 = core::f64::consts::FRAC_1_SQRT_2;

#[test]
fn transforms_compose_from_the_root_down() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    // Column by column: a quarter turn from x to y, then 5 along z.
    let matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1];
    file.json["nodes"] = json!([
        { "children": [1], "translation": [10, 0, 0], "rotation": [0, HALF, 0, HALF] }, // quarter turn from z to x
        { "children": [2], "scale": [2, 3, 4] },
        { "mesh": mesh, "matrix": matrix },
    ]);
    // (1, 0, 0) -> (0, 1, 5) -> (0, 3, 20) -> (20, 3, 0) -> (30, 3, 0)
    let expected = [[30.0, 0.0, 0.0], [30.0, 3.0, 0.0], [30.0, 0.0, 2.0]];
    let found = corners(&file.model())[0];
    assert!(near(found[0], expected[0]) && near(found[1], expected[1]) && near(found[2], expected[2]), "{found:?}");
}

#[test]
fn mirrors_keep_the_front_in_front() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.json["nodes"] = json!([
        { "mesh": mesh },
        { "mesh": mesh, "scale": [-1, 1, 1] },
        { "mesh": mesh, "scale": [-1, -1, 1] },
        { "mesh": mesh, "scale": [1, 1, -1] },
        { "children": [5], "scale": [-1, 1, 1] },
        { "mesh": mesh, "matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }, // x and y change places
    ]);
    let normals: Vec<_> = corners(&file.model()).into_iter().map(normal).collect();
    let [front, back] = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    assert_eq!(normals, [front, front, front, back, front]);
}

#[test]
fn instances_are_copies_with_names() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.json["meshes"][mesh]["name"] = json!("leaf");
    file.json["nodes"] = json!([{ "mesh": mesh }, { "mesh": mesh, "translation": [0, 0, 7], "name": "second" }]);
    let model = file.model();
    assert_eq!(model.positions.len(), 6);
    assert_eq!(model.triangles[1].corners, [3, 4, 5]);
    assert_eq!(model.positions[4], [1.0, 0.0, 7.0]);
    let instances: Vec<_> = model.instances.iter().map(|i| (i.node, i.name.as_str(), i.triangles.clone())).collect();
    assert_eq!(instances, [(0, "leaf", 0..1), (1, "second", 1..2)]);
}

#[test]
fn the_default_scene_or_the_first_or_all_nodes_are_read() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    for x in 0..3 {
        file.add("nodes", json!({ "mesh": mesh, "translation": [x, 0, 0] }));
    }
    let first = |file: &Builder| file.model().positions.iter().step_by(3).map(|p| p[0]).collect::<Vec<_>>();
    assert_eq!(first(&file), [0.0, 1.0, 2.0]);
    file.json["scenes"] = json!([{ "nodes": [1], "extras": { "fog": 1 } }, { "nodes": [2, 0] }, {}]);
    assert_eq!(first(&file), [1.0]);
    assert_eq!(file.model().extras.scene, Some(json!({ "fog": 1 })));
    file.json["scene"] = json!(1);
    assert_eq!(first(&file), [2.0, 0.0]);
    assert_eq!(file.model().extras.scene, None);
    file.json["scene"] = json!(2);
    assert_eq!(first(&file), [0.0; 0]);
}

#[test]
fn a_file_may_show_nothing() {
    let model = Builder::new().model();
    assert!(model.positions.is_empty() && model.triangles.is_empty() && model.materials.is_empty(), "{model:?}");
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
}

#[test]
fn hierarchies_may_be_deeper_than_any_stack() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    let levels = 100_000;
    let node = |index: usize| match index + 1 < levels {
        true => json!({ "children": [index + 1], "translation": [0, 0.5, 0] }),
        false => json!({ "mesh": mesh }),
    };
    file.json["nodes"] = (0..levels).map(node).collect();
    file.json["scenes"] = json!([{ "nodes": [0] }]);
    let started = Instant::now();
    assert_eq!(file.model().positions[0], [0.0, 49999.5, 0.0]);
    assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
}

#[test]
fn rotations_are_normalized() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.json["nodes"] = json!([{ "mesh": mesh, "rotation": [0, 0, 3, 3], "name": "Lamp" }]);
    let model = file.model();
    assert!(near(model.positions[1], [0.0, 1.0, 0.0]), "{:?}", model.positions);
    assert_eq!(warnings(&model), ["node 0 \"Lamp\": rotations that are not unit quaternions are normalized"]);
}

#[test]
fn scale_0_hides_a_node_and_its_children() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.json["nodes"] = json!([{ "children": [1], "scale": [0, 0, 0] }, { "mesh": mesh }]);
    let model = file.model();
    assert!(model.triangles.is_empty());
    assert_eq!(warnings(&model), ["node 0: nodes of scale 0 are left out, with all nodes below them"]);
}

#[test]
fn flattened_nodes_keep_what_is_left_of_them() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    let into_the_plane = [2, 0, 0, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0, 0, 5, 1]; // z leans onto y
    file.json["nodes"] = json!([
        { "mesh": mesh, "scale": [2, 3, 0], "translation": [0, 0, 5] },
        { "mesh": mesh, "matrix": into_the_plane },
        { "mesh": mesh, "scale": [1, 0, 1] },                     // no area is left
        { "children": [4], "scale": [1e-200, 1e-200, 1e-200] },
        { "mesh": mesh, "scale": [1e-200, 1e-200, 1e-200] },      // nothing at all
    ]);
    let found = corners(&file.model());
    let expected = [[0.0, 0.0, 5.0], [2.0, 0.0, 5.0], [0.0, 3.0, 5.0]];
    assert_eq!(found[..2], [expected; 2]);
    assert_eq!(found[2], [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]]);
    assert_eq!(found[3], [[0.0; 3]; 3]);
    assert_eq!(normal(found[0]), [0.0, 0.0, 1.0]);
}

#[test]
fn cameras_and_spots_need_their_z_axis() {
    let lens = json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } });
    let camera = |scale: [f64; 3]| {
        let mut file = Builder::new();
        file.json["cameras"] = json!([lens]);
        file.json["nodes"] = json!([{ "camera": 0, "scale": scale, "name": "Eye" }]);
        file
    };
    let upright = camera([0.0, 0.0, 2.0]).model();
    assert_eq!((upright.cameras[0].forward, upright.cameras[0].up[2]), ([0.0, 0.0, -1.0], 0.0));
    let error = camera([1.0, 1.0, 0.0]).error();
    assert!(error.contains("node 0 \"Eye\": its transform flattens its z axis"), "{error}");
    assert!(error.contains("give it a scale above 0 along z"), "{error}");
}

#[test]
fn extras_of_nodes_are_kept() {
    let mut file = Builder::new();
    file.json["nodes"] = json!([{}, { "name": "fog", "extras": { "g": [0.9] } }]);
    let extras = file.model().extras.nodes;
    assert_eq!(extras.len(), 1);
    assert_eq!(
        (extras[0].node, extras[0].name.as_deref(), &extras[0].extras),
        (1, Some("fog"), &json!({ "g": [0.9] }))
    );
}
