//! Which end of a free walk comes first, for eight bridges.
//!
//! A free walk is as likely read from its end as from its beginning, and has the same length and span; but its first
//! and last edge have angles beta and delta to its axis that differ, and the turn at the start depends on which of them
//! comes first. With gamma the angle at which the path arrives,
//!
//! ```text
//! A(beta) = 1 / (h_- sqrt(h_+)),      h_- = h(cos(beta - gamma)),   h_+ = h(cos(beta + gamma))
//! P(beta first) = A(beta) / (A(beta) + A(delta)),                   density of the bridge  *=  2 P(beta first)
//! ```
//!
//! The mean of `h^{-3/2}` over all rolls is between 2 / pi (where `h_- << h_+`) and 1 (where `h_- = h_+`) times A.

use wide::f32x8;

use crate::phase::{HenyeyGreensteinX8, PlaneAngle};

/// What the turn at the start, at which the path arrives at the angle `arriving` to the axis, asks of the ends of walks.
#[derive(Clone, Copy)]
pub struct Ends<'p> {
    /// The phase function, or the lobe that stands for it.
    pub lobe: &'p HenyeyGreensteinX8,
    /// gamma
    pub arriving: PlaneAngle,
}

impl Ends<'_> {
    /// P: the probability that the end at the angle `this` to the axis comes first, and not that at the angle `other`.
    #[inline(always)]
    pub fn share(&self, this: PlaneAngle, other: PlaneAngle) -> f32x8 {
        let (this, other) = (self.rarity(this), self.rarity(other));
        other / (this + other)
    }

    /// `1 / A`
    #[inline(always)]
    fn rarity(&self, end: PlaneAngle) -> f32x8 {
        let (near, far) = self.lobe.h_in_plane(self.arriving, end);
        near * far.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::connect::bridge::reference::first_share;
    use crate::phase::HenyeyGreenstein;

    const ANGLES: [f64; 6] = [0.0, 0.05, 0.4, 1.2, 2.5, core::f64::consts::PI];

    fn plane_angle(angle: f64) -> PlaneAngle {
        PlaneAngle { cosine: f32x8::splat(angle.cos() as f32), sine: f32x8::splat(angle.sin().max(0.0) as f32) }
    }

    #[test]
    fn shares_are_those_of_the_twin_and_both_ends_have_one_together() {
        let tilted = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos());
        for g in [0.95, 0.6, 0.0, -0.8] {
            let phase = HenyeyGreenstein { g };
            let lobe = HenyeyGreensteinX8::new(phase);
            for (gamma, this) in ANGLES.into_iter().flat_map(|gamma| ANGLES.map(|this| (gamma, this))) {
                let ends = Ends { lobe: &lobe, arriving: plane_angle(gamma) };
                for other in ANGLES {
                    let share = |a: f64, b: f64| ends.share(plane_angle(a), plane_angle(b)).to_array()[0];
                    let found = f64::from(share(this, other));
                    let expected = first_share(&phase, tilted(gamma), DVec3::Z, tilted(this), tilted(other));
                    let case = format!("g = {g}: {gamma}, {this} or {other}: {found}, expected {expected}");
                    assert!((found / expected - 1.0).abs() < 2e-5, "{case}");
                    assert!((found + f64::from(share(other, this)) - 1.0).abs() < 1e-6, "{case}");
                }
            }
        }
    }

    #[test]
    fn the_end_that_goes_on_where_the_path_arrives_comes_first_more_often() {
        let lobe = HenyeyGreensteinX8::new(HenyeyGreenstein { g: 0.9 });
        let share = |gamma: f64, this: f64, other: f64| {
            let ends = Ends { lobe: &lobe, arriving: plane_angle(gamma) };
            ends.share(plane_angle(this), plane_angle(other)).to_array()[0]
        };
        assert!(share(0.5, 0.5, 0.1) > 0.9 && share(0.5, 0.1, 0.5) < 0.1, "{}", share(0.5, 0.5, 0.1));
        assert_eq!(share(0.5, 0.3, 0.3), 0.5);
    }
}
