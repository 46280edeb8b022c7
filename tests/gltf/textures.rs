//! Images and what textures make of them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fogbow::gltf::{Filter, Image, Model, Texture, Wrap};
use png::{BitDepth, ColorType};
use serde_json::json;

use super::support::{Builder, TRIANGLE, near, png, rgb, warnings};

/// Base64, width, height and grey value of images of one colour: baseline, progressive, and without colour.
pub const JPEGS: [(&str, u32, u32, u8); 3] = [
    (
        "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMU\
         FRUVDA8XGBYUGBIUFRT/2wBDAQMEBAUEBQkFBQkUDQsNFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQU\
         FBQUFBQUFBT/wAARCAAIABADASIAAhEBAxEB/8QAFAABAAAAAAAAAAAAAAAAAAAAAP/EABQQAQAAAAAAAAAAAAAAAAAAAAD/xAAU\
         AQEAAAAAAAAAAAAAAAAAAAAA/8QAFBEBAAAAAAAAAAAAAAAAAAAAAP/aAAwDAQACEQMRAD8AAA//2Q==",
        16,
        8,
        128,
    ),
    (
        "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMU\
         FRUVDA8XGBYUGBIUFRT/2wBDAQMEBAUEBQkFBQkUDQsNFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQU\
         FBQUFBQUFBT/wgARCAAIABADASIAAhEBAxEB/8QAFAABAAAAAAAAAAAAAAAAAAAAAP/EABQBAQAAAAAAAAAAAAAAAAAAAAD/2gAM\
         AwEAAhADEAAAAQP/xAAUEAEAAAAAAAAAAAAAAAAAAAAQ/9oACAEBAAEFAj//xAAUEQEAAAAAAAAAAAAAAAAAAAAA/9oACAEDAQE/\
         AX//xAAUEQEAAAAAAAAAAAAAAAAAAAAA/9oACAECAQE/AX//xAAUEAEAAAAAAAAAAAAAAAAAAAAQ/9oACAEBAAY/Aj//xAAUEAEA\
         AAAAAAAAAAAAAAAAAAAQ/9oACAEBAAE/IT//2gAMAwEAAgADAAAAEAP/xAAUEQEAAAAAAAAAAAAAAAAAAAAA/9oACAEDAQE/EH//\
         xAAUEQEAAAAAAAAAAAAAAAAAAAAA/9oACAECAQE/EH//xAAUEAEAAAAAAAAAAAAAAAAAAAAQ/9oACAEBAAE/ED//2Q==",
        16,
        8,
        128,
    ),
    (
        "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMU\
         FRUVDA8XGBYUGBIUFRT/wAALCAAFAAkBAREA/8QAFQABAQAAAAAAAAAAAAAAAAAAAAj/xAAUEAEAAAAAAAAAAAAAAAAAAAAA/9oA\
         CAEBAAA/ALAH/9k=",
        9,
        5,
        200,
    ),
];

/// The bytes of one of them.
pub fn jpeg(base64: &str) -> Vec<u8> {
    STANDARD.decode(base64).expect("base64")
}

/// A file with a material for each of `textures`.
fn using(mut file: Builder, textures: &[usize]) -> Model {
    for texture in textures {
        file.add(
            "materials",
            json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorTexture": { "index": texture } } }),
        );
    }
    file.model()
}

fn image(bytes: &[u8]) -> Image {
    let mut file = Builder::new();
    let texture = file.texture(bytes);
    using(file, &[texture]).images.remove(0)
}

#[test]
fn every_kind_of_png_is_read() {
    type Case = (ColorType, BitDepth, &'static [u8], [[u8; 3]; 2]);
    let cases: [Case; 6] = [
        (ColorType::Rgb, BitDepth::Eight, &[1, 2, 3, 4, 5, 6], [[1, 2, 3], [4, 5, 6]]),
        (ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 0, 4, 5, 6, 255], [[1, 2, 3], [4, 5, 6]]),
        (ColorType::Grayscale, BitDepth::Eight, &[7, 8], [[7; 3], [8; 3]]),
        (ColorType::Grayscale, BitDepth::One, &[0b0100_0000], [[0; 3], [255; 3]]),
        (ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 0, 8, 9], [[7; 3], [8; 3]]),
        (ColorType::Grayscale, BitDepth::Sixteen, &[7, 200, 8, 0], [[7; 3], [8; 3]]),
    ];
    for (color, depth, rows, texels) in cases {
        let image = image(&png(2, 1, color, depth, rows));
        assert_eq!((image.width, image.height, image.texels.as_slice()), (2, 1, &texels[..]), "{color:?} {depth:?}");
    }
}

#[test]
fn palettes_are_looked_up() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 3, 1);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Two);
    encoder.set_palette(vec![9, 8, 7, 1, 2, 3]);
    encoder.set_trns(vec![0, 255]);
    encoder.write_header().expect("a header").write_image_data(&[0b0100_0100]).expect("a row");
    assert_eq!(image(&bytes).texels, [[1, 2, 3], [9, 8, 7], [1, 2, 3]]);
}

#[test]
fn jpegs_are_read() {
    for (base64, width, height, grey) in JPEGS {
        let image = image(&jpeg(base64));
        assert_eq!((image.width, image.height), (width, height));
        assert_eq!(image.texels, vec![[grey; 3]; (width * height) as usize]);
    }
}

#[test]
fn an_image_is_decoded_once_and_looked_up_in_many_ways() {
    let mut file = Builder::new();
    let unused = file.texture(b"this is not an image");
    let plain = file.texture(&rgb(1, 2, &[[1; 3], [2; 3]]));
    file.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648, "minFilter": 9987 }]);
    let other = file.add("textures", json!({ "source": 1, "sampler": 0 }));
    let alias = file.json["images"][1].clone();
    let alias = file.add("images", alias);
    let aliased = file.add("textures", json!({ "source": alias }));
    let model = using(file, &[other, plain, other, aliased]);
    assert_eq!(unused, 0);
    assert_eq!(model.images.len(), 1);
    let repeated = Texture { image: 0, wrap: [Wrap::Repeat; 2], filter: Filter::Linear };
    let clamped = Texture { image: 0, wrap: [Wrap::Clamp, Wrap::Mirror], filter: Filter::Nearest };
    assert_eq!(model.textures, [clamped, repeated, repeated]);
    let textures = model.materials.iter().map(|material| material.base_color_texture.expect("a texture").texture);
    assert_eq!(textures.collect::<Vec<_>>(), [0, 1, 0, 2]);
}

#[test]
fn lookups_are_linear_and_wrap() {
    let image = image(&rgb(2, 2, &[[0, 64, 255], [255; 3], [128, 0, 0], [0; 3]]));
    // 64 is 0.05126946 and 128 is 0.21586050 in linear light.
    assert!(near(image.linear(0, 0), [0.0, 0.051_269_46, 1.0]));
    let texture = |wrap, filter| Texture { image: 0, wrap: [wrap, Wrap::Clamp], filter };
    let nearest = |wrap, u, v| texture(wrap, Filter::Nearest).sample(&image, [u, v])[0];
    assert_eq!([0.1, 0.9].map(|u| nearest(Wrap::Repeat, u, 0.1)), [0.0, 1.0]);
    assert_eq!([1.1, 1.9, -0.1].map(|u| nearest(Wrap::Repeat, u, 0.1)), [0.0, 1.0, 1.0]);
    assert_eq!([1.1, 1.9, -0.1].map(|u| nearest(Wrap::Mirror, u, 0.1)), [1.0, 0.0, 0.0]);
    assert_eq!([1.1, 1.9, -0.1].map(|u| nearest(Wrap::Clamp, u, 0.1)), [1.0, 1.0, 0.0]);
    assert!((nearest(Wrap::Repeat, 0.1, 0.9) - 0.215_860_5).abs() < 1e-6);
    let linear = |wrap, u, v| texture(wrap, Filter::Linear).sample(&image, [u, v])[0];
    // Centres of texels are at 1/4 and 3/4.
    assert_eq!([0.25, 0.5, 0.625, 0.75].map(|u| linear(Wrap::Repeat, u, 0.25)), [0.0, 0.5, 0.75, 1.0]);
    assert_eq!([0.0, 1.0].map(|u| linear(Wrap::Repeat, u, 0.25)), [0.5, 0.5]);
    assert_eq!([0.0, 1.0].map(|u| linear(Wrap::Mirror, u, 0.25)), [0.0, 1.0]);
    assert_eq!([-3.0, 4.0].map(|u| linear(Wrap::Clamp, u, 0.25)), [0.0, 1.0]);
    let middle = linear(Wrap::Repeat, 0.5, 0.5);
    assert!((middle - (1.0 + 0.215_860_5) / 4.0).abs() < 1e-6, "{middle}");
}

#[test]
fn meshes_without_texture_coordinates_are_at_0_0() {
    let mut file = Builder::new();
    let texture = file.texture(&rgb(1, 1, &[[9; 3]]));
    let info = json!({ "index": texture, "texCoord": 1 });
    file.add("materials", json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorTexture": info } }));
    let positions = file.floats(&TRIANGLE);
    let texcoords = file.floats(&[[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]);
    let bytes = file.normalized(super::support::U8, "VEC2", 3, &[0, 51, 102, 153, 204, 255]);
    for attributes in [
        json!({ "POSITION": positions, "TEXCOORD_0": texcoords }),
        json!({ "POSITION": positions, "TEXCOORD_1": texcoords }),
        json!({ "POSITION": positions, "TEXCOORD_1": bytes }),
    ] {
        let mesh = file.mesh(json!({ "attributes": attributes, "material": 0 }));
        file.place(mesh);
    }
    let model = file.model();
    assert!(model.texcoords[0].is_empty());
    let second = &model.texcoords[1];
    assert_eq!(second[..6], [[0.0; 2], [0.0; 2], [0.0; 2], [0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]);
    assert!(near(second[6], [0.0, 0.2]) && near(second[7], [0.4, 0.6]) && near(second[8], [0.8, 1.0]), "{second:?}");
    let warning = "texture coordinates for a texture of the material are missing; (0, 0) is used";
    assert_eq!(warnings(&model), [format!("mesh 0, primitive 0: {warning}")]);
}
