//! Files that are not glTF 2.0, or not whole.

use fogbow::gltf;
use serde_json::{Value, json};

use super::super::support::{everything, glb};
use super::{changed, refuse};

#[test]
fn versions_and_extensions() {
    let draco = "KHR_draco_mesh_compression";
    refuse(&[
        ("/asset", Value::Null, "asset: is missing, and with it the version of glTF"),
        ("/asset/version", json!("1.0"), "asset: version is \"1.0\""),
        ("/asset/version", json!("20.0"), "asset: version is \"20.0\""),
        ("/asset/version", json!(""), "asset: version is \"\""),
        ("/asset/minVersion", json!("2.1"), "asset: minVersion is \"2.1\""),
        ("/asset/version", json!(2), "JSON, line 1, column "),
        (
            "/extensionsRequired",
            json!(["KHR_texture_transform", draco]),
            &format!("extensionsRequired: requires \"{draco}\""),
        ),
        ("/extensionsRequired", json!(["\u{1b}[31m\n"]), "extensionsRequired: requires \"\\u{1b}[31m\\n\"\n"),
    ]);
    let remedies = [
        (draco, "without mesh compression"),
        ("EXT_meshopt_compression", "without mesh compression"),
        ("KHR_texture_basisu", "textures in PNG or JPEG"),
        ("EXT_texture_webp", "textures in PNG or JPEG"),
        ("KHR_materials_unlit", "without this extension"),
    ];
    for (name, remedy) in remedies {
        let error = changed("/extensionsRequired", json!([name])).error();
        assert!(error.contains(remedy), "{error}");
    }
}

#[test]
fn json_of_wrong_types() {
    let cases = [
        ("/nodes/1/mesh", json!(-1), "nodes[1].mesh: invalid value: integer `-1`"),
        ("/nodes/1/mesh", json!(1.5), "nodes[1].mesh: invalid type: floating point `1.5`"),
        ("/nodes/0/matrix", json!([1, 2, 3]), "nodes[0].matrix"),
        ("/nodes/0/name", json!(7), "nodes[0].name: invalid type: integer `7`, expected a string"),
        ("/accessors/0/count", json!(1e30), "accessors[0].count"),
        ("/accessors/0/count", json!("many"), "accessors[0].count"),
        ("/accessors/0", json!({}), "accessors[0]: missing field `componentType`"),
        ("/meshes/0/primitives/0", json!({}), "meshes[0].primitives[0]: missing field `attributes`"),
        ("/meshes", json!({}), "meshes: invalid type: map"),
    ];
    for (pointer, value, expected) in cases {
        let error = changed(pointer, value).error();
        assert!(error.starts_with("error: test.glb: JSON, line 1, column "), "{error}");
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn text_that_is_not_json() {
    let error = |text: &[u8]| gltf::parse("a.gltf", text, None).expect_err("malformed").to_string();
    let cases: [(&[u8], &str); 8] = [
        (b"", "error: a.gltf: is empty\n"),
        (b" \n", "error: a.gltf: is empty\n"),
        (b"glTF", "error: a.gltf: ends after 4 bytes, inside its header"),
        (b"solid cube", "error: a.gltf: is not glTF: "),
        (b"[]", "error: a.gltf: is not glTF: "),
        (b"{\n  \"asset\": }", "error: a.gltf:2:12: asset: expected value\n  help: correct the JSON"),
        (b"{\n  \"asset\": {", "error: a.gltf:2:12: asset: EOF while parsing"),
        (b"{ \"asset\": { \"version\": \"2.0\" } } x", "error: a.gltf:1:35: trailing characters"),
    ];
    for (text, expected) in cases {
        assert!(error(text).starts_with(expected), "{}", error(text));
    }
    assert!(error(b"{ \"asset\": {}, \"asset\": {} }").contains("missing field `version`"));
    let nested = format!("{{ \"scenes\": [{{ \"extras\": {}{} }}] }}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(error(nested.as_bytes()).contains("recursion limit"), "{}", error(nested.as_bytes()));
    let ignored = format!("{{ \"other\": {}{} }}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(error(ignored.as_bytes()).contains("asset: is missing"), "{}", error(ignored.as_bytes()));
    let large = b"{ \"asset\": { \"version\": \"2.0\" }, \"nodes\": [{ \"scale\": [1e999, 1, 1] }] }";
    assert!(error(large).contains("nodes[0].scale[0]: number out of range"), "{}", error(large));
    assert!(error(b"{ \"asset\": { \"version\": \"\xff\" } }").contains("asset.version: invalid unicode"));
}

#[test]
fn containers() {
    let valid = everything().glb();
    let error = |bytes: &[u8]| gltf::parse("a.glb", bytes, None).expect_err("malformed").to_string();
    let put = |offset: usize, value: u32| {
        let mut bytes = valid.clone();
        bytes[offset..offset + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let json = u32::from_le_bytes(*valid[12..].first_chunk().expect("a length"));
    let length = valid.len() as u32;
    let cases = [
        (put(0, 7), "a.glb: is not glTF: "),
        (put(4, 1), "a.glb: is a binary container of version 1\n"),
        (put(8, length + 4), &format!("a.glb: has {length} bytes, but its header says {}\n", length + 4)),
        (put(8, 3), &format!("a.glb: has {length} bytes, but its header says 3\n")),
        (put(8, 12), "a.glb: chunk 0: its first chunk is not of type JSON\n"),
        (put(8, 16), "a.glb: chunk 0: the file ends inside the header of this chunk\n"),
        (put(12, json + 1), &format!("a.glb: chunk 0: its length is {}, not a multiple of 4\n", json + 1)),
        (put(12, u32::MAX - 3), "a.glb: chunk 0: its length is 4294967292, but "),
        (put(16, 7), "a.glb: chunk 0: its first chunk is not of type JSON\n"),
        (put(20 + json as usize, length), "a.glb: chunk 1: its length is "),
        (put(24 + json as usize, 7), "a.glb: buffer 0: has neither a URI nor the binary part of a .glb file\n"),
        (valid[..valid.len() - 1].to_vec(), &format!("a.glb: has {} bytes, but its header says", length - 1)),
        (valid[..11].to_vec(), "a.glb: ends after 11 bytes, inside its header\n"),
    ];
    for (bytes, expected) in cases {
        assert!(error(&bytes).starts_with(&format!("error: {expected}")), "{}\nexpected {expected}", error(&bytes));
    }
    let short = glb(
        everything().json.to_string().replace("\"asset\"", "\"buffers\":[{\"byteLength\":9}],\"asset\"").as_bytes(),
        b"12345678",
    );
    assert!(error(&short).starts_with("error: a.glb: buffer 0: its byteLength is 9, but there are 8 bytes of data"));
}
