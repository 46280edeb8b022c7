//! Files that were damaged at random: whatever comes of it, it is a model or an error.

use fogbow::error::Result;
use fogbow::gltf::{self, Model};
use fogbow_testing::random::Random;
use serde_json::{Value, json};

use super::animations::moving;
use super::support::{Builder, everything, rgb};
use super::textures::{JPEGS, jpeg};

/// Damaged files of each kind.
const CASES: u64 = 4000;

/// Says which case it was if reading panics.
struct Case(u64);

impl Drop for Case {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("case {}", self.0);
        }
    }
}

/// Reads what `damage` makes of each case. A model must be consistent, an error must have words.
fn try_all(damage: impl Fn(&mut Random) -> Vec<u8>) {
    try_all_by(damage, |bytes| gltf::parse("x", bytes, None));
}

fn try_all_by(damage: impl Fn(&mut Random) -> Vec<u8>, read: impl Fn(&[u8]) -> Result<Model>) {
    let mut models = 0;
    for case in 0..CASES {
        let _case = Case(case);
        match read(&damage(&mut Random::new(case))) {
            Ok(model) => {
                models += 1;
                let vertices = model.positions.len();
                assert!(model.positions.as_flattened().iter().all(|x| x.is_finite()));
                assert!(model.triangles.iter().all(|triangle| {
                    triangle.corners.iter().all(|corner| (*corner as usize) < vertices)
                        && (triangle.material as usize) < model.materials.len()
                }));
                assert!(model.texcoords.iter().all(|set| set.is_empty() || set.len() == vertices));
                assert!(model.colors.is_empty() || model.colors.len() == vertices);
                assert!(model.textures.iter().all(|texture| (texture.image as usize) < model.images.len()));
            }
            Err(error) => assert!(!error.finding.is_empty() && !error.remedy.is_empty(), "{error:?}"),
        }
    }
    assert!(models < CASES, "nothing was damaged");
}

#[test]
fn flipped_bits() {
    let valid = everything().glb();
    try_all(|random| {
        let mut bytes = valid.clone();
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        bytes
    });
}

#[test]
fn missing_and_repeated_bytes() {
    let valid = everything().glb();
    try_all(|random| {
        let [start, end] = [random.below(valid.len()), random.below(valid.len())];
        match random.below(3) {
            0 => valid[..start].to_vec(),
            1 => [&valid[..start], &valid[end..]].concat(),
            _ => [&valid[..start], &valid[start.min(end)..]].concat(),
        }
    });
}

#[test]
fn damaged_data() {
    let file = everything();
    try_all(|random| {
        let mut binary = file.binary.clone();
        for _ in 0..=random.below(6) {
            let at = random.below(binary.len());
            binary[at] = random.next() as u8;
        }
        Builder { json: file.json.clone(), binary }.glb()
    });
}

#[test]
fn damaged_images() {
    let mut images: Vec<Vec<u8>> = JPEGS.iter().map(|(base64, ..)| jpeg(base64)).collect();
    images.push(rgb(9, 7, &[[1, 2, 3]; 63]));
    try_all(|random| {
        let mut image = images[random.below(images.len())].clone();
        for _ in 0..=random.below(6) {
            let at = random.below(image.len());
            image[at] = random.next() as u8;
        }
        image.truncate(image.len() - random.below(2) * random.below(image.len()));
        let mut file = Builder::new();
        let texture = file.texture(&image);
        file.add("materials", json!({ "emissiveTexture": { "index": texture } }));
        file.glb()
    });
}

#[test]
fn replaced_values() {
    let valid = everything().embedded();
    try_all(|random| with_strange_values(&valid, random));
}

#[test]
fn damaged_animations() {
    let file = moving();
    let read = |bytes: &[u8]| gltf::parse_at("x", bytes, None, 1.25);
    let valid = file.embedded();
    try_all_by(|random| with_strange_values(&valid, random), read);
    let damaged = |random: &mut Random| {
        let mut binary = file.binary.clone();
        let at = random.below(binary.len());
        binary[at] = random.next() as u8;
        Builder { json: file.json.clone(), binary }.glb()
    };
    try_all_by(damaged, read);
}

/// The file with values that somebody may not have thought of, in the place of others.
fn with_strange_values(valid: &Value, random: &mut Random) -> Vec<u8> {
    let mut json = valid.clone();
    for _ in 0..=random.below(2) {
        let leaves = count(&json);
        let mut number = random.below(leaves);
        let value = strange(random);
        replace(&mut json, &mut number, &value);
    }
    json.to_string().into_bytes()
}

/// How many values there are in `value`, itself included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(list) => list.iter().map(count).sum(),
        Value::Object(map) => map.values().map(count).sum(),
        _ => 0,
    }
}

/// Puts `new` in the place of the value with this number, counted as [`count`] does.
fn replace(value: &mut Value, number: &mut usize, new: &Value) -> bool {
    if *number == 0 {
        *value = new.clone();
        return true;
    }
    *number -= 1;
    match value {
        Value::Array(list) => list.iter_mut().any(|value| replace(value, number, new)),
        Value::Object(map) => map.values_mut().any(|value| replace(value, number, new)),
        _ => false,
    }
}

/// A value that somebody may not have thought of.
fn strange(random: &mut Random) -> Value {
    let small = random.below(12);
    let strange = [
        json!(small),
        json!(small),
        json!(0),
        json!(-1),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(u32::MAX),
        json!(1_000_000),
        json!(5120 + small),
        json!(1e308),
        json!(-1e-308),
        json!(0.5),
        json!(null),
        json!(true),
        json!(""),
        json!("VEC3"),
        json!("data:;base64,AAAA"),
        json!([]),
        json!([0, 1, 2]),
        json!([[], {}]),
        json!({}),
        json!({ "index": small }),
    ];
    strange[random.below(strange.len())].clone()
}
