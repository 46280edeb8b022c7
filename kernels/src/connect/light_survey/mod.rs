//! What the current vertices know of the lights, whichever techniques connect from there.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{LastSurfaceColumns, OutlookColumns, PathColumns, VertexColumns};
use crate::lanes::LaneSet;
use crate::tables::lights::Lights;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lights, and how connections choose among them.
    pub lights: &'a Lights,
    /// Longest distance between start and light point that the techniques look back for `[m]`; infinite if there is
    /// none.
    pub near: f32,
    /// Vertices that connect, counted from the camera or the last surface, >= 1; `u32::MAX` for all.
    pub starts: u32,
    /// The paths that go on.
    pub live: &'a LaneSet<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: its depth.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Read: position.
    pub vertex: &'a VertexColumns<'q>,
    /// Filled where the selection depends on the vertex: the light sum. Lowered to the depth of the vertex where `near`
    /// is finite and a light may be within it: the first near vertex.
    pub outlook: &'a mut OutlookColumns<'q>,
}

/// Surveys the lights from every vertex that may start a connection: `depth - first < starts`, where `first` is the
/// depth of the last surface vertex, or 1.
///
/// A light may be near if its centre is within `1.0001 (near + radius)`: rounding never hides a light.
pub type Kernel = fn(Step, Columns<'_, '_>);
