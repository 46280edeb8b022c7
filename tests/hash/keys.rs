//! A scene that has every key, and what can be said about keys.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use fogbow::scene::document::Override;
use fogbow::scene::schema::Scene;
use fogbow::scene::{self, LoadedScene};
use schemars::schema_for;
use serde_json::Value as Json;
use tempfile::TempDir;
use toml::Value;

/// A scene that has every key, but those about a model.
pub const SCENE: &str = r#"
[camera]
position = [0.5, 1, 2]
look_at = [0.25, 0.5, 5]
up = [0, 1, 0.125]
vertical_fov_deg = 60
near = 0.5

[film]
size = [8, 6]
exposure = 1
aov = ["depth"]

[medium]
scattering = [0.5, 0.75, 1]
absorption = [1, 0.75, 0.5]
emission = [1, 2, 3]
phase = { type = "henyey_greenstein", g = 0.5 }

[[light]]
type = "disk"
center = [0, 0, 9]
normal = [0.25, 0.5, -1]
radius = 1.5
radiance = [10, 5, 2]

[[light]]
type = "spot"
center = [3, 0, 9]
normal = [0.25, 0.5, -1]
radius = 0.5
radiance = [1, 5, 2]
exponent = 4

[[light]]
type = "sphere"
center = [-3, 0, 9]
radius = 0.5
radiance = [1, 2, 3]

[render]
technique = ["mvnee", "bridge", "lis"]
max_segments = 8
min_segments = 2
roll = "aligned"
bridge_mesc = 9
bridge_vertices = 5
starts = 3
survival = 0.5
aimed = 0.25
roulette = 0.125
mesc = 4
perturbation = "ggx"
seeds = "coarse"
lis = "bridge"
light_selection = "uniform"
samples = 4
seed = 7
"#;

/// The medium of the scene, and the volume that stands in its place in another one.
pub const MEDIUM: [&str; 2] = [
    "[medium]\nscattering = [0.5, 0.75, 1]\nabsorption = [1, 0.75, 0.5]\nemission = [1, 2, 3]\nphase = { type = \"henyey_greenstein\", g = 0.5 }",
    r#"[[volume]]
name = "cloud"
scattering = [0.5, 0.75, 1]
absorption = [1, 0.75, 0.5]
emission = [1, 2, 3]
phase = { type = "henyey_greenstein", g = 0.5 }

[volume.grid]
file = "cloud.vdb"
name = "density"
scale = 2
interpolation = "nearest"
scale_by = 0.5
rotate_deg = [10, 20, 30]
translate = [1, 2, 3]

[volume.emission_grid]
file = "cloud.vdb"
name = "density"
scale = 3
interpolation = "nearest"
scale_by = 0.5
rotate_deg = [10, 20, 30]
translate = [1, 2, 3]

[environment]
image = "sky.exr"
rotation_deg = 10
scale = 2

[[light]]
type = "sun"
direction = [0.5, -1, 0.25]
irradiance = [3, 2, 1]
angular_radius_deg = 0.5"#,
];

/// Keys that change no sample.
pub const WITHOUT_EFFECT: [&str; 4] = ["render.samples", "film.exposure", "film.aov", "punctual_radius"];
/// Keys with nothing else to say here: phase functions have a test of their own, and what a light is follows from its
/// normal and its exponent.
pub const WITHOUT_CHOICE: [&str; 9] = [
    "environment.image",
    "medium.phase.type",
    "light.type",
    "volume.phase.type",
    "volume.name",
    "volume.grid.file",
    "volume.grid.name",
    "volume.emission_grid.file",
    "volume.emission_grid.name",
];
/// Keys of other phase functions, the preset in the place of coefficients, and what needs a file of its own: see below,
/// and the tests of models.
pub const ELSEWHERE: [&str; 18] = [
    "environment.radiance",
    "geometry",
    "medium.phase.alpha",
    "medium.phase.diameter_um",
    "medium.phase.file",
    "medium.phase.weight",
    "medium.preset",
    "volume.phase.alpha",
    "volume.phase.diameter_um",
    "volume.phase.file",
    "volume.phase.weight",
    "volume.preset",
    "volume.shape.center",
    "volume.shape.max",
    "volume.shape.min",
    "volume.shape.name",
    "volume.shape.radius",
    "volume.shape.type",
];

/// The scene in a file, and what can be said about its keys.
pub struct Keys {
    pub folder: TempDir,
    pub schema: Json,
}

impl Keys {
    pub fn new() -> Self {
        Self::of(SCENE)
    }

    pub fn of(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("scene.toml"), text).expect("a file");
        let cloud = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/blob.vdb");
        std::fs::copy(cloud, folder.path().join("cloud.vdb")).expect("a file");
        write_sky(&folder.path().join("sky.exr"), 0.5);
        Self { folder, schema: schema_for!(Scene).to_value() }
    }

    /// The scene with a volume instead of a medium.
    pub fn with_volume() -> Self {
        let [medium, volume] = MEDIUM;
        assert!(SCENE.contains(medium));
        Self::of(&SCENE.replace(medium, volume))
    }

    pub fn file(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    /// The scene with other values; none if one of them is refused.
    pub fn with(&self, changes: &[(String, Value)]) -> Option<LoadedScene> {
        let change = |(key, value): &(String, Value)| Override {
            key: key.clone(),
            value: value.clone(),
            flag: format!("--set {key}={value}"),
            is_dedicated: false,
        };
        scene::load(&self.file(), changes.iter().map(change).collect()).ok()
    }

    pub fn base(&self) -> LoadedScene {
        self.with(&[]).expect("a valid scene")
    }

    /// What the schema says of the key at `path`, which has no indices.
    pub fn definition(&self, path: &str) -> &Json {
        path.split('.').fold(&self.schema, |table, key| self.resolve(&table["properties"][key]))
    }

    /// The definition that a property, or an entry of it, refers to, or itself.
    pub fn resolve<'a>(&'a self, property: &'a Json) -> &'a Json {
        let alternatives = ["anyOf", "allOf"].iter().filter_map(|name| property[*name].as_array()).flatten();
        let mut targets = [property, &property["items"]].into_iter().chain(alternatives);
        let reference = targets.find_map(|target| target["$ref"].as_str());
        let target = reference.and_then(|path| self.schema.pointer(path.trim_start_matches('#')));
        target.map_or(property, |target| self.resolve(target))
    }

    /// The paths of all keys that are not tables.
    pub fn all(&self) -> BTreeSet<String> {
        let mut paths = BTreeSet::new();
        self.collect("", &self.schema, &mut paths);
        paths
    }

    pub fn collect(&self, path: &str, table: &Json, paths: &mut BTreeSet<String>) {
        match table["properties"].as_object() {
            None => drop(paths.insert(path.into())),
            Some(properties) => properties.iter().for_each(|(key, property)| {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                self.collect(&path, self.resolve(property), paths);
            }),
        }
    }

    /// Other values for the one at `path`.
    pub fn others(&self, path: &str, value: &Value) -> Vec<Value> {
        let choices = self.definition(path)["oneOf"].as_array();
        let names = choices.into_iter().flatten().filter_map(|choice| choice["const"].as_str());
        match value {
            Value::Integer(number) => vec![(number + 1).into(), (number - 1).into()],
            Value::Float(number) => vec![(number + 0.125).into(), (number - 0.125).into()],
            Value::String(name) => names.filter(|other| other != name).map(Value::from).collect(),
            _ => panic!("{path} is {value}"),
        }
    }
}

/// Writes an image of a sky, of this red.
pub fn write_sky(path: &Path, red: f32) {
    let pixel = |x: usize, y: usize| (red, x as f32, y as f32);
    exr::prelude::write_rgb_file(path, 8, 4, pixel).expect("an image");
}

/// Calls `visit` with path and value of everything in `value` that is neither a table nor a list.
pub fn leaves(path: &str, value: &Value, visit: &mut impl FnMut(&str, &Value)) {
    match value {
        Value::Table(table) if path.is_empty() => table.iter().for_each(|(key, value)| leaves(key, value, visit)),
        Value::Table(table) => table.iter().for_each(|(key, value)| leaves(&format!("{path}.{key}"), value, visit)),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(index, value)| leaves(&format!("{path}[{index}]"), value, visit));
        }
        value => visit(path, value),
    }
}

/// The path without indices.
pub fn key(path: &str) -> String {
    path.split('.').map(|step| step.split('[').next().unwrap_or(step)).collect::<Vec<_>>().join(".")
}

/// What goes with a change at `path`, so that the scene stays valid: extinction is the same in all channels.
pub fn companion(path: &str, by: f64) -> Option<(String, Value)> {
    let absorption = |channel: usize| [1.0, 0.75, 0.5][channel];
    let (table, channel) = path.strip_suffix(']')?.split_once(".scattering[")?;
    let channel = channel.parse().ok()?;
    Some((format!("{table}.absorption[{channel}]"), (absorption(channel) - by).into()))
}
