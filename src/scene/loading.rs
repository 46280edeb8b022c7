//! How far a scene has been read, for whoever waits for it.

use std::path::{Path, PathBuf};

/// A file that is being read, of those that may be large: volumes.
#[derive(Clone, Debug, PartialEq)]
pub struct Loading {
    /// Its path.
    pub file: PathBuf,
    /// Share of it that has been read, in [0, 1].
    pub fraction: f64,
}

impl Loading {
    /// `done` parts out of `total` of the file at `path`.
    pub fn of(path: &Path, done: u64, total: u64) -> Self {
        Self { file: path.to_path_buf(), fraction: done as f64 / total.max(1) as f64 }
    }
}

/// Who is told of it, now and then.
pub type Look<'a> = &'a dyn Fn(Loading);
