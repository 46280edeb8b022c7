//! The pilot: a short look at a scene that picks what is most efficient for it.
//!
//! How many vertices should connect, and how readily a walk should end, belong to the scene: in open fog the first vertex
//! suffices, behind a perforated plate the later ones find the holes. A pilot renders the whole image small, once per
//! setting, and keeps the setting with the smallest product of variance and cost.
//!
//! The cost is counted work, not time, and the pilot's samples are those of a seed of its own: the choice is the same on
//! every machine, for every split of the samples, and independent of the samples that are kept.

use fogbow_kernels::pipeline::SIMD;

use crate::film::{Film, Region, tile_size};
use crate::frame::Frame;
use crate::render::{Monitor, Renderer};
use crate::scene::schema::{Render, Starts};
use crate::stats::Stats;

/// Numbers of starts to try; the last is all.
const STARTS: [u32; 5] = [1, 2, 4, 8, u32::MAX];
/// Longest paths, in segments, for which all starts are tried: their cost grows with the square of that number, and beyond
/// it is more than a hundred times that of eight starts.
const LONGEST_FOR_ALL: u32 = 128;
/// Survival probabilities to try.
const SURVIVALS: [f32; 4] = [1.0, 0.9, 0.75, 0.5];
/// Longest side of the pilot's image in pixels.
const SIDE: u32 = 32;
/// Samples per pixel and setting.
const SAMPLES: u32 = 32;
/// Makes the pilot's seed another than the frame's.
const SEED: u32 = 0x9e37_79b9;

/// What a setting turned out to be worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Vertices that connect; `u32::MAX` for all.
    pub starts: u32,
    /// Probability of going on from a vertex.
    pub survival: f32,
    /// Variance of a sample, mean over pixels, sum over channels.
    pub variance: f64,
    /// Work of a sample in about nanoseconds of one core.
    pub cost: f64,
}

impl Trial {
    /// What a render should maximise: one over variance times cost; a setting that found nothing has none.
    pub fn efficiency(&self) -> f64 {
        let work = self.variance * self.cost;
        if work > 0.0 { 1.0 / work } else { 0.0 }
    }
}

/// `frame` with the most efficient of the settings that `render` leaves open, and the trials that led to it.
///
/// `size` is that of the whole image. Without bridges, or where nothing is left open, there is nothing to try: techniques
/// that do not reach every path need every walk.
pub fn settle(frame: &Frame, size: [u32; 2], render: &Render, renderer: &Renderer) -> (Frame, Vec<Trial>) {
    let open_starts = render.starts == Starts::Auto;
    let open_survival = render.survival.0.is_none();
    let scatters = !frame.medium.never_scatters() && frame.lengths.max > 2;
    if frame.techniques.bridge.is_none() || !scatters || !(open_starts || open_survival) {
        return (frame.clone(), Vec::new());
    }
    let pilot = Pilot::new(frame, size, renderer);
    let fixed = (frame.walk.starts, frame.walk.survival);
    let mut trials = Vec::new();
    let starts = if open_starts { STARTS.as_slice() } else { &[fixed.0] };
    let affordable = |starts: &&u32| **starts < u32::MAX || !open_starts || frame.lengths.max <= LONGEST_FOR_ALL;
    trials.extend(starts.iter().filter(affordable).map(|starts| pilot.attempt(*starts, fixed.1)));
    let most_starts = best(&trials).starts;
    if open_survival && most_starts > 1 {
        let others = SURVIVALS.iter().filter(|survival| **survival < fixed.1);
        trials.extend(others.map(|survival| pilot.attempt(most_starts, *survival)));
    }
    let Trial { starts, survival, .. } = best(&trials);
    (frame.clone().with_walk(starts, survival), trials)
}

/// The most efficient trial; the first of equals.
fn best(trials: &[Trial]) -> Trial {
    let better = |best: Trial, trial: &Trial| if trial.efficiency() > best.efficiency() { *trial } else { best };
    trials[1..].iter().fold(trials[0], better)
}

struct Pilot<'a> {
    frame: Frame,
    region: Region,
    renderer: &'a Renderer,
}

impl<'a> Pilot<'a> {
    fn new(frame: &Frame, [width, height]: [u32; 2], renderer: &'a Renderer) -> Self {
        let longest = width.max(height);
        let small =
            |side: u32| (u64::from(side) * u64::from(SIDE)).div_ceil(u64::from(longest)).min(side.into()) as u32;
        let size = [small(width), small(height)];
        let camera = frame.camera.at_size([width, height], size);
        let frame = Frame { camera, seed: frame.seed ^ SEED, ..frame.clone() };
        Self { frame, region: Region::whole(size[0], size[1]), renderer }
    }

    fn attempt(&self, starts: u32, survival: f32) -> Trial {
        let frame = self.frame.clone().with_walk(starts, survival);
        let film = Film::new(&frame, self.region, tile_size(self.region));
        let stats = self.renderer.render(&frame, &SIMD, &film, 0..SAMPLES, &Monitor::default());
        let squares = |errors: [f64; 3]| errors.iter().map(|error| error * error).sum::<f64>();
        let sum: f64 = film.pixels().map(|pixel| squares(pixel.standard_error)).sum();
        let variance = sum / self.region.pixels() as f64 * f64::from(SAMPLES);
        Trial { starts, survival, variance, cost: cost(&stats) / stats.samples as f64 }
    }
}

/// Work in units of about a nanosecond on one core: what stages were measured to cost per row.
fn cost(stats: &Stats) -> f64 {
    const SAMPLE: f64 = 10.0;
    const SEGMENT: f64 = 5.0;
    const CONNECTION: f64 = 40.0;
    const EDGE: f64 = 9.0;
    const TERM: f64 = 9.0;
    let work = stats.work;
    SAMPLE * stats.samples as f64
        + SEGMENT * stats.segments as f64
        + CONNECTION * work.connections as f64
        + EDGE * work.edges as f64
        + TERM * work.terms as f64
}
