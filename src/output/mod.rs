//! Files that a command leaves behind.
//!
//! A regular file is written whole or not at all: a temporary file beside it takes its place, with its mode and, where
//! the system allows, its owner. What is not a regular file, a pipe, a terminal, `/dev/stdout`, is never replaced:
//! bytes go straight into it, from memory. Symbolic links are followed, also to where nothing is yet.

mod pipe;
mod place;

use std::cell::Cell;
use std::fs::{File, TryLockError};
use std::io::{self, BufWriter, Cursor, ErrorKind, Seek, SeekFrom, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::error::{Error, Kind, Result};
use place::Place;

/// What a file is written through.
pub trait Sink: Write + Seek {}
impl<S: Write + Seek> Sink for S {}

/// Fails if nothing can be written to `path`, so that nobody finds out after an hour of rendering.
///
/// # Errors
/// If it is a folder, a disk or read-only, or the folder that it is to be in does not exist or cannot be written.
pub fn check(path: &Path) -> Result<()> {
    match place::of(path)? {
        Place::Regular(file) => temporary(path, &file, PREFIX).map(drop),
        Place::Stream(_) | Place::Standard(_) => Ok(()),
    }
}

/// Whether both paths lead to the same file, pipe or device, so that one result would replace or run into the other;
/// `/dev/null` takes any number of them.
pub fn are_same(a: &Path, b: &Path) -> bool {
    place::identity(a).is_some_and(|a| place::identity(b) == Some(a))
}

/// Whether `path` leads to standard output.
pub fn is_standard_output(path: &Path) -> bool {
    are_same(path, Path::new("/dev/stdout"))
}

/// Whether `path` leads to something other than a regular file, as `/dev/stdout` and process substitution do; its name
/// then says nothing of its content.
pub fn is_stream(path: &Path) -> bool {
    matches!(place::of(path), Ok(Place::Stream(_) | Place::Standard(_)))
}

/// Writes to `path` what `fill` writes. A named pipe is waited for until somebody reads it or `interrupted` says so.
///
/// # Errors
/// If anything cannot be written; a regular file is then what it was before. If the wait was interrupted.
pub fn write(
    path: &Path,
    interrupted: impl Fn() -> bool,
    fill: impl FnOnce(&mut dyn Sink) -> core::result::Result<(), String>,
) -> Result<()> {
    write_as(path, PREFIX, || Ok(Replace::Any), interrupted, fill).map(drop)
}

/// What a new file may take the place of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replace {
    /// Whatever is there.
    Any,
    /// Nothing: there must not be a file.
    Nothing,
    /// What is there stays, and the new file is not kept.
    Never,
}

/// What names of temporary files begin and end with.
const PREFIX: &str = ".fogbow-";
const SUFFIX: &str = ".part";

/// What the names of temporary files begin with that are to take the place of `path` alone.
fn own_prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    format!("{PREFIX}{}-", &blake3::hash(name.as_encoded_bytes()).to_hex()[..16])
}

/// The same as [`write()`] for what is written again and again, by a program that may be killed meanwhile: what that
/// leaves is found by [`remove_leftovers`]. Once all is written, `permit` says what it may take the place of; whether it
/// did.
///
/// # Errors
/// As [`write()`], that of `permit`, and if there is a file where there must not be one.
pub fn rewrite(
    path: &Path,
    permit: impl FnOnce() -> Result<Replace>,
    fill: impl FnOnce(&mut dyn Sink) -> core::result::Result<(), String>,
) -> Result<bool> {
    write_as(path, &own_prefix(path), permit, || false, fill)
}

/// Removes temporary files that were to take the place of `path` when the program that wrote them was killed, but none
/// that a program is still writing.
pub fn remove_leftovers(path: &Path) {
    let prefix = own_prefix(path);
    for entry in place::folder(path).read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_own = name.to_str().is_some_and(|name| name.starts_with(&prefix) && name.ends_with(SUFFIX));
        if is_own && !is_locked(&entry.path()) {
            // One that stays does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether some program holds the lock of the file at `path`.
fn is_locked(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
}

fn write_as(
    path: &Path,
    prefix: &str,
    permit: impl FnOnce() -> Result<Replace>,
    interrupted: impl Fn() -> bool,
    fill: impl FnOnce(&mut dyn Sink) -> core::result::Result<(), String>,
) -> Result<bool> {
    let place = place::of(path)?;
    let Place::Regular(file) = place else {
        let mut bytes = Cursor::new(Vec::new());
        fill(&mut bytes).map_err(|error| failed(path, error))?;
        let written = stream(&place, bytes.get_ref(), interrupted).map_err(|error| failed(path, error))?;
        return if written { Ok(true) } else { Err(unread(path)) };
    };
    let mut temporary = temporary(path, &file, prefix)?;
    // Where there are no locks, it has none.
    let _ = temporary.as_file().try_lock();
    let is_full = Cell::new(false);
    let filled = fill_temporary(&mut temporary, &file, &is_full, fill);
    filled.map_err(|error| if is_full.get() { full(path, error) } else { failed(path, error) })?;
    let placed = match permit()? {
        Replace::Any => temporary.persist(&file),
        Replace::Nothing => match temporary.persist_noclobber(&file) {
            // Where that cannot be done in one step, it has to do that nothing was there a moment ago.
            Err(error) if error.error.kind() != ErrorKind::AlreadyExists => error.file.persist(&file),
            placed => placed,
        },
        Replace::Never => return Ok(false),
    };
    placed.map_err(|error| failed(path, error.error))?;
    // Not before the folder is on the disk, too, does a power cut leave the new file and not the one before. Where a
    // folder cannot be opened or synced, that is left to the system.
    let _ = File::open(place::folder(&file)).and_then(|folder| folder.sync_all());
    Ok(true)
}

/// Has `fill` write the temporary file that is to take the place of `file`, and waits until it is on the disk; notes if
/// that is full.
fn fill_temporary(
    temporary: &mut NamedTempFile,
    file: &Path,
    is_full: &Cell<bool>,
    fill: impl FnOnce(&mut dyn Sink) -> core::result::Result<(), String>,
) -> core::result::Result<(), String> {
    let text = |error: io::Error| error.to_string();
    let mut buffer = BufWriter::with_capacity(1 << 16, Watched { file: temporary.as_file_mut(), is_full });
    fill(&mut buffer)?;
    buffer.flush().map_err(text)?;
    drop(buffer);
    keep_mode(file, temporary.as_file()).map_err(text)?;
    temporary.as_file().sync_all().inspect_err(|error| is_full.set(is_no_space(error))).map_err(text)
}

/// A file of which it is noted if there is no room for it.
struct Watched<'a> {
    file: &'a mut File,
    is_full: &'a Cell<bool>,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes).inspect_err(|error| self.is_full.set(is_no_space(error)))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Whether the disk is full, or what its user may have of it.
fn is_no_space(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
}

/// The error that there is no room for the file at `path`.
fn full(path: &Path, error: impl core::fmt::Display) -> Error {
    let finding = format!("cannot be written: {error}");
    Error { kind: Kind::NoSpace, ..Error::failure(path.display(), finding, "make room at the destination") }
}

fn failed(path: &Path, error: impl core::fmt::Display) -> Error {
    let remedy = "check the free space and the permissions at the destination";
    Error::failure(path.display(), format!("cannot be written: {error}"), remedy)
}

/// The error that nobody reads the pipe at `path`.
fn unread(path: &Path) -> Error {
    let finding = "is a pipe that nobody had opened for reading when a signal came, so nothing was written";
    let error = Error::failure(path.display(), finding, "start the program that reads it before fogbow is done");
    Error { kind: Kind::Interrupted, ..error }
}

/// Sends `bytes` straight to what is not a regular file; not if `interrupted` says so before anybody reads it.
fn stream(place: &Place, bytes: &[u8], interrupted: impl Fn() -> bool) -> io::Result<bool> {
    let all = |mut to: Box<dyn Write>| to.write_all(bytes).and_then(|()| to.flush()).map(|()| true);
    match place {
        Place::Standard(place::Standard::Output) => all(Box::new(io::stdout().lock())),
        Place::Standard(place::Standard::Error) => all(Box::new(io::stderr().lock())),
        Place::Stream(path) | Place::Regular(path) => match pipe::open(path, interrupted)? {
            Some(file) => all(Box::new(file)),
            None => Ok(false),
        },
    }
}

/// A new file beside `file`, to take its place; `path` is what the user calls that.
fn temporary(path: &Path, file: &Path, prefix: &str) -> Result<NamedTempFile> {
    let folder = place::folder(file);
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Less the umask, as for any new file, but not wider than what it replaces.
        let mode = file.metadata().map_or(0o666, |metadata| metadata.permissions().mode() & 0o666);
        builder.permissions(std::fs::Permissions::from_mode(mode | 0o600));
    }
    builder.tempfile_in(folder).map_err(|error| {
        if is_no_space(&error) {
            return full(path, error);
        }
        // The rest is the temporary file's name, which says nothing to anybody.
        let reason = error.to_string();
        let reason = reason.split(" at path ").next().unwrap_or(&reason);
        let finding = format!("no file can be created in {}: {reason}", folder.display());
        Error::failure(path.display(), finding, "give a path in a folder that exists and is writable")
    })
}

/// Gives `new` the mode of the file that it replaces, if there is one, and its owner, if that is allowed.
#[cfg(unix)]
fn keep_mode(old: &Path, new: &File) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let Ok(old) = old.metadata() else { return Ok(()) };
    let own = new.metadata()?;
    if (own.uid(), own.gid()) != (old.uid(), old.gid()) {
        // Only root may give files away; to everybody else the new file belongs.
        let _ = fchown(new, Some(old.uid()), Some(old.gid()));
    }
    new.set_permissions(old.permissions())
}

#[cfg(not(unix))]
fn keep_mode(_: &Path, _: &File) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_live_program_is_writing_is_no_leftover() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.checkpoint");
        let names = || folder.path().read_dir().expect("a folder").count();
        let written = rewrite(
            &path,
            || Ok(Replace::Any),
            |file| {
                remove_leftovers(&path);
                assert_eq!(names(), 1, "it is locked");
                file.write_all(b"x").map_err(|error| error.to_string())
            },
        );
        assert_eq!(written, Ok(true));
        let leftover = folder.path().join(format!("{}1{SUFFIX}", own_prefix(&path)));
        std::fs::write(&leftover, "x").expect("a file");
        remove_leftovers(&path);
        assert!(path.exists() && !leftover.exists());
    }

    #[test]
    fn a_file_takes_the_place_of_what_it_may() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        let write = |text: &str, replace| {
            rewrite(&path, || Ok(replace), |file| file.write_all(text.as_bytes()).map_err(|error| error.to_string()))
        };
        let content = || std::fs::read_to_string(&path).expect("a file");
        assert_eq!((write("1", Replace::Nothing), content()), (Ok(true), "1".into()));
        let error = write("2", Replace::Nothing).expect_err("there is a file");
        assert!(error.place.ends_with('a') && content() == "1", "{error}");
        assert_eq!((write("3", Replace::Never), content()), (Ok(false), "1".into()));
        assert_eq!((write("4", Replace::Any), content()), (Ok(true), "4".into()));
        assert_eq!(folder.path().read_dir().expect("a folder").count(), 1, "nothing is left over");
    }
}
