//! The library, as a program that depends on it uses it.

use fogbow::session::{Session, Settings};
use fogbow::{Scene, Target};

const FOG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/fog-facing");

#[test]
fn a_render_of_the_library_is_that_of_the_program() {
    let mut scene = Scene::load(FOG).expect("a scene");
    scene.set("film.size", vec![16, 16]).expect("a size");
    scene.set("medium.phase.g", 0.6).expect("a mean cosine");
    let image = scene.render(Target::Samples(4)).expect("an image");
    let folder = tempfile::tempdir().expect("a folder");
    let [library, program] = ["library.exr", "program.exr"].map(|name| folder.path().join(name));
    image.write(&library).expect("written");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_fogbow"));
    let flags = ["--size", "16x16", "--samples", "4", "--set", "medium.phase.g=0.6", "--progress", "none", "-o"];
    let run = command.args(["render", FOG]).args(flags).arg(&program).output().expect("the program");
    assert!(run.status.success(), "{run:?}");
    let [library, program] = [library, program].map(|path| fogbow::image::exr::read_image(&path).expect("an image"));
    assert_eq!(library.channels, program.channels);
    let red = library.channel("R").expect("red");
    assert_eq!(image.pixel(3, 5).mean[0] as f32, red[5 * 16 + 3]);
    assert_eq!(image.pixels().count(), 256);
    assert!(image.warnings().iter().any(|warning| warning.starts_with("paths of more than 15 segments")));
}

#[test]
fn parts_of_a_render_merge_to_the_whole() {
    let mut scene = Scene::load(FOG).expect("a scene");
    scene.set("film.size", vec![24, 16]).expect("a size");
    let folder = tempfile::tempdir().expect("a folder");
    let paths: Vec<_> = ["a.exr", "b.exr"].map(|name| folder.path().join(name)).into();
    for (samples, path) in [0..3, 3..8].into_iter().zip(&paths) {
        let part = scene.render_part(samples).expect("a part");
        part.write(path).expect("written");
        assert!(!part.pixels().eq(scene.render(Target::Samples(8)).expect("an image").pixels()));
    }
    let merged = fogbow::merge::exact(&paths).expect("parts of one render");
    assert!(merged.film.pixels().eq(scene.render(Target::Samples(8)).expect("an image").pixels()));
    assert!(merged.warnings.is_empty(), "{:?}", merged.warnings);
}

#[test]
fn what_is_known_before_a_render_is_told_before_it() {
    let scene = Scene::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-fog")).expect("a scene");
    let is_slow = fogbow::cpu::advice().is_some();
    let before = scene.warnings();
    assert_eq!(before.len(), scene.loaded().warnings.len() + usize::from(is_slow), "{before:?}");
    assert_eq!(before.iter().any(|warning| warning.contains("this build does not use AVX2")), is_slow);
}

/// The example of the README is the one on the front page of the crate, which is run.
#[test]
fn the_example_of_the_readme_is_one_that_runs() {
    let [readme, page] = ["README.md", "src/lib.rs"].map(|file| {
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("text")
    });
    let example = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    for line in example.lines().filter(|line| line.contains("scene.set") || line.contains("Scene::load")) {
        assert!(page.contains(&format!("//! {line}")), "{line}");
    }
    for text in [&readme, &page] {
        assert!(text.contains("Build with `--release`") && text.contains("[profile.dev.package.\"*\"]"));
    }
}

#[test]
fn what_cannot_be_set_leaves_the_scene_as_it_was() {
    let mut scene = Scene::load(FOG).expect("a scene");
    let before = scene.loaded().hash();
    for (key, value) in [("medium.phase.g", 2.0), ("medium.mist", 1.0), ("light[7].radius", 1.0)] {
        let error = scene.set(key, value).expect_err("out of range").to_string();
        assert!(error.starts_with(&format!("error: {key} = ")), "{error}");
    }
    assert_eq!(scene.loaded().hash(), before);
    let image = scene.render(Target::Noise(0.9)).expect("an image");
    assert!(image.write("fog.jpg").expect_err("no format").to_string().contains("does not name an image format"));
}

#[test]
fn progress_towards_a_noise_never_goes_back() {
    let mut scene = Scene::load(FOG).expect("a scene");
    scene.set("film.size", vec![24, 24]).expect("a size");
    scene.set("render.technique", "path").expect("a technique");
    // Few paths find the light, so that early noise is far too small.
    scene.set("light[0].radius", 0.1).expect("a radius");
    let session = Session::new(scene.loaded().clone(), Settings::default()).expect("a session");
    let mut states = Vec::new();
    let outcome = session.run(Target::Noise(0.3), || false, |state| states.push(state));
    assert!(states.is_sorted_by(|before, after| before.fraction <= after.fraction), "{states:?}");
    let known = states.iter().filter(|state| state.fraction > 0.0);
    let first = known.clone().next().expect("an estimate");
    assert!(states.len() > known.count(), "the first rounds know nothing");
    let expected = first.samples as f64 / first.fraction;
    let ratio = expected / outcome.stats.samples as f64;
    assert!((0.5..2.0).contains(&ratio), "{ratio} of the samples that it took were expected");
}
