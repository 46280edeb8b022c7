//! Camera rays for the lanes that are to be refilled.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::Spectrum;
use crate::columns::paths::{
    ImmersionColumns, LastSurfaceColumns, OutlookColumns, PathColumns, RayColumns, VertexColumns,
};
use crate::columns::queues::RequestColumns;
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::tables::camera::Camera;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The camera.
    pub camera: &'a Camera,
    /// The medium that it is in.
    pub medium: &'a Medium,
    /// Lanes to fill.
    pub requested: &'a LaneSet<'q>,
    /// Which sample of which pixel each of them takes.
    pub requests: &'a RequestColumns<'q>,
    /// The lanes are added.
    pub live: &'a mut LaneSet<'q>,
    /// The lanes are added.
    pub occupied: &'a mut LaneSet<'q>,
    /// Filled.
    pub paths: &'a mut PathColumns<'q>,
    /// Filled: where extinction is coloured, a hero.
    pub immersion: &'a mut ImmersionColumns<'q>,
    /// Filled where extinction is coloured: alike for all channels.
    pub log_posterior: &'a mut Spectrum<'q>,
    /// Filled: there is none yet.
    pub last_surface: &'a mut LastSurfaceColumns<'q>,
    /// Filled: no vertex near a light yet.
    pub outlook: &'a mut OutlookColumns<'q>,
    /// Filled: 1 in every channel.
    pub throughput: &'a mut Spectrum<'q>,
    /// Filled: 0 in every channel.
    pub radiance: &'a mut Spectrum<'q>,
    /// Filled: the camera vertex, on the near plane, at arc 0.
    pub vertex: &'a mut VertexColumns<'q>,
    /// Filled: the camera ray.
    pub ray: &'a mut RayColumns<'q>,
}

/// Makes the first ray of every requested path.
///
/// A sample's place in its pixel is uniform (box filter). Paths start on the plane at distance `near` along the viewing
/// axis. The hero of a path is channel `floor(3 u)`, with u the first number of block `HERO` at depth 0.
pub type Kernel = fn(Step, Columns<'_, '_>);
