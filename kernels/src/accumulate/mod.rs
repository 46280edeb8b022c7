//! Contributions: from weighted candidates to the radiance of their paths.

pub mod reference;
pub mod simd;

use crate::columns::paths::PathTable;
use crate::columns::queues::{Bucket, CandidateQueue};
use crate::tables::lights::Lights;
use crate::tables::media::Medium;
use crate::{PathLengths, Step};

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Rows to add: those of this bucket.
    pub bucket: Bucket,
    /// Read: lane, light and weight.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: birth and throughput. Added to: radiance, in the channels in use.
    pub paths: &'a mut PathTable<'q>,
    /// Added to: contributions that were not finite, and so were dropped.
    pub dropped: &'a mut Dropped,
}

/// Contributions that were dropped because they were not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// How many.
    pub count: u64,
    /// Pixel index and sample number of the first.
    pub first: Option<(u32, u32)>,
}

impl Dropped {
    /// Notes one more, of `sample` of `pixel`.
    #[cold]
    pub fn note(&mut self, pixel: u32, sample: u32) {
        self.count += 1;
        self.first.get_or_insert((pixel, sample));
    }
}

/// Adds `weight * Le * throughput * albedo^inserted` (transport: C) of every candidate to its path, unless the number
/// of its segments, `depth + inserted + 1`, is outside `lengths`.
pub type Kernel = fn(&Medium, &Lights, PathLengths, Step, Columns<'_, '_>);
