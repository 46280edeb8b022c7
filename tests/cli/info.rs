//! `fogbow info`

use super::support::Folder;

#[test]
fn a_scene_is_described_with_its_cost() {
    let folder = Folder::empty();
    folder.write("mist/scene.toml", super::support::SCENE);
    for scene in ["mist", "mist/scene.toml"] {
        let run = folder.done(&["info", scene]);
        let lines: Vec<_> = run.stdout.lines().collect();
        assert_eq!(lines[0], "mist: 8x8 pixels, 4 samples each, seed 1", "{run}");
        assert_eq!(lines[1], "fog: mean free path 1 m, albedo 0.7000, henyey_greenstein of mean cosine 0.5000");
        assert_eq!(lines[2], "light: disk of radius 1.5 m at 3 m from the camera (3 mean free paths)");
        assert_eq!(lines[3], "technique mvnee, paths of 1 to 24 segments");
        assert_eq!(lines[4], "vertices that connect: all, survival 1");
        assert!(lines[5].starts_with("cost: 256 samples, ") && lines[5].contains(" samples/s; film 1 MiB"), "{run}");
        assert_eq!((lines.len(), run.stderr.as_str()), (6, ""), "{run}");
    }
}

#[test]
fn a_medium_that_does_nothing_is_vacuum() {
    let folder = Folder::with_edited_scene("scattering = 0.7\nabsorption = 0.3", "scattering = 0");
    let run = folder.done(&["info", "scene.toml"]);
    assert!(run.stdout.contains("\nvacuum: only directly visible light counts\n"), "{run}");
}

#[test]
fn an_image_of_extreme_shape_is_measured_quickly() {
    for size in ["[20000000, 1]", "[1, 20000000]", "[1, 1]"] {
        let folder = Folder::with_edited_scene("size = [8, 8]", &format!("size = {size}"));
        let start = std::time::Instant::now();
        folder.done(&["info", "scene.toml"]);
        assert!(start.elapsed().as_secs() < 10, "{size} took {:?}", start.elapsed());
    }
}

#[test]
fn an_image_is_described_with_its_header() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--technique", "nee", "--seed", "7"]);
    let run = folder.done(&["info", "a.exr"]);
    for line in ["a.exr: 8x8 pixels", "  N     mean 4", "technique: nee", "seed: 7", "sample_range: 0..4", "  [film]"] {
        assert!(run.stdout.lines().any(|found| found == line), "{line:?} is missing\n{run}");
    }
    assert!(run.stdout.lines().all(|line| line.trim_end() == line), "{run}");
}

#[test]
fn what_is_neither_scene_nor_image_is_refused() {
    let folder = Folder::with_edited_scene("radius = 1.5", "radius = 0");
    folder.write("fake.exr", "no image");
    folder.write("a.png", "an image for the eye");
    folder.refused(&["info", "missing"], 1, "missing: cannot be read: ");
    folder.refused(&["info", "missing.exr"], 1, "missing.exr: cannot be read: ");
    folder.refused(&["info", "fake.exr"], 1, "fake.exr: is not an EXR image\n");
    folder.refused(&["info", "a.png"], 1, "a.png: is a PNG image, which");
    let beginning = format!("{}: light[0].radius is 0.0\n", folder.place("radius"));
    folder.refused(&["info", "scene.toml"], 1, &beginning);
}
