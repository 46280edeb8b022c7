//! A render from its first round to the files it leaves.

use std::ops::Range;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use fogbow_kernels::pipeline::Pipeline;

use super::progress::{Reporter, State};
use super::report::Report;
use super::signals::Signals;
use super::tell;
use super::values::ImageOutput;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::image::tone::Exposure;
use crate::image::{self, Format};
use crate::output;
use crate::pilot::Trial;
use crate::render::{Monitor, Renderer};
use crate::scene::LoadedScene;
use crate::stats::Stats;
use crate::truncation::Truncation;

/// How often progress and deadlines are looked at.
const TICK: Duration = Duration::from_millis(20);
/// Contributions that may be dropped for not being finite, as a share of the samples.
const TOLERATED_DROPS: f64 = 1e-6;

/// Time after which the rate so far says how long the rest will take.
const SURE_AFTER: Duration = Duration::from_secs(3);
/// The same where so much is done.
const LIKELY_AFTER: Duration = Duration::from_millis(500);
/// Share of the work after which it does.
const LIKELY_FRACTION: f64 = 0.05;

/// Samples per pixel after which an image that is still black is taken for black.
const BLACK_AFTER: u32 = 1 << 14;

/// Most samples per pixel, whatever the target.
const MOST_SAMPLES: u32 = 1 << 31;

/// When a render is done.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// After so many samples per pixel.
    Samples(u32),
    /// After so long.
    Time(Duration),
    /// At this relative noise.
    Noise(f64),
}

/// What is rendered, and with what.
pub struct Job<'a> {
    pub scene: &'a LoadedScene,
    pub renderer: Renderer,
    pub pipeline: Pipeline,
    pub film: Film,
    pub preparation: Preparation,
    /// When it began, the pilot included.
    pub start: Instant,
    /// Stops it, and counts samples.
    pub monitor: Monitor,
    /// Tell when the user stops it.
    pub signals: Signals,
}

/// What was settled before the first sample.
pub struct Preparation {
    /// What the pilot tried.
    pub trials: Vec<Trial>,
    /// What the limit on the length of paths leaves out.
    pub left_out: Option<Truncation>,
    /// Exposure of the PNG images, if there are any.
    pub exposure: Option<Exposure>,
    /// The twins in the pipeline: a stage's name, `all` or `none`.
    pub reference: String,
}

/// How it ended.
pub struct Outcome {
    stats: Stats,
    elapsed: Duration,
    /// Exit code of the signal that stopped it.
    stopped: Option<u8>,
}

/// What to render before the next look at the target.
struct Round {
    /// Sample numbers.
    samples: Range<u32>,
    /// Samples per pixel after which the target will be met, as far as that is known.
    expected: Option<f64>,
}

impl Job<'_> {
    /// Renders in rounds until the target is met or the user stops it.
    pub fn run(&self, target: Target, reporter: &mut Reporter) -> Outcome {
        let (monitor, start) = (&self.monitor, self.start);
        let (mut stats, mut done, mut last) = (Stats::new(false), 0, State::default());
        let begin = Instant::now();
        while !self.signals.came() {
            let Some(round) = self.next_round(target, done, start.elapsed()) else { break };
            // The first sample of every pixel is taken whatever the time.
            let deadline = match target {
                Target::Time(time) if done > 0 => start.checked_add(time),
                _ => None,
            };
            let pixels = self.film.region().pixels();
            let watch = Watch { monitor, start, begin, target, expected: round.expected.map(|n| n * pixels as f64) };
            done = round.samples.end;
            stats.merge(&self.render(round.samples, monitor, deadline, || reporter.update(watch.state())));
            last = watch.state();
            reporter.update(last); // a short round had no time for it
        }
        let stopped = self.signals.exit_code();
        let elapsed = start.elapsed();
        let fraction = if stopped.is_some() { last.fraction } else { 1.0 };
        reporter.finish(State { fraction, samples: stats.samples, elapsed, seconds_left: Some(0.0) });
        Outcome { stats, elapsed, stopped }
    }

    /// Renders one round, calling `look` now and then, and stops it at the deadline.
    fn render(
        &self,
        samples: Range<u32>,
        monitor: &Monitor,
        mut deadline: Option<Instant>,
        mut look: impl FnMut(),
    ) -> Stats {
        std::thread::scope(|scope| {
            let (end, ended) = mpsc::channel();
            let round = scope.spawn(move || {
                let stats = self.renderer.render(&self.scene.frame, &self.pipeline, &self.film, samples, monitor);
                let _ = end.send(());
                stats
            });
            let left = |deadline: Instant| deadline.saturating_duration_since(Instant::now());
            while ended.recv_timeout(deadline.map_or(TICK, left).min(TICK)) == Err(RecvTimeoutError::Timeout) {
                look();
                if deadline.is_some_and(|deadline| left(deadline).is_zero()) {
                    monitor.stop.store(true, Ordering::Relaxed);
                    deadline = None;
                }
            }
            round.join().expect("stages do not panic")
        })
    }

    /// The round after `done` samples of every pixel, or `None` if the target is met.
    fn next_round(&self, target: Target, done: u32, elapsed: Duration) -> Option<Round> {
        let until = |end: u32, expected: Option<f64>| {
            (end > done).then_some(Round { samples: done..end.min(MOST_SAMPLES), expected })
        };
        match target {
            _ if done >= MOST_SAMPLES => None,
            Target::Samples(samples) => until(samples, Some(f64::from(samples))),
            Target::Time(time) if done > 0 && elapsed >= time => None,
            Target::Time(_) => until((2 * u64::from(done)).clamp(1, u64::from(done) + 64) as u32, None),
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

    /// Writes what there is and says so.
    pub fn finish(
        &self,
        outcome: &Outcome,
        outputs: &[ImageOutput],
        stats: Option<&Path>,
        reporter: &Reporter,
    ) -> Result<ExitCode> {
        let report = Report {
            scene: self.scene,
            film: &self.film,
            threads: self.renderer.threads(),
            elapsed: outcome.elapsed,
            stats: &outcome.stats,
            preparation: &self.preparation,
        };
        if outcome.stopped.is_some() {
            reporter.line(format!("stopped after {} samples; writing what there is", outcome.stats.samples));
        }
        // What can be written is, also if something else cannot.
        let images: Vec<_> = outputs.iter().map(|image| self.write_image(image, &report)).collect();
        let statistics = stats.map_or(Ok(()), |path| report.write_statistics(path));
        images.into_iter().chain([statistics]).collect::<Result<()>>()?;
        reporter.line(report.summary(outputs));
        if outcome.stopped.is_none() && self.film.mean().0 == [0.0; 3] {
            reporter.warn("the image is black: no path found light");
        }
        self.refuse_drops(&outcome.stats)?;
        Ok(outcome.stopped.map_or(ExitCode::SUCCESS, ExitCode::from))
    }

    fn write_image(&self, image: &ImageOutput, report: &Report<'_>) -> Result<()> {
        output::write(&image.path, |file| match image.format {
            Format::Png => image::png::write_film(file, &self.film, self.preparation.exposure.unwrap_or(Exposure(0.0))),
            Format::Exr => image::exr::write_film(file, &self.film, self.scene.scene.film.size, &report.header()),
        })
    }

    fn refuse_drops(&self, stats: &Stats) -> Result<()> {
        let dropped = stats.dropped;
        let Some((pixel, sample)) = dropped.first else { return Ok(()) };
        let width = self.scene.frame.camera.width;
        let finding = format!(
            "contributions that were not finite were dropped: {}, one of them in sample {sample} of pixel ({}, {})",
            dropped.count,
            pixel % width,
            pixel / width
        );
        if dropped.count as f64 > TOLERATED_DROPS * stats.samples as f64 {
            let remedy = "the image is written but not to be trusted; please report the scene";
            return Err(Error::failure(&self.scene.name, finding, remedy));
        }
        tell(format!("warning: {finding}"));
        Ok(())
    }
}

/// Reads the progress of a running render.
struct Watch<'a> {
    monitor: &'a Monitor,
    /// When the program began, the pilot included.
    start: Instant,
    /// When the first sample was begun.
    begin: Instant,
    target: Target,
    /// Samples of all pixels together after which the target will be met, as far as that is known.
    expected: Option<f64>,
}

impl Watch<'_> {
    fn state(&self) -> State {
        let (samples, elapsed) = (self.monitor.samples.load(Ordering::Relaxed), self.start.elapsed());
        let fraction = match self.target {
            Target::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9),
            Target::Samples(_) | Target::Noise(_) => self.expected.map_or(0.0, |expected| samples as f64 / expected),
        };
        let seconds_left = match self.target {
            Target::Time(time) => Some(time.saturating_sub(elapsed).as_secs_f64()),
            Target::Samples(_) | Target::Noise(_) => self.seconds_left(fraction),
        };
        State { fraction: fraction.min(1.0), samples, elapsed, seconds_left }
    }

    /// Time left at the rate so far `[s]`; none as long as that says little.
    fn seconds_left(&self, fraction: f64) -> Option<f64> {
        let since = self.begin.elapsed();
        let is_known = since >= SURE_AFTER || (since >= LIKELY_AFTER && fraction >= LIKELY_FRACTION);
        (is_known && fraction > 0.0).then(|| since.as_secs_f64() * (1.0 - fraction).max(0.0) / fraction)
    }
}
