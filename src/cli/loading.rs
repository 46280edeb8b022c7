//! Loading a scene: how far it is, where that takes long, and an end to it when a signal comes.

use std::panic::resume_unwind;
use std::path::Path;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use super::progress::Reporter;
use crate::error::{Error, Result};
use crate::scene::document::Override;
use crate::scene::{self, LoadedScene};

/// How often signals are looked for.
const TICK: Duration = Duration::from_millis(20);
/// Loading that takes no longer needs no progress.
pub const NOTICEABLE: Duration = Duration::from_millis(500);
/// Bytes of the loader's stack: what the first thread of a program usually has.
const STACK: usize = 8 << 20;

/// Loads the scene at `path`, at a `time` of its animations `[s]`, and tells `reporter` how far that is. None if it was
/// `interrupted`: whatever the loader is at, it is not waited for, and ends with the program.
pub fn load(
    path: &Path,
    overrides: Vec<Override>,
    time: Option<f64>,
    reporter: &mut Reporter,
    interrupted: impl Fn() -> bool,
) -> Result<Option<LoadedScene>> {
    let (path, (tell, told)) = (path.to_path_buf(), mpsc::channel());
    let start = Instant::now();
    let work = move || {
        scene::load_at(&path, overrides, time, &|loading| {
            // Nobody listens once a signal has come.
            let _ = tell.send(loading);
        })
    };
    let thread = thread::Builder::new().stack_size(STACK).spawn(work).map_err(|error| {
        Error::failure("fogbow", format!("a thread cannot be started: {error}"), "end other programs")
    })?;
    let mut last = None;
    while !interrupted() {
        match told.recv_timeout(TICK) {
            Ok(loading) => last = Some(loading),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                reporter.loaded();
                return thread.join().unwrap_or_else(|panic| resume_unwind(panic)).map(Some);
            }
        }
        if let Some(loading) = last.as_ref().filter(|_| start.elapsed() >= NOTICEABLE) {
            reporter.loading(loading, start.elapsed());
        }
    }
    reporter.loaded();
    Ok(None)
}
