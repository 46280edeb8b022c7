//! When checkpoints of a render are to be written, where, and what becomes of those that are there.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::RenderArgs;
use super::outputs::ImageOutput;
use super::progress::Reporter;
use super::values::Checkpoints;
use crate::error::{Error, Result};
use crate::figures::percent;
use crate::output;
use crate::session::checkpoint::{Checkpoint, Slot};
use crate::session::{Limits, Session, State};

/// Time between checkpoints where nothing else is asked for.
const INTERVAL: Duration = Duration::from_secs(60);
/// Renders that are known to take no longer than this have none, unless they are asked for.
const LONG: Duration = Duration::from_secs(120);
/// What is added to the name of an output.
const SUFFIX: &str = ".checkpoint";

/// What is asked for.
#[derive(Debug)]
pub struct Plan {
    /// Where checkpoints go; none if there is no output that is a regular file.
    slot: Option<Slot>,
    /// Checkpoints beside further outputs.
    others: Vec<PathBuf>,
    asked: Option<Checkpoints>,
    resume: bool,
    overwrite: bool,
    limits: Limits,
}

impl Plan {
    /// What the command line asks for.
    ///
    /// # Errors
    /// If it asks for checkpoints where there is no place for any.
    pub fn new(args: &RenderArgs, outputs: &[ImageOutput], limits: Limits) -> Result<Self> {
        let (asked, resume, overwrite) = (args.checkpoint, args.resume, args.overwrite_checkpoint);
        let beside = |image: &ImageOutput| {
            let mut path = image.path.clone().into_os_string();
            path.push(SUFFIX);
            PathBuf::from(path)
        };
        let files = outputs.iter().filter(|image| !output::is_stream(&image.path)).map(beside);
        let is_there = |path: &PathBuf| path.symlink_metadata().is_ok();
        let (mut others, free): (Vec<_>, Vec<_>) = files.partition(is_there);
        // What is there may have been begun with fewer outputs.
        let path = if others.is_empty() { free.into_iter().next() } else { Some(others.remove(0)) };
        // Where nobody asked for any, a name that is too long is no reason not to render.
        let is_needed = asked.is_some() || resume || overwrite;
        let is_fit = |path: &PathBuf| is_needed || is_there(path) || output::check(path).is_ok();
        let path = path.filter(is_fit);
        let flag = match asked {
            Some(Checkpoints::Every(_)) => Some("--checkpoint"),
            _ if resume => Some("--resume"),
            _ if overwrite => Some("--overwrite-checkpoint"),
            _ => None,
        };
        if let Some(flag) = flag.filter(|_| path.is_none()) {
            let finding = "there is no place for a checkpoint: no output is a regular file";
            return Err(Error::usage(flag, finding, "write an image to a file, beside which the checkpoint can be"));
        }
        Ok(Self { slot: path.map(Slot::new), others, asked, resume, overwrite, limits })
    }

    /// Where checkpoints go, if any are written, resumed from or overwritten.
    pub fn path(&self) -> Option<&Path> {
        self.slot().map(Slot::path)
    }

    /// The place where they go, the same.
    pub fn slot(&self) -> Option<&Slot> {
        let is_used = self.asked != Some(Checkpoints::Off) || self.resume || self.overwrite;
        self.slot.as_ref().filter(|_| is_used)
    }

    /// Whether a checkpoint is there.
    pub fn has_checkpoint(&self) -> bool {
        self.path().is_some_and(Path::exists)
    }

    /// Whether checkpoints, or to go on from one, were asked for in so many words.
    pub fn is_asked_for(&self) -> bool {
        self.resume || matches!(self.asked, Some(Checkpoints::Every(_)))
    }

    /// The checkpoint to go on from, if there is one and that is asked for.
    ///
    /// # Errors
    /// If there is one that cannot be gone on from, or that nobody said what to do with.
    pub fn existing(&self, session: &Session, reporter: &Reporter) -> Result<Option<Checkpoint>> {
        let Some(slot) = self.slot() else { return Ok(None) };
        let path = slot.path();
        if self.resume || self.overwrite {
            for other in &self.others {
                reporter.warn(format!("{}: is a checkpoint, too, and is left alone", other.display()));
            }
            output::remove_leftovers(path);
        }
        if path.symlink_metadata().is_err() {
            if self.resume {
                reporter.line(format!("there is no checkpoint {}: starting with the first sample", path.display()));
            }
            return Ok(None);
        }
        if self.overwrite {
            slot.clear();
            return Ok(None);
        }
        let checkpoint = Checkpoint::open(path)?;
        if self.resume {
            checkpoint.check(session)?;
            slot.adopt(&checkpoint);
            return Ok(Some(checkpoint));
        }
        let (finding, remedy) = match checkpoint.difference(session) {
            None => (
                "is a checkpoint of this render".to_string(),
                "go on from it with --resume, or start anew with --overwrite-checkpoint",
            ),
            Some(difference) => (
                format!("is the checkpoint of another render: {difference}"),
                if difference.is_in_files {
                    "go on with that render, by its files and --resume, or replace it with --overwrite-checkpoint"
                } else {
                    "go on with that render, by its flags and --resume, or replace it with --overwrite-checkpoint"
                },
            ),
        };
        Err(Error::failure(path.display(), finding, remedy))
    }

    /// Fails if the session, gone on with after it was to be rendered until `before`, is further than it is to get.
    ///
    /// # Errors
    /// If it has more samples than that, or less noise.
    pub fn check_limits(&self, session: &Session, before: Limits, reporter: &Reporter) -> Result<()> {
        let Some(path) = self.path() else { return Ok(()) };
        let fault = |finding: String, remedy: &str| Err(Error::failure(path.display(), finding, remedy));
        if let Some(samples) = self.limits.samples
            && let Some(most) = session.most_beyond(samples)
        {
            let finding = format!("has {most} samples per pixel already, more than the {samples} that are asked for");
            return fault(finding, "ask for as many, or start anew with --overwrite-checkpoint");
        }
        let Some(noise) = self.limits.noise.filter(|noise| before.noise != Some(*noise)) else { return Ok(()) };
        let reached = session.film.relative_noise();
        // What was to get as noisy as this may have got there just before it was killed.
        if reached <= noise && before.noise.is_none_or(|before| before < noise) {
            let [has, asked] = [reached, noise].map(percent);
            let finding = format!("has a noise of {has} already, less than the {asked} that are asked for");
            return fault(finding, "ask for less noise, as before, or start anew with --overwrite-checkpoint");
        }
        let was = before.noise.map_or_else(|| "not given before".into(), |noise| format!("{noise} before"));
        let end = "the render may end with more samples than one that had it from the start";
        reporter.line(format!("--noise is {noise}, and was {was}: {end}"));
        Ok(())
    }

    /// Whether a render in this state is to have checkpoints.
    pub fn wants(&self, state: &State) -> bool {
        match self.asked {
            Some(Checkpoints::Off) => false,
            Some(Checkpoints::Every(_)) => true,
            None if self.resume => true,
            None if self.limits.time.is_some_and(|time| time <= LONG) => false,
            // What nothing is known of may take months.
            None => state.projected().is_none_or(|seconds| seconds > LONG.as_secs_f64()),
        }
    }

    /// Time between checkpoints.
    pub fn interval(&self) -> Duration {
        match self.asked {
            Some(Checkpoints::Every(interval)) => interval,
            Some(Checkpoints::Off) | None => INTERVAL,
        }
    }

    /// Removes the checkpoint of a render whose results are written.
    pub fn remove(&self, reporter: &Reporter) {
        let Some(slot) = self.slot() else { return };
        let path = slot.path().display();
        match slot.remove() {
            Ok(true) => {}
            Ok(false) => reporter.warn(format!("{path}: is a checkpoint of another run, and is left alone")),
            Err(error) => reporter.warn(format!("{path}: the checkpoint cannot be removed: {error}")),
        }
    }
}
