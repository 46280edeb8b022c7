//! The three transcendental functions that kernels need, as short polynomials without special cases.
//!
//! Each is a minimax fit on its reduced range, good to two units in the last place where it matters, and takes a third
//! to a half of the time of a general routine because the arguments are known: uniform numbers and optical depths.
//! The tests walk through every uniform number there is.

use core::f32::consts::{LN_2, LOG2_E};

use crate::real::{Real, Word};

/// `c[0] + c[1] x + c[2] x^2 + ..`
#[inline(always)]
fn polynomial<F: Real, const N: usize>(x: F, c: [f32; N]) -> F {
    let mut sum = F::splat(c[N - 1]);
    for i in (0..N - 1).rev() {
        sum = sum.mul_add(x, F::splat(c[i]));
    }
    sum
}

/// `-ln v` for a normal `v > 0`: the free flight, in mean free paths, for `v = 1 - u`.
///
/// `v = 2^e (1 + m)` with `1 + m` in [sqrt(1/2), sqrt(2)); `ln(1 + m) = m - m^2/2 + m^3 p(m)`, so that the result is
/// accurate relative to itself even next to `v = 1`.
#[inline(always)]
pub fn neg_ln<F: Real>(v: F) -> F {
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let bits = v.to_bits();
    let exponent = bits.wrapping_sub(F::Word::splat(SQRT_HALF_BITS)).shifted_right_signed(23);
    let fraction = bits.wrapping_sub(exponent.shifted_left(23));
    let m = fraction.as_real() - F::ONE;
    let p = polynomial(
        m,
        [0.333_339_1, -0.250_013_4, 0.199_630_63, -0.165_775_85, 0.149_147_67, -0.142_674_86, 0.087_004_356],
    );
    let m2 = m * m;
    let ln_fraction = (m * m2).mul_add(p, m2.mul_neg_add(F::splat(0.5), m));
    -exponent.to_real().mul_add(F::splat(LN_2), ln_fraction)
}

/// `e^x`, with `x` clamped to [-87, 88] so that the result is a normal number.
#[inline(always)]
pub fn exp<F: Real>(x: F) -> F {
    const LN_2_HIGH: f32 = 0.693_359_4; // 11 bits: exponent * LN_2_HIGH is exact
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    let x = x.fast_max(F::splat(-87.0)).fast_min(F::splat(88.0));
    let (exponent, bits) = (x * F::splat(LOG2_E)).rounded();
    let f = exponent.mul_neg_add(F::splat(LN_2_HIGH), x);
    let f = exponent.mul_neg_add(F::splat(LN_2_LOW), f) * F::splat(LOG2_E);
    let power =
        polynomial(f, [1.0, LN_2, 0.240_226_48, 0.055_503_324, 0.009_618_437, 0.001_339_887_4, 0.000_153_533_62]);
    power.to_bits().wrapping_add(bits.shifted_left(23)).as_real()
}

/// `(sin, cos)` of `pi (u - 1/2)` for `u` in [0, 1].
#[inline(always)]
pub fn sin_cos_half_turn<F: Real>(u: F) -> (F, F) {
    let x = u - F::splat(0.5);
    let x2 = x * x;
    let sin = x * polynomial(x2, [core::f32::consts::PI, -5.167_71, 2.550_069_8, -0.598_242_1, 0.077_560_39]);
    let cos = polynomial(x2, [1.0, -4.934_795_4, 4.058_451, -1.332_093_8, 0.220_080_66]);
    (sin, cos)
}

/// `(sin, cos)` of `2 pi u` for `u` in [0, 1]: with s and c of half the turn, `-2 s c` and `s^2 - c^2`.
#[inline(always)]
pub fn sin_cos_turn<F: Real>(u: F) -> (F, F) {
    let (s, c) = sin_cos_half_turn(u);
    (s * c * F::splat(-2.0), s.mul_sub(s, c * c))
}

#[cfg(test)]
mod tests {
    use wide::{f32x8, u32x8};

    use super::*;
    use crate::random::uniform_f32;

    /// Calls `check` with every number that `random::uniform_f32` can return.
    fn every_uniform(mut check: impl FnMut(f32x8)) {
        for first in (0..1 << 23).step_by(8) {
            let cells = u32x8::splat(first) + u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
            check(uniform_f32(cells << 9_u32));
        }
    }

    #[test]
    fn neg_ln_is_accurate_for_every_uniform_number() {
        let mut worst: f64 = 0.0;
        every_uniform(|u| {
            for (u, found) in u.to_array().into_iter().zip(neg_ln(u).to_array()) {
                let exact = -f64::from(u).ln();
                worst = worst.max((f64::from(found) / exact - 1.0).abs());
            }
        });
        assert!(worst < 1.8e-7, "relative error {worst:e}");
    }

    #[test]
    fn sin_cos_turn_is_accurate_for_every_uniform_number() {
        let mut worst: f64 = 0.0;
        every_uniform(|u| {
            let (sin, cos) = sin_cos_turn(u);
            for ((u, sin), cos) in u.to_array().into_iter().zip(sin.to_array()).zip(cos.to_array()) {
                let (s, c) = (core::f64::consts::TAU * f64::from(u)).sin_cos();
                worst = worst.max((f64::from(sin) - s).abs()).max((f64::from(cos) - c).abs());
            }
        });
        assert!(worst < 4e-7, "absolute error {worst:e}");
    }

    #[test]
    fn exp_is_accurate_and_never_leaves_the_normal_numbers() {
        let mut worst: f64 = 0.0;
        for i in -870_000..880_000 {
            let x = i as f32 * 1e-4;
            let found = f64::from(exp(f32x8::splat(x)).to_array()[0]);
            worst = worst.max((found / f64::from(x).exp() - 1.0).abs());
        }
        assert!(worst < 2.5e-7, "relative error {worst:e}");
        for x in [-1e30, -88.0, 89.0, 1e30] {
            assert!(exp(f32x8::splat(x)).to_array()[0].is_normal(), "exp({x})");
        }
        assert_eq!(exp(f32x8::ZERO).to_array()[0], 1.0);
    }
}
