//! The hash of a scene follows every key on which samples depend, and no other.

use std::collections::BTreeSet;
use std::path::PathBuf;

use fogbow::scene::document::Override;
use fogbow::scene::presets::PRESETS;
use fogbow::scene::schema::Scene;
use fogbow::scene::{self, LoadedScene};
use schemars::schema_for;
use serde_json::Value as Json;
use tempfile::TempDir;
use toml::Value;

/// A scene that has every key, but those about a model.
const SCENE: &str = r#"
[camera]
position = [0.5, 1, 2]
look_at = [0.25, 0.5, 5]
up = [0, 1, 0.125]
vertical_fov_deg = 60
near = 0.5

[film]
size = [8, 6]
exposure = 1

[medium]
scattering = [0.5, 0.75, 1]
absorption = [1, 0.75, 0.5]
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
lis = "bridge"
light_selection = "uniform"
samples = 4
seed = 7
"#;

/// The medium of the scene, and the volume that stands in its place in another one.
const MEDIUM: [&str; 2] = [
    "[medium]\nscattering = [0.5, 0.75, 1]\nabsorption = [1, 0.75, 0.5]\nphase = { type = \"henyey_greenstein\", g = 0.5 }",
    r#"[[volume]]
name = "cloud"
scattering = [0.5, 0.75, 1]
absorption = [1, 0.75, 0.5]
phase = { type = "henyey_greenstein", g = 0.5 }

[volume.grid]
file = "cloud.vdb"
name = "density"
scale = 2
interpolation = "nearest"
scale_by = 0.5
rotate_deg = [10, 20, 30]
translate = [1, 2, 3]"#,
];

/// Keys that change no sample.
const WITHOUT_EFFECT: [&str; 3] = ["render.samples", "film.exposure", "punctual_radius"];
/// Keys with nothing else to say here: phase functions have a test of their own, and what a light is follows from its
/// normal and its exponent.
const WITHOUT_CHOICE: [&str; 6] =
    ["medium.phase.type", "light.type", "volume.phase.type", "volume.name", "volume.grid.file", "volume.grid.name"];
/// Keys of other phase functions, the preset in the place of coefficients, and what needs a file of its own: see below,
/// and the tests of models.
const ELSEWHERE: [&str; 14] = [
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
    "volume.shape.max",
    "volume.shape.min",
    "volume.shape.type",
];

/// The scene in a file, and what can be said about its keys.
struct Keys {
    folder: TempDir,
    schema: Json,
}

impl Keys {
    fn new() -> Self {
        Self::of(SCENE)
    }

    fn of(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("scene.toml"), text).expect("a file");
        let cloud = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/blob.vdb");
        std::fs::copy(cloud, folder.path().join("cloud.vdb")).expect("a file");
        Self { folder, schema: schema_for!(Scene).to_value() }
    }

    /// The scene with a volume instead of a medium.
    fn with_volume() -> Self {
        let [medium, volume] = MEDIUM;
        assert!(SCENE.contains(medium));
        Self::of(&SCENE.replace(medium, volume).replace(", \"lis\"]", "]"))
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    /// The scene with other values; none if one of them is refused.
    fn with(&self, changes: &[(String, Value)]) -> Option<LoadedScene> {
        let change = |(key, value): &(String, Value)| Override {
            key: key.clone(),
            value: value.clone(),
            flag: format!("--set {key}={value}"),
            is_dedicated: false,
        };
        scene::load(&self.file(), changes.iter().map(change).collect()).ok()
    }

    fn base(&self) -> LoadedScene {
        self.with(&[]).expect("a valid scene")
    }

    /// What the schema says of the key at `path`, which has no indices.
    fn definition(&self, path: &str) -> &Json {
        path.split('.').fold(&self.schema, |table, key| self.resolve(&table["properties"][key]))
    }

    /// The definition that a property, or an entry of it, refers to, or itself.
    fn resolve<'a>(&'a self, property: &'a Json) -> &'a Json {
        let alternatives = ["anyOf", "allOf"].iter().filter_map(|name| property[*name].as_array()).flatten();
        let mut targets = [property, &property["items"]].into_iter().chain(alternatives);
        let reference = targets.find_map(|target| target["$ref"].as_str());
        let target = reference.and_then(|path| self.schema.pointer(path.trim_start_matches('#')));
        target.map_or(property, |target| self.resolve(target))
    }

    /// The paths of all keys that are not tables.
    fn all(&self) -> BTreeSet<String> {
        let mut paths = BTreeSet::new();
        self.collect("", &self.schema, &mut paths);
        paths
    }

    fn collect(&self, path: &str, table: &Json, paths: &mut BTreeSet<String>) {
        match table["properties"].as_object() {
            None => drop(paths.insert(path.into())),
            Some(properties) => properties.iter().for_each(|(key, property)| {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                self.collect(&path, self.resolve(property), paths);
            }),
        }
    }

    /// Other values for the one at `path`.
    fn others(&self, path: &str, value: &Value) -> Vec<Value> {
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

/// Calls `visit` with path and value of everything in `value` that is neither a table nor a list.
fn leaves(path: &str, value: &Value, visit: &mut impl FnMut(&str, &Value)) {
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
fn key(path: &str) -> String {
    path.split('.').map(|step| step.split('[').next().unwrap_or(step)).collect::<Vec<_>>().join(".")
}

/// What goes with a change at `path`, so that the scene stays valid: extinction is the same in all channels.
fn companion(path: &str, by: f64) -> Option<(String, Value)> {
    let absorption = |channel: usize| [1.0, 0.75, 0.5][channel];
    let (table, channel) = path.strip_suffix(']')?.split_once(".scattering[")?;
    let channel = channel.parse().ok()?;
    Some((format!("{table}.absorption[{channel}]"), (absorption(channel) - by).into()))
}

#[test]
fn every_key_that_samples_depend_on_changes_the_hash_and_no_other_does() {
    let mut seen = BTreeSet::from(ELSEWHERE.map(String::from));
    for keys in [Keys::new(), Keys::with_volume()] {
        assert_that_keys_change_the_hash(&keys, &mut seen);
    }
    assert_eq!(seen, Keys::new().all(), "keys of a scene, on the left those that were tried");
}

/// Tries every key of a scene, and notes it.
fn assert_that_keys_change_the_hash(keys: &Keys, seen: &mut BTreeSet<String>) {
    let base = keys.base();
    let written: Value = base.to_toml().parse::<toml::Table>().expect("a scene is TOML").into();
    leaves("", &written, &mut |path, value| {
        let key = key(path);
        seen.insert(key.clone());
        if WITHOUT_CHOICE.contains(&key.as_str()) {
            return;
        }
        let mut accepted = 0;
        for other in keys.others(&key, value) {
            let by = other.as_float().unwrap_or(0.0) - value.as_float().unwrap_or(0.0);
            let changes: Vec<_> = [(path.to_string(), other)].into_iter().chain(companion(path, by)).collect();
            let Some(changed) = keys.with(&changes) else { continue };
            accepted += 1;
            let same = changed.hash() == base.hash();
            assert_eq!(same, WITHOUT_EFFECT.contains(&key.as_str()), "{changes:?}");
            assert!(!same || changed.frame == base.frame, "{changes:?}: another frame under the same hash");
        }
        // Absorption alone is not a spectrum that can be rendered.
        assert!(accepted > 0 || key.ends_with(".absorption"), "{path}: no other value is accepted");
    });
}

#[test]
fn corners_of_a_box_change_the_hash() {
    let volume = "[[volume]]\nscattering = 1\nshape = { type = 'box', min = [0, 0, 1], max = [1, 2, 3] }\n";
    let keys = Keys::of(&SCENE.replace(MEDIUM[0], volume).replace(", \"lis\"]", "]"));
    for (corner, axis) in ["min", "max"].into_iter().flat_map(|corner| (0..3).map(move |axis| (corner, axis))) {
        let change = (format!("volume[0].shape.{corner}[{axis}]"), Value::from(0.5 + f64::from(axis)));
        let change = if corner == "max" { (change.0, Value::from(4.5)) } else { change };
        assert_ne!(keys.with(&[change]).expect("a scene").hash(), keys.base().hash(), "{corner} {axis}");
    }
}

#[test]
fn what_a_file_of_voxels_says_changes_the_hash_and_not_its_name() {
    let keys = Keys::with_volume();
    let hash = |file: &str| keys.with(&[("volume[0].grid.file".into(), file.into())]).expect("a scene").hash();
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes");
    for (from, to) in [("blob.vdb", "same.vdb"), ("block.vdb", "other.vdb")] {
        std::fs::copy(data.join(from), keys.folder.path().join(to)).expect("a file");
    }
    assert_eq!(hash("same.vdb"), hash("cloud.vdb"));
    assert_ne!(hash("other.vdb"), hash("cloud.vdb"));
}

#[test]
fn every_phase_function_and_every_parameter_of_it_has_a_hash_of_its_own() {
    let keys = Keys::new();
    std::fs::write(keys.folder.path().join("a.csv"), "-1, 1\n1, 2\n").expect("a file");
    std::fs::write(keys.folder.path().join("b.csv"), "-1, 1\n1, 3\n").expect("a file");
    let phases = [
        "{ type = 'henyey_greenstein', g = 0.5 }",
        "{ type = 'isotropic' }",
        "{ type = 'rayleigh' }",
        "{ type = 'two_lobe', g = [0.5, -0.5], weight = 0.5 }",
        "{ type = 'two_lobe', g = [0.25, -0.5], weight = 0.5 }",
        "{ type = 'two_lobe', g = [0.5, -0.25], weight = 0.5 }",
        "{ type = 'two_lobe', g = [0.5, -0.5], weight = 0.25 }",
        "{ type = 'draine', g = 0.5, alpha = 1 }",
        "{ type = 'draine', g = 0.25, alpha = 1 }",
        "{ type = 'draine', g = 0.5, alpha = 2 }",
        "{ type = 'droplets', diameter_um = 10 }",
        "{ type = 'droplets', diameter_um = 20 }",
        "{ type = 'tabulated', file = 'a.csv' }",
        "{ type = 'tabulated', file = 'b.csv' }",
    ];
    let hash = |phase: &str| {
        let value = toml::from_str::<Value>(&format!("phase = {phase}")).expect("TOML")["phase"].clone();
        keys.with(&[("medium.phase".into(), value)]).unwrap_or_else(|| panic!("{phase} is refused")).hash()
    };
    let hashes: BTreeSet<_> = phases.map(hash).into();
    assert_eq!(hashes.len(), phases.len());
    // Not only the name of a table's file matters, but also what it says.
    std::fs::write(keys.folder.path().join("a.csv"), "-1, 1\n1, 4\n").expect("a file");
    assert!(!hashes.contains(&hash("{ type = 'tabulated', file = 'a.csv' }")));
}

#[test]
fn scattering_and_absorption_change_the_hash_each_on_its_own() {
    let keys = Keys::new();
    for key in ["scattering", "absorption"] {
        let all = |by: f64| {
            let medium = toml::from_str::<Value>(SCENE).expect("TOML")["medium"].clone();
            let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|n| n as f64));
            let spectrum = medium[key].as_array().expect("a list").iter().map(|x| number(x).expect("a number") + by);
            (format!("medium.{key}"), spectrum.collect::<Vec<_>>().into())
        };
        assert_eq!(keys.with(&[all(0.0)]).expect("valid").hash(), keys.base().hash());
        assert_ne!(keys.with(&[all(0.125)]).expect("valid").hash(), keys.base().hash(), "{key}");
    }
}

#[test]
fn a_preset_has_the_hash_of_its_coefficients() {
    let keys = Keys::new();
    let hash = |medium: toml::Table| keys.with(&[("medium".into(), medium.into())]).expect("valid").hash();
    let mut hashes = BTreeSet::new();
    for preset in &PRESETS {
        let named = toml::Table::from_iter([("preset".into(), preset.name.into())]);
        let written = toml::Table::from_iter([
            ("scattering".into(), preset.scattering.to_vec().into()),
            ("absorption".into(), preset.absorption.to_vec().into()),
            ("phase".into(), Value::try_from(&preset.phase).expect("a table")),
        ]);
        assert_eq!(hash(named.clone()), hash(written), "{}", preset.name);
        hashes.insert(hash(named));
    }
    assert_eq!(hashes.len(), PRESETS.len());
}

#[test]
fn what_a_light_is_changes_the_hash() {
    let keys = Keys::new();
    let light = |text: &str| {
        let light = format!("light = [{{ {text}, center = [0, 0, 9], radius = 1, radiance = 10 }}]");
        let light = toml::from_str::<Value>(&light).expect("TOML")["light"].clone();
        keys.with(&[("light".into(), light)]).expect("valid").hash()
    };
    let hashes = BTreeSet::from([
        light("type = 'disk', normal = [0, 0, -1]"),
        light("type = 'spot', normal = [0, 0, -1], exponent = 0"),
        light("type = 'sphere'"),
    ]);
    assert_eq!(hashes.len(), 3);
}

#[test]
fn what_is_left_to_the_program_is_not_the_same_as_what_it_finds() {
    let keys = Keys::new();
    for (path, found) in
        [("starts", 3.into()), ("survival", 0.5.into()), ("aimed", 0.25.into()), ("roulette", 0.125.into())]
    {
        let path = format!("render.{path}");
        assert_eq!(keys.with(&[(path.clone(), found)]).expect("valid").hash(), keys.base().hash(), "{path} as it is");
        assert_ne!(keys.with(&[(path.clone(), "auto".into())]).expect("valid").hash(), keys.base().hash(), "{path}");
    }
}
