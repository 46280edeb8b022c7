//! Henyey-Greenstein for eight rows.
//!
//! ```text
//! cosine(u)  = (1 + g^2 - q^2) / (2 g),  q = (1 - g^2) / d,  d = 1 - g + 2 g u
//! density(c) = (1 - g^2) / (4 pi h^{3/2}),  h = 1 + g^2 - 2 g c
//! ```
//!
//! Departures from the textbook:
//! 1. A backward lobe is the mirror image of a forward one: `cosine(g, u) = -cosine(-g, 1 - u)`. What follows is for
//!    g >= 0.
//! 2. Sampling returns `1 - cosine = 2 (1-g)^2 (1-u) (1+gu) / d^2` and
//!    `sine = 2 (1-g^2) sqrt(u (1-u) (1+gu) (1-g+gu)) / d^2`, which are the same functions factored. Nothing cancels
//!    and nothing is divided by g, so one branch-free line serves isotropic and needle-sharp lobes.
//! 3. The density of a sampled direction needs no power: h = q^2.
//! 4. Between two given directions h comes from the chord, `h = (1-|g|)^2 + |g| |out -+ in|^2`: a dot product would
//!    lose the small angles on which a forward peak depends.

use core::f64::consts::PI;

use wide::f32x8;

use super::{HenyeyGreenstein, reference};
use crate::phase::{Deflection, PhaseX8, PlaneAngle, Turns};
use crate::real::{Mask, Real};
use crate::transcendental::sin_cos_half_turn;
use crate::vec3::{Vec3, Vec3x8};

/// The constants of one [`HenyeyGreenstein`], for one row or splatted.
#[derive(Clone, Copy)]
pub struct Lobe<F> {
    /// |g|
    g: F,
    /// 1 or -1, as g
    sign: F,
    /// 2 |g|
    two_g: F,
    /// 1 - |g|
    back: F,
    /// 2 (1 - |g|)^2
    cosine_scale: F,
    /// 2 (1 - g^2)
    sine_scale: F,
    /// (1 - |g|)^2
    smallest_h: F,
    /// 4 pi / (1 - g^2)
    inverse_scale: F,
    /// share of the forward hemisphere
    forward: F,
}

/// A [`HenyeyGreenstein`], prepared for eight lanes.
pub type HenyeyGreensteinX8 = Lobe<f32x8>;

impl<F: Real> Lobe<F> {
    /// That of `phase`.
    pub fn new(phase: HenyeyGreenstein) -> Self {
        let (g, sign) = (f64::from(phase.g).abs(), 1.0_f64.copysign(f64::from(phase.g)));
        let (back, width) = (1.0 - g, (1.0 - g) * (1.0 + g));
        let splat = |x: f64| F::splat(x as f32);
        Self {
            g: splat(g),
            sign: splat(sign),
            two_g: splat(2.0 * g),
            back: splat(back),
            cosine_scale: splat(2.0 * back * back),
            sine_scale: splat(2.0 * width),
            smallest_h: splat(back * back),
            inverse_scale: splat(4.0 * PI / width),
            forward: splat(reference::forward_share(f64::from(phase.g))),
        }
    }

    /// `h` of the turn between two unit propagation directions, in [(1-|g|)^2, (1+|g|)^2].
    #[inline(always)]
    pub fn h(&self, incoming: Vec3<F>, outgoing: Vec3<F>) -> F {
        let chord = incoming.mul_neg_add(self.sign, outgoing);
        self.g.mul_add(chord.length_squared(), self.smallest_h)
    }

    /// The turn of a number u of which `above = 1 - u` is known apart.
    #[inline(always)]
    fn turn_at(&self, u: F, above: F) -> Deflection<F> {
        let forward = self.sign.simd_gt(F::ZERO);
        let (u, above) = (forward.select(u, above), forward.select(above, u));
        let inverse_d = F::ONE / self.two_g.mul_add(u, self.back);
        let inverse_d2 = inverse_d * inverse_d;
        let rest = above * self.g.mul_add(u, F::ONE);
        let radicand = u * rest * self.g.mul_add(u, self.back);
        Deflection {
            cosine: self.sign * (self.cosine_scale * rest).mul_neg_add(inverse_d2, F::ONE),
            sine: self.sine_scale * radicand.sqrt() * inverse_d2,
        }
    }

    /// One over the phase function of the turn between two directions `[sr]`.
    #[inline(always)]
    fn inverse_phase(&self, incoming: Vec3<F>, outgoing: Vec3<F>) -> F {
        let h = self.h(incoming, outgoing);
        self.inverse_scale * h * h.sqrt()
    }
}

impl Turns<f32> for Lobe<f32> {
    #[inline(always)]
    fn turn(&self, u: f32) -> Deflection<f32> {
        self.turn_at(u, 1.0 - u)
    }

    #[inline(always)]
    fn inverse_density_of(&self, incoming: Vec3<f32>, outgoing: Vec3<f32>) -> f32 {
        self.inverse_phase(incoming, outgoing)
    }
}

impl HenyeyGreensteinX8 {
    /// Mean of `h` over all turns, weighed by the phase function: 1 - g^2.
    #[inline(always)]
    pub fn mean_h(&self) -> f32x8 {
        self.sine_scale * f32x8::splat(0.5)
    }

    /// `h` of the turns between a direction and two others: those in one plane with it and the axis from which all
    /// angles are counted, at the same angle to the axis on either side, h_- and h_+.
    #[inline(always)]
    pub fn h_in_plane(&self, incoming: PlaneAngle, outgoing: PlaneAngle) -> (f32x8, f32x8) {
        let along = self.sign.mul_neg_add(incoming.cosine, outgoing.cosine);
        let (near, far) =
            (self.sign.mul_neg_add(incoming.sine, outgoing.sine), self.sign.mul_add(incoming.sine, outgoing.sine));
        let h = |across: f32x8| self.g.mul_add(along.mul_add(along, across * across), self.smallest_h);
        (h(near), h(far))
    }
}

impl PhaseX8 for HenyeyGreensteinX8 {
    #[inline(always)]
    fn sample(&self, u: f32x8) -> Deflection {
        self.sample_at(u, f32x8::ONE - u)
    }

    #[inline(always)]
    fn sample_at(&self, u: f32x8, above: f32x8) -> Deflection {
        self.turn_at(u, above)
    }

    #[inline(always)]
    fn sample_forward(&self, u: f32x8) -> Deflection {
        self.sample((f32x8::ONE - u).mul_neg_add(self.forward, f32x8::ONE))
    }

    #[inline(always)]
    fn sample_forward_at(&self, _: f32x8, above: f32x8) -> Deflection {
        self.sample_at(above.mul_neg_add(self.forward, f32x8::ONE), self.forward * above)
    }

    #[inline(always)]
    fn forward_share(&self) -> f32x8 {
        self.forward
    }

    #[inline(always)]
    fn scale(&self) -> f32x8 {
        self.inverse_scale
    }

    #[inline(always)]
    fn inverse_shape(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        let h = self.h(incoming, outgoing);
        h * h.sqrt()
    }

    #[inline(always)]
    fn inverse_density(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        self.inverse_phase(incoming, outgoing)
    }

    #[inline(always)]
    fn lobe(&self) -> Self {
        *self
    }

    /// `tan(psi / 2) = sqrt(h_- / h_+) tan(pi (u - 1/2))`, without an arc tangent: see [`roll_by`].
    #[inline(always)]
    fn roll(&self, arriving: PlaneAngle, leaving: PlaneAngle, u: f32x8) -> (f32x8, f32x8) {
        let (near, far) = self.h_in_plane(arriving, leaving);
        roll_by(near, far, u)
    }

    #[inline(always)]
    fn roll_density(&self, [incoming, outgoing]: [Vec3x8; 2], [arriving, leaving]: [PlaneAngle; 2]) -> f32x8 {
        let (near, far) = self.h_in_plane(arriving, leaving);
        (near * far).sqrt() / self.h(incoming, outgoing)
    }

    /// `h^{3/2} sqrt(h_- h_+) / h`, with one root.
    #[inline(always)]
    fn rolled_shape(&self, [incoming, outgoing]: [Vec3x8; 2], [arriving, leaving]: [PlaneAngle; 2]) -> f32x8 {
        let h = self.h(incoming, outgoing);
        let (near, far) = self.h_in_plane(arriving, leaving);
        (h * near * far).sqrt()
    }
}

/// `(sin, cos)` of the roll psi with `tan(psi / 2) = sqrt(near / far) tan(pi (u - 1/2))` for the uniform number `u`:
/// with s and c of `pi (u - 1/2)`, `cos psi = (far c^2 - near s^2) / n` and `sin psi = 2 sqrt(near far) s c / n`, `n =
/// far c^2 + near s^2`.
#[inline(always)]
pub fn roll_by(near: f32x8, far: f32x8, u: f32x8) -> (f32x8, f32x8) {
    let (s, c) = sin_cos_half_turn(u);
    let (s2, c2) = (near * s * s, far * c * c);
    let inverse = f32x8::ONE / (s2 + c2);
    let two = f32x8::splat(2.0);
    (two * (near * far).sqrt() * s * c * inverse, (c2 - s2) * inverse)
}
