//! What a worker does during one render: blocks of tiles, in the order that all workers share.
//!
//! What a block adds to its tile is summed up apart, and added when it is complete: whoever looks at the film finds whole
//! blocks, and does not wait for the longest path of one.

use core::ops::{Deref, DerefMut, Range};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{MutexGuard, PoisonError};

use fogbow_kernels::accumulate::Dropped;

use super::{BLOCKS_PER_LOOK, Monitor, Plan, SAMPLES_PER_BLOCK};
use crate::film::{Film, Tile};
use crate::stats::Stats;
use crate::wavefront::Blocks;

/// Most blocks that a worker has in flight.
const MOST_BLOCKS: u64 = 64;
/// Bytes that their sums should not exceed.
const MOST_BYTES: u64 = 16 << 20;

/// What a block adds to its tile.
pub struct Block<'a> {
    place: usize,
    sums: Tile,
    /// Ends the worker's turn at the tile.
    _turn: MutexGuard<'a, ()>,
}

impl Deref for Block<'_> {
    type Target = Tile;

    fn deref(&self) -> &Tile {
        &self.sums
    }
}

impl DerefMut for Block<'_> {
    fn deref_mut(&mut self) -> &mut Tile {
        &mut self.sums
    }
}

/// One worker's part in a render.
pub struct Shift<'a> {
    film: &'a Film,
    plan: &'a Plan,
    /// Number of the block that nobody has taken yet, over all passes.
    next: &'a AtomicU64,
    monitor: &'a Monitor,
    /// What is to be counted.
    empty: &'a Stats,
    /// The tile that is this worker's turn, while another one is at it.
    waiting_for: Option<usize>,
    /// Blocks taken so far.
    taken: u32,
    /// What was counted before, while somebody looks on.
    before: Option<Stats>,
    /// How many contributions were not finite, as far as it is told.
    told: u64,
}

impl<'a> Shift<'a> {
    /// One that takes blocks of the `plan` from number `next` on, and counts what `empty` says.
    pub fn new(film: &'a Film, plan: &'a Plan, next: &'a AtomicU64, monitor: &'a Monitor, empty: &'a Stats) -> Self {
        Self { film, plan, next, monitor, empty, waiting_for: None, taken: 0, before: None, told: 0 }
    }

    /// The tile of the next block, if there is one.
    fn next_tile(&mut self) -> Option<usize> {
        let tiles = self.film.tile_count() as u64;
        let count = u64::from(self.plan.passes) * tiles;
        while self.waiting_for.is_none() {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return None;
            }
            let (place, pass) = ((index % tiles) as usize, (index / tiles) as u32);
            self.waiting_for = self.plan.has(place, pass).then_some(place);
        }
        self.waiting_for
    }

    /// From here on, counts for whoever looks on, if it is time to. What is counted for them has at least a segment.
    fn watch(&mut self, stats: &mut Stats) {
        if self.before.is_some() && stats.segments == 0 {
            return;
        }
        self.stop_watching(stats);
        let is_watched = self.monitor.is_watched.load(Ordering::Relaxed);
        if is_watched && (self.empty.detailed || self.taken.is_multiple_of(BLOCKS_PER_LOOK)) {
            let own = Stats { detailed: true, ..self.empty.clone() };
            self.before = Some(core::mem::replace(stats, own));
            self.told = 0;
        }
        self.taken += 1;
    }

    /// Hands what was counted for them to whoever looks on.
    pub fn stop_watching(&mut self, stats: &mut Stats) {
        self.tell_dropped(stats);
        let Some(before) = self.before.take() else { return };
        let own = core::mem::replace(stats, before);
        self.monitor.note_work(&own);
        stats.merge(&own);
        self.told = stats.dropped.count;
    }

    /// Tells of contributions that were not finite.
    fn tell_dropped(&mut self, stats: &Stats) {
        let Dropped { count, first } = stats.dropped;
        if count > self.told {
            self.monitor.note_dropped(Dropped { count: count - self.told, first });
            self.told = count;
        }
    }
}

impl<'a> Blocks for Shift<'a> {
    type Sums = Block<'a>;

    fn most(&self) -> usize {
        let bytes = Film::bytes(self.film.layers(), self.film.tile(0).region().pixels());
        (MOST_BYTES / bytes.max(1)).clamp(2, MOST_BLOCKS) as usize
    }

    fn goes_on(&mut self) -> bool {
        self.monitor.finishes_blocks()
    }

    fn next(&mut self, waits: bool, stats: &mut Stats) -> Option<(Block<'a>, Range<u32>)> {
        while !self.monitor.stops() {
            let place = self.next_tile()?;
            let turn = &self.plan.turns[place];
            let turn =
                if waits { turn.lock().unwrap_or_else(PoisonError::into_inner) } else { turn.try_lock().ok()? };
            self.waiting_for = None;
            // A tile's next samples, whoever comes first: at any time it has all from its first to its last one.
            let Range { start: first, end } = self.plan.samples[place].clone();
            let (region, start) = {
                let tile = self.film.tile(place);
                (tile.region(), first.wrapping_add(tile.samples()))
            };
            let block = start..end.min(start.saturating_add(SAMPLES_PER_BLOCK));
            if !block.is_empty() {
                self.watch(stats);
                let sums = Tile::new(self.film.layers(), region);
                return Some((Block { place, sums, _turn: turn }, block));
            }
        }
        None
    }

    fn end(&mut self, block: Block<'a>, samples: u32, stats: &mut Stats) {
        self.film.tile(block.place).merge(&block.sums);
        self.monitor.samples.fetch_add(block.region().pixels() * u64::from(samples), Ordering::Relaxed);
        self.tell_dropped(stats);
    }
}
