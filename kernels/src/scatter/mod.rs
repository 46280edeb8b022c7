//! Scattering events: the next vertex of every path and the direction in which it goes on.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::Spectrum;
use crate::columns::paths::{PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::FlightTable;
use crate::lanes::LaneSet;
use crate::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The paths that go on.
    pub live: &'a LaneSet<'q>,
    /// Those of them that end on a surface: only their columns that reflection overwrites may be filled.
    pub on_surface: &'a LaneSet<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: the flight and the random words.
    pub flights: &'a FlightTable<'q>,
    /// Read: where the flights start.
    pub vertex: &'a VertexColumns<'q>,
    /// Filled: where they end.
    pub next: &'a mut VertexColumns<'q>,
    /// Read: their direction.
    pub ray: &'a RayColumns<'q>,
    /// Filled: the direction after the event.
    pub next_ray: &'a mut RayColumns<'q>,
    /// Multiplied by the albedo, in the channels in use.
    pub throughput: &'a mut Spectrum<'q>,
}

/// Moves every live path that does not end on a surface to the end of its flight and draws a new direction from the
/// phase function of the medium there.
///
/// The cosine follows from inverting the phase function's distribution, `cosine` rising with its word; the azimuth
/// `2 pi u` counts in the [frame](crate::vec3::Vec3x8::frame) of the old direction. Direction and phase function
/// cancel in `f / p`; what remains of the event is the albedo.
pub type Kernel = fn(Step, Columns<'_, '_>);
