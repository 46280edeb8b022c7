//! What a limit on the length of paths leaves out is told, in the terminal, the statistics and the header.

use serde_json::Value;

use super::support::{Folder, header};

#[test]
fn a_limit_that_leaves_out_light_is_told_with_one_that_would_do() {
    let folder = Folder::with_edited_scene("max_segments = 24", "max_segments = 4");
    let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--stats", "s.json", "--progress", "none"]);
    let start = "warning: paths of more than 4 segments are left out, and with them about ";
    assert!(run.stderr.starts_with(start) && run.stderr.lines().count() == 1, "{run}");
    let words: Vec<&str> = run.stderr.split_whitespace().collect();
    let share: f64 = words[14].parse().unwrap_or_else(|_| panic!("{words:?}"));
    assert!((10.0..30.0).contains(&share), "{run}");

    let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    let told = serde_json::from_str::<Value>(&text).expect("JSON")["left_out"].take();
    assert_eq!(told["max_segments"], 4);
    assert!((told["share"].as_f64().expect("a share") - share / 100.0).abs() < 1e-2, "{told}");
    let limit = told["sufficient_max_segments"].as_u64().expect("a limit").to_string();
    assert!(run.stderr.contains(&format!("--max-segments {limit} would leave out 1 % or less")), "{run}");
    let image = folder.image("a.exr");
    let entry = header(&image, "left_out");
    assert!(entry.ends_with(&format!(" beyond 4 segments, no more than 0.01 beyond {limit}")), "{entry}");

    let info = folder.done(&["info", "scene.toml"]);
    assert!(info.stdout.contains(&format!("\n{start}")), "{info}");
    let enough = folder.done(&["render", "scene.toml", "-o", "a.exr", "--max-segments", &limit]);
    assert!(!enough.stderr.contains("warning"), "{enough}");
}

#[test]
fn programs_get_the_warning_as_a_message() {
    let folder = Folder::with_scene();
    let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--max-segments", "4", "--progress", "json"]);
    let first: Value = run.stderr.lines().next().and_then(|line| serde_json::from_str(line).ok()).expect("JSON");
    assert_eq!(first["event"], "warning", "{run}");
    assert!(first["message"].as_str().is_some_and(|text| text.starts_with("paths of more than 4 segments")), "{run}");
}

/// Fog of hundreds of mean free paths: no path of any length reaches the light.
#[test]
fn where_no_light_is_found_what_is_left_out_is_unknown() {
    let folder = Folder::with_scene();
    let fog = ["--set", "medium.scattering=200", "--set", "medium.phase.g=0"];
    let run = folder.done(&[&["render", "scene.toml", "-o", "a.exr", "--stats", "s.json"][..], &fog].concat());
    let told = "warning: paths of more than 24 segments are left out, and with them an unknown share of the light, of \
                which a short look found next to nothing: --max-segments auto leaves out as little as can be\n";
    assert!(run.stderr.contains(told), "{run}");
    assert!(run.stderr.ends_with("warning: the image is black: no path reached a light\n"), "{run}");
    assert!(header(&folder.image("a.exr"), "left_out").starts_with("unknown beyond 24 segments"));
    let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    let left_out = serde_json::from_str::<Value>(&text).expect("JSON")["left_out"].take();
    assert!(left_out["share"].is_null() && left_out["max_segments"] == 24, "{left_out}");
}

#[test]
fn nothing_is_left_out_where_nothing_shines() {
    let folder = Folder::empty();
    let text = "camera = { position = [0, 0, -3], look_at = [0, 0, 0], vertical_fov_deg = 40 }\nfilm.size = [8, 8]\n\
                environment.radiance = 0\nrender.samples = 4\n[[volume]]\nscattering = 1\n\
                shape = { type = \"sphere\", center = [0, 0, 0], radius = 1 }\n";
    folder.write("scene.toml", text);
    let run = folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    assert!(run.stderr.contains("warning: the image is black") && !run.stderr.contains("left out"), "{run}");
}

#[test]
fn a_black_image_is_called_black() {
    let folder = Folder::with_edited_scene("normal = [0, 0, -1]", "normal = [0, 0, 1]");
    let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--set", "medium.scattering=0"]);
    assert!(run.stderr.ends_with("warning: the image is black: no path reached a light\n"), "{run}");
}
