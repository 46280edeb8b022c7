//! What the files of a scene contain, in a few bytes each: by which those that were changed are told.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 16;
/// Digits of a hash.
const DIGITS: usize = 16;

/// A line for every one of `files`: hash and name, as seen from the folder of the first, which is the scene's own. That
/// itself is left out unless it `is_model`: its keys are told one by one. So is what cannot be read twice, as pipes.
pub fn of(files: &[PathBuf], is_model: bool) -> String {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    let line = |file: &PathBuf| {
        let name = file.strip_prefix(folder).ok().or(file.file_name().map(Path::new))?;
        Some(format!("{} {}", hash(file).ok()?, name.display()))
    };
    let mut lines: Vec<_> = files.iter().skip(usize::from(!is_model)).filter_map(line).collect();
    lines.sort();
    lines.dedup();
    lines.join("\n")
}

/// The names of files that are not the same in two such lists.
pub fn changed<'a>(there: &'a str, here: &'a str) -> Vec<&'a str> {
    let only_in = |one: &'a str, other: &'a str| {
        one.lines()
            .filter(move |line| other.lines().all(|other| other != *line))
            .filter_map(|line| line.split_once(' '))
    };
    let mut names: Vec<_> = only_in(there, here).chain(only_in(here, there)).map(|(_, name)| name).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// A hash of the content of a regular file.
fn hash(path: &Path) -> io::Result<String> {
    if !path.metadata()?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let (mut file, mut hasher, mut bytes) = (File::open(path)?, blake3::Hasher::new(), vec![0; CHUNK]);
    loop {
        match file.read(&mut bytes)? {
            0 => return Ok(hasher.finalize().to_hex()[..DIGITS].to_string()),
            count => hasher.update(&bytes[..count]),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_differ_are_named() {
        assert_eq!(changed("1 a.glb\n2 sky.hdr", "2 sky.hdr\n3 a.glb"), ["a.glb"]);
        assert_eq!(changed("1 a b.glb", "1 a b.glb\n2 a.png"), ["a.png"]);
        assert!(changed("1 a", "1 a").is_empty());
    }
}
