//! Connections sorted by the number of vertices they insert, and those that insert as many by how far their weights look
//! back from the start, so that eight lanes share their loop bounds.

use bumpalo::Bump;
use wide::u32x8;

use crate::PathLengths;
use crate::columns::Column;
use crate::columns::paths::{ImmersionColumns, LastSurfaceColumns, OutlookColumns, PathColumns};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable};
use crate::connect::bridge::sample::walk::Pieces;
use crate::lanes::LANES;
use crate::media::Medium;
use crate::tables::lights::Lights;

/// What counting the inserted vertices of connections may touch.
pub struct CountColumns<'a, 'q, T> {
    /// The settings of the technique.
    pub technique: &'a T,
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// Whether there are surfaces; without them, `last_surface` is not read.
    pub solid: bool,
    /// Read: pixel, sample, birth.
    pub paths: &'a PathColumns<'q>,
    /// Read where extinction is coloured: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Read: its depth.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Read: lane, start, arriving and point of the connections.
    pub connections: &'a CandidateQueue<'q>,
    /// Filled: inserted vertices of every connection, or [`DROPPED`].
    pub count: &'a mut Column<'q, u32>,
}

/// What placing the inserted vertices of connections may touch.
pub struct BuildColumns<'a, 'q, T> {
    /// The settings of the technique.
    pub technique: &'a T,
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights on which connections end, if they do.
    pub lights: Option<&'a Lights>,
    /// Whether there are surfaces; without them, `last_surface` is not read.
    pub solid: bool,
    /// Read: pixel, sample, birth.
    pub paths: &'a PathColumns<'q>,
    /// Read where extinction is coloured: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Read: its depth.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Read: every column of the connections.
    pub connections: &'a CandidateQueue<'q>,
    /// Read: order and buckets.
    pub buckets: &'a BucketTable<'q>,
    /// Filled at the buckets' rows.
    pub candidates: &'a mut CandidateQueue<'q>,
    /// Filled at the buckets' rows: the inserted vertices.
    pub chains: &'a mut ChainTable<'q>,
    /// Room for the walks of eight bridges.
    pub pieces: &'a mut Pieces<'q>,
}

/// How many vertices before the start of a connection its weight looks at, at most.
pub struct LookBack<'a, 'q> {
    /// Clock of the bounce.
    pub clock: u32,
    /// Read: lanes of the connections.
    pub connections: &'a CandidateQueue<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: the first vertex that is looked at.
    pub since: Since<'a, 'q>,
}

/// The first vertex of a path that weights look at.
#[derive(Clone, Copy)]
pub enum Since<'a, 'q> {
    /// The first of all.
    Birth,
    /// The last on a surface, if there is one.
    Surface(&'a LastSurfaceColumns<'q>),
    /// The first near a light.
    Near(&'a OutlookColumns<'q>),
}

impl LookBack<'_, '_> {
    /// The vertices of batch `b`.
    #[inline(always)]
    pub fn of(&self, b: usize) -> u32x8 {
        let lane_of = self.connections.lane.batch(b).to_array();
        let depth = u32x8::splat(self.clock) - self.paths.birth.gather(&lane_of);
        let first = match self.since {
            Since::Birth => u32x8::splat(1),
            Since::Surface(last_surface) => last_surface.depth.gather(&lane_of).max(u32x8::splat(1)),
            Since::Near(outlook) => outlook.first_near.gather(&lane_of),
        };
        depth.saturating_sub(first)
    }
}

/// A stable counting sort of connection rows by their number of inserted vertices, and then by how far they look back.
pub struct BucketTable<'q> {
    /// Inserted vertices of each connection; [`DROPPED`] if it cannot be made. Filled by a technique's count stage.
    pub count: Column<'q, u32>,
    /// The connection rows, bucket by bucket. The rows of `buckets()[m]` are those of connections that insert `m`.
    pub order: Column<'q, u32>,
    /// What each connection is sorted by: its part.
    part: Column<'q, u32>,
    /// Rows in every part, and then where its next one goes.
    ends: &'q mut [u32],
    buckets: &'q mut [Bucket],
}

/// Count of a connection that would be longer than the length limit.
pub const DROPPED: u32 = u32::MAX;

/// Parts of a bucket. What looks back as far as the last or farther is in one.
const PARTS: usize = 16;

impl<'q> BucketTable<'q> {
    /// Room for `connections` connections of at most `longest` inserted vertices each.
    pub fn new_in(arena: &'q Bump, connections: usize, longest: usize) -> Self {
        Self {
            count: Column::new_in(arena, connections + LANES),
            order: Column::new_in(arena, Self::rows(connections, longest) + LANES),
            part: Column::new_in(arena, connections + LANES),
            ends: arena.alloc_slice_fill_copy((longest + 1) * PARTS, 0),
            buckets: arena.alloc_slice_fill_with(longest + 1, |inserted| Bucket { inserted, start: 0, len: 0 }),
        }
    }

    /// Rows that the sorted connections may take: every bucket starts with a batch of its own.
    pub fn rows(connections: usize, longest: usize) -> usize {
        connections + (longest + 1) * LANES
    }

    /// Sorts the first `connections` rows, of which batch `b` looks back by `look_back(b)` vertices; afterwards `order` and
    /// [`Self::buckets`] are valid. Returns the number of sorted rows, gaps between buckets included.
    pub fn sort(&mut self, connections: usize, look_back: impl Fn(usize) -> u32x8) -> usize {
        let dropped = u32x8::splat(DROPPED);
        for b in 0..connections.div_ceil(LANES) {
            let count = self.count.batch(b);
            let part = count * u32x8::splat(PARTS as u32) + look_back(b).min(u32x8::splat(PARTS as u32 - 1));
            self.part.set_batch(b, count.simd_eq(dropped).select(dropped, part));
        }
        let parts = &self.part.rows()[..connections];
        let used = parts.iter().map(|part| part.wrapping_add(1)).max().unwrap_or(0) as usize; // DROPPED becomes 0
        self.ends[..used.next_multiple_of(PARTS)].fill(0);
        for part in parts.iter().filter(|part| **part != DROPPED) {
            self.ends[*part as usize] += 1;
        }
        let mut end = 0;
        for (bucket, ends) in self.buckets.iter_mut().zip(self.ends.chunks_exact_mut(PARTS)) {
            bucket.start = end;
            if bucket.inserted * PARTS < used {
                for part in ends {
                    end += core::mem::replace(part, end as u32) as usize;
                }
            }
            bucket.len = end - bucket.start;
            end = end.next_multiple_of(LANES);
        }
        let order = self.order.rows_mut();
        for (row, part) in parts.iter().enumerate().filter(|(_, part)| **part != DROPPED) {
            let next = &mut self.ends[*part as usize];
            order[*next as usize] = row as u32;
            *next += 1;
        }
        end
    }

    /// The buckets, by number of inserted vertices.
    pub fn buckets(&self) -> &[Bucket] {
        self.buckets
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes;

    #[test]
    fn sorting_keeps_every_row_once_and_in_sequence() {
        let arena = Bump::new();
        let counts = [2, 0, DROPPED, 2, 3, 0, 2, 2, 2, 2, 2, 2, 2];
        let sorted = |look_back: &dyn Fn(usize) -> u32| {
            let mut table = BucketTable::new_in(&arena, counts.len(), 3);
            table.count.rows_mut()[..counts.len()].copy_from_slice(&counts);
            let of_batch = |b: usize| u32x8::new(lanes::per_lane(|lane| look_back(b * LANES + lane)));
            assert_eq!(table.sort(counts.len(), of_batch), 32);
            assert!(table.buckets().iter().all(|bucket| bucket.start.is_multiple_of(LANES)));
            let rows = |m: usize| table.buckets()[m].rows().map(|row| table.order.rows()[row]).collect::<Vec<_>>();
            [0, 1, 2, 3].map(rows)
        };
        let in_sequence = [vec![1, 5], vec![], vec![0, 3, 6, 7, 8, 9, 10, 11, 12], vec![4]];
        assert_eq!(sorted(&|_| 0), in_sequence);
        assert_eq!(sorted(&|_| 99), in_sequence);
        let nearest_first = [vec![5, 1], vec![], vec![12, 11, 10, 9, 8, 7, 6, 0, 3], vec![4]];
        // The first rows look back farther than there are parts.
        assert_eq!(sorted(&|row| 19 - row as u32), nearest_first);
    }
}
