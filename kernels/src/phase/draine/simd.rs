//! Draine for eight rows.
//!
//! ```text
//! density(c) = (1 - g^2) (1 + alpha c^2) / (4 pi n h^{3/2}),  n = 1 + alpha (1 + 2 g^2) / 3,  h = 1 + g^2 - 2 g c
//!
//! c     = 1 - x,  x = 2 p e (1 + g e),  p = (1 - g)^2,  y = 1 + 2 g e                 e >= 0 is the unknown
//! v(e)  = (1 + g) / (n y) e [1 + alpha (1 - 2 p e + 2/3 p^2 e^2 (2 + g e))]           share of events above c
//! ```
//!
//! Departures from the textbook:
//! 1. The distribution is a polynomial in y, of which the powers cancel down to g^3. Written in `e = s / (1 + g - 2 g
//!    s)`, with s the share above c of Henyey-Greenstein alone, `integral of x ds = p s e` and `integral of x^2 ds =
//!    2/3 p^2 s e^2 (2 + g e)`: all divisions by g are carried out, and e knows x relative to itself, next to a peak as
//!    well.
//! 2. What lies behind is what lies before the mirror image: `v(g, c) = 1 - v(-g, -c)`. So c >= 0 always, and v rises
//!    with a slope that falls: by steps of Halley's method from below or above, nothing can leave the range. v = 1 - u
//!    is exact.
//! 3. The first guess is Henyey-Greenstein's, stretched so that it is right at both ends. Five steps leave less than
//!    1e-9 of v for all g and alpha <= 1000, four for alpha <= 100.
//! 4. A step shifts s, not e: `e' = (e - d) / (1 + 2 g d)` is that shift, and with Halley's d as a fraction it is one
//!    division. With `w = 1 + alpha c^2`, `r = v n y / (1 + g)` and `f = e [..] - r`: `d = f w / (w^2 + 2 alpha c p y^2
//!    f)`.
//! 5. Between two given directions h comes from the chord, as that of Henyey-Greenstein.

use core::f64::consts::PI;

use wide::f32x8;

use super::Draine;
use crate::phase::reference::Phase;
use crate::phase::{Deflection, HenyeyGreensteinX8, PhaseX8};
use crate::vec3::Vec3x8;

/// Halley steps.
const STEPS: u32 = 5;

/// Cosines in front are at least this.
const SMALLEST_COSINE: f32 = 6e-8;

/// The hemisphere in front of a lobe of any sign, splatted or one per lane.
#[derive(Clone, Copy)]
struct Hemisphere {
    /// in (-1, 1)
    g: f32x8,
    /// (1 - g)^2
    p: f32x8,
    /// n / (1 + g): from v to the residual
    residual: f32x8,
    /// Henyey-Greenstein's share of it over Draine's, over 1 + g
    stretch: f32x8,
    /// e at c = 0
    end: f32x8,
    /// share of all events
    share: f32x8,
}

impl Hemisphere {
    fn new(g: f64, alpha: f64) -> Self {
        let p = (1.0 - g) * (1.0 - g);
        let norm = 1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0;
        // 2 p e (1 + g e) = 1
        let end = 1.0 / (p + (p * (1.0 + g * g)).sqrt());
        let s = end * (1.0 + g) / (1.0 + 2.0 * g * end);
        let pe = p * end;
        let share = s * (1.0 + alpha * (1.0 - 2.0 * pe + 2.0 / 3.0 * pe * pe * (2.0 + g * end))) / norm;
        let splat = |x: f64| f32x8::splat(x as f32);
        Self {
            g: splat(g),
            p: splat(p),
            residual: splat(norm / (1.0 + g)),
            stretch: splat(s / (share * (1.0 + g))),
            end: splat(end),
            share: splat(share),
        }
    }

    #[inline(always)]
    fn select(mask: f32x8, a: &Self, b: &Self) -> Self {
        let of = |field: fn(&Self) -> f32x8| mask.select(field(a), field(b));
        Self {
            g: of(|h| h.g),
            p: of(|h| h.p),
            residual: of(|h| h.residual),
            stretch: of(|h| h.stretch),
            end: of(|h| h.end),
            share: of(|h| h.share),
        }
    }

    /// `1 - c` of the c above which a share v of all events falls, v <= `share`.
    #[inline(always)]
    fn pole_distance(&self, v: f32x8, alpha: f32x8) -> f32x8 {
        let one = f32x8::ONE;
        let two_g = self.g + self.g;
        let clamp = |e: f32x8| e.fast_max(f32x8::ZERO).fast_min(self.end);
        let guess = v * self.stretch;
        let mut e = clamp(guess / two_g.mul_neg_add(guess, one));
        let r = v * self.residual;
        for _ in 0..STEPS {
            let pe = self.p * e;
            let ge = self.g.mul_add(e, one);
            let y = two_g.mul_add(e, one);
            let c = (pe + pe).mul_neg_add(ge, one);
            let w = (alpha * c).mul_add(c, one);
            let mean = (pe * pe * f32x8::splat(2.0 / 3.0)).mul_add(ge + one, (pe + pe).mul_neg_add(one, one));
            let f = e.mul_sub(alpha.mul_add(mean, one), r * y);
            let bend = (alpha + alpha) * c * self.p * y * y * f;
            let w2 = w * w;
            let below = (w2 + bend).fast_max(w2 * f32x8::splat(0.2));
            e = clamp(e.mul_sub(below, f * w) / (two_g * f).mul_add(w, below));
        }
        let x = (self.p + self.p) * e * self.g.mul_add(e, one);
        x.fast_min(f32x8::splat(1.0 - SMALLEST_COSINE))
    }
}

/// The constants of one [`Draine`], splatted.
#[derive(Clone, Copy)]
pub struct DraineX8 {
    alpha: f32x8,
    front: Hemisphere,
    back: Hemisphere,
    /// |g|
    g: f32x8,
    /// 1 or -1, as g
    sign: f32x8,
    /// (1 - |g|)^2
    smallest_h: f32x8,
    /// 4 pi n / (1 - g^2)
    inverse_scale: f32x8,
    lobe: HenyeyGreensteinX8,
}

impl DraineX8 {
    /// Prepares `phase` for eight lanes.
    pub fn new(phase: Draine) -> Self {
        let (g, alpha) = (f64::from(phase.g), f64::from(phase.alpha));
        let norm = 1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0;
        let splat = |x: f64| f32x8::splat(x as f32);
        Self {
            alpha: splat(alpha),
            front: Hemisphere::new(g, alpha),
            back: Hemisphere::new(-g, alpha),
            g: splat(g.abs()),
            sign: splat(1.0_f64.copysign(g)),
            smallest_h: splat((1.0 - g.abs()) * (1.0 - g.abs())),
            inverse_scale: splat(4.0 * PI * norm / ((1.0 - g) * (1.0 + g))),
            lobe: HenyeyGreensteinX8::new(phase.lobe()),
        }
    }
}

#[inline(always)]
fn deflection(x: f32x8, sign: f32x8) -> Deflection {
    Deflection { cosine: sign * (f32x8::ONE - x), sine: (x * (f32x8::splat(2.0) - x)).sqrt() }
}

impl PhaseX8 for DraineX8 {
    #[inline(always)]
    fn sample(&self, u: f32x8) -> Deflection {
        self.sample_at(u, f32x8::ONE - u)
    }

    #[inline(always)]
    fn sample_at(&self, u: f32x8, above: f32x8) -> Deflection {
        let one = f32x8::ONE;
        let forward = above.simd_lt(self.front.share);
        let hemisphere = Hemisphere::select(forward, &self.front, &self.back);
        deflection(hemisphere.pole_distance(forward.select(above, u), self.alpha), forward.select(one, -one))
    }

    #[inline(always)]
    fn sample_forward(&self, u: f32x8) -> Deflection {
        self.sample_forward_at(u, f32x8::ONE - u)
    }

    #[inline(always)]
    fn sample_forward_at(&self, _: f32x8, above: f32x8) -> Deflection {
        deflection(self.front.pole_distance(above * self.front.share, self.alpha), f32x8::ONE)
    }

    #[inline(always)]
    fn forward_share(&self) -> f32x8 {
        self.front.share
    }

    #[inline(always)]
    fn scale(&self) -> f32x8 {
        self.inverse_scale
    }

    #[inline(always)]
    fn inverse_shape(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        let squared_chord = incoming.mul_neg_add(self.sign, outgoing).length_squared();
        let h = self.g.mul_add(squared_chord, self.smallest_h);
        let c = squared_chord.mul_neg_add(f32x8::splat(0.5), f32x8::ONE);
        h * h.sqrt() / (self.alpha * c).mul_add(c, f32x8::ONE)
    }

    #[inline(always)]
    fn lobe(&self) -> HenyeyGreensteinX8 {
        self.lobe
    }
}
