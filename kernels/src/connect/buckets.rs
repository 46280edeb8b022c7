//! Connections sorted by the number of vertices they insert, so that eight lanes share their loop bounds.

use bumpalo::Bump;

use crate::PathLengths;
use crate::columns::Column;
use crate::columns::paths::{ImmersionColumns, LastSurfaceColumns, PathColumns};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable};
use crate::lanes::LANES;
use crate::media::Medium;

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
}

/// A stable counting sort of connection rows by their number of inserted vertices.
pub struct BucketTable<'q> {
    /// Inserted vertices of each connection; [`DROPPED`] if it cannot be made. Filled by a technique's count stage.
    pub count: Column<'q, u32>,
    /// The connection rows, bucket by bucket. The rows of `buckets()[m]` are those of connections that insert `m`.
    pub order: Column<'q, u32>,
    buckets: &'q mut [Bucket],
}

/// Count of a connection that would be longer than the length limit.
pub const DROPPED: u32 = u32::MAX;

impl<'q> BucketTable<'q> {
    /// Room for `connections` connections of at most `longest` inserted vertices each.
    pub fn new_in(arena: &'q Bump, connections: usize, longest: usize) -> Self {
        Self {
            count: Column::new_in(arena, connections + LANES),
            order: Column::new_in(arena, Self::rows(connections, longest) + LANES),
            buckets: arena.alloc_slice_fill_with(longest + 1, |inserted| Bucket { inserted, start: 0, len: 0 }),
        }
    }

    /// Rows that the sorted connections may take: every bucket starts with a batch of its own.
    pub fn rows(connections: usize, longest: usize) -> usize {
        connections + (longest + 1) * LANES
    }

    /// Sorts the first `connections` rows; afterwards `order` and [`Self::buckets`] are valid. Returns the number of
    /// sorted rows, gaps between buckets included.
    pub fn sort(&mut self, connections: usize) -> usize {
        let counts = &self.count.rows()[..connections];
        self.buckets.iter_mut().for_each(|bucket| bucket.len = 0);
        for count in counts.iter().filter(|count| **count != DROPPED) {
            self.buckets[*count as usize].len += 1;
        }
        let mut end = 0;
        for bucket in self.buckets.iter_mut() {
            bucket.start = end;
            end += bucket.len.next_multiple_of(LANES);
            bucket.len = 0;
        }
        let order = self.order.rows_mut();
        for (row, count) in counts.iter().enumerate().filter(|(_, count)| **count != DROPPED) {
            let bucket = &mut self.buckets[*count as usize];
            order[bucket.start + bucket.len] = row as u32;
            bucket.len += 1;
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

    #[test]
    fn sorting_keeps_every_row_once_and_in_sequence() {
        let arena = Bump::new();
        let counts = [2, 0, DROPPED, 2, 3, 0, 2, 2, 2, 2, 2, 2, 2];
        let mut table = BucketTable::new_in(&arena, counts.len(), 3);
        table.count.rows_mut()[..counts.len()].copy_from_slice(&counts);
        assert_eq!(table.sort(counts.len()), 32);
        let rows = |m: usize| table.buckets()[m].rows().map(|row| table.order.rows()[row]).collect::<Vec<_>>();
        assert_eq!(rows(0), [1, 5]);
        assert_eq!(rows(1), []);
        assert_eq!(rows(2), [0, 3, 6, 7, 8, 9, 10, 11, 12]);
        assert_eq!(rows(3), [4]);
        assert!(table.buckets().iter().all(|bucket| bucket.start.is_multiple_of(LANES)));
    }
}
