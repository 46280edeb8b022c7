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
fn keys_are_set_in_scenes_alone() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    folder.write("a.vdb", fogbow_testing::volumes::bytes("two.vdb"));
    for (file, what) in [("a.exr", "an image"), ("a.vdb", "an OpenVDB file")] {
        let start = format!("--set render.samples=2: is for scenes, but {file} is {what}\n");
        folder.refused(&["info", file, "--set", "render.samples=2"], 2, &start);
    }
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

/// What `fogbow info` says of the checkpoint of a render with these flags that was told to stop.
#[cfg(unix)]
fn info_of_checkpoint(flags: &[&str]) -> (Folder, String) {
    let folder = Folder::with_scene();
    let base = ["render", "scene.toml", "-o", "a.exr", "--checkpoint", "20ms", "--progress", "none", "--size", "64x64"];
    let mut child = super::support::program(&folder).args(base).args(flags).spawn().expect("the program starts");
    let start = std::time::Instant::now();
    while !folder.path("a.exr.checkpoint").exists() {
        assert!(start.elapsed().as_secs() < 60, "there is no checkpoint");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let killed = std::process::Command::new("kill").arg(child.id().to_string()).status();
    assert!(killed.is_ok_and(|status| status.success()));
    child.wait().expect("a child");
    let run = folder.done(&["info", "a.exr.checkpoint"]);
    (folder, run.stdout)
}

#[cfg(unix)]
#[test]
fn a_checkpoint_says_what_it_is_of() {
    let (folder, text) =
        info_of_checkpoint(&["--samples", "1000000", "--noise", "1e-6", "--time", "9h", "--seed", "7"]);
    for line in [
        "a.exr.checkpoint: checkpoint of ",
        "size: 64x64 pixels",
        "scene_hash: ",
        "technique: mvnee",
        "seed: 7",
        "samples: ",
        "progress: ",
        "noise: ",
        "time: ",
        "written: 20",
    ] {
        assert!(text.lines().any(|other| other.starts_with(line)), "{line} is not in {text}");
    }
    assert!(text.contains(" per pixel, ") && text.contains(" in 64 tiles; "), "{text}");
    assert!(text.contains(" of 1000000 samples per pixel, or "), "{text}");
    assert!(text.contains(" % of 9 h, or about ") && text.contains(" of the way to a noise of 0.000100 %\n"), "{text}");
    assert!(text.contains("Z, ") && text.ends_with(" ago\n"), "{text}");
    // The hash is that of the image.
    folder.done(&["render", "scene.toml", "-o", "b.exr", "--size", "64x64", "--seed", "7"]);
    let hash = super::support::header(&folder.image("b.exr"), "scene_hash").to_string();
    assert!(text.contains(&format!("scene_hash: {hash}\n")), "{text}");
    // Whatever it is called; and a torn one is told for what it is.
    std::fs::rename(folder.path("a.exr.checkpoint"), folder.path("x")).expect("a file");
    folder.done(&["info", "x"]);
    let start = "--set render.seed=2: is for scenes, but x is a checkpoint\n";
    folder.refused(&["info", "x", "--set", "render.seed=2"], 2, start);
    let bytes = std::fs::read(folder.path("x")).expect("a file");
    for (length, finding) in
        [(bytes.len() / 2, "is a truncated or damaged checkpoint"), (20, "is a truncated checkpoint")]
    {
        folder.write("y", &bytes[..length]);
        folder.refused(&["info", "y"], 1, &format!("y: {finding}"));
    }
    folder.write("z.checkpoint", "");
    folder.refused(&["info", "z.checkpoint"], 1, "z.checkpoint: is empty");
}

#[cfg(unix)]
#[test]
fn a_checkpoint_says_which_samples_it_has() {
    let flags = ["--adaptive", "--sample-range", "40..1000000", "--crop", "8,8,48,64"];
    let (_, text) = info_of_checkpoint(&flags);
    assert!(text.contains("size: 64x64 pixels, of which 8,8,48,64\n"), "{text}");
    assert!(text.contains(" tiles, adaptive, from sample 40 on; "), "{text}");
}
