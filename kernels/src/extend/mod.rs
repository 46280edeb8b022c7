//! Rays against lights and surfaces: what each path meets before its flight ends.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathTable, RayTable, VertexTable};
use crate::columns::queues::{FlightTable, HitQueue, SurfaceHitQueue};
use crate::tables::lights::Lights;
use crate::tables::surfaces::Surfaces;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Read: birth of live lanes. Filled: the set of lanes that end on a surface.
    pub paths: &'a mut PathTable<'q>,
    /// Read: where the current ray starts.
    pub vertices: &'a VertexTable<'q>,
    /// Read: direction of the current ray.
    pub rays: &'a RayTable<'q>,
    /// Read: the flight that bounds the ray.
    pub flights: &'a FlightTable<'q>,
    /// Filled, in lane order.
    pub hits: &'a mut HitQueue<'q>,
    /// Filled, in lane order.
    pub surface_hits: &'a mut SurfaceHitQueue<'q>,
}

/// Finds the closest disk or sphere, front or back, that each live ray crosses before its flight ends.
///
/// Camera rays (depth 0) are not bounded by their flight, because [`light_hit`](crate::light_hit) takes directly seen
/// light by expectation. A ray that lies in a disk's plane, or starts there, does not meet that disk.
///
/// Then finds the closest triangle, front or back, in front of that. It hides what is behind it; the path ends on it if the
/// flight does not end before. If it shines, it is a hit of its own.
pub type Kernel = fn(&Lights, &Surfaces, Step, Columns<'_, '_>);
