//! Materials: colours, emission, and what is not read of them.

use serde_json::{Value, json};

use super::support::{Builder, TRIANGLE, near, rgb, warnings};

/// A file with this material.
fn with(material: Value) -> Builder {
    let mut file = Builder::new();
    file.add("materials", material);
    file
}

#[test]
fn factors_are_linear() {
    let material = json!({
        "name": "glow",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.5, 1.0005, 0.2], "metallicFactor": 0.3 },
        "emissiveFactor": [1, 0.5, 0],
        "doubleSided": true,
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 30 } },
        "extras": { "light": true },
    });
    let material = &with(material).model().materials[0];
    assert_eq!(material.name.as_deref(), Some("glow"));
    assert_eq!(material.base_color, [0.1, 0.5, 1.0]);
    assert_eq!(material.emission, [30.0, 15.0, 0.0]);
    assert!(material.double_sided);
    assert_eq!(material.extras, Some(json!({ "light": true })));
    assert_eq!((material.base_color_texture, material.emissive_texture), (None, None));
}

#[test]
fn a_material_may_say_nothing() {
    assert_eq!(with(json!({})).model().materials, [fogbow::gltf::Material::default()]);
}

/// A triangle of each of these materials, and one material that nothing has.
fn painted(materials: &[Value]) -> Builder {
    let mut file = Builder::new();
    for material in materials {
        let index = file.add("materials", material.clone());
        let positions = file.floats(&TRIANGLE);
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions }, "material": index }));
        file.place(mesh);
    }
    file.add("materials", json!({ "name": "unused" }));
    file
}

#[test]
fn materials_that_are_more_than_diffuse_are_named_once() {
    let matte = json!({ "metallicFactor": 0, "roughnessFactor": 1, "baseColorFactor": [0.5, 0.5, 0.5, 1] });
    let with = |name: &str, key: &str, value: Value| {
        let mut surface = matte.clone();
        surface[key] = value;
        json!({ "name": name, "pbrMetallicRoughness": surface })
    };
    let texture = json!({ "index": 0 });
    let bumpy = json!({ "name": "bumpy", "pbrMetallicRoughness": matte, "normalTexture": texture });
    let materials = [
        json!({ "name": "matte", "pbrMetallicRoughness": matte }),
        with("brass", "metallicFactor", json!(0.9)),
        json!({ "name": "silent" }),
        with("floor", "roughnessFactor", json!(0.4)),
        with("tiles", "metallicRoughnessTexture", texture.clone()),
        bumpy,
    ];
    assert_eq!(
        warnings(&painted(&materials).model()),
        [
            "material 1 \"brass\", material 2 \"silent\": metallic materials are rendered as diffuse (metallicFactor is 1 \
             unless the file sets it)",
            "material 3 \"floor\", material 4 \"tiles\": glossy materials are rendered as diffuse, without highlights",
            "material 5 \"bumpy\": normal maps are ignored; surfaces are as flat as their triangles",
        ]
    );
    assert!(warnings(&painted(&materials[..1]).model()).is_empty());
}

#[test]
fn alpha_is_left_out() {
    let file = with(json!({ "name": "leaf", "alphaMode": "MASK" }));
    assert_eq!(warnings(&file.model()), ["material 0 \"leaf\": alpha is ignored; surfaces are opaque"]);
    assert!(with(json!({ "alphaMode": "OPAQUE" })).model().warnings.is_empty());
}

#[test]
fn textures_are_scaled_rotated_and_shifted() {
    let quarter = core::f64::consts::FRAC_PI_2;
    let transform = json!({ "offset": [0.5, 0.25], "rotation": quarter, "scale": [2, 4], "texCoord": 0 });
    let mut file = Builder::new();
    let texture = file.texture(&rgb(1, 1, &[[9; 3]]));
    let info = json!({ "index": texture, "texCoord": 1, "extensions": { "KHR_texture_transform": transform } });
    file.add("materials", json!({ "emissiveTexture": info, "emissiveFactor": [1, 1, 1] }));
    let plain = json!({ "index": texture, "texCoord": 1 });
    file.add("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": plain } }));
    let model = file.model();
    let turned = model.materials[0].emissive_texture.expect("a texture");
    assert_eq!(turned.texcoords, 0);
    // (1, 0) -> (2, 0) -> (0, -2) -> (0.5, -1.75); (0, 1) -> (0, 4) -> (4, 0) -> (4.5, 0.25)
    assert!(near(turned.transform([1.0, 0.0]), [0.5, -1.75]), "{:?}", turned.transform([1.0, 0.0]));
    assert!(near(turned.transform([0.0, 1.0]), [4.5, 0.25]), "{:?}", turned.transform([0.0, 1.0]));
    let plain = model.materials[1].base_color_texture.expect("a texture");
    assert_eq!((plain.texture, plain.texcoords, plain.transform([0.3, 0.4])), (0, 1, [0.3, 0.4]));
}
