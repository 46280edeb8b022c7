//! Buffer views and accessors that lead out of their data, and values that mean nothing.

use serde_json::{Value, json};

use super::super::support::{
    COLORS, F32, I8, I16, INDICES, MOVED, POSITIONS, TEXCOORDS, U8, U16, U32, everything, float_bytes,
};
use super::refuse;

#[test]
fn buffer_views() {
    let view =
        |view: Value| (format!("/bufferViews/{}", everything().json["accessors"][POSITIONS]["bufferView"]), view);
    let part = |offset: u64, length: u64| view(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
    let stride = |stride: u64| view(json!({ "buffer": 0, "byteLength": 200, "byteStride": stride }));
    let place = "mesh 0 \"Wall\", primitive 0, POSITION, accessor 0";
    let cases = [
        (view(json!({ "buffer": 1, "byteLength": 1 })), "refers to buffer 1, but the last one is 0"),
        (part(100_000, 1), "its 1 bytes from byte 100000 do not fit in buffer 0, which has "),
        (part(0, 100_000), "its 100000 bytes from byte 0 do not fit in buffer 0"),
        (part(u64::MAX, 2), "its 2 bytes from byte 18446744073709551615 do not fit in buffer 0"),
        (part(u64::MAX, u64::MAX), "its 18446744073709551615 bytes from byte "),
        (stride(0), "its byteStride is 0\n"),
        (stride(13), "its byteStride is 13\n"),
        (stride(256), "its byteStride is 256\n"),
    ];
    for ((pointer, value), expected) in cases {
        let index = pointer.rsplit('/').next().expect("an index").to_owned();
        refuse(&[(&pointer, value, &format!("{place}, bufferView {index}: {expected}"))]);
    }
    let (pointer, value) = stride(8);
    refuse(&[(&pointer, value, &format!("{place}: its elements of 12 bytes are 8 bytes apart in its bufferView\n"))]);
    refuse(&[(
        "/accessors/0/bufferView",
        json!(99),
        &format!("{place}: refers to bufferView 99, but the last one is "),
    )]);
}

#[test]
fn accessors() {
    let at = |accessor: usize, key: &str| format!("/accessors/{accessor}/{key}");
    let place = |what: &str, accessor: usize| format!("mesh 0 \"Wall\", primitive 0, {what}, accessor {accessor}: ");
    let position = place("POSITION", POSITIONS);
    let cases = [
        (at(POSITIONS, "componentType"), json!(5124), format!("{position}its componentType is 5124\n")),
        (
            at(POSITIONS, "componentType"),
            json!(U32),
            format!("{position}is VEC3 of UNSIGNED_INT\n  help: give VEC3 of FLOAT"),
        ),
        (at(POSITIONS, "componentType"), json!(I16), format!("{position}is VEC3 of SHORT\n")),
        (at(POSITIONS, "type"), json!("VEC2"), format!("{position}is VEC2 of FLOAT\n")),
        (at(POSITIONS, "type"), json!("MAT3"), format!("{position}is \"MAT3\"\n")),
        (at(POSITIONS, "normalized"), json!(true), format!("{position}is VEC3 of normalized FLOAT\n")),
        (at(POSITIONS, "count"), json!(0), format!("{position}has no elements\n")),
        (
            at(POSITIONS, "count"),
            json!(5),
            format!(
                "{position}its 5 elements (VEC3 of FLOAT) from byte 0, 12 bytes apart, do not fit in its bufferView of 48 bytes\n"
            ),
        ),
        (at(POSITIONS, "count"), json!(u64::MAX), format!("{position}its 18446744073709551615 elements")),
        (at(POSITIONS, "count"), json!(u64::MAX / 12 + 2), format!("{position}its 1537228672809129303 elements")),
        (at(POSITIONS, "byteOffset"), json!(4), format!("{position}its 4 elements (VEC3 of FLOAT) from byte 4,")),
        (at(POSITIONS, "byteOffset"), json!(u64::MAX - 3), format!("{position}its ")),
        (at(POSITIONS, "byteOffset"), json!(2), format!("{position}its elements begin at byte ")),
        (at(TEXCOORDS, "type"), json!("VEC3"), format!("{}is VEC3 of FLOAT\n", place("TEXCOORD_0", TEXCOORDS))),
        (
            at(TEXCOORDS, "componentType"),
            json!(U8),
            format!("{}is VEC2 of UNSIGNED_BYTE\n", place("TEXCOORD_0", TEXCOORDS)),
        ),
        (
            at(TEXCOORDS, "count"),
            json!(3),
            format!("{}has 3 elements, but POSITION has 4\n", place("TEXCOORD_0", TEXCOORDS)),
        ),
        (at(COLORS, "normalized"), json!(false), format!("{}is VEC4 of UNSIGNED_BYTE\n", place("COLOR_0", COLORS))),
        (at(COLORS, "componentType"), json!(I8), format!("{}is VEC4 of normalized BYTE\n", place("COLOR_0", COLORS))),
        (at(COLORS, "count"), json!(2), format!("{}has 2 elements, but POSITION has 4\n", place("COLOR_0", COLORS))),
        (at(INDICES, "componentType"), json!(I16), format!("{}is SCALAR of SHORT\n", place("indices", INDICES))),
        (at(INDICES, "componentType"), json!(F32), format!("{}is SCALAR of FLOAT\n", place("indices", INDICES))),
        (
            at(INDICES, "normalized"),
            json!(true),
            format!("{}is SCALAR of normalized UNSIGNED_SHORT\n", place("indices", INDICES)),
        ),
        (at(INDICES, "type"), json!("VEC2"), format!("{}is VEC2 of UNSIGNED_SHORT\n", place("indices", INDICES))),
        (at(INDICES, "byteOffset"), json!(1), format!("{}its elements begin at byte ", place("indices", INDICES))),
    ];
    for (pointer, value, expected) in cases {
        refuse(&[(&pointer, value, &expected)]);
    }
}

#[test]
fn sparse_accessors() {
    let at = |key: &str| format!("/accessors/{MOVED}/sparse/{key}");
    let place = format!("mesh 0 \"Wall\", primitive 1, POSITION, accessor {MOVED}");
    let cases = [
        (at("count"), json!(0), "sparse: replaces 0 of 4 elements\n"),
        (at("count"), json!(5), "sparse: replaces 5 of 4 elements\n"),
        (at("count"), json!(3), "sparse, indices: its 3 elements (SCALAR of UNSIGNED_BYTE) "),
        (at("indices/componentType"), json!(I16), "sparse, indices: are SHORT\n"),
        (at("indices/componentType"), json!(9), "sparse, indices: its componentType is 9\n"),
        (at("indices/bufferView"), json!(99), "sparse, indices: refers to bufferView 99"),
        (at("values/bufferView"), json!(99), "sparse, values: refers to bufferView 99"),
        (at("values/byteOffset"), json!(12), "sparse, values: its 2 elements (VEC3 of FLOAT) from byte 12,"),
        (at("values/byteOffset"), json!(u64::MAX - 3), "sparse, values: its "),
    ];
    for (pointer, value, expected) in cases {
        let joint = if expected.starts_with("sparse") { ", " } else { ": " };
        refuse(&[(&pointer, value, &format!("{place}{joint}{expected}"))]);
    }
    for (indices, expected) in [
        ([3u8, 1], "its sparse index 1 follows 3\n"),
        ([1, 1], "its sparse index 1 follows 1\n"),
        ([1, 4], "its sparse index 4 is not below its count, 4\n"),
    ] {
        let mut file = everything();
        let view = file.view(&indices);
        file.json["accessors"][MOVED]["sparse"]["indices"]["bufferView"] = json!(view);
        assert!(file.error().starts_with(&format!("error: test.glb: {place}: {expected}")), "{}", file.error());
    }
    let mut file = everything();
    let view = file.json["accessors"][MOVED]["sparse"]["values"]["bufferView"].as_u64().expect("an index");
    file.json["bufferViews"][view as usize]["byteStride"] = json!(12);
    assert!(file.error().contains("sparse, values: are in a bufferView with a byteStride\n"), "{}", file.error());
}

/// [`everything`] whose `accessor` has these bytes and this component type.
fn with_bytes(accessor: usize, component: u32, bytes: &[u8]) -> String {
    let mut file = everything();
    let view = file.view(bytes);
    file.json["accessors"][accessor]["bufferView"] = json!(view);
    file.json["accessors"][accessor]["componentType"] = json!(component);
    file.error()
}

#[test]
fn values_of_accessors() {
    let floats = |at: usize, value: f32, length: usize| {
        let mut values = vec![[0.5]; length];
        values[at] = [value];
        float_bytes(&values)
    };
    let place = "error: test.glb: mesh 0 \"Wall\", primitive 0, ";
    let cases = [
        (
            with_bytes(POSITIONS, F32, &floats(4, f32::NAN, 12)),
            "POSITION, accessor 0: its element 1 is [0.5, NaN, 0.5]\n",
        ),
        (
            with_bytes(POSITIONS, F32, &floats(9, f32::NEG_INFINITY, 12)),
            "POSITION, accessor 0: its element 3 is [-inf, ",
        ),
        (
            with_bytes(TEXCOORDS, F32, &floats(7, f32::INFINITY, 8)),
            "TEXCOORD_0, accessor 1: its element 3 is [0.5, inf]\n",
        ),
        (with_bytes(INDICES, U8, &[0, 1, 2, 2, 4, 3]), "indices, accessor 3: index 4 is 4, but there are 4 vertices\n"),
        (with_bytes(INDICES, U8, &[0, 1, 255, 2, 9, 3]), "indices, accessor 3: index 2 is 255, which would restart"),
        (with_bytes(INDICES, U16, &[255; 12]), "indices, accessor 3: index 0 is 65535, which would restart"),
        (with_bytes(INDICES, U32, &[255; 24]), "indices, accessor 3: index 0 is 4294967295, which would restart"),
    ];
    for (error, expected) in cases {
        assert!(error.starts_with(&format!("{place}{expected}")), "{error}\nexpected {expected}");
    }
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut file = everything();
        let colors = file.floats(&[[0.5; 3], [0.5; 3], [0.5, value, 0.5], [0.5; 3]]);
        file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
        let expected = format!("{place}COLOR_0, accessor {colors}: its element 2 is [0.5, {value:?}, 0.5]\n");
        assert!(file.error().starts_with(&expected), "{}", file.error());
    }
}
