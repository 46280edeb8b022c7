//! Where a path leads, and what is there.

use std::fs::FileType;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Symbolic links in a row before they are taken for a circle: what Linux follows.
const MOST_LINKS: usize = 40;

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A regular file, or one that is not there yet; no symbolic link.
    Regular(PathBuf),
    /// A pipe, a terminal, a device, or a file that this process has open.
    Stream(PathBuf),
    /// What this process writes to anyway.
    Standard(Standard),
}

/// Standard streams.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standard {
    /// Standard output.
    Output,
    /// Standard error.
    Error,
}

/// What all paths to one thing have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Device and inode of what is there.
    #[cfg(unix)]
    There(u64, u64),
    /// The path without links, of what may not be there yet.
    Path(PathBuf),
}

/// What `path` leads to; none if it leads nowhere, or to the null device, where nothing is lost.
pub fn identity(path: &Path) -> Option<Identity> {
    let (end, metadata) = follow(path).ok()?;
    #[cfg(unix)]
    if let Some(metadata) = metadata {
        use std::os::unix::fs::MetadataExt;
        return (!is_null(&metadata)).then(|| Identity::There(metadata.dev(), metadata.ino()));
    }
    #[cfg(not(unix))]
    if metadata.is_some() {
        return end.canonicalize().ok().map(Identity::Path);
    }
    Some(Identity::Path(folder(&end).canonicalize().ok()?.join(end.file_name()?)))
}

#[cfg(unix)]
fn is_null(metadata: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::{FileTypeExt, MetadataExt};
    let null = Path::new("/dev/null").metadata();
    metadata.file_type().is_char_device() && null.is_ok_and(|null| null.rdev() == metadata.rdev())
}

/// The folder that a file is in or will be.
pub fn folder(file: &Path) -> &Path {
    file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Where `path` leads.
///
/// # Errors
/// If it is nothing that a result can be written to.
pub fn of(path: &Path) -> Result<Place> {
    let refuse = |finding: String| Error::failure(path.display(), finding, "give the path of a file");
    if path.as_os_str().is_empty() {
        return Err(Error::failure("\"\"", "is an empty path", "give the path of a file"));
    }
    if path.to_string_lossy().ends_with(std::path::is_separator) {
        return Err(refuse("is a folder".into()));
    }
    let (end, metadata) = follow(path).map_err(|error| refuse(format!("cannot be used as a file: {error}")))?;
    let Some(metadata) = metadata else { return Ok(Place::Regular(end)) };
    let kind = metadata.file_type();
    if let Some(what) = unsuitable(kind) {
        return Err(refuse(format!("is {what}")));
    }
    if is_open_file(&end) {
        return Ok(match descriptor(&end) {
            Some(1) => Place::Standard(Standard::Output),
            Some(2) => Place::Standard(Standard::Error),
            _ => Place::Stream(end),
        });
    }
    if let Some(reason) = forbidden(&end, &metadata) {
        let remedy = "give another path, or make it writable first";
        return Err(Error::failure(path.display(), reason, remedy));
    }
    if !is_replaceable(&end, &metadata) {
        let finding = "belongs to another user, and its folder lets only owners replace files";
        return Err(Error::failure(path.display(), finding, "give another path"));
    }
    Ok(if kind.is_file() { Place::Regular(end) } else { Place::Stream(end) })
}

/// The path at the end of all symbolic links, and what is there. The links to files that a process has open are the
/// end: their targets are not paths.
fn follow(path: &Path) -> io::Result<(PathBuf, Option<std::fs::Metadata>)> {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let metadata = match path.symlink_metadata() {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok((path, None)),
            metadata => metadata?,
        };
        if !metadata.is_symlink() || is_open_file(&path) {
            let metadata = path.metadata()?;
            return Ok((path, Some(metadata)));
        }
        path = folder(&path).join(path.read_link()?);
    }
    Err(io::Error::other("its symbolic links form a loop"))
}

/// Whether `path` stands for a file that some process has open.
fn is_open_file(path: &Path) -> bool {
    let folder = folder(path).canonicalize().unwrap_or_default();
    folder.starts_with("/proc") && folder.ends_with("fd")
}

/// The number of the open file of this process that `path` stands for.
fn descriptor(path: &Path) -> Option<u32> {
    let own = Path::new("/proc/self/fd").canonicalize().ok()?;
    let is_own = folder(path).canonicalize().is_ok_and(|folder| folder == own);
    is_own.then(|| path.file_name()?.to_str()?.parse().ok()).flatten()
}

/// What cannot hold a result, in words.
fn unsuitable(kind: FileType) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_block_device() {
            return Some("a disk, whose contents would be lost");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    kind.is_dir().then_some("a folder")
}

/// Why what exists at `path` may not be written, or replaced, if it may not.
#[cfg(unix)]
fn forbidden(path: &Path, metadata: &std::fs::Metadata) -> Option<String> {
    use rustix::fs::{Access, access};
    use std::os::unix::fs::PermissionsExt;
    // Root may write all, but the owner's mark is there to be kept.
    if metadata.is_file() && metadata.permissions().mode() & 0o200 == 0 {
        return Some("is read-only".into());
    }
    let error = io::Error::from(access(path, Access::WRITE_OK).err()?);
    Some(match error.kind() {
        ErrorKind::PermissionDenied => "is read-only".into(),
        _ => format!("cannot be written: {error}"),
    })
}

/// Whether a new file may take the place of the one at `path`: in a folder with the sticky bit, as `/tmp` is one, that
/// is for the owners of the file and of the folder, and for root.
#[cfg(unix)]
fn is_replaceable(path: &Path, metadata: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    const STICKY: u32 = 0o1000;
    let Ok(folder) = folder(path).metadata() else { return true };
    let user = rustix::process::geteuid();
    let is_owner = [metadata.uid(), folder.uid()].contains(&user.as_raw());
    !metadata.is_file() || folder.mode() & STICKY == 0 || is_owner || user.is_root()
}

#[cfg(not(unix))]
fn is_replaceable(_: &Path, _: &std::fs::Metadata) -> bool {
    true
}

#[cfg(not(unix))]
fn forbidden(_: &Path, metadata: &std::fs::Metadata) -> Option<String> {
    metadata.permissions().readonly().then(|| "is read-only".into())
}
