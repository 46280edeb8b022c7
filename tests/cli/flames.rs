//! Scenes whose media emit light.

use std::path::Path;

use super::support::{Folder, SCENE};

const MEDIUM: &str = "[medium]\nscattering = 0.7\nabsorption = 0.3";

/// The test scene with `medium` in place of its fog, and with or without its light.
fn with(medium: &str, lit: bool) -> Folder {
    let scene = SCENE.replace(MEDIUM, medium);
    let (before, light) = scene.split_once("[[light]]").expect("a light");
    let rest = light.split_once("\n[").map_or(String::new(), |(_, rest)| format!("[{rest}"));
    let folder = Folder::empty();
    folder.write("scene.toml", if lit { scene.clone() } else { format!("{before}{rest}") });
    let blob = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/blob.vdb");
    std::fs::copy(blob, folder.path("blob.vdb")).expect("a file");
    folder
}

const FLAME: &str = "[[volume]]\nemission = [3, 2, 1]\nemission_grid = { file = \"blob.vdb\", translate = [0, 0, 2] }";

#[test]
fn flames_are_all_the_light_that_a_scene_needs() {
    let coloured = format!("{FLAME}\nscattering = [0.3, 0.2, 0.1]\nabsorption = [0.2, 0.2, 0.3]");
    for medium in [FLAME, &format!("{MEDIUM}\nemission = 2"), &coloured] {
        let folder = with(medium, false);
        for technique in ["path", "nee", "bridge", "mvnee,omnee"] {
            let run = folder.done(&["render", "scene.toml", "--technique", technique, "-o", "a.exr", "-o", "a.png"]);
            assert!(!run.stderr.contains("dropped") && !run.stderr.contains("mean 0.0000"), "{run}");
        }
    }
}

#[test]
fn what_emits_is_described() {
    let run = with(FLAME, true).done(&["info", "scene.toml"]);
    assert!(run.stdout.contains("emission 3 | 2 | 1 W/(m^3 sr) times grid \"density\" of \"blob.vdb\""), "{run}");
    let brighter = FLAME.replace("\"blob.vdb\"", "\"blob.vdb\", scale = 10");
    let run = with(&brighter, true).done(&["info", "scene.toml"]);
    assert!(run.stdout.contains("emission 30 | 20 | 10 W/(m^3 sr) times grid \"density\" of \"blob.vdb\""), "{run}");
    let run = with(&format!("{MEDIUM}\nemission = 2"), true).done(&["info", "scene.toml"]);
    assert!(run.stdout.contains(", emission 2 W/(m^3 sr)"), "{run}");
}

#[test]
fn emission_that_cannot_be_is_refused_with_a_reason() {
    let block = "[[volume]]\nshape = { type = \"box\", min = [-1, -1, 1], max = [1, 1, 2] }\n";
    for (medium, finding) in [
        (format!("{MEDIUM}\nemission = -1"), "medium.emission is -1.0"),
        (format!("{MEDIUM}\nemission = 1e21"), "medium.emission is 1e21"),
        ("[medium]\nemission = 1".into(), "medium.emission is given, but the medium has no extinction"),
        (
            "[medium]\nscattering = [1, 0, 3]\nemission = [1, 2, 0]".into(),
            "medium.emission is given, but the medium has no extinction in green",
        ),
        (
            format!("{block}emission_grid = {{ file = \"blob.vdb\" }}"),
            "volume[0].emission_grid is given, but volume[0].emission, which it multiplies, is 0",
        ),
        (
            format!("{block}emission = 1e19\nemission_grid = {{ file = \"blob.vdb\", scale = 1e3 }}"),
            "volume[0].emission is 1e19, which makes an emission of",
        ),
        (format!("{block}emission = 1\nemission_grid = {{ file = \"blob.vdb\", name = \"flame\" }}"), "flame"),
    ] {
        let run = with(&medium, true).run(&["render", "scene.toml"]);
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{medium}: {run}");
        assert!(run.stderr.contains("scene.toml") || run.stderr.contains("blob.vdb"), "{run}");
    }
}
