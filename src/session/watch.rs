//! How far a running render is, and what ends it when.

use core::cell::Cell;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use super::limits::{Limits, Target};
use super::preparation::Step;
use super::{Earlier, Session};

/// Time after which the rate so far says how long the rest will take.
const SURE_AFTER: Duration = Duration::from_secs(3);
/// The same where so much is done.
const LIKELY_AFTER: Duration = Duration::from_millis(500);
/// Share of the work after which it does.
const LIKELY_FRACTION: f64 = 0.05;

/// Time between glimpses of the noise, and the least of it in units of what a glimpse takes.
const GLIMPSE_EVERY: Duration = Duration::from_millis(500);
const GLIMPSE_SHARE: u32 = 50;

/// How far a render is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Whether it is being prepared, so that there is no sample yet.
    pub preparing: bool,
    /// The step of the preparation that it is at, once there is one.
    pub step: Option<Step>,
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
    /// The relative noise, by some of the pixels, while anything is known about it.
    pub noise: Option<f64>,
    /// What can end it.
    pub limits: Limits,
    /// What is expected to end it.
    pub expected: Option<Target>,
}

impl State {
    /// The same, with nothing left to do.
    pub fn done(self) -> Self {
        Self { preparing: false, step: None, fraction: 1.0, seconds_left: Some(0.0), ..self }
    }

    /// Time that it will take in all `[s]`, also where the rate was not measured for long; none if nothing is known of
    /// how much there is to do.
    pub fn projected(&self) -> Option<f64> {
        let by_rate = || self.sampling.as_secs_f64() * (1.0 - self.fraction) / self.fraction;
        let left = self.seconds_left.or_else(|| (self.fraction > 0.0).then(by_rate))?;
        Some(self.elapsed.as_secs_f64() + left)
    }

    /// Camera paths per second so far; none before the first ones, also where others were there when the render was
    /// resumed.
    pub fn rate(&self) -> Option<f64> {
        let own = self.samples - self.earlier;
        (own > 0).then(|| own as f64 / self.sampling.as_secs_f64().max(1e-9))
    }

    /// Its figures for other programs, as JSON.
    pub fn figures(&self) -> Map<String, Value> {
        let figures = [
            ("phase", json!(if self.preparing { "preparing" } else { "rendering" })),
            ("step", json!(self.step.map(Step::name))),
            ("fraction", json!(self.fraction)),
            ("samples", json!(self.samples)),
            ("samples_per_second", json!(self.rate())),
            ("seconds", json!(self.elapsed.as_secs_f64())),
            ("seconds_left", json!(self.seconds_left)),
            ("noise", json!(self.noise)),
            ("noise_target", json!(self.limits.noise)),
            ("until", json!(self.expected.map(Target::name))),
        ];
        figures.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
    }
}

/// Reads the progress of a running render.
pub(super) struct Watch<'a> {
    session: &'a Session,
    /// When the first sample was begun.
    begin: Instant,
    limits: Limits,
    /// The largest share of the work that was told so far.
    fraction: Cell<f64>,
    /// The noise, and when it is to be looked at again.
    noise: Cell<(Option<f64>, Instant)>,
}

/// How far it is to a target.
#[derive(Clone, Copy)]
struct Distance {
    target: Target,
    fraction: f64,
    seconds_left: Option<f64>,
}

impl<'a> Watch<'a> {
    pub fn new(session: &'a Session, limits: Limits) -> Self {
        let begin = Instant::now();
        Self { session, begin, limits, fraction: Cell::new(0.0), noise: Cell::new((None, begin)) }
    }

    /// Time since the first sample was begun.
    pub fn sampling(&self) -> Duration {
        self.begin.elapsed()
    }

    pub fn state(&self) -> State {
        let Session { monitor, earlier: Earlier { samples: earlier, .. }, .. } = self.session;
        let samples = earlier + monitor.samples.load(Ordering::Relaxed);
        let elapsed = self.session.elapsed();
        let Limits { samples: most, time, noise } = self.limits;
        let distances = [
            most.map(|most| self.by_samples(Target::Samples(most), Some(f64::from(most)), samples)),
            time.map(|time| Distance {
                target: Target::Time(time),
                fraction: elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9),
                seconds_left: Some(time.saturating_sub(elapsed).as_secs_f64()),
            }),
            noise.map(|noise| self.by_samples(Target::Noise(noise), self.session.estimates().samples(noise), samples)),
        ];
        let first = first(distances.into_iter().flatten());
        let fraction = first.map_or(0.0, |distance| distance.fraction);
        self.fraction.set(self.fraction.get().max(fraction.min(1.0)));
        State {
            preparing: false,
            step: None,
            fraction: self.fraction.get(),
            samples,
            earlier: *earlier,
            elapsed,
            sampling: self.begin.elapsed(),
            seconds_left: first.and_then(|distance| distance.seconds_left),
            noise: self.noise(samples),
            limits: self.limits,
            expected: first.filter(|distance| distance.fraction > 0.0).map(|distance| distance.target),
        }
    }

    /// How far it is to a target that takes `expected` samples of the mean pixel.
    fn by_samples(&self, target: Target, expected: Option<f64>, samples: u64) -> Distance {
        let Some(expected) = expected.map(|expected| expected * self.session.film.region().pixels() as f64) else {
            return Distance { target, fraction: 0.0, seconds_left: None };
        };
        let [before, fraction] = [self.session.earlier.samples, samples].map(|samples| samples as f64 / expected);
        Distance { target, fraction, seconds_left: self.seconds_left(before, fraction) }
    }

    /// Time left at the rate so far `[s]`, where a share of the work was done `before`; none as long as that says
    /// little.
    fn seconds_left(&self, before: f64, fraction: f64) -> Option<f64> {
        let (since, done) = (self.begin.elapsed(), fraction - before);
        let is_known = since >= SURE_AFTER || (since >= LIKELY_AFTER && done >= LIKELY_FRACTION);
        (is_known && done > 0.0).then(|| since.as_secs_f64() * (1.0 - fraction).max(0.0) / done)
    }

    /// The noise as it was a moment ago, scaled to now.
    fn noise(&self, samples: u64) -> Option<f64> {
        let (last, next) = self.noise.get();
        if samples == 0 || Instant::now() < next {
            return last;
        }
        let start = Instant::now();
        let noise = Some(self.session.film.glimpsed_noise()).filter(|noise| noise.is_finite());
        // Where there is nothing yet to tell it by, there soon is.
        let pause = if noise.is_some() { GLIMPSE_EVERY } else { Duration::ZERO };
        let next = start + pause.max(GLIMPSE_SHARE * start.elapsed());
        self.noise.set((noise.or(last), next));
        noise.or(last)
    }
}

/// The one that is reached first, as far as that is known.
fn first(distances: impl Iterator<Item = Distance>) -> Option<Distance> {
    let key = |distance: &Distance| (distance.seconds_left.unwrap_or(f64::INFINITY), -distance.fraction);
    distances.min_by(|a, b| {
        let ((a, left), (b, right)) = (key(a), key(b));
        a.total_cmp(&b).then(left.total_cmp(&right))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_target_that_is_nearest_in_time_comes_first() {
        let distance = |target, fraction, seconds_left| Distance { target, fraction, seconds_left };
        let samples = distance(Target::Samples(4), 0.9, Some(12.0));
        let time = distance(Target::Time(Duration::from_secs(20)), 0.5, Some(10.0));
        let noise = distance(Target::Noise(0.1), 0.0, None);
        let first = |distances: &[Distance]| first(distances.iter().copied()).map(|first| first.target);
        assert_eq!(first(&[samples, time, noise]), Some(time.target));
        assert_eq!(first(&[noise, samples]), Some(samples.target), "of the other nothing is known");
        assert_eq!(first(&[]), None);
    }
}
