//! The images that a merge is given: by name, in folders, in lists.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::image::Format;
use crate::output;

/// What the name of a list begins with.
const LIST: &[u8] = b"@";

/// All images that are `named`: files, those in folders but for the `results` of this command, and the lines of lists.
///
/// # Errors
/// If a folder or a list cannot be read, or names no image.
pub fn all(named: &[PathBuf], results: &[&Path]) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in named {
        match path.as_os_str().as_encoded_bytes().strip_prefix(LIST) {
            Some(name) => all.extend(listed(path, Path::new(&text(name)))?),
            None if path.is_dir() => all.extend(within(path, results)?),
            None => all.push(path.clone()),
        }
    }
    Ok(all)
}

/// The lines of the file at `path`, which the command line calls `name`.
fn listed(name: &Path, path: &Path) -> Result<Vec<PathBuf>> {
    let bytes = std::fs::read(path).map_err(|error| {
        let remedy = "name a file with the path of an image in every line; if this is an image, put ./ before it";
        Error::failure(name.display(), format!("cannot be read: {error}"), remedy)
    })?;
    let lines = bytes.split(|byte| *byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    let paths: Vec<_> = lines.filter(|line| !line.is_empty()).map(|line| PathBuf::from(text(line))).collect();
    if paths.is_empty() {
        let remedy = "write the path of an image in every line";
        return Err(Error::failure(name.display(), "lists no image", remedy));
    }
    Ok(paths)
}

/// The images in the folder at `path`, by name.
fn within(path: &Path, results: &[&Path]) -> Result<Vec<PathBuf>> {
    let entries = path.read_dir().and_then(|entries| entries.collect::<std::io::Result<Vec<_>>>());
    let entries = entries.map_err(|error| {
        Error::failure(path.display(), format!("cannot be read: {error}"), "check the path and its permissions")
    })?;
    let is_hidden = |file: &Path| file.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
    let is_result = |file: &Path| results.iter().any(|result| output::are_same(result, file));
    let mut files: Vec<_> = entries.into_iter().map(|entry| entry.path()).collect();
    files.retain(|file| Format::of(file) == Some(Format::Exr) && !is_hidden(file) && !is_result(file));
    files.sort();
    if files.is_empty() {
        return Err(Error::failure(path.display(), "is a folder without EXR images", "name the folder of the parts"));
    }
    Ok(files)
}

/// A name as the system has it.
#[cfg(unix)]
fn text(bytes: &[u8]) -> std::ffi::OsString {
    use std::os::unix::ffi::OsStrExt;
    OsStr::from_bytes(bytes).to_owned()
}

#[cfg(not(unix))]
fn text(bytes: &[u8]) -> std::ffi::OsString {
    String::from_utf8_lossy(bytes).into_owned().into()
}
