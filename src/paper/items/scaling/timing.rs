//! Time per sample, of settings in turn.

use std::time::Instant;

use fogbow_kernels::pipeline::{Stage, WIDEST};

use crate::error::{Error, Result};
use crate::film::{Film, Region, tile_size};
use crate::frame::Frame;
use crate::paper::bench::Bench;
use crate::render::{Monitor, Renderer, Workers};
use crate::scene::LoadedScene;
use crate::stats::StageStats;

/// Turns of every setting.
const TURNS: u32 = 5;
/// How many times the time of others settings get whose weights are timed.
const LONGER: f64 = 3.0;
/// Samples of every pixel in the turn that is not counted.
const WARM_UP: u32 = 1;

/// Something of which a sample is timed.
pub struct Setting {
    /// The number that it has in its series.
    pub x: f64,
    /// Paths in flight per thread; none for what suits the frame.
    lanes: Option<usize>,
    frame: Frame,
    size: [u32; 2],
    threads: usize,
    /// Whether its weights are timed by themselves.
    has_weights: bool,
    /// How many times the time of others it gets.
    share: f64,
}

impl Setting {
    /// `scene` on so many threads.
    pub fn of(x: f64, scene: LoadedScene, threads: usize) -> Self {
        let size = scene.scene.film.size;
        Self { x, lanes: None, size, frame: scene.frame, threads, has_weights: false, share: 1.0 }
    }

    /// The same with its weights timed by themselves, in more time: there have to be many.
    pub fn with_weights(self) -> Self {
        Self { has_weights: true, share: LONGER, ..self }
    }

    /// The same with so many paths in flight per thread.
    pub fn with_lanes(self, lanes: usize) -> Self {
        Self { lanes: Some(lanes), ..self }
    }
}

/// What a sample costs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cost {
    /// Wall-clock time times threads per camera path, of every turn [ns].
    pub turns: Vec<f64>,
    /// Processor time per weight, as it is in batches of eight that are full, of every turn [ns]; not numbers where
    /// weights are not timed.
    pub weights: Vec<f64>,
}

impl Cost {
    /// Median of the turns [ns].
    pub fn nanoseconds(&self) -> f64 {
        median(&self.turns)
    }

    /// Median of the weights [ns].
    pub fn weight(&self) -> f64 {
        median(&self.weights)
    }

    /// Half the distance between the fastest and the slowest turn [ns].
    pub fn spread(&self) -> f64 {
        let (low, high) = self
            .turns
            .iter()
            .fold((f64::INFINITY, 0.0), |(low, high), turn| (f64::min(low, *turn), f64::max(high, *turn)));
        0.5 * (high - low)
    }
}

fn median(turns: &[f64]) -> f64 {
    let mut turns = turns.to_vec();
    turns.sort_by(f64::total_cmp);
    turns.get(turns.len() / 2).copied().unwrap_or(f64::NAN)
}

/// A setting that is being timed.
struct Timed<'a> {
    setting: &'a Setting,
    renderer: Renderer,
    film: Film,
    samples: u32,
    cost: Cost,
}

impl<'a> Timed<'a> {
    fn new(setting: &'a Setting) -> Result<Self> {
        let Setting { lanes, frame, size: [width, height], threads, has_weights, .. } = setting;
        let workers = Workers { threads: *threads, lanes: *lanes, detailed_stats: *has_weights };
        let renderer = Renderer::new(workers).map_err(|error| {
            Error::failure(
                "--threads",
                format!("threads cannot be started: {error}"),
                "give a smaller number of threads",
            )
        })?;
        let region = Region::whole(*width, *height);
        let film = Film::new(frame, region, tile_size(region));
        Ok(Self { setting, renderer, film, samples: 0, cost: Cost::default() })
    }

    /// Takes `samples` more of every pixel, and says how long that took `[s]`, and a weight `[ns]`.
    fn take(&mut self, samples: u32) -> [f64; 2] {
        let (start, range) = (Instant::now(), self.samples..self.samples + samples);
        let stats = self.renderer.render(&self.setting.frame, &WIDEST, &self.film, range, &Monitor::default());
        self.samples += samples;
        let StageStats { batches, seconds, .. } = stats.stages[Stage::MisWeight as usize];
        [start.elapsed().as_secs_f64(), 1e9 * seconds / (8 * batches) as f64]
    }

    fn turn(&mut self, samples: u32) {
        let [seconds, weight] = self.take(samples);
        let paths = f64::from(samples) * self.film.region().pixels() as f64;
        self.cost.turns.push(1e9 * seconds * self.renderer.threads() as f64 / paths);
        self.cost.weights.push(if self.setting.has_weights { weight } else { f64::NAN });
    }
}

/// What samples of `settings` cost, in their order, within the budget of the item.
pub fn measure(bench: &Bench<'_>, settings: &[&Setting]) -> Result<Vec<Cost>> {
    let shares: f64 = settings.iter().map(|setting| setting.share).sum();
    let turn = bench.budget.as_secs_f64() / (f64::from(TURNS) * shares);
    let (mut all, mut samples) = (Vec::new(), Vec::new());
    for setting in settings {
        let mut timed = Timed::new(setting)?;
        let taken = if bench.tell.stops() { f64::NAN } else { timed.take(WARM_UP)[0] / f64::from(WARM_UP) };
        samples.push(if taken.is_nan() { 1 } else { (setting.share * turn / taken).clamp(1.0, 1e5) as u32 });
        all.push(timed);
    }
    for _ in 0..TURNS {
        for (timed, samples) in all.iter_mut().zip(&samples) {
            if !bench.tell.stops() {
                timed.turn(*samples);
            }
        }
    }
    Ok(all.into_iter().map(|timed| timed.cost).collect())
}
