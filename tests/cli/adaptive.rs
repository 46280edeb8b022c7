//! `--adaptive`, in files.

use super::support::{Folder, assert_same_bits, header, mean, plane};

fn render(folder: &Folder, name: &str, flags: &[&str]) {
    let base = ["render", "scene.toml", "-o", name, "--size", "80x72", "--progress", "none"];
    folder.done(&[&base[..], flags].concat());
}

/// A small lamp: noise that differs between tiles.
fn folder() -> Folder {
    let folder = Folder::with_edited_scene("radius = 1.5", "radius = 0.1");
    render(&folder, "whole.exr", &["--adaptive", "--samples", "60"]);
    folder
}

#[test]
fn the_number_of_samples_is_that_of_the_mean_pixel() {
    let folder = folder();
    let image = folder.image("whole.exr");
    assert!((mean(&image, "N") - 60.0).abs() < 0.5, "{}", mean(&image, "N"));
    let samples = plane(&image, "N");
    assert!(samples.iter().any(|n| *n < 50.0) && samples.iter().any(|n| *n > 75.0));
    let total: f64 = samples.iter().map(|n| f64::from(*n)).sum();
    assert_eq!(header(&image, "samples"), total.to_string());
    assert_eq!(header(&image, "adaptive"), "true");
    // What the header says of samples is what the pixels have.
    for part in header(&image, "coverage").split(' ') {
        let (region, range) = part.split_once(':').expect("a part");
        let region: Vec<usize> = region.split(',').map(|n| n.parse().expect("a number")).collect();
        let end = range.strip_prefix("0..").and_then(|end| end.parse::<f32>().ok()).expect("from 0 on");
        for y in region[1]..region[3] {
            assert!((region[0]..region[2]).all(|x| samples[80 * y + x] == end), "{part}");
        }
    }
}

#[test]
fn parts_of_the_samples_merge_to_the_bits_of_one_run() {
    let folder = folder();
    for (name, samples) in [("a.exr", "0..25"), ("b.exr", "25..40"), ("c.exr", "40..60")] {
        render(&folder, name, &["--adaptive", "--sample-range", samples]);
    }
    let run = folder.done(&["merge", "c.exr", "a.exr", "b.exr", "-o", "merged.exr"]);
    assert!(!run.stderr.contains("warning"), "{run}");
    assert_same_bits(&folder, "merged.exr", "whole.exr");
    for name in ["coverage", "samples", "adaptive", "sample_range"] {
        let [merged, whole] = ["merged.exr", "whole.exr"].map(|file| header(&folder.image(file), name).to_string());
        assert_eq!(merged, whole, "{name}");
    }
    let run = folder.done(&["merge", "a.exr", "c.exr", "-o", "holes.exr"]);
    let gap = "samples 25..40 of the mean pixel are missing from every pixel";
    assert!(run.stderr.contains(&format!("warning: {gap}\n")), "{run}");
    // Parts that are merged in two steps are checked as well.
    folder.done(&["merge", "a.exr", "b.exr", "-o", "ab.exr", "--expect", "0..40"]);
    folder.done(&["merge", "ab.exr", "c.exr", "-o", "merged.exr", "--expect", "0..60"]);
    assert_same_bits(&folder, "merged.exr", "whole.exr");
    for (parts, expected, finding) in [
        (&["a.exr", "c.exr"][..], "0..60", gap),
        (&["ab.exr"], "0..60", "samples 40..60 of the mean pixel are missing from every pixel"),
        (&["ab.exr", "c.exr"], "0..40", "the parts have samples 0..60 of the mean pixel"),
    ] {
        let args = [&["merge", "-o", "x.exr", "--expect", expected], parts].concat();
        folder.refused(&args, 1, &format!("--expect {expected}: {finding}\n"));
    }
    // Samples that are there already are refused, whether tiles have as many of them or not.
    render(&folder, "even.exr", &["--samples", "60"]);
    folder.refused(&["merge", "a.exr", "even.exr", "-o", "x.exr"], 1, "even.exr: has samples ");
}

#[test]
fn what_has_samples_of_some_tiles_alone_is_not_what_is_expected() {
    let folder = folder();
    // A deadline may happen to be where all tiles have their samples.
    for _ in 0..9 {
        render(&folder, "a.exr", &["--adaptive", "--time", "300ms"]);
        if folder.image("a.exr").header.iter().all(|(name, _)| name != "fogbow.levels") {
            break;
        }
    }
    let stopped = ["merge", "a.exr", "-o", "x.exr", "--expect", "0..1000000"];
    folder.refused(&stopped, 1, "a.exr: has some samples of single tiles");
    render(&folder, "b.exr", &["--samples", "10"]);
    render(&folder, "c.exr", &["--adaptive", "--sample-range", "10..12"]);
    let mixed = ["merge", "b.exr", "c.exr", "-o", "x.exr", "--expect", "0..12"];
    folder.refused(&mixed, 1, "b.exr: is not adaptive, but other parts are");
}

#[test]
fn crops_merge_to_their_own_pixels() {
    let folder = folder();
    render(&folder, "left.exr", &["--adaptive", "--samples", "40", "--crop", "0,0,33,72"]);
    render(&folder, "right.exr", &["--adaptive", "--samples", "40", "--crop", "33,0,80,72"]);
    let run = folder.done(&["merge", "left.exr", "right.exr", "-o", "merged.exr"]);
    assert!(!run.stderr.contains("warning"), "{run}");
    let [merged, left, right] = ["merged.exr", "left.exr", "right.exr"].map(|name| folder.image(name));
    for name in ["R", "SE.G", "N"] {
        let [whole, left, right] = [&merged, &left, &right].map(|image| plane(image, name));
        for (place, value) in whole.iter().enumerate() {
            let (x, y) = (place % 80, place / 80);
            let part = if x < 33 { left[33 * y + x] } else { right[47 * y + x - 33] };
            assert_eq!(value.to_bits(), part.to_bits(), "{name} of ({x}, {y})");
        }
    }
    let run = folder.done(&["merge", "left.exr", "-o", "half.exr"]);
    let gap = "samples 0..40 of the mean pixel are missing from 3384 of the 5760 pixels (columns 33..80, rows 0..72)";
    assert!(run.stderr.contains(gap), "{run}");
}

#[test]
fn few_samples_are_not_adaptive() {
    let folder = Folder::with_scene();
    let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--adaptive", "--samples", "16"]);
    assert!(run.stderr.contains("warning: --adaptive has no effect: the first 16 samples"), "{run}");
    folder.done(&["render", "scene.toml", "-o", "b.exr", "--samples", "16"]);
    assert_same_bits(&folder, "a.exr", "b.exr");
}

/// Of a lamp at the edge of a wide view, far from most of what is seen.
#[test]
fn a_noise_is_met_with_fewer_samples() {
    let folder = folder();
    let view = ["--set", "camera.vertical_fov_deg=130", "--set", "light.0.center=[2.5, 1.5, 2]", "--noise", "0.1"];
    for (name, more) in [("even.exr", &[][..]), ("adaptive.exr", &["--adaptive"])] {
        render(&folder, name, &[&view[..], more].concat());
        assert_eq!(header(&folder.image(name), "ended_by"), "noise", "{name}");
    }
    let [even, adaptive] = ["even.exr", "adaptive.exr"].map(|name| mean(&folder.image(name), "N"));
    println!("{even} and {adaptive} samples per pixel");
    assert!(adaptive < 0.98 * even, "{adaptive} and {even}");
}
