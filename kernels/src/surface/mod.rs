//! Reflection: the next vertex of every path that met a surface, and the direction in which it goes on.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathTable, RayTable, VertexTable};
use crate::columns::queues::{FlightTable, SurfaceHitQueue};
use crate::tables::surfaces::Surfaces;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Paths that end on a surface, and where.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Read: the random words.
    pub flights: &'a FlightTable<'q>,
    /// Filled: last surface vertex and its normal. Multiplied by the albedo: throughput, in the channels in use. Lanes on
    /// black are no longer live.
    pub paths: &'a mut PathTable<'q>,
    /// Read: the vertex of the clock. Filled: position and arc in the next slot.
    pub vertices: &'a mut VertexTable<'q>,
    /// Read: the ray of the clock. Filled: the next slot.
    pub rays: &'a mut RayTable<'q>,
}

/// Moves every listed path to the surface it met and draws a new direction on the side from which it came, whether or not it
/// ends there.
///
/// The front of a triangle is the side from which its corners A, B, C run counterclockwise; n is `(B - A) x (C - A)`,
/// normalised, or its negation for paths that come from the back. A path in the very plane may count as coming from
/// either side.
///
/// The surface reflects as Lambert's law says: with n the unit normal on that side, the direction has density
/// `cos theta / pi`, `cos^2 theta = 1 - u` for the word `cosine`, at azimuth `2 pi u` in the
/// [frame](crate::vec3x8::Vec3x8::frame) of n for the word `azimuth`. What remains of the event in `f / p` is the albedo. Paths
/// end on the back of a one-sided surface, and where the albedo is zero.
///
/// The arc is 0 at the first vertex behind the camera, and grows by the distance of the hit from there on. The vertex is moved
/// off the surface along n by the bound of its rounding error ([`trace::surface`](crate::trace::surface)), so that no ray or
/// segment that leaves it meets the surface again.
pub type Kernel = fn(&Surfaces, Step, Columns<'_, '_>);
