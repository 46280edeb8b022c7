//! Shadow segments: what of a candidate's connection comes through.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable, WorthTable};
use crate::tables::lights::Lights;
use crate::tables::surfaces::Surfaces;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lights.
    pub lights: &'a Lights,
    /// The surfaces.
    pub surfaces: &'a Surfaces,
    /// Rows to test: those of this bucket.
    pub bucket: Bucket,
    /// Read: start, point and emitter.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: the inserted vertices.
    pub chains: &'a ChainTable<'q>,
    /// Read: weight. The factor is multiplied by what comes through.
    pub worth: &'a mut WorthTable<'q>,
}

/// Multiplies the factor by 0 where a connection is blocked, and by 1 where it is free or weighs nothing: the
/// transmittance of media whose extinction is known is part of the weight.
///
/// Tests every segment of every connection, over its true length, against every disk and sphere, front or back, and
/// every triangle.
///
/// The last segment ends on its own emitter, and does not cross it elsewhere if it arrives where that shines, so it is
/// not tested against it: no epsilon is needed. A segment that only touches a disk's plane is free. Starts on a surface
/// were moved off it, so that their own surface does not block them.
pub type Kernel = fn(Step, Columns<'_, '_>);
