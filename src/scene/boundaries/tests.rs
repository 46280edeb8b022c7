use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fogbow_kernels::lanes;
use fogbow_kernels::vec3::Vec3x8;
use serde_json::{Value, json};

use super::*;
use crate::gltf::Asset;

/// The cube from 0 to 1.
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];
const SIDES: [[u16; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// A file with a whole cube (mesh 0 "Cube"), one without its last triangle (mesh 1 "Open"), a shining one (mesh 2), a
/// sheet of no area (mesh 3), a cube whose first triangle faces inward (mesh 4 "Turned") and one that has it twice (mesh 5
/// "Twice"), on `nodes`.
fn loaded(nodes: Value, origin: DVec3) -> Loaded {
    let mut bytes: Vec<u8> = CORNERS.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(SIDES.as_flattened().iter().flat_map(|index| index.to_le_bytes()));
    bytes.extend([0, 1, 1_u16].map(u16::to_le_bytes).as_flattened());
    let [a, b, c] = SIDES[0];
    let (turned, twice) = ([&[[a, c, b]], &SIDES[1..]].concat(), [&SIDES[..], &[[b, c, a]]].concat());
    bytes.extend([turned, twice].concat().as_flattened().iter().flat_map(|index| index.to_le_bytes()));
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    let indices = |first: usize, count: usize| json!({ "bufferView": 1, "byteOffset": 2 * first, "componentType": 5123, "type": "SCALAR", "count": count });
    let mesh = |name: &str, indices: usize, material: usize| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": indices, "material": material });
        json!({ "name": name, "primitives": [primitive] })
    };
    let positions = json!({ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 8,
        "min": [0, 0, 0], "max": [1, 1, 1] });
    let file = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": uri, "byteLength": bytes.len() }],
        "bufferViews": [{ "buffer": 0, "byteLength": 96 }, { "buffer": 0, "byteOffset": 96, "byteLength": 228 }],
        "accessors": [positions, indices(0, 36), indices(0, 33), indices(36, 3), indices(39, 36), indices(75, 39)],
        "materials": [{ "name": "Glass" }, { "name": "Lamp", "emissiveFactor": [1, 0, 0] }],
        "meshes": [mesh("Cube", 1, 0), mesh("Open", 2, 0), mesh("Shining", 1, 1), mesh("Thread", 3, 0),
            mesh("Turned", 4, 0), mesh("Twice", 5, 0)],
        "nodes": nodes,
    });
    let asset = Asset::parse("test.gltf", file.to_string().into_bytes(), None, None).expect("a model");
    Loaded::read(asset, origin).expect("a model")
}

fn document() -> Document {
    Document::parse("scene.toml", "[[volume]]\nshape = { type = \"mesh\", name = \"Cube\" }\n").expect("a document")
}

fn wanted(name: &str) -> Wanted<'_> {
    Wanted { path: "volume[0].shape.name".into(), name }
}

fn error(loaded: Option<&mut Loaded>, name: &str) -> String {
    take(loaded, &document(), &[wanted(name)]).expect_err("an error").to_string()
}

fn contains(mesh: &ClosedMesh, at: [f32; 3]) -> bool {
    lanes::bits(mesh.contains(Vec3x8::splat(at))) == lanes::ALL
}

#[test]
fn a_boundary_leaves_the_model() {
    let nodes = json!([{ "name": "Table", "mesh": 1 }, { "name": "Wax", "mesh": 0, "translation": [2, 0, 0] },
        { "name": "Wall", "mesh": 1 }]);
    let mut loaded = loaded(nodes, DVec3::ZERO);
    let before = loaded.model.clone();
    let [Some(mesh)] = &take(Some(&mut loaded), &document(), &[wanted("Wax")]).expect("a boundary")[..] else {
        panic!("one boundary")
    };
    assert_eq!(mesh.bounds(), [[2.0, 0.0, 0.0], [3.0, 1.0, 1.0]]);
    assert!(contains(mesh, [2.5, 0.5, 0.5]) && !contains(mesh, [0.5; 3]));
    let names: Vec<_> = loaded.model.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(names, ["Table", "Wall"]);
    for instance in &loaded.model.instances {
        let same = before.instances.iter().find(|other| other.name == instance.name).expect("it was there");
        assert_eq!(corners(&loaded.model, instance), corners(&before, same));
    }
    assert_eq!(loaded.model.triangles.len(), 22);
}

#[test]
fn all_nodes_of_a_name_are_parts() {
    let nodes = json!([
        { "mesh": 0 },
        { "name": "Second", "mesh": 0, "translation": [0.5, 0.5, 0.5] },
        { "name": "Mirrored", "mesh": 0, "scale": [-1, 2, 1] },
    ]);
    let mut loaded = loaded(nodes, DVec3::ZERO);
    let boundaries = take(Some(&mut loaded), &document(), &[wanted("Cube"), wanted("Second")]).expect("two boundaries");
    assert!(loaded.model.triangles.is_empty() && loaded.model.instances.is_empty());
    let [Some(all), Some(second)] = &boundaries[..] else { panic!("two boundaries") };
    let points = [[0.25; 3], [0.75; 3], [1.25; 3], [-0.5, 1.5, 0.5], [0.25, 1.25, 0.25]];
    assert_eq!(points.map(|at| contains(all, at)), [true, true, true, true, false]);
    assert_eq!(points.map(|at| contains(second, at)), [false, true, true, false, false]);
}

/// As animations hide things; what is left of a name still is a boundary.
#[test]
fn what_a_scale_of_0_hides_is_nowhere() {
    let nodes = json!([
        { "name": "Gone", "mesh": 0, "scale": [0, 0, 0] },
        { "name": "Empty", "scale": [0, 0, 0], "children": [2] },
        { "name": "Below", "mesh": 1, "translation": [1, 0, 0] },
        { "name": "Here", "mesh": 0 },
    ]);
    let mut loaded = loaded(nodes, DVec3::ZERO);
    let found = take(Some(&mut loaded), &document(), &["Gone", "Below", "Cube"].map(wanted)).expect("boundaries");
    assert_eq!(found.iter().map(Option::is_some).collect::<Vec<_>>(), [false, false, true]);
    let message = error(Some(&mut loaded), "Empty");
    assert!(message.contains("has no such mesh"), "{message}");
}

#[test]
fn parts_that_are_inside_out_do_not_cancel_others() {
    let model = loaded(json!([{ "mesh": 0 }]), DVec3::ZERO).model;
    let cube = corners(&model, &model.instances[0]);
    let inverted: Vec<_> = cube.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let volume = |part: Vec<Corners>| {
        let of = |corners: Corners| {
            let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
            a.dot(b.cross(c)) / 6.0
        };
        outward(part).map(of).sum::<f64>()
    };
    for found in [cube, inverted].map(volume) {
        assert!((found - 1.0).abs() < 1e-12, "{found} m^3");
    }
}

#[test]
fn positions_are_counted_from_the_origin() {
    let nodes = json!([{ "name": "Far", "mesh": 0, "translation": [1e6, 0, 0] }, { "name": "Wrong", "mesh": 1,
        "translation": [1e6, 0, 0] }]);
    let mut loaded = loaded(nodes, DVec3::new(1e6, 0.0, 0.0));
    let message = error(Some(&mut loaded), "Wrong");
    assert!(message.contains("from [1000001.0, 0.0, 0.0] to [1000001.0, 0.0, 1.0]"), "{message}");
    let boundaries = take(Some(&mut loaded), &document(), &[wanted("Far")]).expect("a boundary");
    assert_eq!(boundaries[0].as_ref().map(ClosedMesh::bounds), Some([[0.0; 3], [1.0; 3]]));
}

#[test]
fn nothing_is_taken_where_nothing_is_wanted() {
    assert_eq!(take(None, &document(), &[]), Ok(Vec::new()));
}

#[test]
fn errors_say_what_is_wrong_and_where() {
    let nodes = json!([{ "name": "Wax", "mesh": 1 }, { "mesh": 0 }, { "mesh": 2 }, { "mesh": 3 }, { "mesh": 0 }]);
    let mut loaded = loaded(nodes, DVec3::ZERO);
    let before = loaded.model.clone();
    for (name, expected) in [
        ("Candle", "scene.toml:2:"),
        ("Candle", "volume[0].shape.name is \"Candle\", but test.gltf has no such mesh"),
        ("Candle", "give one of its names: \"Cube\", \"Wax\", \"Open\", \"Shining\", \"Thread\""),
        ("Open", "scene.toml:2:"),
        ("Open", "test.gltf: node 0 \"Wax\": bounds a volume, but is not closed: 3 of its edges are open: from"),
        ("Open", "merge vertices by distance"),
        ("Shining", "bounds a volume and shines, with material 1 \"Lamp\""),
        ("Thread", "none of its triangles has an area"),
    ] {
        let message = error(Some(&mut loaded), name);
        assert!(message.contains(expected), "{message}");
    }
    assert_eq!(loaded.model, before, "nothing is taken after an error");
    let message = error(None, "Wax");
    assert!(message.contains("the scene has no geometry"), "{message}");
}

#[test]
fn faces_that_are_wrong_are_told_from_holes() {
    let both = json!([{ "mesh": 4, "translation": [0, 0, 2] }, { "mesh": 5 }]);
    let mut loaded = loaded(both, DVec3::ZERO);
    for (name, expected) in [
        ("Turned", "1 of its triangles faces the other way than the rest: [0.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0"),
        ("Turned", "let all normals point outward"),
        (
            "Twice",
            "bounds a volume, but 1 of its triangles is there more than once: [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], ",
        ),
        ("Twice", "delete faces that lie on each other"),
    ] {
        let message = error(Some(&mut loaded), name);
        assert!(message.contains(expected) && !message.contains("open"), "{message}");
    }
}

#[test]
fn what_is_wrong_with_many_faces_is_counted() {
    let model = loaded(json!([{ "mesh": 0 }]), DVec3::ZERO).model;
    let cube = corners(&model, &model.instances[0]);
    let finding = |triangles: &[Corners]| match ClosedMesh::check(triangles) {
        Err(OpenMesh::Edges(edges)) => open::diagnosis(triangles, &edges, [0.0; 3]).finding,
        other => panic!("{other:?}"),
    };
    let turn = |[a, b, c]: Corners| [a, c, b];
    // Whichever way most of them face is the right one.
    for inverted in [false, true] {
        let turned = |index: usize| (index < 3) != inverted;
        let all: Vec<_> =
            cube.iter().enumerate().map(|(index, face)| if turned(index) { turn(*face) } else { *face }).collect();
        let found = finding(&all);
        assert!(found.starts_with("3 of its triangles face the other way than the rest: the first ["), "{found}");
    }
    let twice = [&cube[..], &cube[4..]].concat();
    assert!(finding(&twice).starts_with("8 of its triangles are there more than once: the first ["));
    // A hole and a face that is turned.
    let mut both = cube[1..].to_vec();
    both[10] = turn(both[10]);
    let found = finding(&both);
    assert!(found.starts_with("is not closed: 3 of its edges are open: from ["), "{found}");
    assert!(found.contains("; and 3 of its edges are between triangles that face different ways: from ["), "{found}");
    // A wall within.
    let fin = [&cube[..], &[[[0.0; 3], [1.0; 3], [0.5, 0.0, 1.0]]]].concat();
    assert!(finding(&fin).contains("of its edges are open: "));
    let wall = [&cube[..], &[turn(cube[0])]].concat();
    assert!(finding(&wall).starts_with("is not closed: 3 of its edges have more than two triangles: from ["));
}

#[test]
fn sheets_have_no_inside() {
    let turned = [0.18257418, 0.36514837, 0.5477226, 0.7302968];
    let nodes = json!([{ "name": "Flat", "mesh": 0, "scale": [1, 0, 1] },
        { "name": "Tilted", "mesh": 0, "scale": [3, 2, 0], "rotation": turned, "translation": [5, 1, 2] },
        { "name": "Thin", "mesh": 0, "scale": [1, 1e-4, 1], "rotation": turned }]);
    let mut loaded = loaded(nodes, DVec3::ZERO);
    for name in ["Flat", "Tilted"] {
        let message = error(Some(&mut loaded), name);
        assert!(message.contains(&format!("{name:?}: bounds a volume, but has no inside: it is a sheet")), "{message}");
    }
    take(Some(&mut loaded), &document(), &[wanted("Thin")]).expect("a boundary");
    // Both sides of a sheet that is not flat.
    let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];
    assert!(!thickness::has_inside(&[[a, b, c], [c, b, d], [b, a, c], [d, b, c]]));
    assert!(thickness::has_inside(&[[a, b, c], [c, b, d], [b, a, d], [d, a, c]]));
}

#[test]
fn the_candle_of_wax_is_a_boundary() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/wax/wax.glb");
    let mut loaded = Loaded::read(Asset::open(&file, None).expect("a file"), DVec3::ZERO).expect("a model");
    let found = take(Some(&mut loaded), &document(), &[wanted("Candle.inside")]).expect("a boundary");
    let candle = found[0].as_ref().expect("it is there");
    let points = [[0.0, 0.5, 0.0], [0.2, 0.01, 0.2], [0.0, 0.98, 0.0], [0.5, 0.5, 0.0]];
    assert_eq!(points.map(|at| contains(candle, at)), [true, true, false, false]);
    let left: Vec<_> = loaded.model.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(left, ["table", "wall", "wick", "flame"]);
}
