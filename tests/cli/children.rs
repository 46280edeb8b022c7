//! Renders that run while a test looks on, and signals to them.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fogbow_testing::not_run::not_run;

use super::support::{Folder, program};

/// Longer than a checkpoint takes, also on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Arguments that render to `output`.
pub fn flags<'a>(output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let base = ["render", "scene.toml", "-o", output, "--size", "64x64", "--progress", "plain"];
    [&base[..], more].concat()
}

/// On one thread, which leaves others to the tests beside this one.
pub fn spawn(folder: &Folder, output: &str, more: &[&str]) -> Child {
    program(folder).args(flags(output, more)).args(["--threads", "1"]).spawn().expect("the program starts")
}

#[track_caller]
pub fn wait_for(what: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < PATIENCE, "{what} takes too long");
        sleep(Duration::from_millis(2));
    }
}

/// Starts a render and waits for a checkpoint that is new.
pub fn started(folder: &Folder, output: &str, more: &[&str]) -> Child {
    let path = folder.path(&format!("{output}.checkpoint"));
    let time = |path: &PathBuf| path.metadata().and_then(|metadata| metadata.modified()).ok();
    let before = time(&path);
    let child = spawn(folder, output, more);
    wait_for("a checkpoint", || time(&path) > before);
    child
}

/// Ends the child with a signal, and gives its exit code and standard error.
pub fn ended_by(signal: &str, child: Child) -> (Option<i32>, String) {
    send(signal, &child);
    let output = child.wait_with_output().expect("a child");
    (output.status.code(), String::from_utf8(output.stderr).expect("UTF-8"))
}

pub fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(status.success());
}

pub fn handles_sigusr1(child: &Child) -> bool {
    has_signal(child.id(), "SigCgt:", 10)
}

/// Whether tests, and so the renders that they start, are not to end with their terminal, and says so.
pub fn ignores_sighup() -> bool {
    let ignored = has_signal(std::process::id(), "SigIgn:", 1);
    if ignored {
        not_run("these tests were started with SIGHUP ignored");
    }
    ignored
}

/// Whether a signal is in a set of signals of the process.
pub fn has_signal(process: u32, set: &str, signal: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix(set));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
