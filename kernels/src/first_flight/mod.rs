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
//! The others are free flights through a medium that is thinner by c, because vertices farther along have less in front
//! of them and, mostly, more light around them. The flight's density is the mixture
//!
//! ```text
//! p(t) = (1 - share) c mu_t e^{-c mu_t t} + share sum_l share_l q_l(t)
//! ```
//!
//! with `share_l` the light's share of all intensity, whichever part drew it. All techniques have the first flight in
//! common, so it enters neither ratios nor weights: the path's throughput takes the quotient of the free flight's
//! density and the mixture's, at most `1 / (c (1 - share))`; or, where a surface ends the flight, that of [the
//! probabilities to get there](crate::first_surface).

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
    /// How flights are drawn.
    pub aim: Aim,
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

/// How the camera's flights are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Share of those that are drawn towards the lights, (0, 1).
    pub share: f32,
    /// c: extinction of the medium through which the others are drawn, over that of the real one, (0, 1].
    pub thinned: f32,
}

impl Aim {
    /// Aim at lights in a medium that goes on and on. Measured over fog scenes: c of 0.85 and 0.7 takes a tenth of the
    /// variance of single starts and a sixth of that of all starts; from 0.5 on the variance grows.
    pub const fn in_the_open(share: f32) -> Self {
        Self { share, thinned: 0.75 }
    }

    /// Aim at lights in a medium among surfaces, of this optical depth across. The less there is of it, the less it is
    /// thinned: most flights get to a surface anyway, and what light the medium scatters is found by the others.
    pub fn across(share: f32, optical_depth: f32) -> Self {
        let open = Self::in_the_open(share);
        Self { thinned: 1.0 - (1.0 - open.thinned) * (1.0 - 2.0 / (optical_depth + 2.0)), ..open }
    }
}

/// Draws a share of the camera's flights towards the lights, stretches the others, and weighs all of them.
///
/// With u and v the third and fourth uniform of the CAMERA block: the flight is drawn equiangularly, with v, if `u <
/// share`, towards the first light l with `u < share (share_0 + .. + share_l)`, the last one if rounding leaves none,
/// and is the free flight divided by c otherwise.
pub type Kernel = fn(Step, Columns<'_, '_>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn media_are_thinned_the_more_there_is_of_them() {
        let depths = [0.0, 0.1, 1.0, 2.0, 10.0, f32::INFINITY];
        let thinned = depths.map(|depth| Aim::across(0.05, depth).thinned);
        assert_eq!((thinned[0], thinned[3], thinned[5]), (1.0, 0.875, Aim::in_the_open(0.05).thinned));
        assert!(thinned.is_sorted_by(|a, b| a > b), "{thinned:?}");
    }
}
