//! Several renders to the same output: none does harm to the checkpoint of another.

use std::fs;

use fogbow::session::checkpoint::{Checkpoint, Slot};
use fogbow::session::{Session, Settings};
use fogbow::{Limits, Scene, Target};

use super::support::Folder;

/// A session of the small scene with so many samples.
fn session(folder: &Folder, seed: i64, samples: u32) -> Session {
    let mut scene = Scene::load(folder.path("scene.toml")).expect("a scene");
    scene.set("render.seed", seed).expect("a key");
    let mut session = Session::new(scene.loaded().clone(), Settings::default()).expect("memory");
    session.prepare(false, Limits::default(), |_| {});
    session.run(Target::Samples(samples), || false, |_| {});
    session
}

#[test]
fn the_run_that_is_further_along_has_the_checkpoint() {
    let folder = Folder::with_scene();
    let path = folder.path("c");
    let [few, some, many] = [3, 5, 9].map(|samples| session(&folder, 1, samples));
    let content = || fs::read(&path).expect("a checkpoint");
    let [first, second, third] = [(); 3].map(|()| Slot::new(path.clone()));
    assert_eq!(first.write(&some), Ok(true), "nothing is there");
    let before = content();
    assert_eq!(second.write(&few), Ok(false), "it is behind");
    assert_eq!(content(), before);
    assert_eq!(third.write(&many), Ok(true), "it is ahead");
    assert_ne!(content(), before);
    assert_eq!(third.write(&few), Ok(true), "it is its own");
    assert_eq!(first.remove().ok(), Some(false), "it is another's");
    assert!(path.exists());
    second.adopt(&Checkpoint::open(&path).expect("a checkpoint"));
    assert_eq!(second.write(&few), Ok(true), "it goes on from there");
    assert_eq!((third.remove().ok(), second.remove().ok(), path.exists()), (Some(false), Some(true), false));
    assert_eq!(first.remove().ok(), Some(true), "nothing is there");
}

#[test]
fn what_is_not_of_this_render_stays_unless_told_otherwise() {
    let folder = Folder::with_scene();
    let path = folder.path("c");
    let (own, other) = (session(&folder, 1, 9), session(&folder, 2, 1));
    let slot = Slot::new(path.clone());
    other.write_checkpoint(&path).expect("written");
    let foreign = fs::read(&path).expect("a checkpoint");
    for (content, finding) in [
        (&foreign[..], "is the checkpoint of another render, and is left alone: render.seed is 2 there, 1 here"),
        (&b"notes"[..], "is a truncated checkpoint, and nothing that this render has written; it is left alone"),
        (&[7; 99][..], "is not a checkpoint, and nothing that this render has written; it is left alone"),
    ] {
        fs::write(&path, content).expect("a file");
        let error = slot.write(&own).expect_err(finding);
        assert_eq!(error.finding, finding);
        assert_eq!(slot.remove().ok(), Some(false));
        assert_eq!(fs::read(&path).expect("a file"), content);
    }
    assert_eq!(folder.names(), ["c", "scene.toml"], "nothing is left over");
    slot.clear();
    assert_eq!(slot.write(&own), Ok(true), "it was told to");
}

#[cfg(unix)]
#[test]
fn another_render_neither_replaces_nor_removes_a_checkpoint() {
    use super::children::{ended_by, flags, handles_sigusr1, send, spawn, started, wait_for};
    let folder = Folder::with_scene();
    let seconds = |time| ["--seed", "2", "--checkpoint", "1h", "--time", time];
    // Both begin before there is a checkpoint.
    let [stopped, done] = ["1h", "4s"].map(|time| spawn(&folder, "a.exr", &seconds(time)));
    wait_for("the handlers", || handles_sigusr1(&stopped) && handles_sigusr1(&done));
    let first = started(&folder, "a.exr", &["--samples", "100000000", "--checkpoint", "20ms"]);
    send("-STOP", &first);
    let path = folder.path("a.exr.checkpoint");
    let checkpoint = fs::read(&path).expect("a checkpoint");
    send("-USR1", &stopped);
    let output = done.wait_with_output().expect("a child");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("a.exr.checkpoint: is a checkpoint of another run, and is left alone\n"), "{stderr}");
    let (code, stderr) = ended_by("-TERM", stopped);
    assert_eq!(code, Some(143), "it has no checkpoint: {stderr}");
    let difference = "is the checkpoint of another render, and is left alone: render.seed is 1 there, 2 here";
    let warning =
        format!("warning: no checkpoint could be written: a.exr.checkpoint: {difference}; the render goes on");
    assert_eq!(stderr.matches(&warning).count(), 1, "{stderr}");
    assert!(fs::read(&path).expect("a checkpoint") == checkpoint, "it is still there");
    send("-CONT", &first);
    let (code, stderr) = ended_by("-TERM", first);
    assert_eq!(code, Some(75), "{stderr}");
    let run = folder.done(&flags("a.exr", &["--time", "1ms", "--resume"]));
    assert!(run.stderr.contains("going on after "), "{run}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_checkpoint_that_cannot_be_read_is_not_told_to_be_anothers() {
    use super::children::started;
    use std::collections::BTreeSet;
    use std::process::Command;
    use std::thread::sleep;
    use std::time::Duration;
    let folder = Folder::with_scene();
    let child = started(&folder, "a.exr", &["--time", "3s", "--checkpoint", "100ms"]);
    let id = child.id().to_string();
    let files = || {
        sleep(Duration::from_millis(2));
        let entries = fs::read_dir(format!("/proc/{id}/fd")).expect("a process");
        let numbers = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
        numbers.collect::<BTreeSet<u32>>()
    };
    let limit = |files: u32| {
        let limit = format!("--nofile={files}:4096");
        Command::new("prlimit").args(["--pid", &id, &limit]).status().is_ok_and(|status| status.success())
    };
    // There is one number for the next checkpoint, and none to look at what is there.
    let least = (0..50).map(|_| files()).min_by_key(BTreeSet::len).expect("files");
    let free = (0..).find(|number| !least.contains(number)).expect("a number");
    let is_limited = limit(free + 1);
    sleep(Duration::from_millis(700));
    assert!(!is_limited || limit(1024));
    let output = child.wait_with_output().expect("a child");
    if !is_limited {
        fogbow_testing::not_run::not_run("there is no prlimit");
        return;
    }
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let warning = "no checkpoint could be written: a.exr.checkpoint: cannot be read, and is left alone: Too many open";
    assert!(stderr.contains(warning), "{stderr}");
    assert_eq!(folder.names(), ["a.exr", "scene.toml"], "there was room again: {stderr}");
}

#[test]
fn a_checkpoint_is_found_beside_any_output() {
    let folder = Folder::with_scene();
    let render = |more: &[&str]| folder.run(&[&["render", "scene.toml", "--samples", "9"], more].concat());
    session(&folder, 1, 5).write_checkpoint(&folder.path("p.png.checkpoint")).expect("written");
    let run = render(&["-o", "p.exr", "-o", "p.png"]);
    assert!(run.stderr.starts_with("error: p.png.checkpoint: is a checkpoint of this render"), "{run}");
    let run = render(&["-o", "p.exr", "-o", "p.png", "--resume"]);
    assert!(run.code == Some(0) && run.stderr.contains("going on after 5 samples per pixel\n"), "{run}");
    assert_eq!(folder.names(), ["p.exr", "p.png", "scene.toml"]);
    render(&["-o", "whole.exr"]);
    super::support::assert_same_bits(&folder, "p.exr", "whole.exr");
    for name in ["p.exr.checkpoint", "p.png.checkpoint"] {
        session(&folder, 1, 5).write_checkpoint(&folder.path(name)).expect("written");
    }
    let run = render(&["-o", "p.exr", "-o", "p.png", "--resume"]);
    assert!(run.stderr.contains("warning: p.png.checkpoint: is a checkpoint, too, and is left alone\n"), "{run}");
    assert!(!folder.path("p.exr.checkpoint").exists() && folder.path("p.png.checkpoint").exists());
}

#[test]
fn a_noise_that_is_met_already_is_refused_unless_it_was_asked_for() {
    let folder = Folder::with_scene();
    let render = |name: &str, noise: &str, more: &[&str]| {
        folder.run(&[&["render", "scene.toml", "-o", name, "--noise", noise], more].concat())
    };
    let session = session(&folder, 1, 0);
    session.run(Target::Noise(0.05), || false, |_| {});
    let keep = || session.write_checkpoint(&folder.path("a.exr.checkpoint")).expect("written");
    keep();
    let run = render("a.exr", "0.5", &["--resume"]);
    assert!(run.code == Some(1) && run.stderr.starts_with("error: a.exr.checkpoint: has a noise of "), "{run}");
    assert!(run.stderr.contains(" already, less than the 50 % that are asked for\n"), "{run}");
    assert!(folder.path("a.exr.checkpoint").exists());
    // It may have been killed just before its image was written.
    let run = render("a.exr", "0.05", &["--resume"]);
    assert!(run.code == Some(0) && !run.stderr.contains("--noise is"), "{run}");
    render("whole.exr", "0.05", &[]);
    super::support::assert_same_bits(&folder, "a.exr", "whole.exr");
    keep();
    let run = render("a.exr", "0.04", &["--resume"]);
    assert!(run.code == Some(0) && run.stderr.contains("--noise is 0.04, and was 0.05 before: "), "{run}");
}
