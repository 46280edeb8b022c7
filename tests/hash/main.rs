//! The hash of a scene follows every key on which samples depend, and no other.

mod keys;

use std::collections::BTreeSet;
use std::path::PathBuf;

use fogbow::film::aov::Aovs;
use fogbow::frame::Frame;
use fogbow::scene::LoadedScene;
use fogbow::scene::presets::PRESETS;
use toml::Value;

use keys::{ELSEWHERE, Keys, MEDIUM, SCENE, WITHOUT_CHOICE, WITHOUT_EFFECT, companion, key, leaves, write_sky};

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
            // Layers of the film change no radiance; parts are compared by them beside the hash.
            let frame = |scene: &LoadedScene| Frame { aovs: Aovs::default(), ..scene.frame.clone() };
            assert!(!same || frame(&changed) == frame(&base), "{changes:?}: another frame under the same hash");
        }
        // Absorption alone is not a spectrum that can be rendered.
        assert!(accepted > 0 || key.ends_with(".absorption"), "{path}: no other value is accepted");
    });
}

#[test]
fn corners_of_a_box_change_the_hash() {
    let volume = "[[volume]]\nscattering = 1\nshape = { type = 'box', min = [0, 0, 1], max = [1, 2, 3] }\n";
    let keys = Keys::of(&SCENE.replace(MEDIUM[0], volume));
    for (corner, axis) in ["min", "max"].into_iter().flat_map(|corner| (0..3).map(move |axis| (corner, axis))) {
        let change = (format!("volume[0].shape.{corner}[{axis}]"), Value::from(0.5 + f64::from(axis)));
        let change = if corner == "max" { (change.0, Value::from(4.5)) } else { change };
        assert_ne!(keys.with(&[change]).expect("a scene").hash(), keys.base().hash(), "{corner} {axis}");
    }
}

#[test]
fn balls_and_the_order_of_volumes_change_the_hash() {
    let ball = |x: f64, radius: f64, priority: i32| {
        let shape = format!("shape = {{ type = 'sphere', center = [{x}, 0, 2], radius = {radius} }}");
        format!("[[volume]]\nscattering = {radius}\n{shape}\npriority = {priority}\n")
    };
    let hash = |volumes: [String; 2]| Keys::of(&SCENE.replace(MEDIUM[0], &volumes.concat())).base().hash();
    let base = hash([ball(0.0, 1.0, 0), ball(1.0, 2.0, 0)]);
    for other in [
        [ball(0.5, 1.0, 0), ball(1.0, 2.0, 0)],
        [ball(0.0, 1.5, 0), ball(1.0, 2.0, 0)],
        [ball(0.0, 1.0, 1), ball(1.0, 2.0, 0)],
        [ball(1.0, 2.0, 0), ball(0.0, 1.0, 0)],
    ] {
        assert_ne!(hash(other.clone()), base, "{other:?}");
    }
}

#[test]
fn what_a_file_of_voxels_says_changes_the_hash_and_not_its_name() {
    let keys = Keys::with_volume();
    let hash =
        |grid: &str, file: &str| keys.with(&[(format!("volume[0].{grid}.file"), file.into())]).expect("a scene").hash();
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes");
    for (from, to) in [("blob.vdb", "same.vdb"), ("half.vdb", "other.vdb")] {
        std::fs::copy(data.join(from), keys.folder.path().join(to)).expect("a file");
    }
    for grid in ["grid", "emission_grid"] {
        assert_eq!(hash(grid, "same.vdb"), hash(grid, "cloud.vdb"), "{grid}");
        assert_ne!(hash(grid, "other.vdb"), hash(grid, "cloud.vdb"), "{grid}");
    }
}

#[test]
fn what_an_image_of_the_sky_shows_changes_the_hash_and_not_its_name() {
    let keys = Keys::with_volume();
    let hash = |file: &str| keys.with(&[("environment.image".into(), file.into())]).expect("a scene").hash();
    write_sky(&keys.folder.path().join("same.exr"), 0.5);
    write_sky(&keys.folder.path().join("other.exr"), 0.75);
    assert_eq!(hash("same.exr"), hash("sky.exr"));
    assert_ne!(hash("other.exr"), hash("sky.exr"));
}

#[test]
fn the_radiance_of_the_sky_changes_the_hash() {
    let sky = "[[volume]]\nscattering = 1\nshape = { type = 'box', min = [0, 0, 1], max = [1, 2, 3] }\n\
               [environment]\nradiance = [1, 2, 3]\n";
    let keys = Keys::of(&SCENE.replace(MEDIUM[0], sky));
    let without = Keys::of(&SCENE.replace(MEDIUM[0], sky.split("[env").next().expect("a part")));
    assert_ne!(without.base().hash(), keys.base().hash());
    for channel in 0..3 {
        let change = (format!("environment.radiance[{channel}]"), Value::from(1.5));
        assert_ne!(keys.with(&[change]).expect("a scene").hash(), keys.base().hash(), "{channel}");
    }
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
