//! Cameras and lights, from `scene.toml`.

use std::path::{Path, PathBuf};

use glam::DVec3;
use toml::{Table, Value};

/// All scenes with geometry.
pub const SCENES: [&str; 11] = [
    "dense-plate",
    "cornell-fog",
    "cornell-fog-thin",
    "spotlight",
    "colonnade",
    "godrays",
    "cloud-box",
    "cloud-sky",
    "smoke-fire",
    "wax",
    "milk",
];

/// The folder of a scene.
pub fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("among the scenes").join(name)
}

/// What a scene says.
pub fn read(name: &str) -> Table {
    let text = std::fs::read_to_string(folder(name).join("scene.toml")).expect("a readable file");
    text.parse().expect("TOML")
}

/// A disk that emits from its front.
#[derive(Debug)]
pub struct Light {
    pub center: DVec3,
    pub normal: DVec3,
    pub radius: f64,
}

impl Light {
    /// Points all over the disk, the centre first.
    pub fn points(&self) -> impl Iterator<Item = DVec3> {
        let (a, b) = self.normal.any_orthonormal_pair();
        (0..64).map(move |i| {
            let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
            self.center + self.radius * (f64::from(i) / 63.0).sqrt() * (cos * a + sin * b)
        })
    }
}

/// The lights of a scene.
pub fn lights(name: &str) -> Vec<Light> {
    let scene = read(name);
    let lights = scene["light"].as_array().expect("lights");
    let light = |light: &Value| Light {
        center: vector(&light["center"]),
        normal: vector(&light["normal"]).normalize(),
        radius: number(&light["radius"]),
    };
    lights.iter().map(light).collect()
}

/// The pinhole and the unit viewing direction of a scene.
pub fn camera(name: &str) -> [DVec3; 2] {
    let camera = &read(name)["camera"];
    let position = vector(&camera["position"]);
    [position, (vector(&camera["look_at"]) - position).normalize()]
}

/// Three numbers.
pub fn vector(value: &Value) -> DVec3 {
    let numbers: Vec<f64> = value.as_array().expect("three numbers").iter().map(number).collect();
    DVec3::from_slice(&numbers)
}

fn number(value: &Value) -> f64 {
    value.as_float().or(value.as_integer().map(|whole| whole as f64)).expect("a number")
}
