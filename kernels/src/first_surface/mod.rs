//! First flights that end on a surface: what counts is how probable it is that they get that far.
//!
//! A flight of the [mixture](crate::first_flight) that a surface at the distance d ends may have been drawn to end
//! anywhere beyond. Its own density says nothing of the path, and would only be noise. With c, and span, delta and D of
//! light l, as there,
//!
//! ```text
//! P(t > d) = (1 - share) e^{-c mu_t d} + share sum_l share_l (span - angle from 0 to d) / span
//!          = (1 - share) e^{-c mu_t d} + share sum_l share_l atan2(D, d - delta) / span
//! ```
//!
//! takes the place of p(t), and the probability of a free flight, e^{-mu_t d}, that of its density.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{RayColumns, VertexColumns};
use crate::columns::queues::SurfaceHitQueue;
use crate::columns::{Column, Spectrum};
use crate::first_flight::Aim;
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::tables::lights::Lights;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// How flights are drawn.
    pub aim: Aim,
    /// The lanes that have just left the camera.
    pub requested: &'a LaneSet<'q>,
    /// Read: paths that end on a surface, and how far away it is.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Read: where the camera rays start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: direction of the camera rays.
    pub ray: &'a RayColumns<'q>,
    /// Filled for requested lanes that end on a surface, where extinction is grey: probability that a free flight gets
    /// there over that of the mixture, [0, 1 / (1 - share)].
    pub weight: &'a mut Column<'q, f32>,
    /// Filled for these lanes where it is coloured: probability that a flight of the mixture gets there, for every hero.
    pub density: &'a mut Spectrum<'q>,
}

/// Puts probabilities in the place of the densities of all requested flights that end on a surface. Rows of paths that
/// are no longer live are filled as well; nothing reads them.
pub type Kernel = fn(Step, Columns<'_, '_>);
