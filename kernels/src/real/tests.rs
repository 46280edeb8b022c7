//! What is computed for one row is what is computed for eight.

use wide::{f32x8, u32x8};

use super::{Mask, Real, Word};
use crate::phase::{HenyeyGreenstein, Lobe, PhaseX8, Turns};
use crate::random::{block, uniform_f32, words};
use crate::transcendental::{exp, neg_ln, sin_cos_turn};
use crate::vec3::{Vec3, Vec3x8};

/// Asserts that what an expression makes of a word in every row is what it makes of it in one.
macro_rules! assert_alike {
    ($name:literal, |$word:ident| $result:expr) => {
        for first in (0..=u32::MAX - 8 * 0x0010_0307).step_by(0x0080_1803) {
            let eight: [u32; 8] = core::array::from_fn(|i| first + i as u32 * 0x0010_0307);
            let of_eight: [u32; 8] = {
                let $word = u32x8::new(eight);
                bytemuck::cast($result)
            };
            let one_by_one: [u32; 8] = eight.map(|$word| bytemuck::cast($result));
            assert_eq!(of_eight, one_by_one, "{}, words from {first:#x} on", $name);
        }
    };
}

/// A number in (-50, 50).
fn number<W: Word>(word: W) -> W::Real {
    (uniform_f32(word) - W::Real::splat(0.5)) * W::Real::splat(100.0)
}

/// Products and sums that may be rounded together.
fn products<F: Real>(x: F) -> F {
    x.mul_add(x, x) + x.mul_sub(x, x * x) - x.mul_neg_add(x * x, x)
}

/// The whole number next to [`number`]; a zero without a sign.
fn whole<W: Word>(word: W) -> W::Real {
    number(word).rounded().0 + W::Real::ZERO
}

/// A unit vector.
fn direction<W: Word>(word: W) -> Vec3<W::Real> {
    let other = |k: u32| number(word.wrapping_mul(W::splat(k)));
    Vec3::new(other(1), other(0x9e37_79b9), other(0x85eb_ca6b)).length_and_direction().1
}

#[test]
fn arithmetic_on_single_rows_is_that_on_eight() {
    assert_alike!("words", |w| words(w, w ^ w.shifted_right(3), block(w, crate::random::SEGMENT), 7)[2]);
    assert_alike!("shifts", |w| w.shifted_left(3).wrapping_sub(w.shifted_right_signed(5)));
    assert_alike!("uniform", |w| uniform_f32(w));
    assert_alike!("products", |w| products(number(w)));
    assert_alike!("quotient and root", |w| number(w) / (number(w) * number(w)).sqrt());
    assert_alike!("bounds", |w| number(w).fast_max(uniform_f32(w)).fast_min(-number(w)).copysign(number(w)));
    assert_alike!("choice", |w| {
        let (x, y) = (number(w), uniform_f32(w));
        (x.simd_lt(y) & !x.simd_le(-y) | x.simd_gt(y + y) & w.is(w)).select(x, y)
    });
    assert_alike!("rounded", |w| whole(w));
    assert_alike!("bits of rounded", |w| number(w).rounded().1.shifted_left(23));
}

#[test]
fn numbers_that_are_none_are_treated_alike() {
    let none = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, 1.0, f32::MIN_POSITIVE];
    let pairs = none.iter().flat_map(|a| none.iter().map(move |b| (*a, *b)));
    for (a, b) in pairs {
        let (a8, b8) = (f32x8::splat(a), f32x8::splat(b));
        let same = |one: f32, eight: f32x8| one.to_bits() == eight.to_array()[0].to_bits();
        assert!(same(Real::fast_max(a, b), a8.fast_max(b8)), "the larger of {a} and {b}");
        assert!(same(Real::fast_min(a, b), a8.fast_min(b8)), "the smaller of {a} and {b}");
        let masks = [(a.simd_lt(b), a8.simd_lt(b8)), (a.simd_le(b), a8.simd_le(b8)), (a.simd_gt(b), a8.simd_gt(b8))];
        assert!(masks.iter().all(|(one, eight)| *one == eight.any()), "comparing {a} with {b}");
    }
}

#[test]
fn functions_of_single_rows_are_those_of_eight() {
    assert_alike!("logarithm", |w| neg_ln(uniform_f32(w)));
    assert_alike!("exponential", |w| exp(number(w) * number(w).copysign(number(w))));
    assert_alike!("sine", |w| sin_cos_turn(uniform_f32(w)).0);
    assert_alike!("cosine", |w| sin_cos_turn(uniform_f32(w)).1);
    assert_alike!("frame", |w| direction(w).frame().0.x + direction(w).frame().1.z);
}

#[test]
fn lobes_turn_single_rows_as_they_turn_eight() {
    for g in [-0.7, 0.0, 0.3, 0.99] {
        let phase = HenyeyGreenstein { g };
        let (one, eight) = (Lobe::<f32>::new(phase), Lobe::<f32x8>::new(phase));
        for word in (0..=u32::MAX).step_by(0x0040_1003) {
            let (u, from, to) = (uniform_f32(word), direction(word), direction(word.rotate_left(9)));
            let splat = |v: Vec3<f32>| Vec3x8::splat([v.x, v.y, v.z]);
            let turned = one.turn(u).apply(from, uniform_f32(!word));
            let turned_x8 = eight.sample(f32x8::splat(u)).apply(splat(from), f32x8::splat(uniform_f32(!word)));
            assert_eq!(splat(turned), turned_x8, "g {g}, word {word:#x}");
            let density = one.inverse_density_of(from, to);
            assert_eq!(f32x8::splat(density), eight.inverse_density(splat(from), splat(to)), "g {g}, word {word:#x}");
        }
    }
}
