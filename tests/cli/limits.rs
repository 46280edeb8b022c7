//! What ends a render: samples, time and noise, whichever comes first.

use serde_json::Value;

use super::support::{Folder, Run, assert_same_bits, header, plane};

fn render(folder: &Folder, name: &str, flags: &[&str]) -> Run {
    folder.done(&[&["render", "scene.toml", "-o", name, "--progress", "none"], flags].concat())
}

#[test]
fn whatever_comes_first_ends_a_render_and_is_told() {
    let folder = Folder::with_scene();
    for (flags, end) in [
        (&["--samples", "24", "--noise", "1e-9", "--time", "1h"][..], "samples"),
        (&["--samples", "1000000000", "--noise", "0.3", "--time", "1h"], "noise"),
        (&["--samples", "1000000000", "--noise", "1e-9", "--time", "300ms"], "time"),
        (&["--sample-range", "5..9", "--time", "1h"], "samples"),
        (&["--noise", "0.3", "--time", "1h"], "noise"),
        (&[], "samples"),
    ] {
        let base = ["render", "scene.toml", "-o", "a.exr", "--stats", "a.json"];
        let run = folder.done(&[&base[..], flags].concat());
        assert_eq!(header(&folder.image("a.exr"), "ended_by"), end, "{flags:?}");
        let text = std::fs::read_to_string(folder.path("a.json")).expect("statistics");
        let statistics: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(statistics["ended_by"], end, "{flags:?}");
        assert_eq!(run.stderr.contains(&format!(", ended by {end}")), !flags.is_empty(), "{run}");
    }
}

#[test]
fn limits_that_are_not_reached_leave_no_trace() {
    let folder = Folder::with_scene();
    for (name, flags) in [
        ("noise.exr", &["--noise", "0.1"][..]),
        ("noise2.exr", &["--noise", "0.1", "--samples", "100000", "--time", "1h"]),
        ("samples.exr", &["--samples", "50"]),
        ("samples2.exr", &["--samples", "50", "--noise", "1e-9", "--time", "1h", "--threads", "1"]),
    ] {
        render(&folder, name, &[flags, &["--size", "40x40"]].concat());
    }
    assert_same_bits(&folder, "noise.exr", "noise2.exr");
    assert_same_bits(&folder, "samples.exr", "samples2.exr");
}

#[test]
fn the_samples_of_the_scene_count_where_no_flag_says_anything() {
    let folder = Folder::with_scene();
    render(&folder, "a.exr", &["--noise", "0.1"]);
    assert!(plane(&folder.image("a.exr"), "N")[0] > 4.0, "the scene says 4");
    render(&folder, "a.exr", &["--noise", "1e-9", "--samples", "3"]);
    assert_eq!(plane(&folder.image("a.exr"), "N")[0], 3.0);
}

#[test]
fn a_time_is_kept_before_the_noise_is_looked_at() {
    let folder = Folder::with_scene();
    // Twins are slow: 16 samples of every pixel take longer.
    let flags = ["--size", "64x64", "--reference", "--time", "0s", "--noise", "1e-9"];
    render(&folder, "a.exr", &flags);
    assert!(plane(&folder.image("a.exr"), "N").iter().all(|samples| *samples == 1.0));
    assert_eq!(header(&folder.image("a.exr"), "ended_by"), "time");
}

#[test]
fn what_is_done_already_is_left_out_on_resume() {
    let folder = Folder::with_edited_scene("radius = 1.5", "radius = 0.1");
    let is_left_out = |more: &[&str]| {
        let base = ["render", "scene.toml", "-o", "a.exr", "--resume", "--checkpoint", "off", "--size", "40x40"];
        let run = folder.done(&[&base[..], more].concat());
        run.stderr.contains("a.exr: already there, skipped\n")
    };
    for kind in [&[][..], &["--adaptive"]] {
        let part = [kind, &["--sample-range", "20..40"]].concat();
        assert!(!is_left_out(&part), "{kind:?}: another render");
        assert!(is_left_out(&part), "{kind:?}");
        assert!(!is_left_out(&[&part[..], &["--seed", "2"]].concat()), "{kind:?}: another seed");
        assert!(!is_left_out(&[&part[..], &["--crop", "0,0,8,8"]].concat()), "{kind:?}: another crop");
        assert!(!is_left_out(&[kind, &["--sample-range", "10..30"]].concat()), "{kind:?}: other samples");
    }
    assert!(!is_left_out(&["--samples", "4"]) && is_left_out(&["--samples", "4"]));
    assert!(!is_left_out(&["--samples", "4", "--set", "light[0].radius=0.2"]), "another scene");
}
