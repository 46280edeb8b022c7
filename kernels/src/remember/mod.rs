//! The current vertices go into the trail, where weights find them when paths have left them.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{OutlookColumns, RayColumns, VertexColumns};
use crate::columns::trail::TrailTable;
use crate::lanes::LaneSet;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The paths that are about to go on.
    pub live: &'a LaneSet<'q>,
    /// Read: where they are.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the rays that leave.
    pub ray: &'a RayColumns<'q>,
    /// Read: the light sums there.
    pub outlook: &'a OutlookColumns<'q>,
    /// Filled for batches with any live lane: the slot of the clock.
    pub trail: &'a mut TrailTable<'q>,
}

/// Copies position, arc, leaving direction and light sum of every live path into its row of the trail.
pub type Kernel = fn(Step, Columns<'_, '_>);
