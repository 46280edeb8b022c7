//! Frames of an animation: which, at what time, and where their images go.

use std::path::{Path, PathBuf};

use super::RenderArgs;
use super::values::FrameRange;
use crate::error::{Error, Result};
use crate::live::Turn;
use crate::output;

/// Frames per second where nothing else is asked for.
pub const FRAMES_PER_SECOND: f64 = 24.0;
/// Where the number of a frame goes in the name of a file.
const PLACE: char = '#';

/// Frames to render one after the other.
#[derive(Clone, Debug)]
pub struct Sequence {
    range: FrameRange,
    frames_per_second: f64,
}

impl Sequence {
    /// Those that the command line asks for, if it does.
    ///
    /// # Errors
    /// If they would all have the same name.
    pub fn new(args: &RenderArgs) -> Result<Option<Self>> {
        let Some(range) = args.frames.clone() else { return Ok(None) };
        args.output.iter().try_for_each(|image| check("--output", &image.path))?;
        args.stats.iter().try_for_each(|path| check("--stats", path))?;
        Ok(Some(Self { range, frames_per_second: args.fps.unwrap_or(FRAMES_PER_SECOND) }))
    }

    /// All of them.
    pub fn turns(&self) -> impl Iterator<Item = Turn> + use<> {
        let (start, count) = (*self.range.start(), self.range.end() - self.range.start() + 1);
        (0..count).map(move |index| Turn { frame: start + index, place: index + 1, count })
    }

    /// When one of them is `[s]`; frame 0 is at 0.
    pub fn time(&self, turn: Turn) -> f64 {
        f64::from(turn.frame) / self.frames_per_second
    }
}

/// Fails if the frames would replace each other at `path`. A pipe takes one after the other.
fn check(flag: &str, path: &Path) -> Result<()> {
    if numbered(path, 0) != path || output::is_stream(path) {
        return Ok(());
    }
    let place = format!("{flag} {}", path.display());
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
    let remedy = format!("put #### where the number of the frame goes, as in {stem}.####{ending}");
    Err(Error::usage(place, "names one file for all frames", remedy))
}

/// `path` with the number of a frame in the place of the last `####` of its name, with at least as many digits.
pub fn numbered(path: &Path, frame: u32) -> PathBuf {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return path.into() };
    let Some(end) = name.rfind(PLACE).map(|last| last + 1) else { return path.into() };
    let start = name[..end].trim_end_matches(PLACE).len();
    path.with_file_name(format!("{}{frame:0width$}{}", &name[..start], &name[end..], width = end - start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_the_place_of_the_last_hashes_of_a_name() {
        let numbered = |path: &str, frame| numbered(Path::new(path), frame).to_str().map(String::from);
        for (path, frame, expected) in [
            ("a.####.exr", 7, "a.0007.exr"),
            ("a.####.exr", 12345, "a.12345.exr"),
            ("a#.png", 3, "a3.png"),
            ("##b##.png", 3, "##b03.png"),
            ("take#2/###.exr", 40, "take#2/040.exr"),
            ("a.exr", 7, "a.exr"),
            ("a#/b.exr", 7, "a#/b.exr"),
        ] {
            assert_eq!(numbered(path, frame).as_deref(), Some(expected));
        }
    }
}
