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
    refused(&["--set", "light[3].radius=1"], "--set light[3].radius=1: there is no entry 3 in a list of 1\n");
    refused(&["--set", "light[-1].radius=1"], "--set light[-1].radius=1: a list has entries [0], [1]");
    refused(&["--set", "medium.scattering.x=1"], "--set medium.scattering.x=1: there is no medium.scattering.x");
    refused(&["--set", "medium.scattering.x.y=1"], "--set medium.scattering.x.y=1: a plain value has no x\n");
}

#[test]
fn an_override_is_checked_like_the_scene() {
    refused(&["--set", "light[0].radius=-1"], "--set light[0].radius=-1: light[0].radius is -1.0\n");
    refused(
        &["--set", "camera=3"],
        "--set camera=3: camera: this is the whole number `3`, expected a table, or the name of a camera in geometry\n",
    );
    refused(&["--set", "medium.absorption=[1, -2, 3]"], "--set medium.absorption=[1, -2, 3]: medium.absorption is");
    refused(&["--technique", "bdpt"], "--technique bdpt: render.technique: unknown name `bdpt`");
    refused(&["--mesc", "0"], "--mesc 0: render.mesc is 0.0\n");
    for (flag, key, range) in [
        ("--max-segments", "max_segments", "from 1 to 65536 or \"auto\""),
        ("--samples", "samples", "from 1 to 2147483648"),
    ] {
        for number in ["-1", "0", "2147483649", "99999999999999999999", "-99999999999999999999"] {
            let finding = format!("out of range\n  help: give a whole number {range}\n");
            refused(&[flag, number], &format!("{flag} {number}: is {finding}"));
            let set = format!("render.{key}={number}");
            let finding = match number.len() {
                ..19 => format!("render.{key}: {number} is {finding}"),
                _ => format!("{number} is out of range\n  help: give a number of at most 64 bits\n"),
            };
            refused(&["--set", &set], &format!("--set {set}: {finding}"));
        }
    }
    for seed in ["-1", "4294967296", "99999999999999999999"] {
        let finding = "is out of range\n  help: give a whole number from 0 to 4294967295\n";
        refused(&["--seed", seed], &format!("--seed {seed}: {finding}"));
    }
    for written in ["medium.scattering=.3", "medium.scattering=3.", "light[0].radiance=[1, .5, 1]"] {
        refused(
            &["--set", written],
            &format!("--set {written}: digits of a number are missing here\n  help: give a number"),
        );
    }
    for value in ["0xFFFFFFFFFFFFFFFFFF", "{ radius = 99999999999999999999 }"] {
        let set = format!("light[0]={value}");
        let finding = format!("--set {set}: ");
        let run = Folder::with_scene().run(&["render", "scene.toml", "-o", "a.exr", "--set", &set]);
        assert!(run.stderr.starts_with(&format!("error: {finding}")) && run.stderr.contains("out of range"), "{run}");
    }
    refused(&["--size", "0x0"], "--size 0x0: film.size[0]: 0 is out of range\n  help: give a whole number from 1 to");
    refused(&["--size", "4000000000x4"], "--size 4000000000x4: film.size[0]: 4000000000 is out of range\n");
    refused(&["--size", "20000x20000"], "--size 20000x20000: film.size is [20000, 20000]\n");
}

#[test]
fn an_override_with_a_second_line_does_not_smuggle_another() {
    let folder = Folder::with_scene();
    let run = folder.run(&["render", "scene.toml", "--set", "render.samples=1\nrender.seed=2"]);
    assert!(run.code == Some(2) && run.stderr.contains("this is the string \"1\\nrender.seed=2\""), "{run}");
}

#[test]
fn a_flag_and_an_override_do_not_contradict_each_other() {
    for (flags, beginning) in [
        (["--samples", "4", "--set", "render.samples=8"], "--samples 4: contradicts --set render.samples=8\n"),
        (["--size", "8x8", "--set", "film.size[1]=9"], "--size 8x8: contradicts --set film.size[1]=9\n"),
        (["--seed", "3", "--set", "render={ seed = 4 }"], "--seed 3: contradicts --set render={ seed = 4 }\n"),
        (
            ["--technique", "nee", "--set", "render.technique=[\"nee\", \"mvnee\"]"],
            "--technique nee: contradicts --set render.technique=[\"nee\", \"mvnee\"]\n",
        ),
    ] {
        refused(&flags, beginning);
    }
    let folder = Folder::with_scene();
    let same =
        ["--set", "render.samples=2", "--set", "render.technique=[\"nee\", \"mvnee\"]", "--set", "render.mesc=4"];
    let flags = ["--samples", "2", "--technique", "nee,mvnee", "--mesc", "4.0"];
    folder.done(&[&["render", "scene.toml", "-o", "a.exr"][..], &same, &flags].concat());
}

#[test]
fn a_technique_is_named_once() {
    refused(
        &["--technique", "nee,mvnee,nee"],
        "--technique nee,mvnee,nee: render.technique is a list that names nee twice",
    );
}

#[test]
fn an_override_may_begin_a_table() {
    let folder = Folder::empty();
    let scene = super::support::SCENE.replace(
        "[medium]\nscattering = 0.7\nabsorption = 0.3\nphase = { type = \"henyey_greenstein\", g = 0.5 }\n",
        "",
    );
    assert!(!scene.contains("medium"));
    folder.write("vacuum.toml", scene);
    folder.write("scene.toml", super::support::SCENE);
    let fog = [
        "--set",
        "medium.phase.g=0.5",
        "--set",
        "medium.scattering=0.7",
        "--set",
        "medium.absorption=0.3",
        "--progress",
        "none",
    ];
    folder.done(&[&["render", "vacuum.toml", "-o", "a.exr"], &fog[..]].concat());
    folder.done(&["render", "scene.toml", "-o", "b.exr"]);
    assert_eq!(folder.image("a.exr").channels, folder.image("b.exr").channels);
    let isotropic = [&["--set", "medium.phase.type=henyey_greenstein"], &fog[2..]].concat();
    folder.done(&[&["render", "vacuum.toml", "-o", "c.exr"], &isotropic[..]].concat());
    folder.done(&["render", "scene.toml", "-o", "d.exr", "--set", "medium.phase.g=0"]);
    assert_eq!(folder.image("c.exr").channels, folder.image("d.exr").channels, "g is 0 unless it is given");
    let run = folder.done(&["render", "vacuum.toml", "-o", "c.exr", "--set", "medium.phase.g=0.5"]);
    let warning = "warning: --set medium.phase.g=0.5: medium has neither scattering nor absorption, so it is vacuum\n";
    assert!(run.stderr.starts_with(warning), "{run}");
}

#[test]
fn a_very_long_key_is_refused_at_once() {
    let set = format!("{}a=1", "a.".repeat(50_000));
    refused(&["--set", &set], &format!("--set {set}: the key has 50001 parts, more than any key of a scene\n"));
}

#[test]
fn a_value_that_does_not_parse_comes_with_an_example() {
    for size in ["8", "x", "-1x1", "8x8x8", "4294967296x1"] {
        refused(&["--size", size], &format!("--size {size}: is not a size\n  help: give width and height"));
    }
    for crop in ["1,2,3", "a,b,c,d", "-1,0,1,1"] {
        refused(&["--crop", crop], &format!("--crop {crop}: is not a crop window\n  help: give X0,Y0,X1,Y1"));
    }
    for time in ["5", "abc", "-1s", "1h2"] {
        refused(&["--time", time], &format!("--time {time}: is not a duration\n  help: give numbers with units"));
    }
    refused(&["--time", "99999999999999999999s"], "--time 99999999999999999999s: is too long or too short\n");
    for noise in ["0", "-1", "nan", "inf", "x"] {
        refused(&["--noise", noise], &format!("--noise {noise}: is not a fraction above 0\n"));
    }
    for threads in ["0", "-1", "1025", "many", "1.5"] {
        refused(&["--threads", threads], &format!("--threads {threads}: is not a valid number of threads\n"));
    }
    for flag in ["--samples", "--max-segments", "--seed"] {
        refused(&[flag, "1.5"], &format!("{flag} 1.5: is not a whole number\n  help: give a whole number from "));
    }
    refused(&["--mesc", "x"], "--mesc x: is not a number\n");
    refused(
        &["--progress", "loud"],
        "--progress loud: is not one of the choices\n  help: choose one of auto, bar, plain, json",
    );
}

#[test]
fn a_stage_that_does_not_exist_is_answered_with_those_that_do() {
    let folder = Folder::with_scene();
    let beginning = "--reference nosuchstage: is not a stage\n";
    let run = folder.refused(&["render", "scene.toml", "--reference", "nosuchstage"], 2, beginning);
    assert!(run.stderr.contains("mis_weight, phase_quotient, roulette, occlusion"), "{run}");
}

#[test]
fn a_window_lies_inside_the_image() {
    for crop in ["0,0,9,8", "4,4,4,4", "5,0,4,8", "8,8,9,9"] {
        refused(
            &["--crop", crop],
            &format!("--crop {crop}: the window is empty or reaches outside the image of 8x8 pixels"),
        );
    }
}

#[test]
fn samples_are_either_a_number_or_a_range() {
    let folder = Folder::with_scene();
    let run = folder.run(&["render", "scene.toml", "--samples", "1", "--sample-range", "0..4"]);
    assert!(run.code == Some(2) && run.stderr.contains("cannot be used with"), "{run}");
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
