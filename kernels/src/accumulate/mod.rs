//! Contributions: from weighted candidates to the radiance of their paths.

pub mod reference;
pub mod simd;

use crate::columns::Spectrum;
use crate::columns::parts::PartTable;
use crate::columns::paths::PathColumns;
use crate::columns::queues::{Bucket, CandidateQueue, WorthTable};
use crate::tables::lights::Lights;
use crate::{PathLengths, Step};

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lights.
    pub lights: &'a Lights,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// Rows to add: those of this bucket.
    pub bucket: Bucket,
    /// Read: lane and emitter.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: what they count.
    pub worth: &'a WorthTable<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read, in the channels in use.
    pub throughput: &'a Spectrum<'q>,
    /// Added to, in the channels in use.
    pub radiance: &'a mut Spectrum<'q>,
    /// Which of the parts by origin the candidates belong to; of no meaning where there are none.
    pub origin: usize,
    /// Added to, in the channels in use.
    pub parts: &'a mut PartTable<'q>,
    /// Added to: contributions that were not finite, and so were dropped.
    pub dropped: &'a mut Dropped,
}

/// Contributions that were dropped because they were not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// How many.
    pub count: u64,
    /// Smallest pixel index, and smallest sample number in it: the same for any order of work.
    pub first: Option<(u32, u32)>,
}

impl Dropped {
    /// Notes one more, of `sample` of `pixel`.
    #[cold]
    pub fn note(&mut self, pixel: u32, sample: u32) {
        self.merge(&Self { count: 1, first: Some((pixel, sample)) });
    }

    /// Adds those that others noted.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.first = self.first.into_iter().chain(other.first).min();
    }
}

/// Adds `weight factor Le T` of every candidate that weighs something to its path, unless the number of its segments,
/// `depth + inserted + 1`, is outside `lengths`; and once more to the parts of the radiance that it belongs to.
pub type Kernel = fn(Step, Columns<'_, '_>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_dropped_sample_does_not_depend_on_the_order_of_work() {
        let noted = [(7, 3), (2, 9), (2, 5), (8, 0)];
        let of = |samples: &[(u32, u32)]| {
            let mut dropped = Dropped::default();
            samples.iter().for_each(|(pixel, sample)| dropped.note(*pixel, *sample));
            dropped
        };
        let mut halves = of(&noted[2..]);
        halves.merge(&of(&noted[..2]));
        assert_eq!(halves, of(&noted));
        assert_eq!(halves, Dropped { count: 4, first: Some((2, 5)) });
    }
}
