//! What is done about a full disk at the end of a render: somebody may make room yet.

use std::cell::Cell;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::progress::Reporter;
use crate::error::{Kind, Result};

/// For how long a render waits for room, for all of its files together.
const PATIENCE: Duration = Duration::from_secs(10);
/// Time between two tries.
const PAUSE: Duration = Duration::from_millis(500);

/// The patience of one render.
#[derive(Debug, Default)]
pub struct Patience {
    /// When it ends, once there was no room.
    end: Cell<Option<Instant>>,
}

impl Patience {
    /// Does `write` again and again as long as there is no room and patience is left; the first time says so.
    ///
    /// # Errors
    /// Those of `write`.
    pub fn retry<T>(&self, reporter: &Reporter, write: impl Fn() -> Result<T>) -> Result<T> {
        loop {
            let error = match write() {
                Err(error) if error.kind == Kind::NoSpace => error,
                result => return result,
            };
            let end = self.end.get().unwrap_or_else(|| {
                let seconds = PATIENCE.as_secs();
                reporter.warn(format!("{}: there is no room for it; trying again for {seconds} s", error.place));
                Instant::now() + PATIENCE
            });
            self.end.set(Some(end));
            if Instant::now() >= end {
                return Err(error);
            }
            sleep(PAUSE);
        }
    }
}
