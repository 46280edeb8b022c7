//! Disks that are full while a render runs, and at its end.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use fogbow::session::checkpoint::Checkpoint;
use fogbow_testing::not_run::not_run;

use super::children::{ended_by, handles_sigusr1, spawn, wait_for};
use super::support::Folder;

/// Has `check` look at a folder with a full disk as its folder `sub`, where the file `filler` takes nearly all room.
fn on_a_full_disk(check: impl Fn(&Folder, &Path)) {
    let folder = Folder::with_scene();
    let sub = folder.path("sub");
    fs::create_dir(&sub).expect("a folder");
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=2m", "tmpfs"]).arg(&sub).output();
    if !mount.is_ok_and(|output| output.status.success()) {
        not_run("no tmpfs can be mounted here");
        return;
    }
    // All but a page or two.
    let filler = sub.join("filler");
    let filled = fs::write(&filler, vec![1; (2 << 20) - (16 << 10)]);
    let outcome = std::panic::catch_unwind(core::panic::AssertUnwindSafe(|| {
        filled.expect("it has room for that");
        check(&folder, &filler);
    }));
    let unmounted = Command::new("umount").arg(&sub).status();
    outcome.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    assert!(unmounted.is_ok_and(|status| status.success()));
}

#[test]
fn a_full_disk_does_not_stop_a_render() {
    on_a_full_disk(|folder, filler| {
        let child = spawn(folder, "sub/a.exr", &["--samples", "100000", "--checkpoint", "100ms"]);
        wait_for("the handler", || handles_sigusr1(&child));
        let checkpoint = folder.path("sub/a.exr.checkpoint");
        sleep(Duration::from_secs(2));
        fs::remove_file(filler).expect("a file");
        wait_for("a checkpoint", || checkpoint.exists());
        let (code, stderr) = ended_by("-TERM", child);
        assert_eq!(code, Some(75), "{stderr}");
        let warning = "warning: no checkpoint could be written: sub/a.exr.checkpoint: ";
        assert_eq!(stderr.matches(warning).count(), 1, "{stderr}");
        let checkpoint = Checkpoint::open(&checkpoint);
        assert!(checkpoint.is_ok(), "{checkpoint:?}");
    });
}

#[test]
fn room_that_is_made_at_the_end_is_used() {
    on_a_full_disk(|folder, filler| {
        let child = spawn(folder, "sub/a.exr", &["--samples", "1", "-o", "sub/b.exr", "--checkpoint", "off"]);
        sleep(Duration::from_secs(3));
        fs::remove_file(filler).expect("a file");
        let output = child.wait_with_output().expect("a child");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        let warning = "warning: sub/a.exr: there is no room for it; trying again for 10 s\n";
        assert_eq!((stderr.matches(warning).count(), stderr.matches("room").count()), (1, 1), "{stderr}");
        super::support::assert_same_bits(folder, "sub/a.exr", "sub/b.exr");
    });
}

#[test]
fn a_disk_that_stays_full_is_told_once() {
    on_a_full_disk(|folder, _| {
        let child = spawn(folder, "sub/a.exr", &["--samples", "100000000", "--checkpoint", "200ms"]);
        wait_for("the handler", || handles_sigusr1(&child));
        sleep(Duration::from_secs(2));
        let (code, stderr) = ended_by("-TERM", child);
        assert_eq!(code, Some(1), "{stderr}");
        for message in [
            "warning: no checkpoint could be written: sub/a.exr.checkpoint: cannot be written: ",
            "warning: sub/a.exr.checkpoint: there is no room for it; trying again for 10 s\n",
            "warning: sub/a.exr.checkpoint: no checkpoint could be written there by the end of the render\n",
            "error: sub/a.exr: cannot be written: ",
            "  help: make room at the destination",
        ] {
            assert_eq!(stderr.matches(message).count(), 1, "{message}: {stderr}");
        }
        assert_eq!(stderr.matches("checkpoint could be written").count(), 2, "{stderr}");
        assert_eq!(folder.path("sub").read_dir().expect("a folder").count(), 1, "the filler alone: {stderr}");
    });
}
