//! When checkpoints of a render are written, where, and what becomes of them.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::Scope;
use std::time::{Duration, Instant};

use super::RenderArgs;
use super::progress::Reporter;
use super::signals::Signals;
use super::values::{Checkpoints, ImageOutput};
use crate::error::{Error, Result};
use crate::figures::duration;
use crate::output;
use crate::session::checkpoint::Checkpoint;
use crate::session::{Limits, Session, State};

/// Time between checkpoints where nothing else is asked for.
const INTERVAL: Duration = Duration::from_secs(60);
/// Renders that take no longer than this have none, unless they are asked for.
const LONG: Duration = Duration::from_secs(120);
/// What is added to the name of the first output.
const SUFFIX: &str = ".checkpoint";

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Where checkpoints go; none if there is no output that is a regular file.
    path: Option<PathBuf>,
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
        let file = outputs.iter().find(|image| !output::is_stream(&image.path));
        let (asked, resume, overwrite) = (args.checkpoint, args.resume, args.overwrite_checkpoint);
        let path = file.map(|image| {
            let mut path = image.path.clone().into_os_string();
            path.push(SUFFIX);
            PathBuf::from(path)
        });
        // Where nobody asked for any, a name that is too long is no reason not to render.
        let is_needed = asked.is_some() || resume || overwrite;
        let is_fit = |path: &PathBuf| is_needed || path.symlink_metadata().is_ok() || output::check(path).is_ok();
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
        Ok(Self { path, asked, resume, overwrite, limits })
    }

    /// Where checkpoints go, if any are written, resumed from or overwritten.
    pub fn path(&self) -> Option<&Path> {
        let is_used = self.asked != Some(Checkpoints::Off) || self.resume || self.overwrite;
        self.path.as_deref().filter(|_| is_used)
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
        let Some(path) = self.path() else { return Ok(None) };
        if self.resume || self.overwrite {
            output::remove_leftovers(path);
        }
        if path.symlink_metadata().is_err() {
            if self.resume {
                reporter.line(format!("there is no checkpoint {}: starting with the first sample", path.display()));
            }
            return Ok(None);
        }
        if self.overwrite {
            return Ok(None);
        }
        let checkpoint = Checkpoint::open(path)?;
        if self.resume {
            checkpoint.check(session)?;
            return Ok(Some(checkpoint));
        }
        let (finding, remedy) = match checkpoint.difference(session) {
            None => (
                "is a checkpoint of this render".to_string(),
                "go on from it with --resume, or start anew with --overwrite-checkpoint",
            ),
            Some(difference) => (
                format!("is the checkpoint of another render: {difference}"),
                "go on with that render, by its flags and --resume, or replace it with --overwrite-checkpoint",
            ),
        };
        Err(Error::failure(path.display(), finding, remedy))
    }

    /// Fails if the session, gone on with, has more samples than it is to get.
    pub fn check_samples(&self, session: &Session) -> Result<()> {
        let (Some(samples), Some(path)) = (self.limits.samples, self.path()) else { return Ok(()) };
        let Some(most) = session.most_beyond(samples) else { return Ok(()) };
        let finding = format!("has {most} samples per pixel already, more than the {samples} that are asked for");
        Err(Error::failure(path.display(), finding, "ask for as many, or start anew with --overwrite-checkpoint"))
    }

    /// Whether a render in this state is to have checkpoints.
    fn wants(&self, state: &State) -> bool {
        match self.asked {
            Some(Checkpoints::Off) => false,
            Some(Checkpoints::Every(_)) => true,
            None if self.resume => true,
            None => match state.seconds_left {
                Some(left) => state.elapsed.as_secs_f64() + left > LONG.as_secs_f64(),
                // Nothing is known of it yet but the time that it may take.
                None => self.limits.time.map_or(state.elapsed >= INTERVAL, |time| time > LONG),
            },
        }
    }

    fn interval(&self) -> Duration {
        match self.asked {
            Some(Checkpoints::Every(interval)) => interval,
            Some(Checkpoints::Off) | None => INTERVAL,
        }
    }

    /// Removes the checkpoint of a render whose results are written.
    pub fn remove(&self, reporter: &Reporter) {
        let Some(path) = self.path() else { return };
        match std::fs::remove_file(path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                reporter.warn(format!("{}: the checkpoint cannot be removed: {error}", path.display()));
            }
            _ => {}
        }
    }
}

/// Writes checkpoints while a render runs.
pub struct Keeper<'p> {
    plan: &'p Plan,
    /// Tells the thread that writes to write; none if there is nowhere to write to.
    order: Option<Sender<()>>,
    written: Receiver<Result<()>>,
    /// Whether the thread is at it, and whether somebody waits to be told.
    is_writing: bool,
    is_awaited: bool,
    /// When the last one was begun, or else the render.
    last: Instant,
    /// Why the last one could not be written, if so.
    failure: Option<Error>,
    was_told: bool,
}

impl<'p> Keeper<'p> {
    /// Begins, with a thread for slow disks.
    pub fn start<'s>(scope: &'s Scope<'s, '_>, session: &'s Session, plan: &'p Plan) -> Self
    where
        'p: 's,
    {
        let (order, orders) = mpsc::channel();
        let (tell, written) = mpsc::channel();
        let order = plan.path().map(|path| {
            scope.spawn(move || {
                for () in orders {
                    // Nobody listens any more once the render has ended.
                    let _ = tell.send(session.write_checkpoint(path));
                }
            });
            order
        });
        let (last, failure) = (Instant::now(), None);
        Self { plan, order, written, is_writing: false, is_awaited: false, last, failure, was_told: false }
    }

    /// Has a checkpoint written if it is time to, or a signal asks for one.
    pub fn look(&mut self, state: &State, signals: &Signals, reporter: &Reporter) {
        if let Ok(result) = self.written.try_recv() {
            self.note(result, reporter);
        }
        if state.preparing || state.samples == 0 || self.is_writing {
            return;
        }
        let is_asked = signals.asks_for_checkpoint();
        let Some(order) = &self.order else {
            if is_asked {
                reporter.warn("no checkpoint is written: they are off, or no output is a regular file");
            }
            return;
        };
        if is_asked || (self.last.elapsed() >= self.plan.interval() && self.plan.wants(state)) {
            (self.last, self.is_writing, self.is_awaited) = (Instant::now(), true, is_asked);
            // The thread ends with this sender.
            let _ = order.send(());
        }
    }

    fn note(&mut self, result: Result<()>, reporter: &Reporter) {
        self.is_writing = false;
        self.failure = result.err();
        let path = self.plan.path().unwrap_or(Path::new(""));
        match &self.failure {
            None if self.is_awaited => reporter.line(format!("{}: checkpoint written", path.display())),
            Some(error) if !self.was_told || self.is_awaited => {
                self.was_told = true;
                let interval = duration(self.plan.interval().as_secs_f64());
                let next = format!("the render goes on; the next try is in {interval}");
                reporter.warn(format!("no checkpoint could be written: {}: {}; {next}", error.place, error.finding));
            }
            _ => {}
        }
    }

    /// Ends with the render: writes a last checkpoint if the render was `stopped` and is to have one. Whether it is
    /// there.
    pub fn end(mut self, session: &Session, state: &State, stopped: bool, reporter: &Reporter) -> bool {
        self.order = None;
        if self.is_writing
            && let Ok(result) = self.written.recv()
        {
            self.note(result, reporter);
        }
        if !stopped {
            if let Some(error) = &self.failure {
                reporter.warn(format!("{}: no checkpoint could be written there to the end", error.place));
            }
            return false;
        }
        if session.film.samples() == 0 || !self.plan.wants(state) {
            return false;
        }
        write(self.plan, session, reporter)
    }
}

/// Writes a checkpoint now; whether that went well.
pub fn write(plan: &Plan, session: &Session, reporter: &Reporter) -> bool {
    let Some(path) = plan.path() else { return false };
    match session.write_checkpoint(path) {
        Ok(()) => true,
        Err(error) => {
            reporter.warn(format!("no checkpoint could be written: {}: {}", error.place, error.finding));
            false
        }
    }
}
