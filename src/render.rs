//! Scheduling: blocks of samples over threads.

use core::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use bumpalo::Bump;
use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::pipeline::Pipeline;

use crate::film::Film;
use crate::frame::Frame;
use crate::stats::Stats;
use crate::wavefront::{Wavefront, default_lanes};

/// Samples of a pixel that one block takes: enough to amortise filling and draining the wavefront.
const SAMPLES_PER_BLOCK: u32 = 16;

/// How to render; nothing here changes a bit of the image.
#[derive(Clone, Copy, Debug)]
pub struct Workers {
    /// Worker threads; 0 for one per processor.
    pub threads: usize,
    /// Paths in flight per worker; `None` for what suits the frame.
    pub lanes: Option<usize>,
    /// Whether to time stages and count the fate of connections.
    pub detailed_stats: bool,
}

/// Numbers of samples of every pixel of a film.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Samples {
    /// All of these, whatever else there is already.
    All(Range<u32>),
    /// Of these the ones that are missing: pixels have the first of them, some perhaps more than others.
    Missing(Range<u32>),
}

/// Which samples blocks take.
struct Blocks {
    /// Number of the sample with which every tile began: it has as many as follow.
    firsts: Vec<u32>,
    /// Number after the last sample.
    end: u32,
    /// Blocks of the tile that lacks most.
    passes: u32,
}

impl From<Range<u32>> for Samples {
    fn from(samples: Range<u32>) -> Self {
        Self::All(samples)
    }
}

impl Samples {
    fn blocks(self, film: &Film) -> Blocks {
        let tiles = 0..film.tile_count();
        let (firsts, left, end) = match self {
            Self::All(samples) => {
                let firsts = tiles.map(|tile| samples.start.wrapping_sub(film.tile(tile).samples())).collect();
                (firsts, samples.len() as u32, samples.end)
            }
            Self::Missing(samples) => {
                let left = (samples.len() as u32).saturating_sub(film.fewest_samples());
                (vec![samples.start; tiles.len()], left, samples.end)
            }
        };
        Blocks { firsts, end, passes: left.div_ceil(SAMPLES_PER_BLOCK) }
    }
}

/// How a caller watches and stops a running render.
#[derive(Debug, Default)]
pub struct Monitor {
    /// Set to stop: workers finish the block at hand.
    pub stop: Arc<AtomicBool>,
    /// Camera paths finished so far.
    pub samples: AtomicU64,
    /// Their contributions that were not finite.
    dropped: Mutex<Dropped>,
}

impl Monitor {
    /// One that stops when this one does, and counts for itself.
    pub fn uncounted(&self) -> Self {
        Self { stop: Arc::clone(&self.stop), ..Self::default() }
    }

    /// Contributions so far that were not finite, and so were dropped.
    pub fn dropped(&self) -> Dropped {
        *self.dropped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that contributions were dropped.
    pub fn note_dropped(&self, dropped: Dropped) {
        self.dropped.lock().unwrap_or_else(PoisonError::into_inner).merge(&dropped);
    }

    /// Whether it says stop.
    pub fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Worker threads that render.
pub struct Renderer {
    pool: rayon::ThreadPool,
    workers: Workers,
}

impl Renderer {
    /// Starts the threads.
    ///
    /// # Errors
    /// If the system refuses to.
    pub fn new(workers: Workers) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(workers.threads).build()?;
        Ok(Self { pool, workers })
    }

    /// Number of worker threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Takes `samples` of every pixel of `film`, or as many as fit before the monitor says stop.
    ///
    /// Blocks are handed out pass by pass, so that an image that was stopped is evenly covered to within one block.
    /// The sums are exact: who takes which block, and when, leaves no trace.
    pub fn render(
        &self,
        frame: &Frame,
        pipeline: &Pipeline,
        film: &Film,
        samples: impl Into<Samples>,
        monitor: &Monitor,
    ) -> Stats {
        self.render_counting(Stats::new(self.workers.detailed_stats), frame, pipeline, film, samples, monitor)
    }

    /// The same, and gives what `empty` says is to be counted.
    pub fn render_counting(
        &self,
        empty: Stats,
        frame: &Frame,
        pipeline: &Pipeline,
        film: &Film,
        samples: impl Into<Samples>,
        monitor: &Monitor,
    ) -> Stats {
        let Blocks { firsts, end, passes } = samples.into().blocks(film);
        let total = Mutex::new(empty.clone());
        let blocks = u64::from(passes) * film.tile_count() as u64;
        let next = AtomicU64::new(0);
        self.pool.broadcast(|_| {
            let arena = Bump::new();
            let lanes = self.workers.lanes.unwrap_or_else(|| default_lanes(frame));
            let mut wavefront = Wavefront::new_in(&arena, frame, pipeline, lanes);
            wavefront.stats = empty.clone();
            while !monitor.stops() {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= blocks {
                    break;
                }
                let tile = (index % film.tile_count() as u64) as usize;
                let (first, mut tile) = (firsts[tile], film.tile(tile));
                // A tile's next samples, whoever comes first: at any time it has all from its first to its last one.
                let start = first.wrapping_add(tile.samples());
                let block = start..end.min(start.saturating_add(SAMPLES_PER_BLOCK));
                if block.is_empty() {
                    continue;
                }
                let (before, dropped) = (wavefront.stats.samples, wavefront.stats.dropped.count);
                wavefront.render(block, &mut tile);
                drop(tile);
                monitor.samples.fetch_add(wavefront.stats.samples - before, Ordering::Relaxed);
                let Dropped { count, first } = wavefront.stats.dropped;
                if count > dropped {
                    monitor.note_dropped(Dropped { count: count - dropped, first });
                }
            }
            total.lock().unwrap_or_else(PoisonError::into_inner).merge(&wavefront.stats);
        });
        total.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}
