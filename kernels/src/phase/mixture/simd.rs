//! Mixtures for eight rows.
//!
//! ```text
//! density(c) = w a(c) + (1 - w) b(c)
//! turn(u)    = turn_a(u / w) if u < w, else turn_b((u - w) / (1 - w))
//! ```
//!
//! Departures from the textbook:
//! 1. Both parts are asked, and the answer is selected.
//! 2. What remains of 1 - u is computed apart from what remains of u: both ends of a part keep their digits, and with
//!    them turns towards a pole where there is little.
//! 3. What remains is kept in [2^-24, 1 - 2^-24], the range of uniform numbers, whatever the division rounds to. A
//!    part without a share is never selected, though it divides by zero.
//! 4. With the inverse densities A and B of the parts, which are finite, the inverse density is `A B / (w B + (1 - w)
//!    A)`: one division, and no NaN where both are as large as they get, 2^60 sr.

use wide::f32x8;

use super::Mixture;
use crate::phase::reference::Phase;
use crate::phase::{Deflection, HenyeyGreensteinX8, PhaseX8, PlaneAngle};
use crate::vec3::Vec3x8;

/// A part to be asked by chance.
#[derive(Clone, Copy)]
struct Split {
    /// probability of the first
    first: f32x8,
    /// one over it
    inverse_first: f32x8,
    /// one over the probability of the second
    inverse_second: f32x8,
}

impl Split {
    fn new(first: f64) -> Self {
        // What is left of the probability as it is rounded, so that what remains of u covers (0, 1) evenly.
        let first = f64::from(first as f32);
        let splat = |x: f64| f32x8::splat(x as f32);
        Self { first: splat(first), inverse_first: splat(1.0 / first), inverse_second: splat(1.0 / (1.0 - first)) }
    }

    /// Whether u selects the first, and what remains of u and of 1 - u for the first and for the second.
    #[inline(always)]
    fn choose(&self, u: f32x8) -> (f32x8, [f32x8; 2], [f32x8; 2]) {
        const SMALLEST: f32 = 1.0 / 16_777_216.0;
        let inside = |u: f32x8| u.fast_max(f32x8::splat(SMALLEST)).fast_min(f32x8::splat(1.0 - SMALLEST));
        let first = [u, self.first - u].map(|part| inside(part * self.inverse_first));
        let second = [u - self.first, f32x8::ONE - u].map(|part| inside(part * self.inverse_second));
        (u.simd_lt(self.first), first, second)
    }
}

/// A [`Mixture`] for eight lanes.
#[derive(Clone, Copy)]
pub struct MixtureX8<A, B> {
    first: A,
    second: B,
    /// of all events
    all: Split,
    /// of those in the forward hemisphere
    front: Split,
    /// 1 - w
    rest: f32x8,
    /// share of the forward hemisphere
    forward: f32x8,
    lobe: HenyeyGreensteinX8,
}

impl<A: PhaseX8, B: PhaseX8> MixtureX8<A, B> {
    /// Prepares `mixture` for eight lanes; `first` and `second` are its parts, prepared.
    pub fn new<P: Phase, Q: Phase>(mixture: &Mixture<P, Q>, first: A, second: B) -> Self {
        let weight = f64::from(mixture.weight);
        let share = |part: f32x8| f64::from(part.to_array()[0]);
        let (a, b) = (weight * share(first.forward_share()), (1.0 - weight) * share(second.forward_share()));
        Self {
            first,
            second,
            all: Split::new(weight),
            front: Split::new(a / (a + b)),
            rest: f32x8::splat((1.0 - weight) as f32),
            forward: f32x8::splat((a + b) as f32),
            lobe: HenyeyGreensteinX8::new(mixture.lobe()),
        }
    }
}

#[inline(always)]
fn select(mask: f32x8, a: Deflection, b: Deflection) -> Deflection {
    Deflection { cosine: mask.select(a.cosine, b.cosine), sine: mask.select(a.sine, b.sine) }
}

impl<A: PhaseX8, B: PhaseX8> PhaseX8 for MixtureX8<A, B> {
    #[inline(always)]
    fn sample(&self, u: f32x8) -> Deflection {
        let (chosen, [u, above], [v, beyond]) = self.all.choose(u);
        select(chosen, self.first.sample_at(u, above), self.second.sample_at(v, beyond))
    }

    #[inline(always)]
    fn sample_forward(&self, u: f32x8) -> Deflection {
        let (chosen, [u, above], [v, beyond]) = self.front.choose(u);
        select(chosen, self.first.sample_forward_at(u, above), self.second.sample_forward_at(v, beyond))
    }

    #[inline(always)]
    fn forward_share(&self) -> f32x8 {
        self.forward
    }

    #[inline(always)]
    fn inverse_shape(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        let a = self.first.inverse_density(incoming, outgoing);
        let b = self.second.inverse_density(incoming, outgoing);
        a * b / self.all.first.mul_add(b, self.rest * a)
    }

    #[inline(always)]
    fn lobe(&self) -> HenyeyGreensteinX8 {
        self.lobe
    }

    #[inline(always)]
    fn roll(&self, arriving: PlaneAngle, leaving: PlaneAngle, u: f32x8) -> (f32x8, f32x8) {
        let (chosen, [first, _], [second, _]) = self.all.choose(u);
        let (a, b) = (self.first.roll(arriving, leaving, first), self.second.roll(arriving, leaving, second));
        (chosen.select(a.0, b.0), chosen.select(a.1, b.1))
    }

    #[inline(always)]
    fn roll_density(&self, directions: [Vec3x8; 2], angles: [PlaneAngle; 2]) -> f32x8 {
        let (a, b) = (self.first.roll_density(directions, angles), self.second.roll_density(directions, angles));
        self.all.first.mul_add(a, self.rest * b)
    }
}
