//! Rounds of samples, until the target is met.

use core::cell::Cell;
use core::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use super::{Outcome, Session};
use crate::render::Samples;
use crate::scene::schema::MOST_SAMPLES;
use crate::stats::Stats;

/// How often progress and deadlines are looked at.
const TICK: Duration = Duration::from_millis(20);
/// Time after which the rate so far says how long the rest will take.
const SURE_AFTER: Duration = Duration::from_secs(3);
/// The same where so much is done.
const LIKELY_AFTER: Duration = Duration::from_millis(500);
/// Share of the work after which it does.
const LIKELY_FRACTION: f64 = 0.05;

/// Samples per pixel after which an image that is still black is taken for black.
const BLACK_AFTER: u32 = 1 << 14;

/// Share by which two estimates of the samples that a target takes may differ to be believed.
const AGREEMENT: f64 = 0.1;

/// When a render is done.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// After this many samples per pixel, beginning with the first sample of the session's settings.
    Samples(u32),
    /// After this much time.
    Time(Duration),
    /// At this relative noise.
    Noise(f64),
}

/// How far a render is.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Whether it is being prepared, so that there is no sample yet.
    pub preparing: bool,
    /// Share of the work that is done, in [0, 1], as far as that is known; never less than before.
    pub fraction: f64,
    /// Camera paths so far.
    pub samples: u64,
    /// Those of them that were there when the render was resumed.
    pub earlier: u64,
    /// Time since the start.
    pub elapsed: Duration,
    /// Time since the first sample was begun.
    pub sampling: Duration,
    /// Time left, while anything is known about it `[s]`.
    pub seconds_left: Option<f64>,
}

impl State {
    /// The same, with nothing left to do.
    pub fn done(self) -> Self {
        Self { preparing: false, fraction: 1.0, seconds_left: Some(0.0), ..self }
    }

    /// Camera paths per second so far.
    pub fn rate(&self) -> f64 {
        (self.samples - self.earlier) as f64 / self.sampling.as_secs_f64().max(1e-9)
    }
}

/// What to render before the next look at the target.
struct Round {
    /// Samples of every pixel, counted from the first.
    samples: Range<u32>,
    /// Samples per pixel after which the target will be met, as far as that is known.
    expected: Option<f64>,
}

impl Session {
    /// Renders until the target is met, or `interrupted` says so while its monitor's `stop` is set; tells `look` now
    /// and then how far it is.
    pub fn run(&self, target: Target, interrupted: impl Fn() -> bool, mut look: impl FnMut(State)) -> Outcome {
        let (mut stats, mut done) = (Stats::new(false), self.film.fewest_samples());
        let (mut estimates, fraction) = (Estimates::default(), Cell::new(0.0));
        let begin = Instant::now();
        while !interrupted() {
            let Some(round) = self.next_round(target, done) else { break };
            let is_looked_at = matches!(target, Target::Noise(_));
            self.until.store(if is_looked_at { round.samples.end } else { 0 }, Ordering::Relaxed);
            // The first sample of every pixel is taken whatever the time.
            let deadline = match target {
                Target::Time(time) if done > 0 => self.start.checked_add(time.saturating_sub(self.earlier.time)),
                _ => None,
            };
            let pixels = self.film.region().pixels() as f64;
            let expected = match target {
                Target::Noise(_) => estimates.agreed(round.expected),
                Target::Samples(_) | Target::Time(_) => round.expected,
            };
            let expected = expected.map(|expected| expected * pixels);
            let watch = Watch { session: self, begin, target, expected, fraction: &fraction };
            done = round.samples.end;
            stats.merge(&self.render(round.samples, deadline, || look(watch.state())));
            look(watch.state()); // a short round had no time for it
        }
        Outcome { stats, elapsed: self.elapsed(), sampling: begin.elapsed() }
    }

    /// Prepares, telling `look` now and then that it does.
    pub(super) fn watch_preparation<T: Send>(
        &self,
        mut look: impl FnMut(State),
        prepare: impl FnOnce() -> T + Send,
    ) -> T {
        let state = || State { preparing: true, elapsed: self.elapsed(), ..State::default() };
        watched(prepare, TICK, || {
            look(state());
            TICK
        })
    }

    /// Renders one round, calling `look` now and then, and stops it at the deadline.
    fn render(&self, samples: Range<u32>, mut deadline: Option<Instant>, mut look: impl FnMut()) -> Stats {
        let monitor = &self.monitor;
        let pipeline = self.settings.reference.pipeline();
        let left = |deadline: Instant| deadline.saturating_duration_since(Instant::now());
        let first = self.settings.first_sample;
        let samples = Samples::Missing(first..first.saturating_add(samples.end));
        let round = || self.renderer.render(&self.scene.frame, &pipeline, &self.film, samples, monitor);
        watched(round, deadline.map_or(TICK, left).min(TICK), || {
            look();
            if deadline.is_some_and(|deadline| left(deadline).is_zero()) {
                monitor.stop.store(true, Ordering::Relaxed);
                deadline = None;
            }
            deadline.map_or(TICK, left).min(TICK)
        })
    }

    /// The round after `done` samples of every pixel, or `None` if the target is met.
    fn next_round(&self, target: Target, done: u32) -> Option<Round> {
        let until = |end: u32, expected: Option<f64>| {
            (end > done).then_some(Round { samples: done..end.min(MOST_SAMPLES), expected })
        };
        match target {
            _ if done >= MOST_SAMPLES => None,
            Target::Samples(samples) => until(samples, Some(f64::from(samples))),
            Target::Time(time) if done > 0 && self.elapsed() >= time => None,
            Target::Time(_) => until((2 * u64::from(done)).clamp(1, u64::from(done) + 64) as u32, None),
            // A resumed render first ends the round that it was in, so that it looks at the noise of the same samples.
            Target::Noise(_) if self.until.load(Ordering::Relaxed) > done => {
                until(self.until.load(Ordering::Relaxed), None)
            }
            Target::Noise(_) if done == 0 => until(16, None),
            Target::Noise(noise) => {
                let share = self.film.relative_noise() / noise;
                if share <= 1.0 || (share.is_infinite() && done >= BLACK_AFTER) {
                    return None;
                }
                // Noise falls with the root of the number of samples; a little more than that says is rarely too much.
                let needed = (1.05 * share * share * f64::from(done)).ceil();
                let end = needed.clamp(f64::from(done) + 1.0, 2.0 * f64::from(done));
                until(end as u32, needed.is_finite().then_some(needed))
            }
        }
    }
}

/// Estimates of the number of samples that a noise takes. Early ones may be far off, as long as few paths have found
/// the light, so none counts unless the one before was about the same.
#[derive(Debug, Default)]
struct Estimates {
    last: Option<f64>,
}

impl Estimates {
    /// The `next` estimate, if it agrees with the last one.
    fn agreed(&mut self, next: Option<f64>) -> Option<f64> {
        let last = core::mem::replace(&mut self.last, next);
        next.filter(|next| last.is_some_and(|last| (next / last - 1.0).abs() <= AGREEMENT))
    }
}

/// Does `work` on a thread of its own, and calls `look` after `wait`, and then as often as that says, until it is done.
fn watched<T: Send>(work: impl FnOnce() -> T + Send, mut wait: Duration, mut look: impl FnMut() -> Duration) -> T {
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

/// Reads the progress of a running render.
struct Watch<'a> {
    session: &'a Session,
    /// When the first sample was begun.
    begin: Instant,
    target: Target,
    /// Samples of all pixels together after which the target will be met, as far as that is known.
    expected: Option<f64>,
    /// The largest share of the work that was told so far.
    fraction: &'a Cell<f64>,
}

impl Watch<'_> {
    fn state(&self) -> State {
        let Session { monitor, earlier, .. } = self.session;
        let earlier = earlier.samples;
        let (samples, elapsed) = (earlier + monitor.samples.load(Ordering::Relaxed), self.session.elapsed());
        let fraction = match self.target {
            Target::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9),
            Target::Samples(_) | Target::Noise(_) => self.expected.map_or(0.0, |expected| samples as f64 / expected),
        };
        let seconds_left = match self.target {
            Target::Time(time) => Some(time.saturating_sub(elapsed).as_secs_f64()),
            Target::Samples(_) | Target::Noise(_) => {
                let before = self.expected.map_or(0.0, |expected| earlier as f64 / expected);
                self.seconds_left(before, fraction)
            }
        };
        self.fraction.set(self.fraction.get().max(fraction.min(1.0)));
        let (fraction, sampling) = (self.fraction.get(), self.begin.elapsed());
        State { preparing: false, fraction, samples, earlier, elapsed, sampling, seconds_left }
    }

    /// Time left at the rate so far `[s]`, where a share of the work was done `before`; none as long as that says
    /// little.
    fn seconds_left(&self, before: f64, fraction: f64) -> Option<f64> {
        let (since, done) = (self.begin.elapsed(), fraction - before);
        let is_known = since >= SURE_AFTER || (since >= LIKELY_AFTER && done >= LIKELY_FRACTION);
        (is_known && done > 0.0).then(|| since.as_secs_f64() * (1.0 - fraction).max(0.0) / done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_counts_once_the_next_one_agrees() {
        let mut estimates = Estimates::default();
        let told = [None, Some(40.0), Some(90.0), Some(97.0), Some(93.0), Some(200.0), None, Some(200.0), Some(190.0)]
            .map(|next| estimates.agreed(next));
        assert_eq!(told, [None, None, None, Some(97.0), Some(93.0), None, None, None, Some(190.0)]);
    }
}
