//! Files that a command leaves behind.
//!
//! A regular file is written whole or not at all: a temporary file beside it takes its place, with its mode and, where
//! the system allows, its owner. What is not a regular file, a pipe, a terminal, `/dev/stdout`, is never replaced:
//! bytes go straight into it, from memory. Symbolic links are followed, also to where nothing is yet.

mod pipe;
mod place;

use std::fs::File;
use std::io::{self, BufWriter, Cursor, Seek, Write};
use std::path::Path;

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
    write_as(path, PREFIX, interrupted, fill)
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
/// leaves is found by [`remove_leftovers`].
///
/// # Errors
/// As [`write()`].
pub fn rewrite(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> core::result::Result<(), String>) -> Result<()> {
    write_as(path, &own_prefix(path), || false, fill)
}

/// Removes temporary files that were to take the place of `path` when the program that wrote them was killed.
pub fn remove_leftovers(path: &Path) {
    let prefix = own_prefix(path);
    for entry in place::folder(path).read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name.to_str().is_some_and(|name| name.starts_with(&prefix) && name.ends_with(SUFFIX)) {
            // One that stays does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

fn write_as(
    path: &Path,
    prefix: &str,
    interrupted: impl Fn() -> bool,
    fill: impl FnOnce(&mut dyn Sink) -> core::result::Result<(), String>,
) -> Result<()> {
    let place = place::of(path)?;
    let Place::Regular(file) = place else {
        let mut bytes = Cursor::new(Vec::new());
        fill(&mut bytes).map_err(|error| failed(path, error))?;
        let written = stream(&place, bytes.get_ref(), interrupted).map_err(|error| failed(path, error))?;
        return if written { Ok(()) } else { Err(unread(path)) };
    };
    let mut temporary = temporary(path, &file, prefix)?;
    let mut buffer = BufWriter::with_capacity(1 << 16, temporary.as_file_mut());
    fill(&mut buffer).map_err(|error| failed(path, error))?;
    buffer.flush().map_err(|error| failed(path, error))?;
    drop(buffer);
    keep_mode(&file, temporary.as_file()).map_err(|error| failed(path, error))?;
    temporary.as_file().sync_all().map_err(|error| failed(path, error))?;
    temporary.persist(&file).map_err(|error| failed(path, error.error))?;
    // Not before the folder is on the disk, too, does a power cut leave the new file and not the one before. Where a
    // folder cannot be opened or synced, that is left to the system.
    let _ = File::open(place::folder(&file)).and_then(|folder| folder.sync_all());
    Ok(())
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
fn temporary(path: &Path, file: &Path, prefix: &str) -> Result<tempfile::NamedTempFile> {
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
