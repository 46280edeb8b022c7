//! Free flights: how far each path would go through the medium.

pub mod reference;
pub mod simd;

use crate::columns::paths::{ImmersionColumns, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::FlightTable;
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::{Step, WalkLimits};

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// How readily walks go on.
    pub walk: &'a WalkLimits,
    /// Paths that do not survive the vertex they are at are removed.
    pub live: &'a mut LaneSet<'q>,
    /// Read: pixel, sample and birth of live lanes.
    pub paths: &'a PathColumns<'q>,
    /// Read where extinction is coloured: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Read in a field: where paths are.
    pub vertex: &'a VertexColumns<'q>,
    /// Read in a field: where they go.
    pub ray: &'a RayColumns<'q>,
    /// Filled for live lanes.
    pub flights: &'a mut FlightTable<'q>,
}

/// Draws the random block of the current segment; turns its first word into a free flight of the medium, with `1 - u`
/// the share that outlasts it and in the channel of the hero, and leaves the next two for [`scatter`](crate::scatter)
/// and [`surface`](crate::surface). In a field the flight is tracked with stream 0 of block `TRACKING`, and infinite
/// where it leaves all there is. A path that has left the camera ends unless the fourth uniform is below `survival`.
pub type Kernel = fn(Step, Columns<'_, '_>);
