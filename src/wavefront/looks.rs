//! The rays of samples that see lamps whose outlines pass through their pixels.

use bumpalo::Bump;
use fogbow_kernels::columns::Column;
use fogbow_kernels::columns::paths::{RayColumns, VertexColumns};
use fogbow_kernels::lanes::LaneSet;

/// Whose rays a stage takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaysOf {
    /// Those by which paths go on.
    Paths,
    /// [`Looks`].
    Looks,
    /// Those of new samples, without end, by which the camera sees what comes first.
    First,
}

/// Rays that see lamps and go nowhere, one per lane.
pub struct Looks<'q> {
    /// Where they start.
    pub vertex: VertexColumns<'q>,
    /// Their direction.
    pub ray: RayColumns<'q>,
    /// How far they fly: zeros.
    pub flight: Column<'q, f32>,
    /// The lanes that look; stages may remove some.
    pub lanes: LaneSet<'q>,
    /// No lanes: those whose views are made by other rays than these.
    pub nobody: LaneSet<'q>,
}

impl<'q> Looks<'q> {
    /// Those of so many lanes.
    pub fn new_in(arena: &'q Bump, lanes: usize) -> Self {
        Self {
            vertex: VertexColumns::new_in(arena, lanes),
            ray: RayColumns::new_in(arena, lanes),
            flight: Column::new_in(arena, lanes),
            lanes: LaneSet::new_in(arena, lanes),
            nobody: LaneSet::new_in(arena, lanes),
        }
    }
}
