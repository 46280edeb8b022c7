//! What becomes of the rays that met a light.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::Column;
use crate::columns::paths::{PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{CandidateQueue, HitQueue, WorthTable};
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::tables::lights::Lights;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// Rays that meet a light.
    pub hits: &'a HitQueue<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: where the current ray starts.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: direction of the current ray.
    pub ray: &'a RayColumns<'q>,
    /// Read: direction of the ray before.
    pub before: &'a RayColumns<'q>,
    /// Read: the flights.
    pub flight: &'a Column<'q, f32>,
    /// Lanes of which the camera sees lamps by other rays: they have no views here.
    pub outlined: &'a LaneSet<'q>,
    /// What a view counts of: one over the number of rays by which a sample looks.
    pub share: f32,
    /// Paths whose flight would go on beyond a disk or sphere are removed.
    pub live: &'a mut LaneSet<'q>,
    /// Filled: lights seen directly by the camera.
    pub views: &'a mut CandidateQueue<'q>,
    /// Filled: what they count, in the rows of `views`: the transmittance of the way in the clearest channel,
    /// times the profile and the share, and as factors those of all channels over it, times the colour of an image of the sky.
    pub worth: &'a mut WorthTable<'q>,
    /// Filled: lights hit by a scattered path; what they count is still to be found.
    pub light_hits: &'a mut CandidateQueue<'q>,
}

/// Turns hits into candidates and ends the paths that cannot go on.
///
/// A light shows its front where the ray runs against its normal, or where both of its sides shine. At depth 0 a front
/// counts by expectation: it becomes a view of the transmittance of the way times the profile of the light, whether
/// or not the flight reaches it, and the analog hit counts nothing. At greater depth a front is a light hit. Backs are
/// black. Either way the path ends where its flight reaches a disk or sphere; on a triangle it is reflected. `arriving`
/// of a view is zero: nothing arrives at the camera. Outlined lanes have no views: [`outline`](crate::outline).
pub type Kernel = fn(Step, Columns<'_, '_>);
