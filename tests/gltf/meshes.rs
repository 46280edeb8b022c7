//! Meshes: every way to store the same vertices and triangles.

use fogbow::gltf::Model;
use serde_json::json;

use super::support::{Builder, F32, I8, I16, TRIANGLE, U8, U16, U32, corners, float_bytes, near, warnings};

/// Positions of five vertices in the plane.
const FIVE: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0]];

fn triangles(model: &Model) -> Vec<[u32; 3]> {
    model.triangles.iter().map(|triangle| triangle.corners).collect()
}

/// The triangles of the five vertices in this mode, with these indices.
fn joined(mode: u32, indices: Option<&[u16]>) -> (Vec<[u32; 3]>, Vec<String>) {
    let mut file = Builder::new();
    let mut primitive = json!({ "attributes": { "POSITION": file.floats(&FIVE) }, "mode": mode });
    if let Some(indices) = indices {
        primitive["indices"] = json!(file.indices(indices));
    }
    let mesh = file.mesh(primitive);
    file.place(mesh);
    let model = file.model();
    (triangles(&model), warnings(&model))
}

#[test]
fn lists_strips_and_fans_become_triangles() {
    let none: Vec<String> = Vec::new();
    assert_eq!(joined(5, None), (vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], none.clone()));
    assert_eq!(joined(6, None), (vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]], none.clone()));
    assert_eq!(joined(4, Some(&[4, 3, 2, 0, 0, 1])), (vec![[4, 3, 2], [0, 0, 1]], none.clone()));
    assert_eq!(joined(5, Some(&[4, 3, 2, 1])), (vec![[4, 3, 2], [3, 1, 2]], none.clone()));
    assert_eq!(joined(6, Some(&[4, 3, 2, 1])), (vec![[3, 2, 4], [2, 1, 4]], none));
}

#[test]
fn what_is_no_whole_triangle_is_left_out() {
    let warning = ["mesh 0, primitive 0: vertices that do not complete a triangle are left out"];
    let (triangles, warnings) = joined(4, None);
    assert_eq!((triangles.as_slice(), warnings.as_slice()), (&[[0, 1, 2]][..], &warning.map(String::from)[..]));
    for (mode, indices) in [(4, &[0u16, 1][..]), (5, &[0, 1]), (6, &[0])] {
        let (triangles, warnings) = joined(mode, Some(indices));
        assert_eq!((triangles.len(), warnings.as_slice()), (0, &warning.map(String::from)[..]));
    }
}

#[test]
fn points_and_lines_are_left_out() {
    for mode in 0..4 {
        let (triangles, warnings) = joined(mode, None);
        assert!(triangles.is_empty());
        assert_eq!(warnings, ["mesh 0, primitive 0: points and lines are left out"]);
    }
}

#[test]
fn indices_have_8_16_or_32_bits() {
    let stored: [(u32, &[u8]); 3] =
        [(U8, &[2, 1, 0]), (U16, &[2, 0, 1, 0, 0, 0]), (U32, &[2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0])];
    for (component, bytes) in stored {
        let mut file = Builder::new();
        let positions = file.floats(&TRIANGLE);
        let indices = file.accessor(component, "SCALAR", 3, bytes);
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
        file.place(mesh);
        assert_eq!(triangles(&file.model()), [[2, 1, 0]], "{component}");
    }
}

#[test]
fn attributes_may_be_interleaved() {
    let mut file = Builder::new();
    // Position, four bytes of something else, texture coordinates.
    let vertex = |p: [f32; 3], uv: [f32; 2]| [p[0], p[1], p[2], f32::NAN, uv[0], uv[1]];
    let vertices = [vertex(TRIANGLE[0], [0.1, 0.2]), vertex(TRIANGLE[1], [0.3, 0.4]), vertex(TRIANGLE[2], [0.5, 0.6])];
    let view = file.view(&float_bytes(&vertices));
    file.json["bufferViews"][view]["byteStride"] = json!(24);
    let accessor = |offset: u32, shape: &str| json!({ "bufferView": view, "byteOffset": offset, "componentType": F32, "type": shape, "count": 3 });
    let positions = file.add("accessors", accessor(0, "VEC3"));
    let texcoords = file.add("accessors", accessor(16, "VEC2"));
    let texture = file.texture(&super::support::rgb(1, 1, &[[0; 3]]));
    file.add(
        "materials",
        json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorTexture": { "index": texture } } }),
    );
    let attributes = json!({ "POSITION": positions, "TEXCOORD_0": texcoords });
    let mesh = file.mesh(json!({ "attributes": attributes, "material": 0 }));
    file.place(mesh);
    let model = file.model();
    assert_eq!(model.positions, TRIANGLE);
    assert_eq!(model.texcoords[0], [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]);
    assert!(model.texcoords[1].is_empty());
}

#[test]
fn small_integers_are_positions_if_the_file_says_so() {
    let mut file = Builder::new();
    let bytes: Vec<u8> =
        [[-32768i16, 32767, 0], [16384, 0, 0], [0, -32767, 0]].iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let shorts = file.normalized(I16, "VEC3", 3, &bytes);
    let bytes = [-128i8, 127, 5, 0, 100, 0, 0, 0, 0, -100, 0, 0].map(|x| x as u8);
    let integers = file.accessor(I8, "VEC3", 3, &bytes);
    let view = file.json["accessors"][integers]["bufferView"].as_u64().expect("an index") as usize;
    file.json["bufferViews"][view]["byteStride"] = json!(4);
    for positions in [shorts, integers] {
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions } }));
        file.add("nodes", json!({ "mesh": mesh, "scale": [10, 10, 10] }));
    }
    assert!(file.error().contains("KHR_mesh_quantization"), "{}", file.error());
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let positions = file.model().positions;
    assert_eq!(positions[0], [-10.0, 10.0, 0.0]); // -32768 is -1 too
    assert!(near(positions[1], [5.000_152_6, 0.0, 0.0]), "{positions:?}");
    assert_eq!(positions[3..], [[-1280.0, 1270.0, 50.0], [1000.0, 0.0, 0.0], [0.0, -1000.0, 0.0]]);
}

#[test]
fn sparse_elements_take_the_place_of_others() {
    let mut file = Builder::new();
    let positions = file.floats(&TRIANGLE);
    let indices = file.view(&[1, 2]);
    let values = file.view(&float_bytes(&[[7.0, 0.0, 0.0], [0.0, 8.0, 0.0]]));
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": U8 },
        "values": { "bufferView": values },
    });
    file.json["accessors"][positions]["sparse"] = sparse.clone();
    let zeros = json!({ "componentType": F32, "type": "VEC3", "count": 4, "sparse": sparse });
    let zeros = file.add("accessors", zeros);
    for positions in [positions, zeros] {
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions }, "mode": 5 }));
        file.place(mesh);
    }
    let [x, y, zero] = [[7.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0; 3]];
    assert_eq!(file.model().positions, [zero, x, y, zero, x, y, zero]);
}

#[test]
fn accessors_without_data_are_zeros() {
    let mut file = Builder::new();
    let positions = file.add("accessors", json!({ "componentType": F32, "type": "VEC3", "count": 3 }));
    let mesh = file.mesh(json!({ "attributes": { "POSITION": positions } }));
    file.place(mesh);
    let model = file.model(); // a triangle without area is a triangle
    assert_eq!((model.positions.as_slice(), triangles(&model)), (&[[0.0; 3]; 3][..], vec![[0, 1, 2]]));
}

#[test]
fn colors_are_linear_fractions() {
    let mut file = Builder::new();
    let floats = file.floats(&[[0.0, 0.5, 1.0, 0.3], [1.0; 4], [0.25; 4]]);
    let bytes = file.normalized(U8, "VEC3", 3, &[0, 51, 255, 255, 255, 255, 0, 0, 0]);
    let shorts: Vec<u8> = [0u16, 13107, 65535, 65535].repeat(3).iter().flat_map(|x| x.to_le_bytes()).collect();
    let shorts = file.normalized(U16, "VEC4", 3, &shorts);
    let positions = file.floats(&TRIANGLE);
    let plain = file.triangle(TRIANGLE);
    file.place(plain);
    for colors in [floats, bytes, shorts] {
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions, "COLOR_0": colors } }));
        file.place(mesh);
    }
    file.place(plain);
    let colors = file.model().colors;
    let fifth = [0.0, 0.2, 1.0];
    // Instances of a mesh stand together, in the order of the meshes.
    let expected = [[1.0; 3]; 6].into_iter();
    let expected =
        expected.chain([[0.0, 0.5, 1.0], [1.0; 3], [0.25; 3], fifth, [1.0; 3], [0.0; 3], fifth, fifth, fifth]);
    let expected: Vec<[f32; 3]> = expected.collect();
    assert_eq!(colors.len(), expected.len());
    assert!(colors.iter().zip(&expected).all(|(a, b)| near(*a, *b)), "{colors:?}");
}

#[test]
fn colors_are_clamped() {
    let with_color = |color: [f32; 3]| {
        let mut file = Builder::new();
        let [positions, colors] = [file.floats(&TRIANGLE), file.floats(&[color, [0.5; 3], [0.5; 3]])];
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions, "COLOR_0": colors } }));
        file.place(mesh);
        let model = file.model();
        (model.colors[0], warnings(&model))
    };
    let warning = vec!["mesh 0, primitive 0: vertex colours outside 0 to 1 are clamped".to_string()];
    assert_eq!(with_color([1.1, 0.25, 1e30]), ([1.0, 0.25, 1.0], warning.clone()));
    assert_eq!(with_color([-0.1, 0.25, 1.0]), ([0.0, 0.25, 1.0], warning));
    assert_eq!(with_color([1.0001, 0.25, -0.0001]), ([1.0, 0.25, 0.0], Vec::new()), "rounding");
}

#[test]
fn models_without_colors_have_no_list_of_them() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.place(mesh);
    assert!(file.model().colors.is_empty());
}

#[test]
fn primitives_share_vertices_and_differ_in_materials() {
    let mut file = Builder::new();
    let positions = file.floats(&FIVE);
    let [first, second] = [file.indices(&[0, 1, 2]), file.indices(&[2, 3, 4])];
    file.json["materials"] = json!([{ "name": "unused" }, { "name": "used" }]);
    let attributes = json!({ "POSITION": positions });
    let primitives = json!([
        { "attributes": attributes, "indices": first, "material": 1 },
        { "attributes": attributes, "indices": second },
    ]);
    let mesh = file.add("meshes", json!({ "primitives": primitives }));
    file.place(mesh);
    let model = file.model();
    assert_eq!(model.positions, FIVE);
    assert_eq!(triangles(&model), [[0, 1, 2], [2, 3, 4]]);
    assert_eq!(model.triangles.iter().map(|triangle| triangle.material).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(model.materials.len(), 3);
    assert_eq!(model.materials[2], fogbow::gltf::Material::default());
}

#[test]
fn what_moves_stands_still() {
    let mut file = Builder::new();
    let positions = file.floats(&TRIANGLE);
    let targets = json!([{ "POSITION": positions }]);
    let mesh = file.mesh(json!({ "attributes": { "POSITION": positions }, "targets": targets }));
    file.json["nodes"] = json!([{ "mesh": mesh, "skin": 0, "name": "dancer" }]);
    file.json["animations"] = json!([{ "channels": [], "samplers": [] }]);
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_materials_ior", "VENDOR_x"]);
    let model = file.model();
    assert_eq!(model.positions, TRIANGLE);
    let expected = [
        "extension \"KHR_materials_ior\", extension \"VENDOR_x\": extensions that are not supported are ignored",
        "animation 0: animations play only with --frames; without it, nodes stay where the file puts them",
        "node 0 \"dancer\": skins are ignored; meshes keep their bind pose and, unlike in glTF, their node's transform",
        "mesh 0, primitive 0: morph targets are ignored; meshes keep their base shape",
    ];
    assert_eq!(warnings(&model), expected);
}

#[test]
fn triangles_keep_their_order() {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.place(mesh);
    assert_eq!(corners(&file.model()), [TRIANGLE]);
}
