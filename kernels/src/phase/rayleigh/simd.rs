//! Rayleigh for eight rows.
//!
//! ```text
//! x = 1 - |cosine|,   x (6 - 3 x + x^2) = 8 min(u, 1 - u)
//! density(c) = 3 (1 + c^2) / (16 pi)
//! ```
//!
//! Departures from the textbook:
//! 1. The unknown is the distance x of |cosine| from 1, in (0, 1], and u the distance to the nearer end: x is accurate
//!    relative to itself, and with it `sine = sqrt(x (2 - x))` next to both poles.
//! 2. Instead of Cardano's cube root, a cubic that is exact at both ends of the range and 5e-3 off in between, and one
//!    step of Halley's method, which leaves 4e-8. The slope of the equation is in [3, 6], so that nothing can go wrong.

use core::f32::consts::PI;

use wide::f32x8;

use super::Rayleigh;
use crate::phase::{Deflection, HenyeyGreenstein, HenyeyGreensteinX8, PhaseX8};
use crate::vec3::Vec3x8;

/// [`Rayleigh`] for eight lanes.
#[derive(Clone, Copy)]
pub struct RayleighX8;

impl RayleighX8 {
    /// Prepares `phase` for eight lanes.
    pub fn new(_phase: Rayleigh) -> Self {
        Self
    }
}

/// `1 - |cosine|` that a share `v` of all events, in (0, 1/2], has between it and one pole.
#[inline(always)]
fn pole_distance(v: f32x8) -> f32x8 {
    let splat = f32x8::splat;
    let w = v * splat(4.0 / 3.0);
    let x = w * w.mul_add(splat(0.3), splat(0.55)).mul_add(w, f32x8::ONE);
    let excess = x.mul_add((x - splat(3.0)).mul_add(x, splat(6.0)), v * splat(-8.0));
    let half_bend = (x - f32x8::ONE) * splat(3.0);
    let slope = half_bend.mul_add(x - f32x8::ONE, splat(3.0));
    x - excess * slope / slope.mul_sub(slope, excess * half_bend)
}

#[inline(always)]
fn deflection(x: f32x8, sign: f32x8) -> Deflection {
    Deflection { cosine: (f32x8::ONE - x).copysign(sign), sine: (x * (f32x8::splat(2.0) - x)).sqrt() }
}

impl PhaseX8 for RayleighX8 {
    #[inline(always)]
    fn sample(&self, u: f32x8) -> Deflection {
        let x = pole_distance(u.fast_min(f32x8::ONE - u));
        deflection(x, u - f32x8::splat(0.5))
    }

    #[inline(always)]
    fn sample_forward(&self, u: f32x8) -> Deflection {
        let half = f32x8::splat(0.5);
        deflection(pole_distance(u.mul_neg_add(half, half)), f32x8::ONE)
    }

    #[inline(always)]
    fn forward_share(&self) -> f32x8 {
        f32x8::splat(0.5)
    }

    /// 16 pi / 3
    #[inline(always)]
    fn scale(&self) -> f32x8 {
        f32x8::splat(16.0 / 3.0 * PI)
    }

    #[inline(always)]
    fn inverse_shape(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        let cosine = incoming.dot(outgoing);
        f32x8::ONE / cosine.mul_add(cosine, f32x8::ONE)
    }

    #[inline(always)]
    fn lobe(&self) -> HenyeyGreensteinX8 {
        HenyeyGreensteinX8::new(HenyeyGreenstein { g: 0.0 })
    }
}
