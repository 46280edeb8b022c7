//! Emission for eight rows.
//!
//! ```text
//! power: scale cos^k,      cone: window^2 / cos,  window = clamp(a cos + b, 0, 1)
//! cos theta = u^{1 / (k + 2)},    p_dir = (k + 2) / (2 pi) cos^{k + 1}
//! ```
//!
//! 1. What no light of the scene has is passed by: powers, cones, spheres, sides.
//! 2. With `a = -2 ln u / (k + 2)` the cosine is `e^{-a / 2}` and `sin^2 = 1 - e^{-a}`, by its series where a is small:
//!    narrow beams keep the digits of their angle.

use core::f32::consts::TAU;

use wide::{f32x8, u32x8};

use crate::lanes::{self, LANES};
use crate::tables::lights::{Lights, Places};
use crate::transcendental::{exp, neg_ln, sin_cos_turn};
use crate::vec3::Vec3x8;

impl Lights {
    /// Unit normals of the fronts of emitters at `point`.
    #[inline(always)]
    pub fn normal(&self, emitters: &[u32; LANES], point: Vec3x8) -> Vec3x8 {
        let Places { origin, normal: flat, curvature, .. } = self.places(emitters);
        if self.spheres { (point - origin).mul_add(curvature, flat) } else { flat }
    }

    /// Cosine to the normal, at `point`, on the side that shines, of rays that arrive there in `direction`; negative
    /// where it is dark.
    #[inline(always)]
    pub fn cosine(&self, emitters: &[u32; LANES], point: Vec3x8, direction: Vec3x8) -> f32x8 {
        let mut cosine = -direction.dot(self.normal(emitters, point));
        if self.double_sided {
            let both = self.gather(emitters, |emitter| if emitter.double_sided { -1.0 } else { 1.0 });
            cosine = cosine.fast_max(cosine * both);
        }
        if self.has_distant() {
            cosine = self.are_distant(emitters).select(f32x8::ONE, cosine);
        }
        cosine
    }

    /// Rows of emitters at infinity, which face every ray.
    #[inline(always)]
    pub fn are_distant(&self, emitters: &[u32; LANES]) -> f32x8 {
        let first = u32x8::splat(self.first_distant());
        lanes::as_mask(u32x8::new(*emitters).simd_ge(first))
    }

    /// Radiance of emitters at the angles of these cosines, over their `radiance`.
    #[inline(always)]
    pub fn profile(&self, emitters: &[u32; LANES], cosine: f32x8) -> f32x8 {
        if !self.focused {
            return f32x8::ONE;
        }
        let exponent = self.gather(emitters, |emitter| emitter.exponent);
        let scale = self.gather(emitters, |emitter| emitter.scale);
        let cosine = cosine.fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let power = scale * exp(-exponent * neg_ln(cosine));
        if !self.cones {
            return power;
        }
        let [a, b] = [0, 1].map(|i| self.gather(emitters, |emitter| emitter.window[i]));
        let window = a.mul_add(cosine, b).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        a.simd_gt(f32x8::ZERO).select(window * window / cosine, power)
    }

    /// Density of the directions that [`Self::emit`] draws, over their cosine [1/sr], at angles of these cosines.
    #[inline(always)]
    pub fn direction_density(&self, emitters: &[u32; LANES], cosine: f32x8) -> f32x8 {
        let exponent = self.gather(emitters, |emitter| emitter.exponent);
        let per_turn = self.gather(emitters, |emitter| if emitter.double_sided { 0.5 / TAU } else { 1.0 / TAU });
        let power = exp(-exponent * neg_ln(cosine.fast_max(f32x8::splat(f32::MIN_POSITIVE))));
        (exponent + f32x8::splat(2.0)) * per_turn * power
    }

    /// Unit directions that leave emitters at `point`, for four uniform numbers: cosine, azimuth, -, side.
    #[inline(always)]
    pub fn emit(&self, emitters: &[u32; LANES], point: Vec3x8, [cosine, azimuth, _, side]: [f32x8; 4]) -> Vec3x8 {
        let normal = self.outwards(emitters, point, side);
        let exponent = self.gather(emitters, |emitter| emitter.exponent);
        about(normal, exponent, cosine, azimuth)
    }

    /// Unit normals of emitters at `point`, on a side that shines: one of two for the number `side`.
    #[inline(always)]
    fn outwards(&self, emitters: &[u32; LANES], point: Vec3x8, side: f32x8) -> Vec3x8 {
        let normal = self.normal(emitters, point);
        let back = self.gather(emitters, |emitter| if emitter.double_sided { 0.5 } else { 0.0 });
        let sign = side.simd_lt(back).select(-f32x8::ONE, f32x8::ONE);
        normal * (sign / normal.length_squared().sqrt())
    }
}

/// Directions about `normal` that follow the emission of lights of this exponent.
#[inline(always)]
fn about(normal: Vec3x8, exponent: f32x8, u: f32x8, v: f32x8) -> Vec3x8 {
    let (tangent, bitangent) = normal.frame();
    let a = f32x8::splat(2.0) * neg_ln(u) / (exponent + f32x8::splat(2.0));
    let (cosine, sine) = (exp(a * f32x8::splat(-0.5)), one_minus_exp(a).sqrt());
    let (sin, cos) = sin_cos_turn(v);
    normal.mul_add(cosine, tangent.mul_add(sine * cos, bitangent * (sine * sin)))
}

/// `1 - e^{-a}` for a >= 0, accurate relative to itself.
#[inline(always)]
fn one_minus_exp(a: f32x8) -> f32x8 {
    let series =
        (2..=8).rev().fold(f32x8::ONE, |sum, k| (a * f32x8::splat(1.0 / k as f32)).mul_neg_add(sum, f32x8::ONE));
    a.simd_lt(f32x8::splat(0.5)).select(a * series, f32x8::ONE - exp(-a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_minus_exp_keeps_its_digits() {
        for a in [1e-12, 1e-7, 3e-4, 0.1, 0.4999, 0.5, 0.7, 3.0, 17.0_f32] {
            let (found, expected) = (one_minus_exp(f32x8::splat(a)).to_array()[0], -(-f64::from(a)).exp_m1());
            assert!((f64::from(found) / expected - 1.0).abs() < 3e-7, "{a}: {found}, not {expected}");
        }
    }
}
