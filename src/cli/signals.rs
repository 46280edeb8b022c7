//! Signals that end a render: it writes what there is, and its exit code says which it was. A second one ends it at
//! once. SIGUSR1 asks for a checkpoint.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::error::{Error, Result};

#[cfg(unix)]
const ENDING: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [SIGINT, SIGTERM];

/// What a shell adds to the number of the signal that ended a program.
const ENDED_BY_SIGNAL: i32 = 128;

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
        let signals = Self::default();
        each(|signal| signals.watch_for(signal))?;
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

    fn watch_for(&self, signal: i32) -> std::io::Result<()> {
        let again = Arc::new(AtomicBool::new(false));
        flag::register_conditional_shutdown(signal, ENDED_BY_SIGNAL + signal, Arc::clone(&again))?;
        flag::register(signal, again)?;
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
    ENDING.into_iter().filter(|signal| !is_ignored(*signal)).try_for_each(|signal| {
        watch(signal).map_err(|error| {
            let finding = format!("signal {signal} cannot be caught: {error}");
            Error::failure("fogbow", finding, "start fogbow from another shell")
        })
    })
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
