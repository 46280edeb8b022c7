//! A render from its scene to the images it leaves: what is decided first, rounds of samples, and what is told of them.

pub mod checkpoint;
mod done;
mod estimates;
pub mod identity;
mod limits;
mod plan;
mod preparation;
pub mod report;
mod rounds;
mod watch;

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU32};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::pipeline::{self, Pipeline, Stage};

use crate::adaptive::Plan;
use crate::error::{Error, Result};
use crate::film::{self, Film, Region};
use crate::image::tone::Exposure;
use crate::image::{self, Format};
use crate::output;
use crate::render::{Monitor, Renderer, Workers};
use crate::scene::LoadedScene;
use crate::stats::Stats;
use estimates::Estimates;
pub use limits::{End, Limits, Target};
pub use preparation::{Preparation, Step};
pub use report::Report;
pub use watch::State;

/// Side of a tile where twins run: they are slow, and a tile is what an interruption and progress wait for.
const REFERENCE_TILE_SIZE: u32 = 8;

/// Which stages run as scalar twins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// None of them.
    #[default]
    None,
    /// One of them.
    One(Stage),
    /// All of them.
    All,
}

impl Reference {
    /// The name of the stage, `all` or `none`.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::One(stage) => stage.name(),
            Self::All => "all",
        }
    }

    fn pipeline(self) -> Pipeline {
        match self {
            Self::None => pipeline::WIDEST,
            Self::One(stage) => pipeline::WIDEST.with_reference(stage),
            Self::All => pipeline::REFERENCE,
        }
    }
}

/// What a render does besides what its scene says.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// The part of the image to render; all of it if absent.
    pub region: Option<Region>,
    /// Number of the first sample of every pixel: sample numbers are what random numbers depend on. In adaptive renders
    /// the level at which they begin.
    pub first_sample: u32,
    /// Whether noisy tiles get more samples than others; see [`crate::adaptive`].
    pub adaptive: bool,
    /// Number of the frame, if it is one of an animation: frames are never parts of each other.
    pub frame: Option<u32>,
    /// Worker threads; 0 for one per processor.
    pub threads: usize,
    /// Whether to time stages and count the fate of connections.
    pub detailed_stats: bool,
    /// Which stages run as scalar twins.
    pub reference: Reference,
}

/// A render: its scene and all that it needs.
pub struct Session {
    /// The scene; once prepared, with what the pilot chose.
    pub scene: LoadedScene,
    /// The image so far.
    pub film: Film,
    renderer: Renderer,
    settings: Settings,
    preparation: Preparation,
    /// When it began, the pilot included.
    start: Instant,
    monitor: Monitor,
    /// What earlier runs did of it.
    earlier: Earlier,
    /// Samples of every pixel after which the noise is to be looked at next; 0 if it is not.
    until: AtomicU32,
    /// What is known of the number of samples that a noise takes.
    estimates: Mutex<Estimates>,
    /// How many samples which tile gets.
    plan: Mutex<Plan>,
    /// What it was last told to render until.
    limits: Mutex<Limits>,
    /// The hash of the scene, once it is known.
    hash: OnceLock<String>,
}

/// What was done of a render before it was resumed.
#[derive(Clone, Copy, Debug, Default)]
struct Earlier {
    time: Duration,
    /// Samples of all pixels together.
    samples: u64,
}

/// How a render ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Counters.
    pub stats: Stats,
    /// What ended it.
    pub end: End,
    /// Time since the session began, and that of the runs before it was resumed.
    pub elapsed: Duration,
    /// Time since the first sample was begun; what came before is preparation.
    pub sampling: Duration,
}

impl Session {
    /// A render of `scene` that has not begun.
    ///
    /// # Errors
    /// If there is not enough memory, or threads cannot be started.
    pub fn new(scene: LoadedScene, settings: Settings) -> Result<Self> {
        let [width, height] = scene.scene.film.size;
        let region = settings.region.unwrap_or_else(|| Region::whole(width, height));
        let Settings { threads, detailed_stats, reference, .. } = settings;
        let renderer = Renderer::new(Workers { threads, lanes: None, detailed_stats }).map_err(|error| {
            Error::failure(
                "--threads",
                format!("threads cannot be started: {error}"),
                "give a smaller number of threads",
            )
        })?;
        let tile_size = if reference == Reference::None { film::tile_size(region) } else { REFERENCE_TILE_SIZE };
        let layers = film::layers(&scene.frame);
        let film = Film::try_new(&layers, region, tile_size).map_err(|error| {
            let bytes = Film::bytes(&layers, region.pixels());
            let place = scene.files.first().map_or_else(|| scene.name.clone(), |file| file.display().to_string());
            let finding = format!("a film of {} pixels needs {} MiB: {error}", region.pixels(), bytes >> 20);
            Error::failure(place, finding, "render a smaller image with --size, or part of it with --crop")
        })?;
        let (preparation, start, monitor) = (Preparation::default(), Instant::now(), Monitor::default());
        let (earlier, until, hash) = (Earlier::default(), AtomicU32::new(0), OnceLock::new());
        let pixels = region.tiles(tile_size).map(Region::pixels).collect();
        let (plan, limits) = (Mutex::new(Plan::new(pixels, settings.adaptive)), Mutex::default());
        let estimates = Mutex::default();
        Ok(Self {
            scene,
            film,
            renderer,
            settings,
            preparation,
            start,
            monitor,
            earlier,
            until,
            estimates,
            plan,
            limits,
            hash,
        })
    }

    /// Time that it has taken so far, that of the runs before it was resumed included.
    pub fn elapsed(&self) -> Duration {
        self.earlier.time.saturating_add(self.start.elapsed())
    }

    /// What it is, or was last, rendered until.
    pub fn limits(&self) -> Limits {
        *self.limits.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn estimates(&self) -> MutexGuard<'_, Estimates> {
        self.estimates.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Worker threads.
    pub fn threads(&self) -> usize {
        self.renderer.threads()
    }

    /// Contributions that were not finite, and so were dropped, those before it was resumed included.
    pub fn dropped(&self) -> Dropped {
        self.monitor.dropped()
    }

    /// Has `stop` stop a running round when it is set, by the clock as well.
    pub fn stop_by(&mut self, stop: Arc<AtomicBool>) {
        self.monitor.stop = stop;
    }

    /// What stops a running round when it is set.
    pub fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// What was decided before the first sample.
    pub fn preparation(&self) -> &Preparation {
        &self.preparation
    }

    /// Number of its frame, if it is one of an animation.
    pub fn frame_number(&self) -> Option<u32> {
        self.settings.frame
    }

    /// All that is told of a render that ended like this.
    pub fn report<'a>(&'a self, outcome: &'a Outcome) -> Report<'a> {
        Report { session: self, outcome }
    }

    /// Writes the image to `path`. If that is a pipe that nobody reads yet, waits until somebody does or `interrupted`
    /// says so.
    ///
    /// # Errors
    /// If it cannot be written, or the wait was interrupted.
    pub fn write(&self, outcome: &Outcome, path: &Path, format: Format, interrupted: impl Fn() -> bool) -> Result<()> {
        let size = self.scene.scene.film.size;
        output::write(path, interrupted, |file| match format {
            Format::Png => image::png::write_film(file, &self.film, self.png_exposure().unwrap_or(Exposure(0.0))),
            Format::Exr => image::exr::write_film(file, &self.film, size, &self.report(outcome).header()),
        })
    }
}
