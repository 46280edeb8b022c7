//! First flights drawn towards the lights: a share of the camera's flights ends where it sees a light under a wide angle.
//!
//! Where a light is small, or fog is thin, most of what a pixel gets comes from the short stretch of its ray that passes
//! close to a light, where free flights rarely end. A share of the first flights is therefore drawn equiangularly (Kulla and
//! Fajardo, Importance Sampling Techniques for Path Tracing in Participating Media, EGSR 2012): with c the light's centre,
//! R its radius, x the ray's origin and d its direction,
//!
//! ```text
//! delta = (c - x) . d,    D^2 = |x + delta d - c|^2 + R^2,    span = pi / 2 + atan(delta / D)
//! q_l(t) = D / (span (D^2 + (t - delta)^2))
//! t(v) = delta + D cot((1 - v) span) = sqrt(delta^2 + D^2) sin(v span) / sin((1 - v) span)
//! ```
//!
//! The flight's density is the mixture `(1 - share) mu_t e^{-mu_t t} + share sum_l share_l q_l(t)`, with `share_l` the
//! light's share of all intensity, whichever part drew it. All techniques have the first flight in common, so it enters
//! neither ratios nor weights: the path's throughput takes the quotient of the free flight's density and the mixture's,
//! at most `1 / (1 - share)`.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathTable, RayTable, VertexTable};
use crate::columns::queues::{FlightTable, RequestTable};
use crate::tables::lights::Lights;
use crate::tables::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Read: the lanes that have just left the camera.
    pub requests: &'a RequestTable<'q>,
    /// Read: pixel and sample.
    pub paths: &'a PathTable<'q>,
    /// Read: the camera vertices, in the slot of the clock.
    pub vertices: &'a VertexTable<'q>,
    /// Read: the camera rays, in the slot of the clock.
    pub rays: &'a RayTable<'q>,
    /// Filled for requested lanes: weight; flight, where it is drawn equiangularly.
    pub flights: &'a mut FlightTable<'q>,
}

/// Draws a share of the camera's flights towards the lights, and weighs all of them.
///
/// With u and v the third and fourth uniform of the CAMERA block: the flight is drawn equiangularly, with v, if
/// `u < share`, towards the first light l with `u < share (share_0 + .. + share_l)`, the last one if rounding leaves none,
/// and stays the free flight it is otherwise.
pub type Kernel = fn(&Medium, &Lights, f32, Step, Columns<'_, '_>);
