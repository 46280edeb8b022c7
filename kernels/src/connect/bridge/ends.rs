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
