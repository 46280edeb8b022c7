//! What turns count in media whose phase function is not the one that weights go by: see
//! [`Phases`](crate::media::Phases).

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{LastSurfaceColumns, PathColumns};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable, WorthTable};
use crate::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium, whose phase functions differ from place to place.
    pub medium: &'a Medium,
    /// Whether there are surfaces; without them, nothing of `last_surface` is read.
    pub solid: bool,
    /// Rows whose turns count: those of this bucket.
    pub bucket: Bucket,
    /// Read: lane, start, arriving and point.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: the inserted vertices.
    pub chains: &'a ChainTable<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: depth of the last surface vertex of the paths.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Read: weight. The factor is multiplied by the quotients.
    pub worth: &'a mut WorthTable<'q>,
}

/// Multiplies the factor of every connection that weighs anything by `p / p~` of its turns: at the start, unless that is
/// on a surface, and at all inserted vertices.
pub type Kernel = fn(Step, Columns<'_, '_>);
