//! The place of the checkpoints of a render, which other renders may take for theirs.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::super::Session;
use super::{CHECKSUM, Checkpoint, Mark};
use crate::error::{Error, Result};
use crate::output::Replace;

/// Where a render keeps its checkpoints. What other renders have put there meanwhile stays, but for checkpoints of the
/// same render that are not further along.
#[derive(Debug)]
pub struct Slot {
    path: PathBuf,
    /// The mark of what is there as far as this render knows: its own, or what it may replace.
    own: Mutex<Option<Mark>>,
}

impl Slot {
    /// A place at `path`; what is there is nobody's yet.
    pub fn new(path: PathBuf) -> Self {
        Self { path, own: Mutex::default() }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The render goes on from `checkpoint`, which was opened here, and may replace it.
    pub fn adopt(&self, checkpoint: &Checkpoint) {
        self.own(Some(checkpoint.checksum));
    }

    /// The render may replace what is there now, whatever it is.
    pub fn clear(&self) {
        self.own(mark(&self.path).ok().flatten());
    }

    fn own(&self, mark: Option<Mark>) {
        *self.own.lock().unwrap_or_else(PoisonError::into_inner) = mark;
    }

    fn is_own(&self, mark: Mark) -> bool {
        *self.own.lock().unwrap_or_else(PoisonError::into_inner) == Some(mark)
    }

    /// Writes a checkpoint of `session`, whole or not at all; the render may be running. Whether it is there now: if
    /// not, one of the same render is, by another run that is further along.
    ///
    /// # Errors
    /// If it cannot be written, or what is there is not of this render. What was there is then still there.
    pub fn write(&self, session: &Session) -> Result<bool> {
        let mark = session.put_checkpoint(&self.path, |samples| self.permit(session, samples))?;
        mark.iter().for_each(|mark| self.own(Some(*mark)));
        Ok(mark.is_some())
    }

    /// What a checkpoint of `session` with so many samples may take the place of.
    fn permit(&self, session: &Session, samples: u64) -> Result<Replace> {
        if self.path.symlink_metadata().is_err() {
            return Ok(Replace::Nothing);
        }
        let mark = mark(&self.path).map_err(|error| {
            let finding = format!("cannot be read, and is left alone: {error}");
            Error::failure(self.path.display(), finding, "check the path, its permissions, and limits on open files")
        })?;
        if mark.is_some_and(|mark| self.is_own(mark)) {
            return Ok(Replace::Any);
        }
        let other = Checkpoint::open(&self.path).map_err(|error| {
            let finding = format!("{}, and nothing that this render has written; it is left alone", error.finding);
            Error::failure(&error.place, finding, "write to a place that no other program writes to")
        })?;
        if let Some(difference) = other.difference(session) {
            let finding = format!("is the checkpoint of another render, and is left alone: {difference}");
            return Err(Error::failure(self.path.display(), finding, "give every render an output of its own"));
        }
        Ok(if other.samples(&session.film)? > samples { Replace::Never } else { Replace::Any })
    }

    /// Removes the last checkpoint of this render; whether nothing is there any more, and not what another run has put
    /// there.
    ///
    /// # Errors
    /// If it cannot be read or removed.
    pub fn remove(&self) -> io::Result<bool> {
        if self.path.symlink_metadata().is_err() {
            return Ok(true);
        }
        if !mark(&self.path)?.is_some_and(|mark| self.is_own(mark)) {
            return Ok(false);
        }
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(true),
        }
    }
}

/// The mark of the file at `path`, which may be anything; none if it is no file.
fn mark(path: &Path) -> io::Result<Option<Mark>> {
    let metadata = path.metadata()?;
    if !metadata.is_file() {
        return Ok(None);
    }
    let length = metadata.len().min(CHECKSUM);
    let (mut file, mut mark) = (File::open(path)?, Mark::default());
    file.seek(SeekFrom::End(-(length as i64)))?;
    file.read_exact(&mut mark[..length as usize])?;
    Ok(Some(mark))
}
