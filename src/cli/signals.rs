//! Signals that end a render: it writes what there is, and its exit code says which it was. A second one ends it at
//! once, unless it comes so soon that it means the first. SIGUSR1 asks for a checkpoint.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::error::{Error, Result};

#[cfg(unix)]
const ENDING: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [SIGINT, SIGTERM];

/// What a shell adds to the number of the signal that ended a program.
const ENDED_BY_SIGNAL: i32 = 128;

/// For so long after a signal, others are taken for the same: whoever ends a group of processes, as `timeout` does, may
/// send it to one of them and then to the group, and a terminal and the program in between may both hand on Ctrl-C.
const SAME: Duration = Duration::from_secs(1);
/// Time between looks at whether a signal came.
const TICK: Duration = Duration::from_millis(50);

/// The signal that came, if one did.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    received: Arc<AtomicUsize>,
    checkpoint: Arc<AtomicBool>,
    /// Set by a signal, and by whatever else stops the render at hand.
    stop: Arc<AtomicBool>,
}

impl Signals {
    /// Waits for signals from now on. Those that whoever started the program had it ignore, as
    /// `nohup` does, stay ignored.
    pub fn watch() -> Result<Self> {
        let (signals, is_urgent) = (Self::default(), Arc::default());
        each(|signal| signals.watch_for(signal, &is_urgent))?;
        signals.clone().arm(is_urgent).map_err(|error| unwatched(&error))?;
        #[cfg(unix)]
        if !is_ignored(signal_hook::consts::SIGUSR1) {
            // Without it there are still checkpoints now and then.
            let _ = flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&signals.checkpoint));
        }
        Ok(signals)
    }

    /// Whether a signal asked for a checkpoint since this was last asked.
    pub fn asks_for_checkpoint(&self) -> bool {
        self.checkpoint.swap(false, Ordering::Relaxed)
    }

    /// Whether somebody or something other than Ctrl-C ended the render, as those do who start it again later.
    pub fn ended_by_others(&self) -> bool {
        self.came() && self.received.load(Ordering::Relaxed) != SIGINT as usize
    }

    /// Once a signal has come, and its repeats with it, the next one is urgent.
    fn arm(self, is_urgent: Arc<AtomicBool>) -> std::io::Result<()> {
        let arm = move || {
            while !self.came() {
                thread::sleep(TICK);
            }
            thread::sleep(SAME);
            is_urgent.store(true, Ordering::SeqCst);
        };
        thread::Builder::new().name("signals".into()).spawn(arm).map(drop)
    }

    fn watch_for(&self, signal: i32, is_urgent: &Arc<AtomicBool>) -> std::io::Result<()> {
        flag::register_conditional_shutdown(signal, ENDED_BY_SIGNAL + signal, Arc::clone(is_urgent))?;
        flag::register_usize(signal, Arc::clone(&self.received), signal as usize)?;
        // After the number: whoever clears this flag and then finds none loses no signal.
        flag::register(signal, Arc::clone(&self.stop))?;
        Ok(())
    }

    /// What stops the next render: a signal sets it, as one that came before has. What stopped the one before does not.
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.stop.store(false, Ordering::SeqCst);
        if self.received.load(Ordering::SeqCst) != 0 {
            self.stop.store(true, Ordering::SeqCst);
        }
        Arc::clone(&self.stop)
    }

    /// Whether one came.
    pub fn came(&self) -> bool {
        self.received.load(Ordering::Relaxed) != 0
    }

    /// The exit code that says which one came.
    pub fn exit_code(&self) -> Option<u8> {
        let signal = self.received.load(Ordering::Relaxed);
        (signal != 0).then_some((ENDED_BY_SIGNAL as usize + signal) as u8)
    }
}

/// Has `watch` do something for every signal that is not ignored.
fn each(watch: impl Fn(i32) -> std::io::Result<()>) -> Result<()> {
    let mut caught = ENDING.into_iter().filter(|signal| !is_ignored(*signal));
    caught.try_for_each(|signal| watch(signal).map_err(|error| unwatched(&error)))
}

/// The error that signals would end the program as they end any other.
fn unwatched(error: &std::io::Error) -> Error {
    let finding = format!("signals cannot be caught: {error}");
    Error::failure("fogbow", finding, "allow for more threads, or start fogbow from another shell")
}

/// Whether this process was started with `signal` ignored, as far as the system tells.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stopped_one_render_does_not_stop_the_next_unless_it_was_a_signal() {
        let signals = Signals::default();
        signals.stop().store(true, Ordering::Relaxed);
        let next = signals.stop();
        assert!(!next.load(Ordering::Relaxed), "the time of the one before was up");
        signals.received.store(SIGTERM as usize, Ordering::Relaxed);
        assert!(signals.stop().load(Ordering::Relaxed));
        assert!(Arc::ptr_eq(&next, &signals.stop()), "handlers know no other");
    }
}
