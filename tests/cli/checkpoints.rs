//! Renders that are killed, stopped, and gone on with.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use fogbow::kernels::accumulate::Dropped;
use fogbow::session::checkpoint::Checkpoint;
use fogbow::session::{Session, Settings, State, Step};
use fogbow::{Limits, Scene, Target};
use fogbow_testing::suite::IS_LONG;

use super::support::Folder;

/// A folder, and the session whose checkpoint of a few samples is `c` there.
fn session(samples: u32) -> (Folder, Session) {
    let folder = Folder::with_scene();
    let scene = Scene::load(folder.path("scene.toml")).expect("a scene");
    let mut session = Session::new(scene.loaded().clone(), Settings::default()).expect("memory");
    session.prepare(false, Limits::default(), |_| {});
    session.run(Target::Samples(samples), || false, |_| {});
    session.write_checkpoint(&folder.path("c")).expect("written");
    (folder, session)
}

fn pixels(session: &Session) -> Vec<fogbow::film::Pixel> {
    session.film.pixels().collect()
}

#[test]
fn what_was_chosen_before_a_checkpoint_is_not_chosen_again() {
    let folder = Folder::with_scene();
    let mut scene = Scene::load(folder.path("scene.toml")).expect("a scene");
    scene.set("render.technique", "bridge").expect("a technique");
    let session = || Session::new(scene.loaded().clone(), Settings::default()).expect("memory");
    let mut chosen = session();
    chosen.prepare(true, Limits::default(), |_| {});
    assert!(!chosen.preparation().trials.is_empty() && chosen.preparation().unfinished.is_empty());
    assert_ne!(chosen.scene.frame.walk, scene.loaded().frame.walk, "not all vertices connect");
    // Nothing is chosen where there is no time for it.
    let mut hasty = session();
    let stop = std::sync::Arc::clone(&hasty.monitor().stop);
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    hasty.prepare(true, Limits::default(), |_| {});
    stop.store(false, std::sync::atomic::Ordering::Relaxed);
    assert_eq!(hasty.preparation().unfinished, [Step::Choosing, Step::Metering, Step::LongPaths]);
    assert_eq!(hasty.scene.frame.walk, scene.loaded().frame.walk);
    for first in [chosen, hasty] {
        first.run(Target::Samples(3), || false, |_| {});
        first.write_checkpoint(&folder.path("c")).expect("written");
        let (mut resumed, mut checkpoint) = (session(), Checkpoint::open(&folder.path("c")).expect("a checkpoint"));
        resumed.prepare_to_resume(&checkpoint, true, Limits::default(), |_| {});
        assert!(resumed.preparation().trials.is_empty() && resumed.preparation().exposure.is_some());
        resumed.resume(&mut checkpoint).expect("the same render");
        assert_eq!(resumed.scene.frame.walk, first.scene.frame.walk);
        assert_eq!(pixels(&resumed), pixels(&first));
    }
}

#[test]
fn a_session_goes_on_from_a_checkpoint_to_the_same_bits() {
    let (folder, whole) = session(5);
    let dropped = Dropped { count: 3, first: Some((7, 4)) };
    whole.monitor().note_dropped(dropped);
    let elapsed = whole.elapsed();
    whole.write_checkpoint(&folder.path("c")).expect("written");
    whole.run(Target::Samples(9), || false, |_| {});
    let (other, mut resumed) = (session(9).1, session(0).1);
    assert_eq!(pixels(&whole), pixels(&other), "it goes on");
    let mut checkpoint = Checkpoint::open(&folder.path("c")).expect("a checkpoint");
    resumed.resume(&mut checkpoint).expect("the same render");
    resumed.run(Target::Samples(9), || false, |_| {});
    assert_eq!(pixels(&whole), pixels(&resumed));
    assert_eq!(resumed.dropped(), dropped);
    assert!(resumed.elapsed() >= elapsed, "time goes on, too");
}

#[test]
fn what_is_known_of_the_time_that_a_noise_takes_is_known_after_a_resume() {
    let (folder, whole) = session(0);
    let mut last = State::default();
    whole.run(Target::Noise(0.02), || false, |state| last = state);
    assert_eq!(last.expected, Some(Target::Noise(0.02)), "looks at the noise have agreed");
    whole.write_checkpoint(&folder.path("c")).expect("written");
    let mut resumed = session(0).1;
    resumed.resume(&mut Checkpoint::open(&folder.path("c")).expect("a checkpoint")).expect("the same render");
    let (stop, first) = (AtomicBool::new(false), OnceLock::new());
    resumed.run(
        Target::Noise(0.01),
        || stop.load(Ordering::Relaxed),
        |state| {
            first.get_or_init(|| state);
            stop.store(true, Ordering::Relaxed);
            resumed.monitor().stop.store(true, Ordering::Relaxed);
        },
    );
    let first = first.into_inner().expect("a look");
    assert_eq!(first.expected, Some(Target::Noise(0.01)));
    assert!((0.15..0.4).contains(&first.fraction), "{} of the way: half the noise takes four times", first.fraction);
    assert!(first.rate().is_none_or(|rate| rate > 0.0), "{first:?}");
}

#[test]
fn a_file_that_was_changed_is_named() {
    let tabulated = "phase = { type = \"tabulated\", file = \"phase.csv\" }";
    let folder = Folder::with_edited_scene("phase = { type = \"henyey_greenstein\", g = 0.5 }", tabulated);
    folder.write("phase.csv", "-1,1\n1,1\n");
    let session = || {
        let scene = Scene::load(folder.path("scene.toml")).expect("a scene");
        let mut session = Session::new(scene.loaded().clone(), Settings::default()).expect("memory");
        session.prepare(false, Limits::default(), |_| {});
        session
    };
    session().write_checkpoint(&folder.path("a.exr.checkpoint")).expect("written");
    let render = |name: &str, more: &[&str]| folder.run(&[&["render", "scene.toml", "-o", name], more].concat());
    assert_eq!(render("b.exr", &["--sample-range", "0..1"]).code, Some(0));
    folder.write("phase.csv", "-1,1\n1,2\n");
    let finding = "is the checkpoint of another render: the content of phase.csv is another one\n";
    for (more, help) in [(&["--resume"][..], "put the files back"), (&[], "go on with that render, by its files")] {
        let run = render("a.exr", more);
        assert!(run.code == Some(1) && run.stderr.contains(finding) && run.stderr.contains(help), "{run}");
    }
    assert_eq!(render("c.exr", &["--sample-range", "1..2"]).code, Some(0));
    let finding = "c.exr: does not belong to the same render as b.exr: the content of phase.csv is another one\n";
    let run = folder.refused(&["merge", "b.exr", "c.exr", "-o", "x.exr"], 1, finding);
    assert!(run.stderr.contains("help: render all parts with the same files"), "{run}");
}

#[test]
fn no_torn_or_damaged_checkpoint_is_taken_for_a_whole_one() {
    let (folder, _) = session(2);
    let (whole, path) = (fs::read(folder.path("c")).expect("a file"), folder.path("d"));
    let refused = |bytes: &[u8], what: &str| {
        fs::write(&path, bytes).expect("a file");
        let error = Checkpoint::open(&path).expect_err(what);
        assert!(error.remedy.contains("--overwrite-checkpoint"), "{what}: {error}");
    };
    for length in 0..whole.len() {
        refused(&whole[..length], &format!("{length} bytes"));
    }
    refused(&[&whole[..], b"x"].concat(), "one byte more");
    for at in 0..whole.len() {
        let mut flipped = whole.clone();
        flipped[at] ^= 1 << (at % 8);
        refused(&flipped, &format!("byte {at}"));
    }
    let missing = Checkpoint::open(Path::new("nowhere")).expect_err("nothing there");
    assert!(missing.finding.starts_with("cannot be read"), "{missing}");
}

#[cfg(unix)]
mod on_signals {
    use std::thread::sleep;

    use super::super::children::{ended_by, flags, handles_sigusr1, ignores_sighup, send, spawn, started, wait_for};
    use super::super::support::{assert_same_bits, header, plane};
    use super::*;

    /// Kills that a render survives.
    const KILLS: u32 = if IS_LONG { 20 } else { 5 };
    /// Samples of a render that is not done before the last of them.
    const SAMPLES: &str = if IS_LONG { "2400" } else { "600" };

    /// What a render in one go leaves.
    fn whole(folder: &Folder, more: &[&str]) {
        folder.done(&flags("whole.exr", &[&["--checkpoint", "off"], more].concat()));
    }

    #[test]
    fn a_render_survives_being_killed_again_and_again() {
        let folder = Folder::with_edited_scene("radiance = 10", "radiance = [10, 4, 1]");
        whole(&folder, &["--samples", SAMPLES]);
        let resumed = ["--samples", SAMPLES, "--checkpoint", "15ms", "--resume"];
        for kill in 0..KILLS {
            let child = started(&folder, "a.exr", &resumed);
            sleep(Duration::from_millis(u64::from(7 * kill * kill % 50)));
            let (code, stderr) = ended_by("-KILL", child);
            assert_eq!(code, None, "{stderr}");
            let line = if kill == 0 { "starting with the first sample" } else { "going on after " };
            assert!(stderr.contains(line), "{kill}: {stderr}");
        }
        let run = folder.done(&flags("a.exr", &resumed));
        assert!(run.stderr.contains("going on after "), "{run}");
        assert_same_bits(&folder, "a.exr", "whole.exr");
        assert_eq!(folder.names(), ["a.exr", "scene.toml", "whole.exr"], "nothing is left over");
        assert_eq!(header(&folder.image("a.exr"), "coverage"), format!("0,0,64,64:0..{SAMPLES}"));
    }

    #[test]
    fn who_is_told_to_stop_can_be_resumed_with_more_samples() {
        let folder = Folder::with_scene();
        whole(&folder, &["--sample-range", "7..500"]);
        for signal in ["-TERM", "-HUP"] {
            if signal == "-HUP" && ignores_sighup() {
                continue;
            }
            let child = started(&folder, "a.exr", &["--sample-range", "7..407", "--checkpoint", "20ms"]);
            let (code, stderr) = ended_by(signal, child);
            assert_eq!(code, Some(75), "{stderr}");
            assert!(stderr.contains("--resume goes on from a.exr.checkpoint"), "{stderr}");
            assert_eq!(folder.names(), ["a.exr.checkpoint", "scene.toml", "whole.exr"], "no image yet");
            let run = folder.done(&flags("a.exr", &["--sample-range", "7..500", "--resume"]));
            assert!(run.stderr.contains("going on after "), "{run}");
            assert_same_bits(&folder, "a.exr", "whole.exr");
            fs::remove_file(folder.path("a.exr")).expect("an image");
        }
    }

    #[test]
    fn a_render_until_a_noise_is_resumed_to_the_same_bits() {
        let folder = Folder::with_scene();
        for more in [&["--noise", "0.08"][..], &["--noise", "0.08", "--adaptive", "--samples", "100000"]] {
            whole(&folder, more);
            let resumed = [more, &["--checkpoint", "5ms", "--resume"]].concat();
            for wait in [0, 90, 40] {
                let child = started(&folder, "a.exr", &resumed);
                sleep(Duration::from_millis(wait));
                assert_eq!(ended_by("-KILL", child).0, None);
            }
            let child = started(&folder, "a.exr", &resumed);
            assert_eq!(ended_by("-TERM", child).0, Some(75));
            folder.done(&flags("a.exr", &resumed));
            assert_same_bits(&folder, "a.exr", "whole.exr");
            assert_eq!(header(&folder.image("a.exr"), "ended_by"), "noise");
        }
        let child = started(&folder, "a.exr", &["--samples", "100000", "--adaptive", "--checkpoint", "20ms"]);
        assert_eq!(ended_by("-TERM", child).0, Some(75));
        let foreign = "a.exr.checkpoint: is the checkpoint of another render: --adaptive is true there, false here";
        folder.refused(&flags("a.exr", &["--samples", "100000", "--resume"]), 1, foreign);
        let run = folder.run(&flags("a.exr", &["--samples", "1", "--adaptive", "--resume"]));
        assert!(run.code == Some(1) && run.stderr.contains("already, more than the 1 that are asked for"), "{run}");
    }

    #[test]
    fn renders_that_are_expected_to_be_long_have_checkpoints_unasked() {
        for (more, code) in [
            (&["--time", "1h", "--noise", "1e-9", "--samples", "1000000000"][..], 75),
            (&["--time", "1h", "--adaptive"], 75),
            (&["--samples", "1000000000"], 75),
            (&["--noise", "1e-9"], 75),
            (&["--samples", "2000"], 143),
            (&["--time", "100s", "--noise", "1e-9", "--samples", "1000000000"], 143),
        ] {
            let folder = Folder::with_scene();
            let child = spawn(&folder, "a.exr", more);
            wait_for("the handler", || handles_sigusr1(&child));
            sleep(Duration::from_secs(1));
            let (found, stderr) = ended_by("-TERM", child);
            assert_eq!(found, Some(code), "{more:?}: {stderr}");
            let left = if code == 75 { "a.exr.checkpoint" } else { "a.exr" };
            assert_eq!(folder.names(), [left, "scene.toml"], "{more:?}");
        }
    }

    #[test]
    fn ctrl_c_writes_the_image_and_leaves_a_checkpoint() {
        let folder = Folder::with_scene();
        let child = started(&folder, "a.exr", &["--time", "1h", "--checkpoint", "20ms"]);
        let (code, stderr) = ended_by("-INT", child);
        assert_eq!(code, Some(130), "{stderr}");
        assert!(stderr.contains("--resume goes on from a.exr.checkpoint"), "{stderr}");
        assert!(plane(&folder.image("a.exr"), "N")[0] >= 1.0);
        assert_eq!(folder.names(), ["a.exr", "a.exr.checkpoint", "scene.toml"]);
        folder.done(&["merge", "a.exr", "-o", "b.exr"]);
        assert_same_bits(&folder, "a.exr", "b.exr");
        fs::remove_file(folder.path("b.exr")).expect("an image");
        // The time before counts, and is over.
        folder.done(&flags("a.exr", &["--time", "1ms", "--resume"]));
        assert_eq!(folder.names(), ["a.exr", "scene.toml"]);
    }

    #[test]
    fn a_checkpoint_is_neither_overwritten_nor_taken_for_that_of_another_render() {
        let folder = Folder::with_scene();
        let child = started(&folder, "a.exr", &["--samples", "100000", "--checkpoint", "20ms"]);
        assert_eq!(ended_by("-TERM", child).0, Some(75));
        let path = folder.path("a.exr.checkpoint");
        let checkpoint = fs::read(&path).expect("a checkpoint");
        let foreign = "a.exr.checkpoint: is the checkpoint of another render: ";
        for (more, difference) in [
            (&["--seed", "2"][..], "render.seed is 1 there, 2 here"),
            (&["--set", "light[0].radius=1"], "light[0].radius is 1.5 there, 1.0 here"),
            (&["--crop", "0,0,32,64"], "the region of --crop is 0,0,64,64 there, 0,0,32,64 here"),
            (&["--sample-range", "1..9"], "the first sample of --sample-range is 0 there, 1 here"),
            (&["--reference", "scatter"], "--reference is none there, scatter here"),
        ] {
            for resume in [&["--resume"][..], &[]] {
                let args = flags("a.exr", &[resume, more].concat());
                folder.refused(&args, 1, &format!("{foreign}{difference}"));
            }
        }
        let run = folder.refused(&flags("a.exr", &[]), 1, "a.exr.checkpoint: is a checkpoint of this render");
        assert!(run.stderr.contains("--resume") && run.stderr.contains("--overwrite-checkpoint"), "{run}");
        folder.refused(&flags("a.exr", &["--resume", "--samples", "1"]), 1, "a.exr.checkpoint: has ");
        folder.write("a.exr.checkpoint", &checkpoint[..checkpoint.len() / 2]);
        for more in [&["--resume"][..], &[]] {
            folder.refused(&flags("a.exr", more), 1, "a.exr.checkpoint: is a truncated or damaged checkpoint");
        }
        folder.write("a.exr.checkpoint", &checkpoint);
        folder.done(&flags("a.exr", &["--checkpoint", "off"]));
        assert_eq!(fs::read(&path).expect("a checkpoint"), checkpoint, "it is still there");
        folder.done(&flags("a.exr", &["--overwrite-checkpoint"]));
        assert_eq!(folder.names(), ["a.exr", "scene.toml"]);
    }

    #[test]
    fn sigusr1_writes_a_checkpoint_and_the_render_goes_on() {
        let folder = Folder::with_scene();
        let child = spawn(&folder, "a.exr", &["--samples", "100000", "--checkpoint", "1h"]);
        sleep(Duration::from_millis(500));
        let path = folder.path("a.exr.checkpoint");
        assert!(!path.exists(), "an hour has not passed");
        wait_for("the handler", || handles_sigusr1(&child));
        send("-USR1", &child);
        wait_for("a checkpoint", || path.exists());
        sleep(Duration::from_millis(300));
        let (code, stderr) = ended_by("-TERM", child);
        assert_eq!(code, Some(75), "{stderr}");
        assert!(stderr.contains("a.exr.checkpoint: checkpoint written\n"), "{stderr}");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told_at_the_end() {
        let folder = Folder::with_scene();
        fs::create_dir(folder.path("sub")).expect("a folder");
        let child = spawn(&folder, "sub/a.exr", &["--time", "3s", "--checkpoint", "50ms"]);
        wait_for("the handler", || handles_sigusr1(&child));
        wait_for("a checkpoint", || folder.path("sub/a.exr.checkpoint").exists());
        // What is written meanwhile may be in the way of that.
        wait_for("the end of the folder", || fs::remove_dir_all(folder.path("sub")).is_ok());
        let output = child.wait_with_output().expect("a child");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(1), "the image cannot be written either: {stderr}");
        assert!(stderr.contains("the render goes on; the next try is in 50 ms"), "{stderr}");
        let end = "warning: sub/a.exr.checkpoint: no checkpoint could be written there by the end of the render\n";
        assert!(stderr.contains(end), "{stderr}");
    }

    #[test]
    fn results_that_cannot_be_written_leave_a_checkpoint() {
        let folder = Folder::with_scene();
        fs::create_dir(folder.path("gone")).expect("a folder");
        let more = ["--samples", "100", "-o", "gone/b.exr", "--checkpoint", "20ms"];
        let child = started(&folder, "a.exr", &more);
        fs::remove_dir(folder.path("gone")).expect("an empty folder");
        let output = child.wait_with_output().expect("a child");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains("the samples are kept in a.exr.checkpoint, from which --resume goes on\n"), "{stderr}");
        fs::create_dir(folder.path("gone")).expect("a folder");
        let run = folder.done(&flags("a.exr", &[&more[..], &["--resume"]].concat()));
        assert!(run.stderr.contains("going on after 100 samples per pixel\n"), "{run}");
        assert_same_bits(&folder, "a.exr", "gone/b.exr");
        assert_eq!(folder.names(), ["a.exr", "gone", "scene.toml"]);
    }

    #[test]
    fn short_renders_have_no_checkpoints_unless_asked_to() {
        let folder = Folder::with_scene();
        for more in [&["--time", "1s"][..], &["--samples", "8"]] {
            folder.done(&flags("a.exr", more));
            assert_eq!(folder.names(), ["a.exr", "scene.toml"]);
        }
        for (flag, finding) in
            [("0s", "must be longer than 0"), ("often", "is not a duration"), ("60", "is not a duration")]
        {
            let place = format!("--checkpoint {flag}: {finding}");
            folder.refused(&flags("a.exr", &["--checkpoint", flag]), 2, &place);
        }
        folder.refused(&flags("png:/dev/null", &["--resume"]), 2, "--resume: there is no place for a checkpoint");
    }
}
