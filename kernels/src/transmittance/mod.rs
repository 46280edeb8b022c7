//! What comes through where nobody knows how much: estimated transmittances, for candidates in a field.

mod channels;
pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{ImmersionColumns, PathColumns};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable, EstimateColumns, WorthTable};
use crate::media::field::Field;
use crate::random::Purpose;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The field.
    pub field: &'a Field,
    /// Whether the hero's flights have got through, so that only those of other channels are left to estimate.
    pub flown: bool,
    /// Rows to estimate: those of this bucket.
    pub bucket: Bucket,
    /// The random dimension of their light points; that of the camera for views.
    pub purpose: Purpose,
    /// Read: lane, start and point.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: the inserted vertices.
    pub chains: &'a ChainTable<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read where paths have flown: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Scratch.
    pub estimates: &'a mut EstimateColumns<'q>,
    /// Read: weight. The factor is multiplied by what comes through.
    pub worth: &'a mut WorthTable<'q>,
}

/// Multiplies the factor of every row that counts anything by `T' e^{tau~}` per channel, segment by segment: an unbiased
/// estimate of the transmittance over what the weight took it for ([`field`](crate::media::field)). Where a path has
/// flown, the hero's factor is 1, and those of the others are estimates of their transmittance over the hero's.
///
/// The estimate of segment j draws from [stream](crate::random::Stream) j of the block `TRANSMITTANCE` for the purpose of
/// the light point, at the depth of the start.
pub type Kernel = fn(Step, Columns<'_, '_>);
