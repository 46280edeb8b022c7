//! Meshes, nodes, materials, cameras and lights that refer to what does not exist or have values out of range.

use serde_json::{Value, json};

use super::super::support::POSITIONS;
use super::{changed, refuse};

#[test]
fn meshes() {
    let primitive = "mesh 0 \"Wall\", primitive 0";
    refuse(&[
        ("/meshes/0/primitives", json!([]), "mesh 0 \"Wall\", primitives: is empty\n"),
        ("/meshes/0/primitives/0/attributes", json!({}), &format!("{primitive}: has no POSITION\n")),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(9),
            &format!("{primitive}, POSITION: refers to accessor 9, but the last one is 4\n"),
        ),
        ("/meshes/0/primitives/0/attributes/COLOR_0", json!(9), &format!("{primitive}, COLOR_0: refers to accessor 9")),
        ("/meshes/0/primitives/0/indices", json!(9), &format!("{primitive}, indices: refers to accessor 9")),
        (
            "/meshes/0/primitives/0/indices",
            json!(4_294_967_296u64),
            &format!("{primitive}, indices: refers to accessor 4294967296"),
        ),
        (
            "/meshes/0/primitives/0/material",
            json!(1),
            &format!("{primitive}: refers to material 1, but the last one is 0\n"),
        ),
        ("/meshes/0/primitives/0/mode", json!(7), &format!("{primitive}: its mode is 7\n")),
        ("/meshes/0/primitives/0/mode", json!(4_294_967_300u64), &format!("{primitive}: its mode is 4294967300\n")),
        ("/nodes/1/mesh", json!(1), "node 1: refers to mesh 1, but the last one is 0\n"),
    ]);
    for (scale, x) in [(3e38, "3e38"), (1.001e9, "1001000000.0")] {
        let error = changed("/nodes/1/scale", json!([scale, scale, scale])).error();
        let finding = format!("node 1, mesh 0 \"Wall\": puts vertex [1.0, 0.0, 0.0] at [{x}, 0.0, 0.0]\n");
        assert!(error.starts_with(&format!("error: test.glb: {finding}")), "{error}");
    }
}

#[test]
fn compressed_meshes() {
    let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    let mut file = changed("/meshes/0/primitives/0/extensions", draco);
    file.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    // What is compressed may also be there as it is.
    assert_eq!(file.model().triangles.len(), 8);
    file.json["accessors"][POSITIONS].as_object_mut().expect("an accessor").remove("bufferView");
    let expected = "error: test.glb: mesh 0 \"Wall\", primitive 0: its positions are only in \
                    \"KHR_draco_mesh_compression\", which is not supported\n  help: export the model without mesh compression";
    assert!(file.error().starts_with(expected), "{}", file.error());
}

#[test]
fn hierarchies() {
    let projective = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 1]);
    let identity = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    refuse(&[
        ("/scene", json!(1), "refers to scene 1, but the last one is 0\n"),
        ("/scenes/0/nodes/0", json!(4), "scene 0: refers to node 4, but the last one is 3\n"),
        ("/scenes/0/nodes/0", json!(1), "scene 0: lists node 1, which is a child of another node\n"),
        ("/scenes/0/nodes/0", json!(3), "scene 0: lists node 3 twice\n"),
        ("/nodes/0/children", json!([1, 2, 4]), "node 0 \"Root\", children: refers to node 4, but the last one is 3\n"),
        ("/nodes/0/children", json!([1, 2, 2]), "node 2: is a child of node 0 and of node 0\n"),
        ("/nodes/3/children", json!([2]), "node 2: is a child of node 0 and of node 3\n"),
        ("/nodes/1/children", json!([0]), "node 0 \"Root\": is in or below a cycle of the hierarchy\n"),
        ("/nodes/3/children", json!([3]), "node 3: is in or below a cycle of the hierarchy\n"),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), "node 0 \"Root\": its rotation is [0.0, 0.0, 0.0, 0.0]\n"),
        ("/nodes/0/rotation", json!([1e300, 1e300, 0, 0]), "node 0 \"Root\": its rotation is [1e300, "),
        ("/nodes/1/scale", json!([1e308, 1e308, 1e308]), "node 1, mesh 0 \"Wall\": puts vertex "),
        ("/nodes/3/matrix", projective, "node 3: the last row of its matrix is [0.0, 0.0, -1.0, 1.0]\n"),
        ("/nodes/0/matrix", identity, "node 0 \"Root\": has a matrix and also translation, rotation or scale\n"),
    ]);
}

#[test]
fn materials_and_textures() {
    let place = "material 0 \"Paint\"";
    let surface = "/materials/0/pbrMetallicRoughness";
    let strength = "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength";
    refuse(&[
        (
            &format!("{surface}/baseColorFactor"),
            json!([0.5, 1.5, 0, 1]),
            &format!("{place}, baseColorFactor: is [0.5, 1.5, 0.0]\n"),
        ),
        (
            &format!("{surface}/baseColorFactor"),
            json!([0.5, -0.5, 0, 1]),
            &format!("{place}, baseColorFactor: is [0.5, -0.5, 0.0]\n"),
        ),
        ("/materials/0/emissiveFactor", json!([-1, 0, 0]), &format!("{place}, emissiveFactor: is [-1.0, 0.0, 0.0]\n")),
        (strength, json!(-2), &format!("{place}, KHR_materials_emissive_strength: is -2.0\n")),
        (strength, json!(1e39), &format!("{place}, emission: is [1.0, 0.5, 0.0] times 1e39, too large")),
        (
            &format!("{surface}/baseColorTexture/index"),
            json!(2),
            &format!("{place}, baseColorTexture: refers to texture 2"),
        ),
        (
            &format!("{surface}/baseColorTexture/texCoord"),
            json!(2),
            &format!("{place}, baseColorTexture: its texCoord is 2\n"),
        ),
        (
            &format!("{surface}/baseColorTexture/extensions/KHR_texture_transform/scale"),
            json!([1e39, 1]),
            &format!("{place}, baseColorTexture, KHR_texture_transform: is "),
        ),
        ("/materials/0/emissiveTexture/index", json!(2), &format!("{place}, emissiveTexture: refers to texture 2")),
        ("/textures/0/sampler", json!(1), &format!("{place}, baseColorTexture, texture 0: refers to sampler 1")),
        ("/textures/0/source", json!(2), &format!("{place}, baseColorTexture, texture 0: refers to image 2")),
        ("/textures/0", json!({}), &format!("{place}, baseColorTexture, texture 0: has no source\n")),
        (
            "/textures/0",
            json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }),
            &format!(
                "{place}, baseColorTexture, texture 0: its only image is in \"KHR_texture_basisu\", which is not supported\n"
            ),
        ),
        (
            "/samplers/0/magFilter",
            json!(9987),
            &format!("{place}, baseColorTexture, texture 0, sampler 0: its magFilter is 9987\n"),
        ),
        ("/samplers/0/wrapS", json!(1), &format!("{place}, baseColorTexture, texture 0, sampler 0, wrapS: is 1\n")),
        ("/images/0", json!({}), "image 0: has neither a URI nor a bufferView\n"),
        ("/images/0/uri", json!("a.png"), "image 0: has both a URI and a bufferView\n"),
        ("/images/0/bufferView", json!(99), "image 0: refers to bufferView 99"),
    ]);
}

#[test]
fn cameras() {
    let lens = "/cameras/0/perspective";
    refuse(&[
        ("/nodes/2/camera", json!(1), "node 2: refers to camera 1, but the last one is 0\n"),
        ("/cameras/0/type", json!("fisheye"), "camera 0 \"Eye\": has type \"fisheye\"\n"),
        (lens, Value::Null, "camera 0 \"Eye\": has no perspective\n"),
        (&format!("{lens}/yfov"), json!(0), "camera 0 \"Eye\": its yfov is 0.0\n"),
        (&format!("{lens}/yfov"), json!(3.2), "camera 0 \"Eye\": its yfov is 3.2\n"),
        (&format!("{lens}/yfov"), json!(-1), "camera 0 \"Eye\": its yfov is -1.0\n"),
        (&format!("{lens}/znear"), json!(0), "camera 0 \"Eye\": its znear is 0.0\n"),
        (&format!("{lens}/aspectRatio"), json!(-1), "camera 0 \"Eye\": its aspectRatio is -1.0\n"),
    ]);
}

#[test]
fn lights() {
    let light = "/extensions/KHR_lights_punctual/lights/0";
    let cone = "light 0 \"Lamp\": its cone is from ";
    refuse(&[
        (
            "/nodes/2/extensions/KHR_lights_punctual/light",
            json!(1),
            "node 2: refers to light 1, but the last one is 0\n",
        ),
        ("/extensions", json!({}), "node 2: refers to light 0, but the file has none\n"),
        (&format!("{light}/type"), json!("area"), "light 0 \"Lamp\": has type \"area\"\n"),
        (&format!("{light}/spot"), Value::Null, "light 0 \"Lamp\": has no spot\n"),
        (&format!("{light}/color"), json!([1, -1, 0]), "light 0 \"Lamp\": its color is [1.0, -1.0, 0.0]\n"),
        (&format!("{light}/color"), json!([1e39, 0, 0]), "light 0 \"Lamp\": its color is [1e39, 0.0, 0.0]\n"),
        (&format!("{light}/intensity"), json!(-1), "light 0 \"Lamp\": its intensity is -1.0\n"),
        (&format!("{light}/spot/innerConeAngle"), json!(-0.1), &format!("{cone}-0.1 to 0.5\n")),
        (&format!("{light}/spot/innerConeAngle"), json!(0.6), &format!("{cone}0.6 to 0.5\n")),
        (&format!("{light}/spot"), json!({ "innerConeAngle": 0, "outerConeAngle": 0 }), &format!("{cone}0.0 to 0.0\n")),
        (&format!("{light}/spot/outerConeAngle"), json!(1.6), &format!("{cone}0.1 to 1.6\n")),
    ]);
}
