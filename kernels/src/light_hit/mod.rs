//! What becomes of the rays that met a light.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathTable, RayTable, VertexTable};
use crate::columns::queues::{CandidateQueue, FlightTable, HitQueue};
use crate::tables::lights::Lights;
use crate::tables::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Rays that meet a light.
    pub hits: &'a HitQueue<'q>,
    /// Read: where the current ray starts.
    pub vertices: &'a VertexTable<'q>,
    /// Read: direction of the current ray and of the one before.
    pub rays: &'a RayTable<'q>,
    /// Read: the flight.
    pub flights: &'a FlightTable<'q>,
    /// Read: birth. Lanes whose flight would go on beyond a disk or sphere are no longer live.
    pub paths: &'a mut PathTable<'q>,
    /// Filled: lights seen directly by the camera, with the transmittance of the way, times the profile, as weight.
    pub views: &'a mut CandidateQueue<'q>,
    /// Filled: lights hit by a scattered path; weight still to be found.
    pub light_hits: &'a mut CandidateQueue<'q>,
}

/// Turns hits into candidates and ends the paths that cannot go on.
///
/// A light shows its front where the ray runs against its normal, or where both of its sides shine. At depth 0 a front
/// counts by expectation: it becomes a view of weight `exp(-mu_t distance)` times the profile of the light, whether or
/// not the flight reaches it, and the analog hit counts nothing. At greater depth a front is a light hit. Backs are
/// black. Either way the path ends where its flight reaches a disk or sphere; on a triangle it is reflected. `arriving`
/// of a view is zero: nothing arrives at the camera.
pub type Kernel = fn(&Medium, &Lights, Step, Columns<'_, '_>);
