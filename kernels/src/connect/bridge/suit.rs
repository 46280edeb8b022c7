//! How well free walks suit a bridge, by their ends, for eight bridges.
//!
//! What a bridge counts depends on its shape by the turn at the start and by the cosine at the light, and what is left
//! of both after the roll depends on the angles beta and delta of its first and last edge to the axis: in the mean over
//! all rolls, about as G and F. A walk may be read from either end:
//!
//! ```text
//! S = G(beta) F(delta) + G(delta) F(beta)
//! G(beta) = 1 / (h_- (h_+ + 1 - g^2))
//! F(delta) = (u + max(|u|, t) + 0.41 min(|u|, t)) / 2 + 1/64,      u = cos delta cos theta,   t = 2 / pi sin delta sin theta
//! ```
//!
//! with h_- and h_+ of [A](super::ends), to which G is nearly proportional, as `(x + m) / 2` is nearly `sqrt(m x)`; and
//! theta the angle of the axis to the light's normal, as rays arrive. F is about the mean of `max(0, u + pi / 2 t cos
//! psi)` over all psi, and a little more, so that it is nowhere 0. None of this takes a root: the choice is only as
//! good as S, but it is weighed for what it is.

use wide::f32x8;

use super::ends::Ends;
use crate::phase::PlaneAngle;

/// What is added to mean cosines.
pub const LEAST_COSINE: f32 = 1.0 / 64.0;

/// How much the smaller one of two sides of a right angle adds to the third.
pub const SHORTER_SIDE: f32 = 0.41;

/// What bridges ask of the ends of walks.
#[derive(Clone, Copy)]
pub struct Suit<'p> {
    /// The turn at the start.
    pub ends: Ends<'p>,
    /// The angle of the axis to the light's normal, turned in the direction of rays; None where bridges do not end on
    /// lights.
    pub light: Option<PlaneAngle>,
}

impl Suit<'_> {
    /// S of walks whose first and last edge have these angles to the axis, > 0.
    #[inline(always)]
    pub fn of(&self, first: PlaneAngle, last: PlaneAngle) -> f32x8 {
        let arrives = |end: PlaneAngle| self.light.map_or(f32x8::ONE, |light| facing(end, light));
        let rarities = [first, last].map(|end| self.rarity(end));
        arrives(last).mul_add(rarities[1], arrives(first) * rarities[0]) / (rarities[0] * rarities[1])
    }

    /// `1 / G`
    #[inline(always)]
    fn rarity(&self, end: PlaneAngle) -> f32x8 {
        let Ends { lobe, arriving } = self.ends;
        let (near, far) = lobe.h_in_plane(arriving, end);
        near * (far + lobe.mean_h())
    }
}

/// F: about the mean cosine of a direction at the angle `end` to the axis, over all azimuths, to a normal to which the axis
/// has the angle `normal`.
#[inline(always)]
fn facing(end: PlaneAngle, normal: PlaneAngle) -> f32x8 {
    let u = end.cosine * normal.cosine;
    let t = end.sine * normal.sine * f32x8::splat(core::f32::consts::FRAC_2_PI);
    let third = t.fast_min(u.abs()).mul_add(f32x8::splat(SHORTER_SIDE), t.fast_max(u.abs()));
    (u + third).mul_add(f32x8::splat(0.5), f32x8::splat(LEAST_COSINE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{HenyeyGreenstein, HenyeyGreensteinX8};

    fn plane_angle(angle: f64) -> PlaneAngle {
        PlaneAngle { cosine: f32x8::splat(angle.cos() as f32), sine: f32x8::splat(angle.sin().abs() as f32) }
    }

    /// S of the module's formulas, in f64.
    fn expected(g: f64, gamma: f64, theta: Option<f64>, [first, last]: [f64; 2]) -> f64 {
        let h = |angle: f64| 1.0 + g * g - 2.0 * g * angle.cos();
        let turn = |end: f64| 1.0 / (h(end - gamma) * (h(end + gamma) + 1.0 - g * g));
        let arrive = |end: f64| {
            let Some(theta) = theta else { return 1.0 };
            let (u, t) = (end.cos() * theta.cos(), 2.0 / core::f64::consts::PI * end.sin() * theta.sin());
            (u + u.abs().max(t) + 0.41 * u.abs().min(t)) / 2.0 + 1.0 / 64.0
        };
        turn(first) * arrive(last) + turn(last) * arrive(first)
    }

    #[test]
    fn walks_suit_as_the_formulas_say() {
        let angles = [0.0, 0.02, 0.3, 1.1, 2.0, 3.0];
        for g in [0.95, 0.5, 0.0, -0.7] {
            let lobe = HenyeyGreensteinX8::new(HenyeyGreenstein { g });
            for (gamma, theta) in angles.into_iter().flat_map(|gamma| [None, Some(0.1), Some(1.6)].map(|t| (gamma, t)))
            {
                let ends = Ends { lobe: &lobe, arriving: plane_angle(gamma) };
                let suit = Suit { ends, light: theta.map(plane_angle) };
                for [first, last] in angles.into_iter().flat_map(|first| angles.map(|last| [first, last])) {
                    let found = f64::from(suit.of(plane_angle(first), plane_angle(last)).to_array()[0]);
                    let expected = expected(f64::from(g), gamma, theta, [first, last]);
                    assert!((found / expected - 1.0).abs() < 1e-4, "g = {g}: {found}, expected {expected}");
                }
            }
        }
    }

    #[test]
    fn a_walk_suits_that_turns_where_the_path_goes_and_arrives_at_the_front() {
        let lobe = HenyeyGreensteinX8::new(HenyeyGreenstein { g: 0.9 });
        let suit = Suit { ends: Ends { lobe: &lobe, arriving: plane_angle(0.6) }, light: Some(plane_angle(1.5)) };
        let of = |first: f64, last: f64| suit.of(plane_angle(first), plane_angle(last)).to_array()[0];
        assert!(of(0.6, 0.6) > 10.0 * of(0.1, 0.1), "{} and {}", of(0.6, 0.6), of(0.1, 0.1));
        assert!(of(0.6, 1.4) > 3.0 * of(0.6, 2.9), "{} and {}", of(0.6, 1.4), of(0.6, 2.9));
    }
}
