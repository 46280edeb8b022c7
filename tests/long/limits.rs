//! What limits on the length of paths leave out.

use fogbow::render::{Monitor, Renderer};
use fogbow::scene::document::Override;
use fogbow::truncation::Truncation;
use fogbow::{scene, truncation};
use fogbow_testing::render::WORKERS;

/// What a shipped scene leaves out, with these settings.
fn left_out(folder: &str, settings: &[&str]) -> Option<Truncation> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(folder);
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    let scene = scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"));
    let renderer = Renderer::new(WORKERS).expect("threads start");
    truncation::estimate(&scene.frame, scene.scene.film.size, &renderer, &Monitor::default())
}

#[test]
fn the_limit_offered_for_a_shipped_scene_does() {
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for folder in std::fs::read_dir(scenes).expect("scenes").map(|entry| entry.expect("an entry")) {
        if !folder.path().join("scene.toml").exists() {
            continue;
        }
        let name = folder.file_name().into_string().expect("UTF-8");
        for size in ["film.size=[256, 256]", "film.size=[8, 8]", "film.size=[1, 1]"] {
            let found = left_out(&name, &[size]).expect("fog");
            println!("{name}, {size}: {found:?}");
            let Some(limit) = found.sufficient else { continue };
            let enough = left_out(&name, &[size, &format!("render.max_segments={limit}")]).expect("fog");
            assert!(!enough.matters(), "{name}, {size}: {found:?}, then {enough:?}");
        }
    }
}
