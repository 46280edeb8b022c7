//! Images on disk.

pub mod exr;
pub mod png;
pub mod tone;

use crate::error::{Error, Result};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// An image in memory: named planes of equal size.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Planes, row-major from the top, by name.
    pub channels: Vec<(String, Vec<f32>)>,
    /// What the file says about itself, as text.
    pub header: Vec<(String, String)>,
}

impl Image {
    /// The plane called `name`.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|(channel, _)| channel == name).map(|(_, values)| values.as_slice())
    }
}

/// Whether the name of `path` says that it is an EXR image.
pub fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"))
}

/// Whether the name of `path` says that it is a PNG image.
pub fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

/// Fails if no file can be made at `path`, so that nobody finds out after an hour of rendering.
///
/// # Errors
/// If the folder does not exist or cannot be written, or `path` is a folder or no possible name.
pub fn check_writable(path: &Path) -> Result<()> {
    let refuse = |finding: String| Err(Error::failure(path.display(), finding, "give the path of a file"));
    let ends_in_separator = path.to_string_lossy().ends_with(std::path::is_separator);
    if path.is_dir() || ends_in_separator {
        return refuse("is a folder".into());
    }
    temporary(path)?;
    match path.metadata() {
        Err(error) if error.kind() != ErrorKind::NotFound => refuse(format!("cannot be a file: {error}")),
        _ => Ok(()),
    }
}

/// Writes a whole file or none: `fill` writes to a temporary file beside it, which then takes its place.
///
/// # Errors
/// If anything cannot be written.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut std::fs::File>) -> core::result::Result<(), String>,
) -> Result<()> {
    let failed = |what: String| Error::failure(path.display(), what, "check free space and permissions of its folder");
    let mut file = temporary(path)?;
    let mut buffer = BufWriter::with_capacity(1 << 16, file.as_file_mut());
    fill(&mut buffer).map_err(|error| failed(format!("cannot be written: {error}")))?;
    buffer.flush().map_err(|error| failed(format!("cannot be written: {error}")))?;
    drop(buffer);
    file.as_file().sync_all().map_err(|error| failed(format!("cannot be written to disk: {error}")))?;
    file.persist(destination(path)).map_err(|error| failed(format!("cannot take its place: {}", error.error)))?;
    Ok(())
}

/// The file behind a symbolic link, or else `path` itself.
fn destination(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}

fn temporary(path: &Path) -> Result<tempfile::NamedTempFile> {
    let destination = destination(path);
    let folder = match destination.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".fogbow-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the umask, as for any new file
    }
    builder.tempfile_in(folder).map_err(|error| {
        // The rest is the temporary file's name, which says nothing to anybody.
        let reason = error.to_string();
        let reason = reason.split(" at path ").next().unwrap_or(&reason);
        let finding = format!("no file can be made in {}: {reason}", folder.display());
        Error::failure(path.display(), finding, "give a path in a folder that exists and can be written")
    })
}
