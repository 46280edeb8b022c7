//! Ctrl-C and other signals: what there is is written.

#![cfg(unix)]

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::children::{has_signal, ignores_sighup, send};
use super::support::{Folder, Run, header, plane, program};

/// How much slower a build without optimisation is.
const SLOWNESS: u32 = if cfg!(debug_assertions) { 20 } else { 1 };

/// Starts a render that would take hours, without checkpoints, and returns once it has begun.
fn started(folder: &Folder, flags: &[&str]) -> Child {
    let mut command = program(folder);
    let base = ["render", "scene.toml", "-o", "a.exr", "-o", "a.png", "--checkpoint", "off", "--threads", "1"];
    command.args(base).args(flags);
    let child = command.spawn().expect("the program starts");
    wait_for_handlers(&child);
    // Tests that run beside this one may delay its first samples.
    sleep(SLOWNESS * Duration::from_millis(1000));
    child
}

/// Whether the process has a handler for SIGTERM, signal 15, the last that it asks for but one.
fn catches_interrupts(process: u32) -> bool {
    has_signal(process, "SigCgt:", 15)
}

/// Waits until signals do not end the process as they end one without handlers.
pub fn wait_for_handlers(child: &Child) {
    let start = Instant::now();
    while !catches_interrupts(child.id()) && start.elapsed() < Duration::from_secs(20) {
        sleep(Duration::from_millis(2));
    }
}

/// Interrupts the render and returns its exit code, standard output and standard error.
fn interrupted(child: Child) -> (Option<i32>, String, String) {
    ended_by("-INT", child)
}

/// Sends the signal, which is to end the child without a wait for what takes minutes or never comes.
#[track_caller]
pub fn ended_by(signal: &str, child: Child) -> (Option<i32>, String, String) {
    send(signal, &child);
    let run = Run::until_end(child, format!("a render that was sent {signal}"));
    (run.code, run.stdout, run.stderr)
}

#[test]
fn ctrl_c_writes_the_image_and_says_so() {
    let folder = Folder::with_scene();
    let child = started(&folder, &["--samples", "1000000000", "--size", "40x40", "--progress", "plain"]);
    let (code, stdout, stderr) = interrupted(child);
    assert_eq!((code, stdout.as_str()), (Some(130), ""), "{stderr}");
    let lines: Vec<_> = stderr.lines().collect();
    let [.., stopped, summary] = lines.as_slice() else { panic!("{stderr}") };
    assert!(stopped.starts_with("stopped after ") && stopped.ends_with("writing the results so far"), "{stderr}");
    assert!(summary.starts_with("a.exr, a.png: mvnee, "), "{stderr}");
    assert_eq!(folder.names(), ["a.exr", "a.png", "scene.toml"]);

    let image = folder.image("a.exr");
    let samples = plane(&image, "N");
    let (fewest, most) = samples.iter().fold((f32::MAX, 0.0_f32), |(low, high), n| (low.min(*n), high.max(*n)));
    assert!(fewest >= 1.0 && most - fewest <= 16.0, "{fewest} to {most} samples are not even");
    assert_eq!(header(&image, "sample_range"), format!("0..{most}"));
    let total: f64 = samples.iter().map(|n| f64::from(*n)).sum();
    assert_eq!(header(&image, "samples"), total.to_string());
    let told = stopped.split(' ').nth(2).and_then(|number| number.parse::<f64>().ok()).expect("a number");
    assert!(stopped.contains("per pixel; ") && (told * 1600.0 / total - 1.0).abs() < 1e-3, "{stderr}");
}

#[test]
fn ctrl_c_ends_a_render_of_unlimited_time() {
    let folder = Folder::with_scene();
    let child = started(&folder, &["--time", "18446744073709551615s", "--progress", "openjd"]);
    let (code, stdout, stderr) = interrupted(child);
    assert_eq!((code, stderr.as_str()), (Some(130), ""), "{stdout}");
    assert!(stdout.contains("openjd_status: stopped after "), "{stdout}");
    assert!(!stdout.contains("openjd_progress: 100"), "{stdout}");
    assert!(plane(&folder.image("a.exr"), "N")[0] >= 1.0);
}

#[test]
fn ctrl_c_does_not_wait_for_twins() {
    let folder = Folder::with_scene();
    // One sample of every pixel takes the twins a quarter of an hour.
    let slow = ["--set", "medium.scattering=30", "--max-segments", "300", "--technique", "bridge"];
    let flags = ["--samples", "1000000", "--size", "256x256", "--reference", "--progress", "none"];
    let child = started(&folder, &[&flags[..], &slow].concat());
    let (code, stdout, stderr) = interrupted(child);
    assert_eq!((code, stdout.as_str()), (Some(130), ""), "{stderr}");
    assert!(folder.names() == ["scene.toml"] || plane(&folder.image("a.exr"), "N").contains(&0.0), "{stderr}");
}

#[test]
fn an_image_that_cannot_be_written_does_not_take_the_others_with_it() {
    let folder = Folder::with_scene();
    std::fs::create_dir(folder.path("gone")).expect("a folder");
    let child = started(&folder, &["--samples", "1000000000", "-o", "gone/b.exr", "-o", "c.exr", "--progress", "none"]);
    std::fs::remove_dir(folder.path("gone")).expect("an empty folder");
    let (code, _, stderr) = interrupted(child);
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.starts_with("error: gone/b.exr: no file can be created in gone: "), "{stderr}");
    assert_eq!(folder.names(), ["a.exr", "a.png", "c.exr", "scene.toml"]);
}

#[test]
fn ctrl_c_ends_the_choice_of_a_setting_too() {
    let folder = Folder::with_scene();
    let mut command = program(&folder);
    // A pilot of seconds: long paths in dense fog.
    let settings = ["--max-segments", "128", "--set", "medium.scattering=60", "--size", "200x200"];
    command.args(["render", "scene.toml", "-o", "a.exr", "--technique", "bridge"]).args(settings);
    // Without a sample there is nothing to put in the place of what is there.
    folder.write("a.exr", "the image of yesterday");
    let child = command.args(["--stats", "s.json"]).spawn().expect("the program starts");
    wait_for_handlers(&child);
    let (code, _, stderr) = interrupted(child);
    assert_eq!(code, Some(130), "{stderr}");
    assert!(stderr.ends_with("stopped before the first sample; nothing is written\n"), "{stderr}");
    assert_eq!(folder.names(), ["a.exr", "scene.toml"]);
    assert_eq!(std::fs::read_to_string(folder.path("a.exr")).expect("a file"), "the image of yesterday");
}

/// Makes a named pipe in the folder.
fn make_pipe(folder: &Folder, name: &str) {
    let status = Command::new("mkfifo").arg(folder.path(name)).status().expect("mkfifo");
    assert!(status.success());
}

/// Waits until the folder has a file of this name.
fn wait_for(folder: &Folder, name: &str) {
    let start = Instant::now();
    while !folder.path(name).exists() && start.elapsed() < Duration::from_secs(20) {
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn one_signal_ends_the_wait_for_a_reader() {
    for flags in [&["-o", "png:pipe", "-o", "b.exr"][..], &["-o", "b.exr", "--stats", "pipe"]] {
        let folder = Folder::with_scene();
        make_pipe(&folder, "pipe");
        let child = started(&folder, &[flags, &["--progress", "none"]].concat());
        wait_for(&folder, "a.png");
        let (code, _, stderr) = ended_by("-TERM", child);
        assert_eq!(code, Some(143), "{stderr}");
        let error =
            "error: pipe: is a pipe that nobody had opened for reading when a signal came, so nothing was written\n";
        assert!(stderr.starts_with(error), "{stderr}");
        assert_eq!(plane(&folder.image("b.exr"), "N")[0], 4.0, "what does not wait is written");
    }
}

#[test]
fn a_reader_that_comes_late_gets_the_whole_image() {
    let folder = Folder::with_scene();
    make_pipe(&folder, "pipe");
    // Larger than what a pipe holds, so that the writer has to wait for the reader too.
    let child = started(&folder, &["-o", "exr:pipe", "--samples", "1", "--size", "200x200", "--progress", "none"]);
    let pipe = std::fs::File::open(folder.path("pipe")).expect("a pipe");
    sleep(Duration::from_millis(200));
    std::io::copy(&mut &pipe, &mut std::fs::File::create(folder.path("c.exr")).expect("a file")).expect("an image");
    let output = child.wait_with_output().expect("a child");
    assert!(output.status.success(), "{output:?}");
    assert_eq!(folder.image("c.exr").channels, folder.image("a.exr").channels);
}

/// What long paths would bring takes seconds to find out, so it is not found yet, however late the signal is sent where
/// other tests run beside this one.
#[test]
fn a_signal_ends_a_long_preparation() {
    let folder = Folder::with_scene();
    let settings = ["--max-segments", "1024", "--set", "medium.scattering=600", "--size", "200x200"];
    let flags = ["render", "scene.toml", "-o", "a.exr", "--technique", "bridge", "--progress", "json"];
    let child = program(&folder).args(flags).args(settings).spawn().expect("the program starts");
    wait_for_handlers(&child);
    sleep(SLOWNESS * Duration::from_millis(200));
    let (code, _, stderr) = ended_by("-TERM", child);
    assert_eq!(code, Some(143), "{stderr}");
    assert!(stderr.contains("stopped before the first sample; nothing is written"), "{stderr}");
    assert!(!stderr.contains("are left out"), "nothing is known of it yet\n{stderr}");
}

#[test]
fn a_signal_ends_loading_at_once() {
    let folder = Folder::empty();
    // Whoever opens it waits for a writer.
    make_pipe(&folder, "pipe.toml");
    for (signal, expected) in [("-INT", 130), ("-TERM", 143)] {
        let child = program(&folder).args(["render", "pipe.toml"]).spawn().expect("the program starts");
        wait_for_handlers(&child);
        sleep(Duration::from_millis(100));
        let (code, stdout, stderr) = ended_by(signal, child);
        assert_eq!((code, stdout.as_str()), (Some(expected), ""), "{stderr}");
        assert_eq!(stderr, "stopped before the first sample; nothing is written\n");
        assert_eq!(folder.names(), ["pipe.toml"]);
    }
}

#[test]
fn the_exit_code_says_which_signal_it_was() {
    for (signal, expected) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        if signal == "-HUP" && ignores_sighup() {
            continue;
        }
        let folder = Folder::with_scene();
        let child = started(&folder, &["--samples", "1000000000", "--progress", "none"]);
        let (code, _, stderr) = ended_by(signal, child);
        assert_eq!(code, Some(expected), "{stderr}");
        assert!(plane(&folder.image("a.exr"), "N")[0] >= 1.0, "{signal}");
    }
}

#[test]
fn who_starts_it_may_have_a_hangup_ignored() {
    let folder = Folder::with_scene();
    let mut shell = Command::new("sh");
    let fogbow = env!("CARGO_BIN_EXE_fogbow");
    let script = "trap '' HUP; exec \"$0\" render scene.toml -o a.exr --time 2s --progress none";
    let child = shell.args(["-c", script, fogbow]).current_dir(folder.path(".")).spawn().expect("a shell");
    let start = Instant::now();
    wait_for_handlers(&child);
    let (code, ..) = ended_by("-HUP", child);
    assert_eq!(code, Some(0));
    assert!(start.elapsed() >= Duration::from_secs(2), "it went on for its two seconds");
}

#[test]
fn a_signal_that_comes_twice_is_one() {
    for gap in [0, 1, 300] {
        let folder = Folder::with_scene();
        let flags = ["render", "scene.toml", "-o", "a.exr", "--time", "1h", "--checkpoint", "1h", "--progress", "none"];
        let child = program(&folder).args(flags).spawn().expect("the program starts");
        wait_for_handlers(&child);
        sleep(SLOWNESS * Duration::from_millis(700));
        // The second comes from one program that starts no other, so that it is as soon as that.
        let script = format!("kill -TERM {0}; sleep 0.{gap:03}; kill -TERM {0} || true", child.id());
        let status = Command::new("bash").args(["-c", &script]).stderr(Stdio::null()).status().expect("a shell");
        assert!(status.success());
        let output = child.wait_with_output().expect("a child");
        assert_eq!(output.status.code(), Some(75), "{gap} ms: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(folder.names(), ["a.exr.checkpoint", "scene.toml"], "{gap} ms");
    }
}

/// Whoever has opened a pipe may read on, so the program waits, until it is told again.
#[test]
fn a_second_signal_ends_it_at_once() {
    let folder = Folder::with_scene();
    make_pipe(&folder, "pipe");
    // Larger than what a pipe holds.
    let mut child = started(&folder, &["-o", "exr:pipe", "--samples", "1", "--size", "200x200", "--progress", "none"]);
    let pipe = std::fs::File::open(folder.path("pipe")).expect("a pipe");
    send("-TERM", &child);
    // The first of them may be sent twice.
    sleep(Duration::from_millis(1500));
    assert_eq!(child.try_wait().expect("a child"), None, "the first waits for the reader");
    let (code, ..) = ended_by("-TERM", child);
    assert_eq!(code, Some(143));
    drop(pipe);
}
