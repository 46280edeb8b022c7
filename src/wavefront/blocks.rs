//! Blocks of samples in flight: lanes are refilled from the next block while the last paths of others go on.
//!
//! Some paths are a hundred times as long as most. A worker that waited for the last one of a block would leave nearly
//! all of its lanes empty meanwhile.

use core::ops::{DerefMut, Range};

use super::work::Work;
use crate::film::Tile;
use crate::stats::Stats;

/// Where a worker's blocks come from, and where they go.
pub trait Blocks {
    /// The sums of a block's pixels, which are the worker's as long as the block is in flight.
    type Sums: DerefMut<Target = Tile>;

    /// Most blocks to have in flight, at least 1.
    fn most(&self) -> usize;

    /// Whether to go on, asked before every segment. If not, the tiles in flight have part of their samples, and paths
    /// are left where they are.
    fn goes_on(&mut self) -> bool;

    /// The next block: its pixels, and the numbers of the samples to take of each. None if no other is left; or, unless
    /// the worker `waits` as it has nothing else to do, if it is not to be had right now.
    fn next(&mut self, waits: bool, stats: &mut Stats) -> Option<(Self::Sums, Range<u32>)>;

    /// Takes back a block of which all of so many samples of every pixel are counted.
    fn end(&mut self, sums: Self::Sums, samples: u32, stats: &mut Stats);
}

/// One block, as long as `goes_on` says so.
pub(super) struct One<'t, F> {
    pub block: Option<(&'t mut Tile, Range<u32>)>,
    pub goes_on: F,
}

impl<'t, F: FnMut() -> bool> Blocks for One<'t, F> {
    type Sums = &'t mut Tile;

    fn most(&self) -> usize {
        1
    }

    fn goes_on(&mut self) -> bool {
        (self.goes_on)()
    }

    fn next(&mut self, _: bool, _: &mut Stats) -> Option<(&'t mut Tile, Range<u32>)> {
        self.block.take()
    }

    fn end(&mut self, _: &'t mut Tile, _: u32, _: &mut Stats) {}
}

/// A block in flight.
struct Open<S> {
    sums: S,
    /// Samples of every pixel.
    samples: u32,
    /// Samples that are not yet on the film.
    left: u64,
}

/// The blocks that a worker has in flight, each in a slot of its own.
pub(super) struct InFlight<S> {
    slots: Vec<Option<Open<S>>>,
    /// What no lane has taken yet of the last one, which is in this slot.
    work: Option<(usize, Work)>,
}

impl<S: DerefMut<Target = Tile>> InFlight<S> {
    /// None yet, of at most so many.
    pub fn none(most: usize) -> Self {
        Self { slots: (0..most).map(|_| None).collect(), work: None }
    }

    /// What no lane has taken yet, and the slot of its block; another block's if that is nothing.
    pub fn work(&mut self, mut next: impl FnMut(bool) -> Option<(S, Range<u32>)>) -> Option<(u32, &mut Work)> {
        while self.work.as_ref().is_none_or(|(_, work)| work.is_done()) {
            let vacant = self.slots.iter().position(Option::is_none)?;
            let waits = self.slots.iter().all(Option::is_none);
            let (sums, samples) = next(waits)?;
            let (region, count) = (sums.region(), samples.len() as u32);
            let left = region.pixels() * u64::from(count);
            self.slots[vacant] = Some(Open { sums, samples: count, left });
            self.work = Some((vacant, Work::new(region, samples)));
        }
        self.work.as_mut().map(|(slot, work)| (*slot as u32, work))
    }

    /// The tile of so many paths that have ended, which thereby are counted.
    #[inline]
    pub fn count(&mut self, slot: u32, paths: u32) -> &mut Tile {
        let open = self.slots[slot as usize].as_mut().expect("a block with a path in flight");
        open.left -= u64::from(paths);
        &mut open.sums
    }

    /// Hands all blocks whose samples are all counted to `end`.
    pub fn end(&mut self, mut end: impl FnMut(S, u32)) {
        for slot in &mut self.slots {
            if let Some(Open { mut sums, samples, .. }) = slot.take_if(|open| open.left == 0) {
                sums.count(samples);
                end(sums, samples);
            }
        }
    }
}
