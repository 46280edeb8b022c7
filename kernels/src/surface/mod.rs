//! Reflection: the next vertex of every path that met a surface, and the direction in which it goes on.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::Spectrum;
use crate::columns::paths::{LastSurfaceColumns, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{FlightTable, SurfaceHitQueue};
use crate::lanes::LaneSet;
use crate::tables::surfaces::Surfaces;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The surfaces.
    pub surfaces: &'a Surfaces,
    /// Paths that end on a surface, and where.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: the random words.
    pub flights: &'a FlightTable<'q>,
    /// Paths on black are removed.
    pub live: &'a mut LaneSet<'q>,
    /// Filled.
    pub last_surface: &'a mut LastSurfaceColumns<'q>,
    /// Read: arc of the vertex that the ray left.
    pub vertex: &'a VertexColumns<'q>,
    /// Filled: the vertex on the surface.
    pub next: &'a mut VertexColumns<'q>,
    /// Read: direction of the ray that met it.
    pub ray: &'a RayColumns<'q>,
    /// Filled: the direction after the event.
    pub next_ray: &'a mut RayColumns<'q>,
    /// Multiplied by the albedo, in the channels in use.
    pub throughput: &'a mut Spectrum<'q>,
}

/// Moves every listed path to the surface it met and draws a new direction on the side from which it came, whether or
/// not it ends there.
///
/// The front of a triangle is the side from which its corners A, B, C run counterclockwise; n is `(B - A) x (C - A)`,
/// normalised, or its negation for paths that come from the back. A path in the very plane may count as coming from
/// either side.
///
/// The surface reflects as Lambert's law says: with n the unit normal on that side, the direction has density `cos
/// theta / pi`, `cos^2 theta = 1 - u` for the word `cosine`, at azimuth `2 pi u` in the
/// [frame](crate::vec3::Vec3x8::frame) of n for the word `azimuth`. What remains of the event in `f / p` is the
/// albedo. Paths end on the back of a one-sided surface, and where the albedo is zero.
///
/// The arc is 0 at the first vertex behind the camera, and grows by the distance of the hit from there on. The vertex
/// is moved off the surface along n by the bound of its rounding error ([`trace::surface`](crate::trace::surface)), so
/// that no ray or segment that leaves it meets the surface again.
pub type Kernel = fn(Step, Columns<'_, '_>);
