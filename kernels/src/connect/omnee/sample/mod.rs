//! Making the connections: where the one inserted vertex is.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::PathColumns;
use crate::columns::queues::{CandidateQueue, ChainTable};
use crate::media::Medium;

/// What building may touch.
pub struct BuildColumns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// Read: pixel, sample, birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: lane, start and point of the connections.
    pub connections: &'a CandidateQueue<'q>,
    /// Filled at the same rows: the first inserted vertex.
    pub chains: &'a mut ChainTable<'q>,
}

/// Places the inserted vertex of every connection.
///
/// Block `OMNEE_VERTEX` at the depth of the start: the first word gives the cosine of theta, the phase function's own
/// sample for the number `1 - F (1 - u)`; the second `alpha = u theta`; the third the azimuth `2 pi u` in the
/// [frame](crate::vec3::Vec3x8::frame) of the axis.
pub type BuildKernel = fn(Step, BuildColumns<'_, '_>);
