//! `--frames`: animations of glTF files, frame by frame.

use serde_json::{Value, json};

use super::models::{SMALL, with_model};
use super::support::{Folder, assert_same_bits, header, mean};

/// Adds an animation of four seconds to the model: the wall comes nearer, the lamp rises, the camera turns at once.
fn animate(model: &mut Value) {
    let numbers: [f32; 16] = [
        0.0, 4.0, /* wall */ 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, /* lamp */ 1.0, 0.0, 0.0, 1.0, 0.25, 0.0,
        /* eye */ 0.0, 2.0,
    ];
    let turns: [f32; 8] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = numbers.iter().chain(&turns).flat_map(|x| x.to_le_bytes()).collect();
    let uri = format!("data:application/octet-stream;base64,{}", super::models::encoded(&bytes));
    let add = |model: &mut Value, list: &str, object: Value| {
        let list = model[list].as_array_mut().expect("a list");
        list.push(object);
        list.len() - 1
    };
    let buffer = add(model, "buffers", json!({ "uri": uri, "byteLength": bytes.len() }));
    let mut accessor = |first: usize, shape: &str, components: usize| {
        let place = json!({ "buffer": buffer, "byteOffset": 4 * first, "byteLength": 8 * components });
        let view = add(model, "bufferViews", place);
        add(model, "accessors", json!({ "bufferView": view, "componentType": 5126, "type": shape, "count": 2 }))
    };
    let (slow, wall, lamp) = (accessor(0, "SCALAR", 1), accessor(2, "VEC3", 3), accessor(8, "VEC3", 3));
    let (late, eye) = (accessor(14, "SCALAR", 1), accessor(16, "VEC4", 4));
    model["animations"] = json!([
        {
            "samplers": [{ "input": slow, "output": wall }, { "input": slow, "output": lamp }],
            "channels": [
                { "sampler": 0, "target": { "node": 0, "path": "translation" } },
                { "sampler": 1, "target": { "node": 2, "path": "translation" } },
            ],
        },
        {
            "samplers": [{ "input": late, "output": eye, "interpolation": "STEP" }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "rotation" } }],
        },
    ]);
}

pub fn animated() -> Folder {
    with_model(animate)
}

/// Flags of a render of four frames a second.
pub fn flags<'a>(output: &'a str, frames: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let base = ["render", "room.gltf", "-o", output, "--frames", frames, "--fps", "4"];
    let is_given = |flag| more.contains(&flag) || (flag == "--samples" && more.contains(&"--sample-range"));
    let settings = SMALL.chunks(2).chain([&["--samples", "4"][..]]).filter(|setting| !is_given(setting[0]));
    let own: Vec<_> = settings.flatten().copied().collect();
    [&base[..], &own, more].concat()
}

#[test]
fn a_frame_has_the_bits_of_a_static_scene_with_these_transforms() {
    let folder = animated();
    let run = folder.done(&flags("a.####.exr", "0-20", &["--stats", "s#.json"]));
    assert!(!run.stderr.contains("warning"), "{run}");
    assert_eq!(run.stderr.lines().count(), 21, "{run}");
    // The last one is beyond the end.
    for (frame, wall, lamp, is_turned) in [
        (0, 0.0, 0.0, false),
        (1, 0.0625, 0.015625, false),
        (7, 0.4375, 0.109375, false),
        (8, 0.5, 0.125, true),
        (20, 1.0, 0.25, true),
    ] {
        let baked = with_model(|model| {
            model["nodes"][0]["translation"] = json!([0, 0, wall]);
            model["nodes"][1]["rotation"] = if is_turned { json!([0, 0, 1, 0]) } else { json!([0, 0, 0, 1]) };
            model["nodes"][2]["translation"] = json!([1, lamp, 0]);
        });
        baked.done(&[&["render", "room.gltf", "-o", "a.exr", "--samples", "4"], &SMALL[..]].concat());
        let (moment, baked) = (folder.image(&format!("a.{frame:04}.exr")), baked.image("a.exr"));
        assert!(mean(&moment, "R") > 0.0 && moment.channels == baked.channels, "frame {frame}");
        assert_eq!(header(&moment, "scene_hash"), header(&baked, "scene_hash"), "frame {frame}");
        assert_eq!(header(&moment, "frame"), frame.to_string());
        let statistics = std::fs::read(folder.path(&format!("s{frame}.json"))).expect("statistics");
        assert_eq!(serde_json::from_slice::<Value>(&statistics).expect("JSON")["frame"], frame);
    }
    assert!(folder.image("a.0001.exr").channels != folder.image("a.0002.exr").channels, "something moves");
}

#[test]
fn a_single_frame_and_other_rates_are_the_same_moments() {
    let folder = animated();
    folder.done(&flags("a#.exr", "6", &[]));
    let eighths = ["render", "room.gltf", "-o", "b#.exr", "--frames", "12", "--fps", "8", "--samples", "4"];
    folder.done(&[&eighths[..], &SMALL[..]].concat());
    assert_same_bits(&folder, "a6.exr", "b12.exr");
    let default = ["render", "room.gltf", "--frames", "36", "--samples", "4"];
    folder.done(&[&default[..], &SMALL[..]].concat());
    assert_same_bits(&folder, "a6.exr", "room.0036.exr");
}

#[test]
fn a_scene_that_names_its_geometry_moves_too() {
    let folder = animated();
    folder.write("scene.toml", "geometry = \"room.gltf\"\n[render]\ntechnique = \"nee\"\nsamples = 4\n");
    folder.done(&["render", "scene.toml", "-o", "b#.exr", "--frames", "5", "--fps", "4", "--size", "6x4"]);
    folder.done(&flags("a#.exr", "5", &[]));
    assert_same_bits(&folder, "a5.exr", "b5.exr");
}

#[test]
fn frames_need_names_of_their_own() {
    let folder = animated();
    let place = "--output a.exr: names one file for all frames\n  \
                 help: put #### where the number of the frame goes, as in a.####.exr";
    folder.refused(&flags("a.exr", "1-2", &[]), 2, place);
    folder.refused(&flags("a#.exr", "1", &["-o", "b.png"]), 2, "--output b.png: names one file for all frames");
    folder.refused(&flags("a#.exr", "1", &["--stats", "s.json"]), 2, "--stats s.json: names one file for all frames");
}

#[cfg(unix)]
#[test]
fn a_pipe_takes_one_frame_after_the_other() {
    let folder = animated();
    let output = super::support::program(&folder).args(flags("png:/dev/stdout", "0-2", &[])).output().expect("a run");
    let images = output.stdout.windows(8).filter(|window| window == b"\x89PNG\r\n\x1a\n").count();
    assert_eq!((output.status.code(), images), (Some(0), 3));
}

#[test]
fn frames_that_are_no_frames_are_refused() {
    let folder = animated();
    for wrong in ["", "x", "1.5", "1-x", "-1", "1-", "0..3", "4294967296"] {
        let flag = format!("--frames={wrong}");
        let expected = format!("--frames {wrong}: is not a range of frames");
        folder.refused(&["render", "room.gltf", "-o", "a#.exr", &flag], 2, &expected);
    }
    folder.refused(&flags("a#.exr", "5-3", &[]), 2, "--frames 5-3: ends before it begins");
    for wrong in ["0", "-1", "x", "inf"] {
        let flag = format!("--fps={wrong}");
        let expected = format!("--fps {wrong}: is not a number above 0");
        folder.refused(&["render", "room.gltf", "-o", "a#.exr", "--frames", "1", &flag], 2, &expected);
    }
    let run = folder.run(&["render", "room.gltf", "-o", "a.exr", "--fps", "24"]);
    assert!(run.code == Some(2) && run.stderr.contains("--frames"), "{run}");
}

#[test]
fn frames_that_are_there_count_as_progress() {
    let folder = animated();
    folder.done(&flags("a#.exr", "1-2", &[]));
    let render = |style| folder.done(&flags("a#.exr", "1-4", &["--resume", "--progress", style]));
    let run = render("openjd");
    let percents: Vec<_> = run.stdout.lines().filter_map(|line| line.strip_prefix("openjd_progress: ")).collect();
    assert_eq!(percents, ["25.00", "50.00", "75.00", "100.00"], "{run}");
    let run = render("alf");
    assert_eq!(run.stdout, "ALF_PROGRESS 25%\nALF_PROGRESS 50%\nALF_PROGRESS 75%\nALF_PROGRESS 100%\n", "{run}");
    let run = render("json");
    let messages = run.stderr.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let done: Vec<_> = messages.filter(|message| message["event"] == "progress").collect();
    assert_eq!(done.len(), 4, "{run}");
    for (message, place) in done.iter().zip(1..) {
        assert_eq!((&message["frame"]["place"], &message["fraction"]), (&json!(place), &json!(1.0)), "{run}");
    }
}

#[test]
fn info_says_how_long_animations_are_and_what_they_move() {
    let lines = |folder: &Folder| {
        let run = folder.done(&["info", "room.gltf"]);
        let lines = run.stdout.lines().filter(|line| line.starts_with("animation"));
        lines.map(String::from).collect::<Vec<_>>()
    };
    let moves = |wall: &str| format!("animation 0: 4 s, frames 0-96 at 24 per second; moves {wall}, node 2 \"Lamp\"");
    let turn = "animation 1: 2 s, frames 0-48 at 24 per second; moves camera \"Eye\"".to_string();
    assert_eq!(lines(&animated()), [moves("node 0 \"Wall\""), turn.clone()]);
    let above = with_model(|model| {
        animate(model);
        model["animations"][1]["name"] = "Turn".into();
        model["nodes"][0]["children"] = json!([1]);
        model["scenes"][0]["nodes"] = json!([0, 2]);
    });
    let turn = turn.replace("animation 1:", "animation 1 \"Turn\":");
    assert_eq!(lines(&above), [moves("camera \"Eye\", node 0 \"Wall\""), turn], "the camera is below the wall");
    let strange = with_model(|model| {
        animate(model);
        model["animations"][0]["samplers"][1]["input"] = json!(99);
        model["animations"][1]["channels"][0]["target"] = json!({ "path": "pointer" });
    });
    let unplayable = moves("node 0 \"Wall\"").replace("4 s, frames 0-96 at 24 per second", "cannot be played");
    assert_eq!(lines(&strange), [unplayable.as_str(), "animation 1: 2 s, frames 0-48 at 24 per second; moves nothing"]);
    assert_eq!(lines(&with_model(|_| {})), [""; 0]);
}

#[test]
fn a_malformed_animation_names_its_place() {
    let folder = with_model(|model| {
        animate(model);
        model["animations"][1]["channels"][0]["target"]["node"] = json!(9);
    });
    let place = "room.gltf: animation 1, channel 0: refers to node 9, but the last one is 2";
    folder.refused(&flags("a#.exr", "1-2", &[]), 1, place);
}

#[test]
fn nothing_that_moves_is_a_warning_told_once() {
    let folder = with_model(|_| {});
    let run = folder.done(&flags("a#.exr", "1-3", &[]));
    let warnings: Vec<_> = run.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert_eq!(warnings, ["warning: room.gltf: animations: there are none: all frames are alike"], "{run}");
    let folder = Folder::with_scene();
    let run = folder.done(&["render", "scene.toml", "-o", "a#.exr", "--frames", "1-2"]);
    assert!(run.stderr.contains("nothing moves: there is no geometry"), "{run}");
}

#[test]
fn png_images_that_may_flicker_are_told_of_once() {
    let folder = animated();
    let flicker = "warning: PNG images of frames are each exposed for themselves: give all the same --exposure";
    let told = |frames: &str, more: &[&str]| {
        let run = folder.done(&flags("a#.png", frames, more));
        run.stderr.lines().filter(|line| *line == flicker).count()
    };
    assert_eq!([told("1-3", &[]), told("1-3", &["--exposure", "1"]), told("1", &[])], [1, 0, 0]);
    let [one, other] = ["a1.png", "a3.png"].map(|name| folder.png(name).0.uncompressed_latin1_text[0].text.clone());
    assert!(one != other, "{one} is what it is metered at, {other} what it is told");
}

#[test]
fn frames_are_no_parts_of_each_other() {
    let folder = with_model(|_| {});
    for (frame, samples) in [("1", "0..2"), ("2", "2..4")] {
        let base = ["render", "room.gltf", "-o", "a#.exr", "--frames", frame, "--sample-range", samples];
        folder.done(&[&base[..], &SMALL[..]].concat());
    }
    let expected = "a2.exr: does not belong to the same render as a1.exr: frame is 1 there, 2 here";
    folder.refused(&["merge", "a1.exr", "a2.exr", "-o", "b.exr"], 1, expected);
    let base = ["render", "room.gltf", "-o", "c#.exr", "--frames", "1", "--sample-range", "2..4"];
    folder.done(&[&base[..], &SMALL[..]].concat());
    folder.done(&["merge", "a1.exr", "c1.exr", "-o", "b.exr"]);
    assert_eq!(
        (header(&folder.image("b.exr"), "frame"), header(&folder.image("b.exr"), "sample_range")),
        ("1", "0..4")
    );
}

#[test]
fn resume_leaves_out_frames_that_are_there() {
    let folder = animated();
    let there = |more: &[&str]| {
        let run = folder.done(&flags("a#.exr", "1-3", &[&["-o", "b#.png", "--resume"], more].concat()));
        let there = (1..=3).filter(|n| run.stderr.contains(&format!("a{n}.exr, b{n}.png: already there, skipped\n")));
        there.collect::<Vec<_>>()
    };
    assert_eq!(there(&[]), [0; 0]);
    assert_eq!(there(&[]), [1, 2, 3]);
    std::fs::remove_file(folder.path("b2.png")).expect("a file");
    assert_eq!(there(&[]), [1, 3]);
    folder.write("a3.exr", "torn");
    assert_eq!(there(&[]), [1, 2]);
    assert_eq!(there(&["--seed", "5"]), [0; 0], "another render");
    assert_eq!(there(&["--samples", "8"]), [0; 0], "more samples");
    assert_eq!(there(&["--samples", "8"]), [1, 2, 3]);
    assert_eq!(there(&["--samples", "8", "--exposure", "1"]), [0; 0], "another exposure");
    assert_eq!(there(&["--samples", "8", "--noise", "1e-6"]), [0; 0], "another limit");
    folder.done(&flags("a#.exr", "1", &["--sample-range", "4..8"]));
    assert_eq!(there(&["--samples", "4"]), [0; 0], "other samples");
    let run = folder.done(&flags("b#.png", "1", &["--resume"]));
    assert!(!run.stderr.contains("already there, skipped"), "a PNG image does not say what it is of\n{run}");
    let reason = "warning: --resume: images are there that do not say what they are of, and are rendered again; ";
    assert!(run.stderr.contains(reason), "{run}");
}

#[test]
fn progress_says_which_frame_it_is_about() {
    let folder = animated();
    let run = folder.done(&flags("a#.exr", "3-5", &["--progress", "json"]));
    let messages = run.stderr.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let frames: Vec<_> =
        messages.filter(|message| message["event"] == "progress").map(|m| m["frame"].clone()).collect();
    let frame = |number: u32, place: u32| json!({ "number": number, "place": place, "of": 3 });
    assert_eq!(frames, [frame(3, 1), frame(4, 2), frame(5, 3)], "{run}");
    let run = folder.done(&flags("a#.exr", "3-6", &["--progress", "alf"]));
    let lines: Vec<_> = run.stdout.lines().collect();
    assert_eq!(lines, ["25%", "50%", "75%", "100%"].map(|percent| format!("ALF_PROGRESS {percent}")), "{run}");
    let run =
        folder.done(&flags("a#.exr", "3-4", &["--progress", "plain", "--time", "2300ms", "--samples", "999999999"]));
    assert!(run.stderr.contains(" %  frame 1 of 2  ") && run.stderr.contains(" %  frame 2 of 2  "), "{run}");
}

#[cfg(unix)]
#[test]
fn a_signal_ends_all_frames_and_resume_goes_on() {
    use std::process::Command;
    use std::time::{Duration, Instant};
    let folder = animated();
    let more = ["--checkpoint", "1h", "--resume", "--size", "48x32"];
    let child = super::support::program(&folder).args(flags("a###.exr", "0-999", &more)).spawn().expect("a child");
    let start = Instant::now();
    while !folder.path("a002.exr").is_file() {
        assert!(start.elapsed() < Duration::from_secs(60), "it takes too long");
        std::thread::sleep(Duration::from_millis(5));
    }
    Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill");
    let output = child.wait_with_output().expect("a child");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(75), "{stderr}");
    assert!(!folder.path("a999.exr").exists());
    let run = folder.done(&flags("a###.exr", "0-3", &more));
    assert!(
        run.stderr.starts_with(
            "a000.exr: already there, skipped\na001.exr: already there, skipped\na002.exr: already there, skipped\n"
        ),
        "{run}"
    );
    let whole = animated();
    whole.done(&flags("a###.exr", "3", &["--size", "48x32"]));
    assert!(folder.image("a003.exr").channels == whole.image("a003.exr").channels);
}
