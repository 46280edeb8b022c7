//! Rounds of samples, until a target is met.

use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use super::limits::{End, Limits, Target};
use super::watch::{State, Watch};
use super::{Outcome, Session};
use crate::scene::schema::MOST_SAMPLES;
use crate::stats::Stats;

/// How often progress and deadlines are looked at.
pub(super) const TICK: Duration = Duration::from_millis(20);

/// Samples of every pixel before the noise is looked at for the first time.
const FIRST_LOOK: u32 = 16;
/// Samples per pixel after which an image that is still black is taken for black.
const BLACK_AFTER: u32 = 1 << 14;

/// What comes next.
enum Next {
    /// Samples of every pixel, counted from the first, up to this one.
    Until(u32),
    /// Nothing.
    End(End),
}

impl Session {
    /// Renders until the first of the `limits` is reached, or `interrupted` says so while its monitor's `stop` is set;
    /// tells `look` now and then how far it is.
    pub fn run(
        &self,
        limits: impl Into<Limits>,
        interrupted: impl Fn() -> bool,
        mut look: impl FnMut(State),
    ) -> Outcome {
        let limits = limits.into();
        *self.limits.lock().unwrap_or_else(PoisonError::into_inner) = limits;
        let (mut stats, watch) = (Stats::new(false), Watch::new(self, limits));
        let end = loop {
            if interrupted() {
                break End::Interrupted;
            }
            let done = self.level();
            let until = match self.next(limits, done) {
                Next::Until(until) => until,
                Next::End(end) => break end,
            };
            // The first sample of every pixel is taken whatever the time.
            let deadline = limits.time.filter(|_| done > 0);
            let deadline = deadline.and_then(|time| self.start.checked_add(time.saturating_sub(self.earlier.time)));
            stats.merge(&self.render(until, deadline, || look(watch.state())));
            look(watch.state()); // a short round had no time for it
        };
        Outcome { stats, end, elapsed: self.elapsed(), sampling: watch.sampling() }
    }

    /// Renders one round, calling `look` now and then, and stops it at the deadline.
    fn render(&self, until: u32, mut deadline: Option<Instant>, mut look: impl FnMut()) -> Stats {
        let monitor = &self.monitor;
        let pipeline = self.settings.reference.pipeline();
        let left = |deadline: Instant| deadline.saturating_duration_since(Instant::now());
        let round = || {
            if !self.probe(until) {
                return Stats::new(false);
            }
            self.renderer.render(&self.scene.frame, &pipeline, &self.film, self.samples_until(until), monitor)
        };
        watched(round, deadline.map_or(TICK, left).min(TICK), || {
            look();
            if deadline.is_some_and(|deadline| left(deadline).is_zero()) {
                monitor.stop.store(true, Ordering::Relaxed);
                deadline = None;
            }
            deadline.map_or(TICK, left).min(TICK)
        })
    }

    /// What comes after `done` samples of every pixel. Rounds end where the noise is looked at or probes are taken, and
    /// that at numbers of samples that depend on no clock.
    fn next(&self, limits: Limits, done: u32) -> Next {
        let Limits { samples, time, noise } = limits;
        let most = samples.unwrap_or(MOST_SAMPLES).min(MOST_SAMPLES - self.settings.first_sample);
        if done >= most {
            return Next::End(End::Met(Target::Samples(most)));
        }
        let is_over = time.filter(|time| done > 0 && self.elapsed() >= *time);
        let until = match noise {
            // A resumed render first ends the round that it was in, so that it looks at the noise of the same samples.
            Some(_) if self.until.load(Ordering::Relaxed) > done => self.until.load(Ordering::Relaxed),
            Some(_) if done == 0 => FIRST_LOOK,
            Some(noise) => match self.until_next_look(noise, done) {
                Some(until) => until,
                None => return Next::End(End::Met(Target::Noise(noise))),
            },
            None if time.is_some() => (2 * u64::from(done)).clamp(1, u64::from(done) + 64) as u32,
            None => MOST_SAMPLES,
        };
        if let Some(time) = is_over {
            return Next::End(End::Met(Target::Time(time)));
        }
        let until = until.min(self.last_of_round(done));
        self.until.store(noise.map_or(0, |_| until), Ordering::Relaxed);
        // Before the first sample nothing is stopped by the clock.
        let most = if time.is_some() && done == 0 { 1 } else { most };
        Next::Until(until.min(most))
    }

    /// The number of samples of every pixel at which the noise is to be looked at after `done`; none if it is met.
    fn until_next_look(&self, noise: f64, done: u32) -> Option<u32> {
        let share = self.film.relative_noise() / noise;
        if share <= 1.0 || (share.is_infinite() && done >= BLACK_AFTER) {
            return None;
        }
        // Noise falls with the root of the number of samples; a little more than that says is rarely too much.
        let needed = 1.05 * share * share * f64::from(done);
        self.estimates().add(Some(needed * noise * noise).filter(|product| product.is_finite()));
        let needed = needed.ceil();
        Some(needed.clamp(f64::from(done) + 1.0, 2.0 * f64::from(done)) as u32)
    }
}

/// Does `work` on a thread of its own, and calls `look` after `wait`, and then as often as that says, until it is done.
pub(super) fn watched<T: Send>(
    work: impl FnOnce() -> T + Send,
    mut wait: Duration,
    mut look: impl FnMut() -> Duration,
) -> T {
    std::thread::scope(|scope| {
        let (end, ended) = mpsc::channel();
        let thread = scope.spawn(move || {
            let result = work();
            let _ = end.send(());
            result
        });
        while ended.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
            wait = look();
        }
        thread.join().expect("stages do not panic")
    })
}
