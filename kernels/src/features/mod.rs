//! What the camera sees first: depth, normal, albedo and transmittance, for layers of the film beside radiance.
//!
//! A sample's light is first scattered or absorbed where its free flight ends, or on the surface or lamp before that:
//! its first collision. Free flights are those of the walk before any of them are aimed, so that plain means over
//! samples are those over collisions, without weights. Where extinction is coloured, flights are drawn for red, green
//! and blue alike, and means are over the collisions of all three.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::Column;
use crate::columns::paths::{FeatureColumns, RayColumns, VertexColumns};
use crate::columns::queues::{CandidateQueue, HitQueue, SurfaceHitQueue, WorthTable};
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::tables::camera::Camera;
use crate::tables::lights::Lights;
use crate::tables::surfaces::Surfaces;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The camera.
    pub camera: &'a Camera,
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// The surfaces.
    pub surfaces: &'a Surfaces,
    /// New samples.
    pub requested: &'a LaneSet<'q>,
    /// Read: where their rays start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the direction of their rays.
    pub ray: &'a RayColumns<'q>,
    /// Read: their free flights.
    pub flight: &'a Column<'q, f32>,
    /// Read: the lamps that rays without end meet.
    pub hits: &'a HitQueue<'q>,
    /// Read: the surfaces that they meet.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Filled for requested lanes, but for the transmittance.
    pub features: &'a mut FeatureColumns<'q>,
    /// Filled, one row per requested lane in lane order: the way up to the first surface or lamp, or to infinity.
    pub views: &'a mut CandidateQueue<'q>,
    /// Filled, in the rows of `views`: as factor the transmittance of the way as weights count it, the weight is 1.
    pub worth: &'a mut WorthTable<'q>,
}

/// Says what every new sample meets first, and lists the way up to the first surface or lamp, of which
/// [`transmittance`](crate::transmittance) estimates what comes through where that is not known.
///
/// A collision at the distance t of the ray has the depth `near + t cos`, with the cosine between ray and viewing axis.
/// Lamps are disks and spheres: black. A surface that shines is a surface. Points at infinity are
/// [`FAR`](crate::tables::lights::FAR) away.
pub type Kernel = fn(Step, Columns<'_, '_>);
