//! First flights drawn towards the lights: a share of the camera's flights ends where it sees a light under a wide
//! angle.
//!
//! Where a light is small, or fog is thin, most of what a pixel gets comes from the short stretch of its ray that
//! passes close to a light, where free flights rarely end. A share of the first flights is therefore drawn
//! equiangularly (Kulla and Fajardo, Importance Sampling Techniques for Path Tracing in Participating Media, EGSR
//! 2012): with c the light's centre, R its radius, x the ray's origin and d its direction,
//!
//! ```text
//! delta = (c - x) . d,    D^2 = |x + delta d - c|^2 + R^2,    span = pi / 2 + atan(delta / D)
//! q_l(t) = D / (span (D^2 + (t - delta)^2))
//! t(v) = delta + D cot((1 - v) span) = sqrt(delta^2 + D^2) sin(v span) / sin((1 - v) span)
//! ```
//!
//! The others are free flights through a medium that is thinner by [`THINNED`], because vertices farther along have
//! less in front of them and, mostly, more light around them. The flight's density is the mixture
//!
//! ```text
//! p(t) = (1 - share) c mu_t e^{-c mu_t t} + share sum_l share_l q_l(t),    c = THINNED
//! ```
//!
//! with `share_l` the light's share of all intensity, whichever part drew it. All techniques have the first flight in
//! common, so it enters neither ratios nor weights: the path's throughput takes the quotient of the free flight's
//! density and the mixture's, at most `1 / (c (1 - share))`.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathColumns, RayColumns, VertexColumns};
use crate::columns::{Column, Spectrum};
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::tables::lights::Lights;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// Share of the flights that are drawn towards the lights, (0, 1).
    pub share: f32,
    /// The lanes that have just left the camera.
    pub requested: &'a LaneSet<'q>,
    /// Read: pixel and sample.
    pub paths: &'a PathColumns<'q>,
    /// Read: where the camera rays start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: direction of the camera rays.
    pub ray: &'a RayColumns<'q>,
    /// Read for requested lanes: the free flight. Filled: the one that is taken `[m]`.
    pub flight: &'a mut Column<'q, f32>,
    /// Filled for requested lanes where extinction is grey: density of the free flight over that of the one that is
    /// taken, >= 0.
    pub weight: &'a mut Column<'q, f32>,
    /// Filled for requested lanes where it is coloured: density of the flight that is taken, for every hero [1/m].
    pub density: &'a mut Spectrum<'q>,
}

/// Extinction of the medium through which the camera's flights are drawn, over that of the real one. Measured over fog
/// scenes: 0.85 and 0.7 take a tenth of the variance of single starts and a sixth of that of all starts; from 0.5 on
/// the variance grows.
pub const THINNED: f32 = 0.75;

/// Draws a share of the camera's flights towards the lights, stretches the others, and weighs all of them.
///
/// With u and v the third and fourth uniform of the CAMERA block: the flight is drawn equiangularly, with v, if `u <
/// share`, towards the first light l with `u < share (share_0 + .. + share_l)`, the last one if rounding leaves none,
/// and is the free flight divided by [`THINNED`] otherwise.
pub type Kernel = fn(Step, Columns<'_, '_>);
