//! Wrong flags are usage errors: exit code 2, the flag as it was written, and what would be right.

use super::support::Folder;

#[track_caller]
fn refused(flags: &[&str], beginning: &str) {
    let folder = Folder::with_scene();
    folder.refused(&[&["render", "scene.toml"], flags].concat(), 2, beginning);
}

#[test]
fn an_override_names_a_key_that_exists() {
    refused(&["--set", "foo"], "--set foo: has no '='\n");
    refused(&["--set", "=1"], "--set =1: the key is empty\n");
    refused(&["--set", "foo=1"], "--set foo=1: foo: unknown key `foo`");
    refused(&["--set", "light[3].radius=1"], "--set light[3].radius=1: entry 3 of a list of 1 does not exist\n");
    refused(&["--set", "light[-1].radius=1"], "--set light[-1].radius=1: a list has entries [0], [1]");
    refused(&["--set", "medium.scattering.x=1"], "--set medium.scattering.x=1: there is no medium.scattering.x");
    refused(&["--set", "medium.scattering.x.y=1"], "--set medium.scattering.x.y=1: a plain value has no x\n");
}

#[test]
fn an_override_is_checked_like_the_scene() {
    refused(&["--set", "light[0].radius=-1"], "--set light[0].radius=-1: light[0].radius is -1.0\n");
    refused(
        &["--set", "camera=3"],
        "--set camera=3: camera: this is the whole number `3`, expected a table, or the name of a camera of geometry\n",
    );
    refused(&["--set", "medium.absorption=[1, 2, 3]"], "--set medium.absorption=[1, 2, 3]: extinction");
    refused(&["--technique", "bdpt"], "--technique bdpt: render.technique: unknown name `bdpt`");
    refused(&["--mesc", "0"], "--mesc 0: render.mesc is 0.0\n");
    refused(&["--max-segments", "0"], "--max-segments 0: render.max_segments is 0\n");
    refused(&["--max-segments", "1025"], "--max-segments 1025: render.max_segments is 1025\n");
    refused(&["--samples", "0"], "--samples 0: render.samples is 0\n");
    refused(&["--seed", "-1"], "--seed -1: render.seed: this is the whole number `-1`");
    refused(&["--seed", "4294967296"], "--seed 4294967296: render.seed: ");
    refused(&["--size", "0x0"], "--size 0x0: film.size is [0, 0]\n");
    refused(&["--size", "4000000000x4000000000"], "--size 4000000000x4000000000: film.size is ");
}

#[test]
fn an_override_with_a_second_line_does_not_smuggle_another() {
    let folder = Folder::with_scene();
    let run = folder.run(&["render", "scene.toml", "--set", "render.samples=1\nrender.seed=2"]);
    assert!(run.code == Some(2) && run.stderr.contains("this is the string \"1\\nrender.seed=2\""), "{run}");
}

#[test]
fn a_very_long_key_is_refused_at_once() {
    let set = format!("{}a=1", "a.".repeat(50_000));
    refused(&["--set", &set], &format!("--set {set}: no key has 50001 parts\n"));
}

#[test]
fn a_value_that_does_not_parse_comes_with_an_example() {
    for size in ["8", "x", "-1x1", "8x8x8", "4294967296x1"] {
        refused(&["--size", size], &format!("--size {size}: is no size of an image\n  help: give width and height"));
    }
    for crop in ["1,2,3", "a,b,c,d", "-1,0,1,1"] {
        refused(&["--crop", crop], &format!("--crop {crop}: is no window of an image\n  help: give first column"));
    }
    for time in ["5", "abc", "-1s", "1h2"] {
        refused(&["--time", time], &format!("--time {time}: is no duration: "));
    }
    for noise in ["0", "-1", "nan", "inf", "x"] {
        refused(&["--noise", noise], &format!("--noise {noise}: is no share above 0\n"));
    }
    for threads in ["0", "-1", "1025", "many", "1.5"] {
        refused(&["--threads", threads], &format!("--threads {threads}: is no possible number of threads\n"));
    }
    for flag in ["--samples", "--max-segments", "--seed"] {
        refused(&[flag, "1.5"], &format!("{flag} 1.5: is no whole number\n"));
    }
    refused(&["--mesc", "x"], "--mesc x: is no number\n");
    refused(&["--progress", "loud"], "--progress loud: is no choice\n  help: choices are auto, bar, plain, json");
}

#[test]
fn a_stage_that_does_not_exist_is_answered_with_those_that_do() {
    let folder = Folder::with_scene();
    let beginning = "--reference nosuchstage: is no stage\n";
    let run = folder.refused(&["render", "scene.toml", "--reference", "nosuchstage"], 2, beginning);
    assert!(run.stderr.contains("mis_weight, roulette, occlusion"), "{run}");
}

#[test]
fn a_window_lies_inside_the_image() {
    for crop in ["0,0,9,8", "4,4,4,4", "5,0,4,8", "8,8,9,9"] {
        refused(
            &["--crop", crop],
            &format!("--crop {crop}: the window is empty or not inside the image of 8x8 pixels"),
        );
    }
}

#[test]
fn one_target_is_enough() {
    let folder = Folder::with_scene();
    for flags in [["--samples", "1", "--time", "1s"], ["--noise", "0.1", "--samples", "1"]] {
        let run = folder.run(&[&["render", "scene.toml"], flags.as_slice()].concat());
        assert!(run.code == Some(2) && run.stderr.contains("cannot be used with"), "{run}");
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn unknown_and_missing_arguments_are_usage_errors() {
    let folder = Folder::with_scene();
    for args in [&["render"][..], &["render", "scene.toml", "--nosuch"], &["compare", "a.exr"], &["nosuch"], &[]] {
        let run = folder.run(args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{run}");
        assert!(run.stderr.contains("Usage: fogbow"), "{run}");
    }
}
