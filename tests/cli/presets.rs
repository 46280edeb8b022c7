//! `fogbow presets` and `medium.preset`.

use fogbow::scene::presets::PRESETS;
use serde_json::Value;

use super::support::{Folder, header};

/// The medium of the test scene.
const MEDIUM: &str = "scattering = 0.7\nabsorption = 0.3\nphase = { type = \"henyey_greenstein\", g = 0.5 }";

/// The test scene with other keys of its medium.
fn with_medium(keys: &str) -> Folder {
    Folder::with_edited_scene(MEDIUM, keys)
}

/// The hash of the scene in `folder`.
fn hash(folder: &Folder) -> String {
    let run = folder.done(&["render", "scene.toml", "--size", "4x4", "--samples", "1", "-o", "a.exr"]);
    assert!(!run.stderr.contains("vacuum"), "{run}");
    header(&folder.image("a.exr"), "scene_hash").to_string()
}

/// What `fogbow presets --json` says of the preset called `name`.
fn listed(name: &str) -> Value {
    let run = Folder::empty().done(&["presets", "--json"]);
    let list: Value = serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{error}\n{run}"));
    let presets = list["presets"].as_array().expect("a list");
    presets.iter().find(|preset| preset["name"] == name).unwrap_or_else(|| panic!("{name} is missing\n{run}")).clone()
}

/// The keys of the medium that the preset called `name` is, with this phase function.
fn written_out(name: &str, phase: &str) -> String {
    let preset = listed(name);
    format!("scattering = {}\nabsorption = {}\nphase = {phase}", preset["scattering"], preset["absorption"])
}

#[test]
fn the_list_names_every_preset_with_its_source() {
    let run = Folder::empty().done(&["presets"]);
    let words = run.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for name in ["milk", "skim_milk", "sea_water", "skin", "wax"] {
        assert!(PRESETS.iter().any(|preset| preset.name == name), "{name} is missing");
    }
    for preset in &PRESETS {
        assert!(run.stdout.lines().any(|line| line.starts_with(&format!("{} ", preset.name))), "{preset:?}\n{run}");
        assert!(words.contains(&format!("{}: {}", preset.name, preset.meaning)), "{preset:?}\n{run}");
        assert!(words.contains(&format!("source {}", preset.source)), "{preset:?}\n{run}");
        assert!(words.contains(&format!("conversion {}", preset.conversion)), "{preset:?}\n{run}");
    }
    assert_eq!(run.stderr, "", "{run}");
}

#[test]
fn the_table_is_aligned_and_has_a_unit_that_fits() {
    let run = Folder::empty().done(&["presets"]);
    let table: Vec<_> = run.stdout.lines().take_while(|line| !line.is_empty()).collect();
    assert_eq!(table.len(), 2 + PRESETS.len(), "{run}");
    let row = |name: &str| table.iter().find(|line| line.starts_with(&format!("{name} "))).expect("a row");
    let cells = |name: &str| row(name).split_whitespace().collect::<Vec<_>>();
    assert_eq!(cells("milk")[1..], ["8947", "11260", "13230", "1.1", "2.4", "14", "0.112", "0.0888", "0.0755", "mm"]);
    assert_eq!(cells("sea_water")[7..], ["3.08", "9.98", "18.5", "m"]);
    let end = table[1].len();
    for preset in &PRESETS {
        let row = row(preset.name);
        assert!(row[..end].ends_with(|c: char| c.is_ascii_digit()) && row[end..].starts_with(' '), "{row}\n{run}");
    }
    assert!(run.stdout.lines().all(|line| line.len() <= 80 && line.trim_end() == line), "{run}");
}

#[test]
fn the_list_as_json_has_the_same_numbers() {
    for preset in &PRESETS {
        let listed = listed(preset.name);
        let numbers = |key: &str| -> Vec<f64> {
            listed[key].as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
        };
        assert_eq!(numbers("scattering"), preset.scattering);
        assert_eq!(numbers("absorption"), preset.absorption);
        let single = |lengths: &[f64]| lengths.iter().map(|x| *x as f32).collect::<Vec<_>>();
        assert_eq!(single(&numbers("mean_free_path")), single(&preset.mean_free_path()));
        assert_eq!(listed["source"], preset.source);
    }
}

#[test]
fn a_preset_is_the_medium_with_its_coefficients_written_out() {
    let keys = written_out("sea_water", "{ type = \"two_lobe\", g = [0.924, 0.0], weight = 0.948 }");
    assert_eq!(hash(&with_medium("preset = \"sea_water\"")), hash(&with_medium(&keys)));
}

#[test]
fn a_phase_function_beside_a_preset_replaces_its_own() {
    let of_both = hash(&with_medium("preset = \"sea_water\"\nphase = \"rayleigh\""));
    assert_eq!(of_both, hash(&with_medium(&written_out("sea_water", "\"rayleigh\""))));
    assert_ne!(of_both, hash(&with_medium("preset = \"sea_water\"")));
}

#[test]
fn a_flag_can_put_a_preset_in_the_place_of_the_whole_medium() {
    let folder = Folder::with_scene();
    let set = "medium={ preset = \"sea_water\" }";
    folder.done(&["render", "scene.toml", "--size", "4x4", "--samples", "1", "-o", "a.exr", "--set", set]);
    let of_flag = header(&folder.image("a.exr"), "scene_hash").to_string();
    assert_eq!(of_flag, hash(&with_medium("preset = \"sea_water\"")));
}

#[test]
fn the_list_says_the_phase_function_as_a_scene_file_does() {
    let run = Folder::empty().done(&["presets"]);
    for phase in
        ["{ type = \"henyey_greenstein\", g = 0.715 }", "{ type = \"two_lobe\", g = [0.924,0.0], weight = 0.948 }"]
    {
        assert!(run.stdout.contains(&format!("\n  phase       {phase}\n")), "{phase} is missing\n{run}");
    }
}

#[test]
fn an_unknown_name_is_refused_with_those_that_exist() {
    let folder = with_medium("preset = \"milq\"");
    let beginning = format!("{}: medium.preset is \"milq\", but no preset has that name\n", folder.place("preset"));
    let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
    let names: Vec<_> = PRESETS.iter().map(|preset| preset.name).collect();
    assert!(run.stderr.contains(&format!("choose one of {};", names.join(", "))), "{run}");
}

#[test]
fn a_preset_beside_coefficients_is_refused() {
    for key in ["scattering", "absorption"] {
        let folder = with_medium(&format!("preset = \"milk\"\n{key} = 0"));
        let beginning = format!("{}: medium.{key} is given, but medium.preset is \"milk\"\n", folder.place(key));
        folder.refused(&["render", "scene.toml"], 1, &beginning);
    }
}

#[test]
fn a_flag_that_contradicts_the_file_is_refused() {
    let set = "medium.preset=milk";
    let run = Folder::with_scene().refused(
        &["render", "scene.toml", "--set", set],
        2,
        "--set medium.preset=milk: medium.preset is \"milk\", but medium.scattering is given, too\n",
    );
    assert!(run.stderr.contains("--set 'medium={ preset = \"milk\" }'"), "{run}");
    with_medium("preset = \"milk\"").refused(
        &["render", "scene.toml", "--set", "medium.absorption=1"],
        2,
        "--set medium.absorption=1: medium.absorption is given, but medium.preset is \"milk\"\n",
    );
}

#[test]
fn a_preset_that_is_no_name_is_refused() {
    let folder = with_medium("preset = 3");
    folder.refused(&["render", "scene.toml"], 1, &format!("{}: medium.preset: this is the", folder.place("preset")));
}
