//! Who is told what, and where.

use super::support::{Folder, Run};
use serde_json::Value;

/// A render that is longer than the interval between messages.
fn long_render(style: &str) -> Run {
    Folder::with_scene().done(&["render", "scene.toml", "-o", "a.exr", "--time", "2300ms", "--progress", style])
}

fn short_render(style: &str) -> Run {
    Folder::with_scene().done(&["render", "scene.toml", "-o", "a.exr", "--progress", style])
}

#[test]
fn plain_progress_is_a_line_now_and_then_and_a_summary() {
    let run = long_render("plain");
    let lines: Vec<_> = run.stderr.lines().collect();
    assert_eq!((lines.len(), run.stdout.as_str()), (2, ""), "{run}");
    let percent = lines[0].split_once('%').and_then(|(number, _)| number.trim().parse::<f64>().ok());
    assert!(percent.is_some_and(|percent| (80.0..=100.0).contains(&percent)), "{run}");
    assert!(lines[0].contains("samples/s") && lines[0].contains("  noise ") && lines[0].ends_with(" left"), "{run}");
    assert!(lines[1].starts_with("a.exr: mvnee, ") && lines[1].contains("samples per pixel in 2."), "{run}");
}

#[test]
fn json_progress_is_one_object_per_line_on_standard_error() {
    let run = long_render("json");
    let messages: Vec<Value> =
        run.stderr.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}\n{run}"))).collect();
    let events: Vec<_> = messages.iter().map(|message| message["event"].as_str().expect("an event")).collect();
    assert_eq!((events.as_slice(), run.stdout.as_str()), (&["progress", "progress", "status"][..], ""), "{run}");
    let fractions = [&messages[0], &messages[1]].map(|message| message["fraction"].as_f64().expect("a fraction"));
    assert!(fractions[0] > 0.8 && fractions[1] == 1.0, "{run}");
    for name in ["samples", "samples_per_second", "seconds", "seconds_left", "noise"] {
        assert!(messages[0][name].is_number(), "{name}: {run}");
    }
    assert!(messages[0]["until"] == "time" && messages[0]["noise_target"].is_null(), "{run}");
    assert!(messages[2]["message"].as_str().is_some_and(|text| text.starts_with("a.exr: mvnee, ")), "{run}");
}

#[test]
fn progress_says_how_noisy_it_is_and_what_comes_first() {
    let flags = ["--noise", "1e-6", "--time", "2500ms", "--samples", "1000000000", "--size", "32x32"];
    let with = |style: &str| {
        let base = ["render", "scene.toml", "-o", "a.exr", "--progress", style];
        Folder::with_scene().done(&[&base[..], &flags].concat())
    };
    let run = with("plain");
    let line = run.stderr.lines().next().expect("a line");
    assert!(line.contains(" samples/s  noise ") && line.ends_with(" left of 2.5 s"), "{run}");
    let run = with("json");
    let message: Value = serde_json::from_str(run.stderr.lines().next().expect("a line")).expect("JSON");
    assert!(message["until"] == "time" && message["noise_target"] == 1e-6, "{run}");
    assert!(message["noise"].as_f64().is_some_and(|noise| (1e-4..1.0).contains(&noise)), "{run}");
}

#[test]
fn openjd_progress_is_on_standard_output() {
    let run = long_render("openjd");
    let lines: Vec<_> = run.stdout.lines().collect();
    assert_eq!((lines.len(), run.stderr.as_str()), (3, ""), "{run}");
    let percents = [lines[0], lines[2]].map(|line| line.strip_prefix("openjd_progress: ").and_then(|n| n.parse().ok()));
    assert!(percents[0].is_some_and(|percent: f64| percent > 80.0) && percents[1] == Some(100.0), "{run}");
    assert!(lines[1].starts_with("openjd_status: a.exr: mvnee, "), "{run}");
}

#[test]
fn alf_progress_is_whole_percents_on_standard_output() {
    let run = long_render("alf");
    let lines: Vec<_> = run.stdout.lines().collect();
    assert_eq!((lines.len(), run.stderr.lines().count()), (2, 1), "{run}");
    let percents =
        [lines[0], lines[1]].map(|line| line.strip_prefix("ALF_PROGRESS ")?.strip_suffix('%')?.parse::<u32>().ok());
    assert!(percents[0].is_some_and(|percent| (80..100).contains(&percent)) && percents[1] == Some(100), "{run}");
    assert!(run.stderr.starts_with("a.exr: mvnee, "), "{run}");
}

#[cfg(target_os = "linux")]
#[test]
fn nothing_is_done_before_its_results_are_there() {
    let folder = Folder::with_scene();
    for (style, done) in [("openjd", "openjd_progress: 100"), ("alf", "ALF_PROGRESS 100%")] {
        let render = |output: &str| folder.run(&["render", "scene.toml", "-o", output, "--progress", style]);
        assert!(render("a.exr").stdout.contains(done));
        let merge = folder.run(&["merge", "a.exr", "-o", "b.exr", "--weighted", "--progress", style]);
        assert!(merge.stdout.contains(done), "{merge}");
        // What cannot be written is found out when it is.
        let run = folder.run(&["merge", "a.exr", "-o", "png:/dev/full", "--progress", style]);
        assert!(run.code == Some(1) && !run.stdout.contains(done), "{run}");
    }
}

/// Commands that fail in two ways: before anything is rendered or read, and because a scene or a part is wrong.
fn failures(style: &str) -> [Run; 3] {
    let folder = Folder::with_edited_scene("radius = 1.5", "radius = \"wide\"");
    let render = |output| folder.run(&["render", "scene.toml", "-o", output, "--progress", style]);
    let merge = folder.run(&["merge", "missing.exr", "-o", "b.exr", "--progress", style]);
    [render("no/a.exr"), render("a.exr"), merge]
}

#[test]
fn openjd_is_told_why_it_failed_on_one_line() {
    for run in failures("openjd") {
        let lines: Vec<_> = run.stdout.lines().collect();
        assert!(run.code != Some(0) && lines.len() == 1, "{run}");
        let finding = run.stderr.lines().next().and_then(|line| line.strip_prefix("error: ")).expect("an error");
        assert!(lines[0].starts_with(&format!("openjd_fail: {finding}; ")), "{run}");
    }
}

#[test]
fn json_has_errors_too() {
    for run in failures("json") {
        assert!(run.code != Some(0) && run.stdout.is_empty() && run.stderr.lines().count() == 1, "{run}");
        let message: Value = serde_json::from_str(&run.stderr).unwrap_or_else(|error| panic!("{error}\n{run}"));
        assert_eq!(message["event"], "error", "{run}");
        for name in ["place", "message", "help"] {
            assert!(message[name].as_str().is_some_and(|text| !text.is_empty()), "{name}: {run}");
        }
    }
}

#[test]
fn a_merge_tells_its_progress_too() {
    let folder = Folder::with_scene();
    for (name, samples) in [("a.exr", "0..1"), ("b.exr", "1..3")] {
        folder.done(&["render", "scene.toml", "-o", name, "--sample-range", samples, "--progress", "none"]);
    }
    let merge = |style| folder.done(&["merge", "a.exr", "b.exr", "-o", "c.exr", "--progress", style]);
    let summary = "c.exr: 2 images, 3 samples per pixel";
    let run = merge("openjd");
    assert!(run.stdout.starts_with(&format!("openjd_status: {summary}")), "{run}");
    assert!(run.stdout.ends_with("\nopenjd_progress: 100.00\n"), "{run}");
    assert_eq!((run.stdout.lines().count(), run.stderr.as_str()), (2, ""), "{run}");
    let run = merge("alf");
    assert_eq!(run.stdout, "ALF_PROGRESS 100%\n", "{run}");
    assert!(run.stderr.starts_with(summary) && merge("plain").stderr.starts_with(summary), "{run}");
    let run = merge("none");
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "{run}");
    let events = merge("json")
        .stderr
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).expect("JSON")["event"].clone())
        .collect::<Vec<_>>();
    assert_eq!(events, ["progress", "status"]);
}

#[test]
fn without_progress_success_is_silent_and_errors_are_not() {
    let run = short_render("none");
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "{run}");
    Folder::with_scene().refused(&["render", "scene.toml", "-o", "a", "--progress", "none"], 2, "--output a: ");
}

#[test]
fn a_short_render_is_a_single_line() {
    for style in ["auto", "plain", "bar"] {
        let run = short_render(style);
        assert_eq!((run.stderr.lines().count(), run.stdout.as_str()), (1, ""), "{run}");
        assert!(run.stderr.starts_with("a.exr: mvnee, 4 samples per pixel in "), "{run}");
        assert!(run.stderr.contains(" +- ") && run.stderr.contains(", noise "), "{run}");
    }
}

#[test]
fn one_sample_per_pixel_claims_no_accuracy() {
    let run = Folder::with_scene().done(&["render", "scene.toml", "-o", "a.exr", "--samples", "1"]);
    assert!(run.stderr.contains("1 sample per pixel"), "{run}");
    assert!(!run.stderr.contains("+-") && !run.stderr.contains("noise"), "{run}");
}

#[cfg(unix)]
#[test]
fn a_reader_that_has_gone_away_does_not_stop_a_render() {
    for (stream, style) in [("2>&1 >/dev/null", "json"), ("", "openjd")] {
        let folder = Folder::with_scene();
        let mut shell = std::process::Command::new("sh");
        let fogbow = env!("CARGO_BIN_EXE_fogbow");
        // The reader ends at once; the program's exit code goes to a file.
        let script = format!(
            "{{ '{fogbow}' render scene.toml -o a.exr --time 300ms --progress {style} {stream}; echo $? >code; }} | true"
        );
        shell.args(["-c", &script]).current_dir(folder.path("."));
        assert!(shell.status().expect("a shell").success());
        assert_eq!(std::fs::read_to_string(folder.path("code")).expect("a code"), "0\n", "{style}");
        assert_eq!(folder.image("a.exr").width, 8);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_an_error() {
    use super::support::program;
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    for args in [&["render", "--help-scene"][..], &["info", "a.exr"], &["compare", "a.exr", "a.exr", "--json"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let run = Run::of(program(&folder).args(args).stdout(full));
        assert_eq!(run.code, Some(1), "{run}");
        assert!(run.stderr.starts_with("error: standard output: cannot be written: "), "{run}");
    }
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
    let run = Run::of(program(&folder).args(["render", "scene.toml", "-o", "b.exr"]).stderr(full));
    assert_eq!(run.code, Some(0), "{run}");
}
