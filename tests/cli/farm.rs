//! Renders in many parts, as farms make them: repeated, killed, lost, and put together.

use std::process::Child;
use std::time::{Duration, Instant};

use super::support::{Folder, assert_same_bits, header, program};
use serde_json::Value;

/// Arguments that render `samples` to `name`.
fn part<'a>(name: &'a str, samples: &'a str, flags: &[&'a str]) -> Vec<&'a str> {
    let base = ["render", "scene.toml", "-o", name, "--sample-range", samples, "--progress", "none", "--threads", "1"];
    [&base[..], flags].concat()
}

/// A folder with `count` parts of two samples each, and their names.
fn parts(count: usize, flags: &[&str]) -> (Folder, Vec<String>) {
    let folder = Folder::with_scene();
    let names: Vec<_> = (0..count).map(|index| format!("p{index}.exr")).collect();
    for (index, name) in names.iter().enumerate() {
        folder.done(&part(name, &format!("{}..{}", 2 * index, 2 * index + 2), flags));
    }
    (folder, names)
}

/// Arguments that merge `names`.
fn merge<'a>(names: impl IntoIterator<Item = &'a String>, flags: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["merge"];
    args.extend(names.into_iter().map(String::as_str));
    args.extend(flags);
    args
}

#[test]
fn many_parts_in_any_order_are_one_render() {
    let (folder, names) = parts(40, &[]);
    folder.done(&["render", "scene.toml", "-o", "whole.exr", "--samples", "80"]);
    // 40 and 17 have no divisor in common: every part once, far from its neighbours.
    let shuffled: Vec<_> = (0..40).map(|index| &names[index * 17 % 40]).collect();
    let run = folder.done(&merge(shuffled, &["-o", "merged.exr", "--expect", "0..80"]));
    assert!(run.stderr.starts_with("merged.exr: 40 images, 80 samples per pixel"), "{run}");
    assert_same_bits(&folder, "merged.exr", "whole.exr");
    assert_eq!(header(&folder.image("merged.exr"), "parts"), "40");
    let settings = |name: &str| header(&folder.image(name), "settings").to_string();
    assert_eq!(settings("merged.exr"), settings("whole.exr"));
    let run = folder.done(&["compare", "merged.exr", "whole.exr"]);
    assert!(run.stdout.ends_with("\nthe same exact sums of the same samples\n"), "{run}");
    let same = |a: &str, b: &str| {
        let run = folder.done(&["compare", a, b, "--json"]);
        serde_json::from_str::<Value>(&run.stdout).expect("JSON")["same_sums"].clone()
    };
    assert_eq!((same("merged.exr", "whole.exr"), same("p0.exr", "p1.exr")), (true.into(), false.into()));
    folder.done(&["merge", "--weighted", "p0.exr", "p1.exr", "-o", "mean.exr"]);
    assert_eq!(same("mean.exr", "p1.exr"), Value::Null);
}

#[test]
fn a_merge_that_expects_samples_says_which_are_missing() {
    let (folder, names) = parts(8, &[]);
    let lost =
        |lost: &[usize]| (0..8).filter(|index| !lost.contains(index)).map(|index| &names[index]).collect::<Vec<_>>();
    for (without, ranges, first, more) in
        [(&[7][..], "14..16", "14..16", ""), (&[0, 3, 4], "0..2, 6..10", "0..2", " and so on")]
    {
        let args = merge(lost(without), &["-o", "x.exr", "--expect", "0..16"]);
        let finding = format!("--expect 0..16: samples {ranges} are missing from every pixel\n");
        let run = folder.refused(&args, 1, &finding);
        let remedy = format!("  help: render them with --sample-range {first}{more}, and merge again\n");
        assert!(run.stderr.ends_with(&remedy), "{run}");
    }
    let finding = "--expect 0..14: the parts have samples 0..16\n";
    folder.refused(&merge(&names, &["-o", "x.exr", "--expect", "0..14"]), 1, finding);
    folder.done(&merge(lost(&[0, 7]), &["-o", "x.exr", "--expect", "2..14"]));
    folder.refused(&merge(&names, &["-o", "x.exr", "--expect", "4"]), 2, "--expect 4: is not a range of samples");
    // What was rendered again under another name is no further part.
    std::fs::copy(folder.path("p3.exr"), folder.path("again.exr")).expect("a copy");
    let args = merge(&names, &["again.exr", "-o", "y.exr", "--expect", "0..16"]);
    folder.refused(&args, 1, "again.exr: has samples 6..8, which p3.exr has, too");
    folder.done(&part("crop.exr", "0..2", &["--crop", "0,0,4,8"]));
    let finding = "--expect 0..16: samples 0..2 are missing from 32 of the 64 pixels (columns 4..8, rows 0..8)\n";
    let run = folder.refused(&merge(&names[1..], &["crop.exr", "-o", "z.exr", "--expect", "0..16"]), 1, finding);
    let remedy = "  help: render them with --crop 4,0,8,8 --sample-range 0..2, and merge again\n";
    assert!(run.stderr.ends_with(remedy), "{run}");
}

#[test]
fn a_merge_that_expects_samples_misses_crops_at_the_border() {
    let folder = Folder::with_scene();
    for (name, crop) in [("left.exr", "0,0,4,8"), ("top.exr", "4,0,8,3"), ("bottom.exr", "4,3,8,8")] {
        folder.done(&part(name, "0..2", &["--crop", crop]));
    }
    let expect = |parts: &[&'static str], more: &[&'static str]| {
        [&["merge", "-o", "x.exr", "--expect", "0..2"], parts, more].concat()
    };
    for (parts, pixels, crop, remedy) in [
        (&["left.exr"][..], "32 of the 64 pixels (columns 4..8, rows 0..8)", "4,0,8,8", Some("0,0,4,8")),
        (&["left.exr", "bottom.exr"], "12 of the 64 pixels (columns 4..8, rows 0..3)", "4,0,8,3", None),
        (
            &["top.exr"],
            "52 of the 64 pixels (columns 0..4, rows 0..3; columns 0..8, rows 3..8)",
            "0,0,4,3 and",
            Some("4,0,8,3"),
        ),
    ] {
        let finding = format!("--expect 0..2: samples 0..2 are missing from {pixels}\n");
        let run = folder.refused(&expect(parts, &[]), 1, &finding);
        let has_remedy = run.stderr.contains(&format!("  help: render them with --crop {crop}"));
        let end = remedy.map_or("merge again\n".into(), |crop| format!("are wanted, merge with --crop {crop}\n"));
        assert!(has_remedy && run.stderr.ends_with(&end), "{run}");
    }
    let finding = "--expect 0..2: the parts have more pixels than that (columns 0..8, rows 0..8)\n";
    let all = ["left.exr", "top.exr", "bottom.exr"];
    folder.refused(&expect(&all, &["--crop", "0,0,4,8"]), 1, finding);
    folder.refused(&expect(&all, &["--crop", "0,0,4,9"]), 2, "--crop 0,0,4,9: the window is empty or reaches outside");
    let run = folder.done(&expect(&all, &[]));
    assert!(!run.stderr.contains("warning"), "{run}");
    let run = folder.done(&expect(&["left.exr"], &["--crop", "0,0,4,8"]));
    assert!(!run.stderr.contains("warning"), "{run}");
    assert_same_bits(&folder, "x.exr", "left.exr");
    assert_eq!(folder.run(&["merge", "left.exr", "-o", "x.exr", "--crop", "0,0,4,8"]).code, Some(2));
}

#[test]
fn two_renders_to_the_same_file_at_once_leave_a_whole_one() {
    let folder = Folder::with_scene();
    let flags = ["--checkpoint", "1ms", "--resume", "--size", "32x32"];
    folder.done(&part("alone.exr", "3..40", &flags));
    for _ in 0..3 {
        let start = || program(&folder).args(part("p.exr", "3..40", &flags)).spawn().expect("the program starts");
        let both = [start(), start()];
        for child in both {
            let output = child.wait_with_output().expect("a child");
            assert!(output.status.success(), "{output:?}");
        }
        assert_same_bits(&folder, "p.exr", "alone.exr");
        folder.done(&["merge", "p.exr", "-o", "merged.exr", "--expect", "3..40"]);
    }
    // Whichever was last to write a checkpoint may have left it there, whole.
    let checkpoint = folder.path("p.exr.checkpoint");
    assert!(!checkpoint.exists() || fogbow::session::checkpoint::Checkpoint::open(&checkpoint).is_ok());
}

#[test]
fn a_part_that_is_rendered_again_and_killed_stays_whole() {
    let (folder, names) = parts(3, &["--size", "96x96"]);
    folder.done(&["render", "scene.toml", "-o", "whole.exr", "--samples", "6", "--size", "96x96"]);
    for wait in (0..60).step_by(5) {
        let mut again: Child =
            program(&folder).args(part("p1.exr", "2..4", &["--size", "96x96"])).spawn().expect("the program starts");
        std::thread::sleep(Duration::from_millis(wait));
        again.kill().and_then(|()| again.wait()).expect("a child");
        folder.done(&merge(&names, &["-o", "merged.exr", "--expect", "0..6"]));
        assert_same_bits(&folder, "merged.exr", "whole.exr");
    }
    std::fs::remove_file(folder.path("p1.exr")).expect("a file");
    let names: Vec<_> = names.iter().filter(|name| folder.path(name).exists()).collect();
    folder.refused(
        &merge(names, &["-o", "x.exr", "--expect", "0..6"]),
        1,
        "--expect 0..6: samples 2..4 are missing from every pixel\n",
    );
}

/// Most memory that a run of the program has had, as often as it was looked at [kB].
#[cfg(target_os = "linux")]
fn peak(folder: &Folder, args: &[&str]) -> u64 {
    let mut child = program(folder).args(args).spawn().expect("the program starts");
    let (path, start, mut peak) = (format!("/proc/{}/status", child.id()), Instant::now(), 0);
    while child.try_wait().expect("a child").is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "{args:?} hangs");
        let status = std::fs::read_to_string(&path).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let number = line.and_then(|line| line.trim().split(' ').next()?.parse().ok());
        peak = peak.max(number.unwrap_or(0));
        std::thread::sleep(Duration::from_millis(1));
    }
    let output = child.wait_with_output().expect("a child");
    assert!(output.status.success(), "{output:?}");
    peak
}

#[cfg(target_os = "linux")]
#[test]
fn merging_more_parts_takes_no_more_memory() {
    // All pixels of 14 parts would be 70 MB, those of 48 images without their sums 83 MB.
    const MARGIN: u64 = 32 << 10;
    let (folder, names) = parts(16, &["--size", "256x256", "--technique", "path"]);
    let few = peak(&folder, &merge(&names[..2], &["-o", "few.exr"]));
    let many = peak(&folder, &merge(&names, &["-o", "many.exr"]));
    assert!(many < few + MARGIN, "{few} kB for 2 parts, {many} kB for 16");
    let weighted = |count| peak(&folder, &merge(vec![&names[0]; count], &["--weighted", "-o", "mean.exr"]));
    let (few, many) = (weighted(2), weighted(50));
    assert!(many < few + MARGIN, "{few} kB for 2 images, {many} kB for 50");
}
