//! Scattering events: the next vertex of every path and the direction in which it goes on.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathTable, RayTable, VertexTable};
use crate::columns::queues::FlightTable;
use crate::tables::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Read: the flight and the random words of live lanes.
    pub flights: &'a FlightTable<'q>,
    /// Read: the lanes that end on a surface. Multiplied by the albedo: throughput of the other live lanes, in the channels in
    /// use.
    pub paths: &'a mut PathTable<'q>,
    /// Read: the vertex of the clock. Filled: position and arc in the next slot.
    pub vertices: &'a mut VertexTable<'q>,
    /// Read: the ray of the clock. Filled: the next slot.
    pub rays: &'a mut RayTable<'q>,
}

/// Moves every live path that does not end on a surface to the end of its flight and draws a new direction from the
/// phase function.
///
/// The cosine follows from inverting the phase function's distribution, `cosine` rising with its word; the azimuth
/// `2 pi u` counts in the [frame](crate::vec3x8::Vec3x8::frame) of the old direction. Direction and phase function
/// cancel in `f / p`; what remains of the event is the albedo.
pub type Kernel = fn(&Medium, Step, Columns<'_, '_>);
