//! What paths have passed through, where extinction varies: running sums that weights read instead of lengths.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PassageColumns, PathColumns, VertexColumns};
use crate::columns::trail::PassageTrail;
use crate::lanes::LaneSet;
use crate::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The paths that have just come to their next vertex.
    pub live: &'a LaneSet<'q>,
    /// Paths of which that vertex is on a surface.
    pub on_surface: &'a LaneSet<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: the vertex before.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the vertex that they have come to.
    pub next: &'a VertexColumns<'q>,
    /// Sums up to the vertex before, replaced by those up to this one: as many as the medium has.
    pub passages: &'a mut [PassageColumns<'q>],
    /// Filled for batches with any live lane: the slot of the clock after this one.
    pub trails: &'a mut [PassageTrail<'q>],
}

/// Adds the optical depth of the last segment, as weights count it, and the logarithm of the extinction at its end, 0 on
/// a surface, both in the medium's [own channel](crate::media::MediumLanes::own) or, where channels are
/// [apart](crate::media::field::Apart), in each of them. Sums begin at the first vertex after the camera, as arcs do: with
/// no depth, and its own extinction.
pub type Kernel = fn(Step, Columns<'_, '_>);
