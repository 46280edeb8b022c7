//! Scheduling: blocks of samples over threads.

mod shift;

use core::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use bumpalo::Bump;
use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::pipeline::Pipeline;

use self::shift::Shift;
use crate::adaptive::{self, Cell};
use crate::film::{Film, RADIANCE, Tile};
use crate::frame::Frame;
use crate::stats::Stats;
use crate::wavefront::{Wavefront, default_lanes};

/// Samples of a pixel that one block takes: enough for whole batches, few enough that an image which is stopped is evenly
/// covered.
const SAMPLES_PER_BLOCK: u32 = 16;

/// Of so many blocks one is timed where only somebody looks on: to time all of them costs some percent.
const BLOCKS_PER_LOOK: u32 = 8;

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
    /// The same with a range for every tile.
    MissingOf(Vec<Range<u32>>),
}

/// Which samples blocks take.
struct Plan {
    /// Tile by tile, the number of the sample with which it began, of which it has as many as follow, to that after its
    /// last one.
    samples: Vec<Range<u32>>,
    /// Blocks that every tile lacks.
    counts: Vec<u32>,
    /// Those of the tile that lacks most.
    passes: u32,
    /// Held by the worker that is at a tile: its blocks come one after the other.
    turns: Vec<Mutex<()>>,
}

impl From<Range<u32>> for Samples {
    fn from(samples: Range<u32>) -> Self {
        Self::All(samples)
    }
}

impl Samples {
    fn plan(self, film: &Film) -> Plan {
        let has = film.samples_of_tiles();
        let samples = match self {
            Self::All(samples) => {
                has.iter().map(|has| samples.start.wrapping_sub(*has)..samples.end).collect::<Vec<_>>()
            }
            Self::Missing(samples) => vec![samples; has.len()],
            Self::MissingOf(samples) => samples,
        };
        let left = |(samples, has): (&Range<u32>, &u32)| samples.end.saturating_sub(samples.start.wrapping_add(*has));
        let counts: Vec<_> = samples.iter().zip(&has).map(|tile| left(tile).div_ceil(SAMPLES_PER_BLOCK)).collect();
        let passes = counts.iter().copied().max().unwrap_or(0);
        let turns = has.iter().map(|_| Mutex::new(())).collect();
        Plan { samples, counts, passes, turns }
    }
}

impl Plan {
    /// Whether the tile has a block in this pass: those of a tile are spread evenly over all passes.
    fn has(&self, tile: usize, pass: u32) -> bool {
        let (count, passes) = (u64::from(self.counts[tile]), u64::from(self.passes));
        let before = |pass: u64| pass * count / passes;
        before(u64::from(pass) + 1) > before(pass.into())
    }
}

/// How a caller watches and stops a running render.
#[derive(Debug, Default)]
pub struct Monitor {
    /// Set to stop: workers finish the block at hand, unless nobody will keep it.
    pub stop: Arc<AtomicBool>,
    /// Whether a block that is not finished is left as it is: nobody keeps what was rendered before a stop.
    is_all_or_nothing: bool,
    /// Camera paths finished so far.
    pub samples: AtomicU64,
    /// Their contributions that were not finite.
    dropped: Mutex<Dropped>,
    /// Whether somebody looks on, who is to see statistics.
    pub is_watched: AtomicBool,
    /// Detailed statistics of blocks, for them.
    work: Mutex<Option<Stats>>,
}

impl Monitor {
    /// One that stops when this one does, and counts for itself, of looks that are of no use once it says stop.
    pub fn of_looks(&self) -> Self {
        Self { stop: Arc::clone(&self.stop), is_all_or_nothing: true, ..Self::default() }
    }

    /// Whether workers go on with a block at hand.
    fn finishes_blocks(&self) -> bool {
        !(self.is_all_or_nothing && self.stops())
    }

    /// Contributions so far that were not finite, and so were dropped.
    pub fn dropped(&self) -> Dropped {
        *self.dropped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that contributions were dropped.
    pub fn note_dropped(&self, dropped: Dropped) {
        self.dropped.lock().unwrap_or_else(PoisonError::into_inner).merge(&dropped);
    }

    /// Detailed statistics so far, if somebody looks on: of some of the blocks, unless all are timed. Their samples are
    /// those of these blocks.
    pub fn work(&self) -> Option<Stats> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Adds what a block took.
    fn note_work(&self, work: &Stats) {
        let mut all = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        all.get_or_insert_with(|| Stats::new(true)).merge(work);
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
    /// Blocks are handed out pass by pass, so that an image that was stopped is evenly covered to within one block, as
    /// far as all tiles are to get as many samples.
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
        let plan = samples.into().plan(film);
        let (total, next) = (Mutex::new(empty.clone()), AtomicU64::new(0));
        self.pool.broadcast(|_| {
            let arena = Bump::new();
            let lanes = self.workers.lanes.unwrap_or_else(|| default_lanes(frame));
            let mut wavefront = Wavefront::new_in(&arena, frame, pipeline, lanes);
            wavefront.stats = empty.clone();
            let mut shift = Shift::new(film, &plan, &next, monitor, &empty);
            wavefront.render_blocks(&mut shift);
            shift.stop_watching(&mut wavefront.stats);
            total.lock().unwrap_or_else(PoisonError::into_inner).merge(&wavefront.stats);
        });
        total.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// So many looks at the region of `film`, of `samples` of every pixel each, one look's after the other's, none of which
    /// are kept: what each of them counted, of what `empty` says is to be counted; nothing if the monitor said stop
    /// before. A look is the work of one worker, as few paths that are long fill more lanes together than in tiles of
    /// their own.
    pub fn looks(
        &self,
        empty: &Stats,
        frame: &Frame,
        pipeline: &Pipeline,
        film: &Film,
        (count, samples): (u32, u32),
        monitor: &Monitor,
    ) -> Option<Vec<Stats>> {
        let radiance = &film.layers()[..=RADIANCE];
        self.in_turn(frame, pipeline, count as usize, |wavefront, number| {
            let first = number as u32 * samples;
            wavefront.stats = empty.clone();
            take(wavefront, first..first + samples, &mut Tile::new(radiance, film.region()), monitor)?;
            Some(wavefront.stats.clone())
        })
    }

    /// Takes these samples of every pixel of `film` and keeps none of them; what they say of its tiles, or nothing if
    /// the monitor said stop before.
    pub fn probe(
        &self,
        frame: &Frame,
        pipeline: &Pipeline,
        film: &Film,
        samples: Range<u32>,
        monitor: &Monitor,
    ) -> Option<Vec<Vec<Cell>>> {
        let radiance = &film.layers()[..=RADIANCE];
        self.in_turn(frame, pipeline, film.tile_count(), |wavefront, index| {
            let mut tile = Tile::new(radiance, film.tile(index).region());
            take(wavefront, samples.clone(), &mut tile, monitor)?;
            Some(adaptive::cells(&tile))
        })
    }

    /// What `work` finds for each number below `count`: workers take them in turn, each with a wavefront of its own. None
    /// if there is nothing for one of them.
    fn in_turn<T: Clone + Send>(
        &self,
        frame: &Frame,
        pipeline: &Pipeline,
        count: usize,
        work: impl Fn(&mut Wavefront<'_>, usize) -> Option<T> + Sync,
    ) -> Option<Vec<T>> {
        let (next, found) = (AtomicUsize::new(0), Mutex::new(vec![None; count]));
        self.pool.broadcast(|_| {
            let arena = Bump::new();
            let lanes = self.workers.lanes.unwrap_or_else(|| default_lanes(frame));
            let mut wavefront = Wavefront::new_in(&arena, frame, pipeline, lanes);
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= count {
                    break;
                }
                let Some(one) = work(&mut wavefront, number) else { return };
                found.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(one);
            }
        });
        found.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect()
    }
}

/// Takes these samples of every pixel of `tile`; nothing if the monitor said stop before.
fn take(wavefront: &mut Wavefront<'_>, samples: Range<u32>, tile: &mut Tile, monitor: &Monitor) -> Option<()> {
    (!monitor.stops() && wavefront.render_while(samples, tile, || monitor.finishes_blocks())).then_some(())
}
