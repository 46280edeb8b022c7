//! Connections that cannot count, whatever they weigh: they are dropped before anybody asks how much.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable, WorthTable};
use crate::media::Medium;
use crate::tables::lights::Lights;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// Rows to judge: those of this bucket.
    pub bucket: Bucket,
    /// Read: emitter, start and point.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: the inserted vertices.
    pub chains: &'a ChainTable<'q>,
    /// Filled: the weight, 1 or 0.
    pub worth: &'a mut WorthTable<'q>,
}

/// Weighs a connection 0 if its last segment arrives at the dark side of its emitter, if its first inserted vertex was
/// rounded to its start, which leaves no direction to weigh it by, or where extinction varies if one of its inserted
/// vertices is in vacuum; and 1 otherwise: then it is yet to be weighed.
pub type Kernel = fn(Step, Columns<'_, '_>);
