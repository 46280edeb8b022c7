//! `--stats`

use super::support::{Folder, header};
use fogbow_kernels::pipeline::Stage;
use serde_json::Value;

fn statistics(folder: &Folder, flags: &[&str]) -> Value {
    folder.done(&[&["render", "scene.toml", "-o", "a.exr", "--stats", "s.json"], flags].concat());
    let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    assert!(text.ends_with("}\n"));
    serde_json::from_str(&text).expect("statistics are JSON")
}

/// The number at `pointer`.
#[track_caller]
fn number(statistics: &Value, pointer: &str) -> f64 {
    let value = statistics.pointer(pointer).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("no number at {pointer}\n{statistics:#}"))
}

#[test]
fn statistics_tell_what_every_stage_did() {
    let folder = Folder::with_scene();
    let flags = ["--technique", "nee,mvnee,omnee,bridge,lis", "--samples", "16", "--set", "render.roulette=0.1"];
    let statistics = statistics(&folder, &[&flags[..], &["--aov", "depth"]].concat());
    let stages = statistics["stages"].as_array().expect("stages");
    let names: Vec<_> = stages.iter().map(|stage| stage["stage"].as_str().expect("a name")).collect();
    assert_eq!(names, Stage::ALL.iter().map(|stage| stage.name()).collect::<Vec<_>>());
    // Nothing is solid in this scene, and its extinction is grey and the same everywhere; lamps has what is solid.
    // Where several techniques connect, none does so in place.
    let elsewhere = [
        "first_surface",
        "surface",
        "spectral_weight",
        "flight_hue",
        "passage",
        "phase_quotient",
        "transmittance",
        "glow",
        "outline",
        "nee",
    ];
    let others = |(_, name): &(usize, &&str)| !elsewhere.contains(name);
    for (index, name) in names.iter().enumerate().filter(others) {
        let stage = |what: &str| number(&statistics, &format!("/stages/{index}/{what}"));
        let lanes = stage("live_lanes_per_batch");
        assert!(stage("calls") >= 1.0 && stage("rows") >= stage("calls"), "{name}: {statistics:#}");
        assert!((1.0..=8.0).contains(&lanes), "{name}: {lanes} of 8 lanes are live");
        assert!(stage("seconds") > 0.0, "{name}: {statistics:#}");
    }
    assert_eq!(number(&statistics, "/stages/0/rows"), 16.0 * 64.0, "every sample is generated once");
}

#[test]
fn next_event_estimation_alone_connects_in_place() {
    let folder = Folder::with_scene();
    let statistics = statistics(&folder, &["--technique", "nee", "--samples", "4", "--set", "render.roulette=0"]);
    let calls = |stage: Stage| number(&statistics, &format!("/stages/{}/calls", stage as usize));
    assert!(calls(Stage::Nee) >= 1.0 && calls(Stage::LightSample) == 0.0, "{statistics:#}");
    assert!(number(&statistics, "/connections/nee/weighted") > 0.0, "{statistics:#}");
}

/// The lamp of the test scene fills its image.
#[test]
fn outlines_of_lamps_are_looked_at() {
    let folder = Folder::with_scene();
    let calls =
        |flags: &[&str]| number(&statistics(&folder, flags), &format!("/stages/{}/calls", Stage::Outline as usize));
    assert_eq!(calls(&["--samples", "4"]), 0.0);
    assert!(calls(&["--samples", "4", "--size", "32x32", "--set", "light[0].radius=0.4"]) >= 16.0);
}

#[test]
fn flights_are_weighed_by_channel_where_extinction_is_coloured() {
    let folder = Folder::with_scene();
    let statistics = statistics(&folder, &["--samples", "4", "--set", "medium.scattering=[0.5, 0.7, 1]"]);
    let calls = |stage: Stage| number(&statistics, &format!("/stages/{}/calls", stage as usize));
    assert!(calls(Stage::SpectralWeight) >= 1.0 && calls(Stage::FlightWeight) == 0.0, "{statistics:#}");
}

/// A volume and another one beside it, so that neither is all there is.
fn doubled(volume: &str) -> String {
    format!("{volume}\n{}", volume.replace("[0, 0, 2]", "[0.5, 0, 2]"))
}

#[test]
fn transmittances_are_estimated_unless_they_are_known() {
    let fog = "[medium]\nscattering = 0.7\nabsorption = 0.3";
    let ball = "[[volume]]\nshape = { type = 'sphere', center = [0, 0, 2], radius = 1 }\nscattering = 2";
    let block = "[[volume]]\nshape = { type = 'box', min = [-1, -1, 1], max = [1, 1, 2] }\nscattering = 2";
    for (volumes, is_estimated) in [(ball, false), (block, false), (&doubled(ball), true)] {
        let statistics = statistics(&Folder::with_edited_scene(fog, volumes), &["--samples", "4"]);
        let calls = |stage: Stage| number(&statistics, &format!("/stages/{}/calls", stage as usize));
        assert!(calls(Stage::Passage) >= 1.0, "{statistics:#}");
        assert_eq!(calls(Stage::Transmittance) >= 1.0, is_estimated, "{volumes}: {statistics:#}");
    }
}

#[test]
fn flights_through_coloured_volumes_are_looked_at_again() {
    let fog = "[medium]\nscattering = 0.7\nabsorption = 0.3";
    let ball = "[[volume]]\nshape = { type = 'sphere', center = [0, 0, 2], radius = 1 }\nscattering = [1, 2, 3]";
    let statistics = statistics(&Folder::with_edited_scene(fog, &doubled(ball)), &["--samples", "4"]);
    let calls = |stage: Stage| number(&statistics, &format!("/stages/{}/calls", stage as usize));
    assert!(calls(Stage::FlightHue) >= 1.0 && calls(Stage::SpectralWeight) >= 1.0, "{statistics:#}");
}

#[test]
fn statistics_tell_rates_and_the_fate_of_connections() {
    let folder = Folder::with_edited_scene(
        "[render]",
        "[[light]]\ntype = \"disk\"\ncenter = [0, 0, 2]\nnormal = [0, 0, -1]\nradius = 0.5\nradiance = 1\n\n[render]",
    );
    let flags = ["--technique", "nee,mvnee,omnee,bridge,lis", "--samples", "16", "--threads", "2"];
    let statistics = statistics(&folder, &[&flags[..], &["--set", "render.roulette=0.05"]].concat());
    assert_eq!(
        statistics["scene"].as_str(),
        folder.path(".").canonicalize().expect("a folder").file_name().and_then(|name| name.to_str())
    );
    assert_eq!(
        (statistics["technique"].as_str(), number(&statistics, "/threads")),
        (Some("nee,mvnee,omnee,bridge,lis"), 2.0)
    );
    assert_eq!(number(&statistics, "/samples"), 16.0 * 64.0);
    // What is prepared before the first sample is no part of the rates.
    let preparation = number(&statistics, "/seconds_of_preparation");
    let seconds = number(&statistics, "/seconds") - preparation;
    assert!(preparation > 0.0 && seconds > 0.0);
    for (rate, count) in [("/samples_per_second", "/samples"), ("/segments_per_second", "/segments")] {
        let expected = number(&statistics, count) / seconds;
        assert!((number(&statistics, rate) / expected - 1.0).abs() < 1e-9, "{rate}");
    }
    for technique in ["nee", "mvnee", "omnee", "bridge", "lis"] {
        let [tried, weighted, faint, occluded] = ["tried", "weighted", "faint", "occluded"]
            .map(|what| number(&statistics, &format!("/connections/{technique}/{what}")));
        assert!(tried >= weighted && weighted > faint + occluded, "{technique}: {statistics:#}");
        assert!(faint > 0.0 && occluded > 0.0, "{technique}: {statistics:#}");
    }
    assert_eq!(number(&statistics, "/dropped_non_finite/count"), 0.0);
    assert!(statistics["dropped_non_finite"]["first"].is_null());
    assert!(number(&statistics, "/mean/0") > 0.0 && number(&statistics, "/standard_error/0") > 0.0);
}

#[test]
fn a_technique_that_does_not_run_has_no_connections() {
    let folder = Folder::with_scene();
    let statistics = statistics(&folder, &["--technique", "path"]);
    for pointer in ["/connections/nee/tried", "/connections/mvnee/tried", "/connections/mvnee/weighted"] {
        assert_eq!(number(&statistics, pointer), 0.0, "{pointer}");
    }
    assert!(number(&statistics, "/segments") > 256.0);
}

#[test]
fn statistics_do_not_change_the_image() {
    let folder = Folder::with_scene();
    statistics(&folder, &[]);
    folder.done(&["render", "scene.toml", "-o", "b.exr"]);
    assert!(folder.image("a.exr").channels == folder.image("b.exr").channels);
}

#[test]
fn the_choice_of_the_pilot_is_told_with_what_it_tried() {
    let folder = Folder::with_scene();
    let told = |flags: &[&str]| {
        let statistics = statistics(&folder, &[&["--technique", "bridge"], flags].concat());
        let image = folder.image("a.exr");
        assert_eq!(header(&image, "starts"), statistics["starts"].as_str().expect("a name or a number"));
        assert_eq!(header(&image, "survival"), number(&statistics, "/survival").to_string());
        let settings: toml::Table = header(&image, "settings").parse().expect("settings are TOML");
        (statistics, settings["render"].clone())
    };
    let (statistics, settings) = told(&[]);
    let trials = statistics["pilot"].as_array().expect("trials").clone();
    assert!(trials.len() >= 3, "one start, two, and all: {statistics:#}");
    let efficiency = |trial: &Value| number(trial, "/efficiency");
    let most = trials.iter().map(efficiency).fold(0.0, f64::max);
    let is_chosen = |trial: &&Value| ["starts", "survival"].iter().all(|key| trial[key] == statistics[key]);
    let chosen = trials.iter().find(is_chosen).expect("the choice is among the trials");
    assert!(efficiency(chosen) >= 0.9 * most, "{statistics:#}");
    for trial in &trials {
        let worst = number(trial, "/variance") + 2.0 * number(trial, "/variance_error");
        assert!((efficiency(trial) * worst * number(trial, "/cost") - 1.0).abs() < 1e-9, "{trial:#}");
        assert!(number(trial, "/mean") > 0.0 && number(trial, "/mean_error") > 0.0, "{trial:#}");
    }
    let auto = Some("auto");
    assert_eq!((settings["starts"].as_str(), settings["survival"].as_str()), (auto, auto), "settings are as written");

    // Fixing what the pilot chose gives the same image without it.
    let chosen = folder.image("a.exr");
    let starts = format!("render.starts={}", header(&chosen, "starts"));
    let survival = format!("render.survival={}", header(&chosen, "survival"));
    let (statistics, _) = told(&["--set", &starts, "--set", &survival]);
    assert_eq!(statistics["pilot"].as_array().map(Vec::len), Some(0), "{statistics:#}");
    assert!(folder.image("a.exr").channels == chosen.channels);

    let (statistics, settings) = told(&["--set", "render.starts=3", "--set", "render.survival=0.5"]);
    assert_eq!((statistics["starts"].as_str(), number(&statistics, "/survival")), (Some("3"), 0.5));
    assert_eq!((settings["starts"].as_integer(), settings["survival"].as_float()), (Some(3), Some(0.5)));
}
