//! Rays against lights and surfaces: what each path meets before its flight ends.

mod flat;
mod open;
pub mod reference;
mod rows;
pub mod simd;

use crate::Step;
use crate::columns::Column;
use crate::columns::paths::{PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{HitQueue, SurfaceHitQueue};
use crate::lanes::LaneSet;
use crate::tables::lights::Lights;
use crate::tables::surfaces::Surfaces;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lights.
    pub lights: &'a Lights,
    /// The surfaces.
    pub surfaces: &'a Surfaces,
    /// The rays to trace.
    pub live: &'a LaneSet<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: where the rays start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: their direction.
    pub ray: &'a RayColumns<'q>,
    /// Read: the flights that bound them.
    pub flight: &'a Column<'q, f32>,
    /// Filled: the lanes whose flight ends on a surface, and no others.
    pub on_surface: &'a mut LaneSet<'q>,
    /// Filled, in lane order.
    pub hits: &'a mut HitQueue<'q>,
    /// Filled, in any order, every lane once at most.
    pub surface_hits: &'a mut SurfaceHitQueue<'q>,
}

/// Finds the closest disk or sphere, front or back, that each live ray crosses before its flight ends.
///
/// Camera rays (depth 0) are not bounded by their flight, because [`light_hit`](crate::light_hit) takes directly seen
/// light by expectation. A ray that lies in a disk's plane, or starts there, does not meet that disk.
///
/// Then finds the closest triangle, front or back, in front of that. It hides what is behind it; the path ends on it if
/// the flight does not end before. If it shines, it is a hit of its own.
///
/// Rays that meet nothing at all, and have left every medium behind unless they leave the camera, go on to infinity and
/// meet all lights there: one hit for each, one after the other, [`FAR`](crate::tables::lights::FAR) away.
pub type Kernel = fn(Step, Columns<'_, '_>);
