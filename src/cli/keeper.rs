//! Writes checkpoints while a render runs, and at its end.

use std::path::Path;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::Scope;
use std::time::Instant;

use super::checkpoints::Plan;
use super::patience::Patience;
use super::progress::Reporter;
use super::signals::Signals;
use crate::error::{Error, Result};
use crate::figures::duration;
use crate::session::checkpoint::Slot;
use crate::session::{Session, State};

/// Writes checkpoints while a render runs.
pub struct Keeper<'p> {
    plan: &'p Plan,
    /// Tells the thread that writes to write; none if there is nowhere to write to.
    order: Option<Sender<()>>,
    /// Whether what was written is there now, or else a checkpoint of another run that is further along.
    written: Receiver<Result<bool>>,
    /// Whether the thread is at it, and whether somebody waits to be told.
    is_writing: bool,
    is_awaited: bool,
    /// When the last one was begun, or else the render.
    last: Instant,
    /// Why the last one could not be written, if so.
    failure: Option<Error>,
    was_told: bool,
    was_behind: bool,
}

/// What became of the samples of a render at its end.
#[derive(Clone, Debug)]
pub enum Kept {
    /// A checkpoint has them, or that of a run of the same render that is further along.
    Yes,
    /// They were not to be kept.
    No,
    /// The last checkpoint could not be written.
    Failed {
        /// Why.
        error: Error,
        /// Whether that was told.
        is_told: bool,
    },
}

impl Kept {
    /// Whether a checkpoint has all samples.
    pub fn is_all(&self) -> bool {
        matches!(self, Self::Yes)
    }

    /// Says that no checkpoint could be written, if that is so.
    pub fn tell(&self, reporter: &Reporter) {
        let Self::Failed { error: Error { place, finding, .. }, is_told } = self else { return };
        let failure = "no checkpoint could be written";
        if *is_told {
            reporter.warn(format!("{place}: {failure} there by the end of the render"));
        } else {
            reporter.warn(format!("{failure} by the end of the render: {place}: {finding}"));
        }
    }
}

impl<'p> Keeper<'p> {
    /// Begins, with a thread for slow disks.
    pub fn start<'s>(scope: &'s Scope<'s, '_>, session: &'s Session, plan: &'p Plan) -> Self
    where
        'p: 's,
    {
        let (order, orders) = mpsc::channel();
        let (tell, written) = mpsc::channel();
        let order = plan.slot().map(|slot| {
            scope.spawn(move || {
                for () in orders {
                    // Nobody listens any more once the render has ended.
                    let _ = tell.send(slot.write(session));
                }
            });
            order
        });
        Self {
            plan,
            order,
            written,
            is_writing: false,
            is_awaited: false,
            last: Instant::now(),
            failure: None,
            was_told: false,
            was_behind: false,
        }
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

    fn path(&self) -> &Path {
        self.plan.path().unwrap_or(Path::new(""))
    }

    fn note(&mut self, result: Result<bool>, reporter: &Reporter) {
        self.is_writing = false;
        self.failure = None;
        match result {
            Ok(is_own) => self.note_written(is_own, reporter),
            Err(error) => {
                if !self.was_told || self.is_awaited {
                    self.was_told = true;
                    let interval = duration(self.plan.interval().as_secs_f64());
                    let next = format!("the render goes on; the next try is in {interval}");
                    let Error { place, finding, .. } = &error;
                    reporter.warn(format!("no checkpoint could be written: {place}: {finding}; {next}"));
                }
                self.failure = Some(error);
            }
        }
    }

    fn note_written(&mut self, is_own: bool, reporter: &Reporter) {
        let path = self.path().display().to_string();
        if is_own && self.is_awaited {
            reporter.line(format!("{path}: checkpoint written"));
        }
        if !is_own && !self.was_behind {
            self.was_behind = true;
            let finding = "is a checkpoint of another run of this render, which is further along, and is left alone";
            reporter.warn(format!("{path}: {finding}"));
        }
    }

    /// Ends with the render: writes a last checkpoint if the render was `stopped` and is to have one.
    pub fn end(
        mut self,
        session: &Session,
        state: &State,
        stopped: bool,
        patience: &Patience,
        reporter: &Reporter,
    ) -> Kept {
        self.order = None;
        if self.is_writing {
            match self.written.recv() {
                // What there is to say of it is said at the end.
                Ok(Err(error)) => self.failure = Some(error),
                Ok(written) => self.note(written, reporter),
                Err(_) => {}
            }
        }
        let wants = stopped && session.film.samples() > 0 && self.plan.wants(state);
        let Some(slot) = self.plan.slot().filter(|_| wants) else { return self.kept() };
        self.is_awaited = false;
        match patience.retry(reporter, || slot.write(session)) {
            Ok(is_own) => {
                self.note_written(is_own, reporter);
                Kept::Yes
            }
            Err(error) => {
                self.failure = Some(error);
                self.kept()
            }
        }
    }

    fn kept(self) -> Kept {
        let is_told = self.was_told;
        self.failure.map_or(Kept::No, |error| Kept::Failed { error, is_told })
    }
}

/// Writes a checkpoint now, of a render whose results could not be written, and of whose samples this became `before`.
pub fn write(slot: &Slot, session: &Session, before: &Kept) -> Kept {
    let is_told = matches!(before, Kept::Failed { is_told: true, .. });
    slot.write(session).map_or_else(|error| Kept::Failed { error, is_told }, |_| Kept::Yes)
}
