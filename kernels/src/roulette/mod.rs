//! Roulette on the contribution: faint candidates are dropped before their segments are traced.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::Spectrum;
use crate::columns::paths::PathColumns;
use crate::columns::queues::{Bucket, CandidateQueue, WorthTable};
use crate::random::Purpose;
use crate::tables::lights::Lights;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lights.
    pub lights: &'a Lights,
    /// What survives.
    pub threshold: Threshold,
    /// Rows to judge: those of this bucket.
    pub bucket: Bucket,
    /// Read: lane and emitter.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read, in the channels in use.
    pub throughput: &'a Spectrum<'q>,
    /// Read: factor. The weight is divided by the probability of survival, or becomes 0.
    pub worth: &'a mut WorthTable<'q>,
}

/// What survives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Contribution from which on a candidate certainly survives [W/(m^2 sr)], > 0: a constant of the frame, for a
    /// threshold that depended on the sample would bias it.
    pub contribution: f32,
    /// The random block of the technique's light point, whose fourth word decides.
    pub purpose: Purpose,
}

/// Keeps a candidate with probability `min(1, C / threshold)`, where C is the largest channel of
/// `weight factor Le T`, and divides its weight by that. It survives if u, the fourth uniform of block `purpose`
/// at the depth of the start, is below the probability. A weight that is not a number stays, to be counted.
pub type Kernel = fn(Step, Columns<'_, '_>);
