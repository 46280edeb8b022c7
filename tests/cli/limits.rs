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

/// What long paths would bring, and how vertices of such paths connect, takes seconds to find out.
const LONG: [&str; 8] =
    ["--max-segments", "1024", "--set", "medium.scattering=60", "--technique", "bridge", "--size", "32x32"];

#[test]
fn preparing_takes_no_more_than_its_share_of_the_time() {
    let folder = Folder::with_scene();
    let flags = ["render", "scene.toml", "-o", "a.png", "-o", "a.exr", "--stats", "a.json", "--time", "2s"];
    let run = folder.done(&[&flags[..], &LONG].concat());
    let statistics: Value =
        serde_json::from_slice(&std::fs::read(folder.path("a.json")).expect("a file")).expect("JSON");
    let unfinished = statistics["unfinished"].as_array().expect("a list");
    assert_eq!(unfinished.last().and_then(Value::as_str), Some("looking at long paths"), "{run}");
    let warning = "warning: preparing may take 0.5 s of the time, which was not enough: ";
    assert!(run.stderr.contains(warning), "{run}");
    assert!(run.stderr.contains("how much light longer paths would bring is not known; more time lets it"), "{run}");
    assert!(!run.stderr.contains("are left out"), "{run}");
    assert!(statistics["exposure"].is_number() && run.stderr.contains(", exposure "), "{run}");
    assert_eq!(header(&folder.image("a.exr"), "left_out"), "unknown beyond 1024 segments, no sufficient limit known");
    // A block of samples of any step may be at hand.
    let seconds = statistics["seconds_of_preparation"].as_f64().expect("a number");
    assert!((0.5..if cfg!(debug_assertions) { 60.0 } else { 6.0 }).contains(&seconds), "{seconds} s");
}
