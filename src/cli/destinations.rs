//! Where results go: each to a place of its own, and none over what the command reads.

use std::path::{Path, PathBuf};

use super::Progress;
use crate::error::{Error, Result};
use crate::output;

/// A path that a flag names for a result.
#[derive(Clone, Copy, Debug)]
pub struct Destination<'a> {
    /// The flag.
    pub flag: &'static str,
    /// The path after it.
    pub path: &'a Path,
}

impl Destination<'_> {
    fn refuse(&self, finding: &str, remedy: &str) -> Result<()> {
        Err(Error::usage(format!("{} {}", self.flag, self.path.display()), finding, remedy))
    }

    /// The error that this is where `others` go, or one of the `inputs`.
    fn refuse_clash(&self, others: &[Destination<'_>], inputs: &[PathBuf]) -> Result<()> {
        if inputs.iter().any(|input| output::are_same(input, self.path)) {
            return self.refuse("names a file that this command reads", "give the result a file of its own");
        }
        if others.iter().any(|other| output::are_same(other.path, self.path)) {
            return self.refuse("names the same file as another output", "name each file only once");
        }
        Ok(())
    }
}

/// Fails if one of `destinations` is standard output, and progress goes there, too.
pub fn check_lines(destinations: &[Destination<'_>], progress: Progress) -> Result<()> {
    let style = match progress {
        Progress::Openjd => "openjd",
        Progress::Alf => "alf",
        Progress::Auto | Progress::Bar | Progress::Plain | Progress::Json | Progress::None => return Ok(()),
    };
    destinations.iter().filter(|destination| output::is_standard_output(destination.path)).try_for_each(|destination| {
        let finding = format!("names standard output, where --progress {style} writes its lines");
        destination.refuse(&finding, "write it to a file of its own")
    })
}

/// Fails unless every destination can be written, is named once, and is none of the `inputs`.
pub fn check(destinations: &[Destination<'_>], inputs: &[PathBuf]) -> Result<()> {
    for (index, destination) in destinations.iter().enumerate() {
        destination.refuse_clash(&destinations[..index], inputs)?;
        output::check(destination.path)?;
    }
    Ok(())
}
