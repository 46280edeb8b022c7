//! What a limit on the length of paths leaves out, as it is estimated before a render.

use std::path::Path;

use fogbow::render::{Renderer, Workers};
use fogbow::scene::{self, LoadedScene, document::Override};
use fogbow::truncation::{Truncation, estimate};
use fogbow_testing::render::WORKERS;

fn scene(folder: &str, settings: &[&str]) -> LoadedScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(folder);
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn left_out(folder: &str, settings: &[&str]) -> Option<Truncation> {
    let scene = scene(folder, settings);
    let renderer = Renderer::new(WORKERS).expect("threads start");
    estimate(&scene.frame, scene.scene.film.size, &renderer)
}

/// The share of the light beyond 15 segments is known for fog-facing: means of 1.2828 +- .0005 up to there, 1.400 +- .005
/// up to 1024 segments.
#[test]
fn fog_loses_what_long_paths_bring() {
    for technique in ["path", "nee", "bridge"] {
        let technique = format!("render.technique={technique}");
        let found = left_out("fog-facing", &[&technique]).expect("something is left out");
        assert!((0.06..0.11).contains(&found.share) && found.matters(), "{found:?}");
        let limit = found.sufficient.expect("a limit");
        assert!((40..=400).contains(&limit), "{found:?}");
    }
    let found = left_out("fog-facing", &["render.max_segments=300"]).expect("a share");
    assert!(!found.matters() || found.share < 0.015, "{found:?}");
}

#[test]
fn the_limit_that_would_do_does() {
    // Paths in absorbing fog end early: the light of n segments is albedo^(n - 1) of what it would be.
    for settings in
        [["medium.absorption=0.8", "render.max_segments=5"], ["medium.absorption=3", "render.max_segments=3"]]
    {
        let found = left_out("fog-facing", &settings).expect("something is left out");
        assert!(found.matters(), "{found:?}");
        let limit = found.sufficient.expect("a limit");
        let enough = left_out("fog-facing", &[settings[0], &format!("render.max_segments={limit}")]);
        assert!(!enough.expect("a share").matters(), "{found:?}, then {enough:?}");
    }
}

#[test]
fn light_that_needs_hundreds_of_scatterings_is_missed_aloud() {
    let dense = ["medium.scattering=20", "medium.phase.g=0.7", "film.size=[64, 64]"];
    let found = left_out("cornell-fog", &[&dense[..], &["render.max_segments=128"]].concat()).expect("a share");
    assert!(found.share > 0.9 && found.matters(), "{found:?}");
}

#[test]
fn nothing_is_left_out_where_nothing_turns_light() {
    assert_eq!(left_out("fog-facing", &["medium.scattering=0", "medium.absorption=1"]), None);
}

#[test]
fn the_estimate_does_not_depend_on_threads_or_seed() {
    let estimates = [1, 3].map(|threads| {
        let scene = scene("cornell-fog-thin", &[&format!("render.seed={threads}"), "render.max_segments=4"]);
        let renderer = Renderer::new(Workers { threads, ..WORKERS }).expect("threads start");
        estimate(&scene.frame, scene.scene.film.size, &renderer)
    });
    assert!(estimates[0].is_some_and(|found| found.matters()), "{estimates:?}");
    assert_eq!(estimates[0], estimates[1]);
}
