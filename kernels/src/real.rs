//! Real numbers and words that kernels compute with: those of one row, or of eight rows side by side.
//!
//! What is written for [`Real`] serves both. Where rows go different ways they are taken eight at a time, masks decide,
//! and the lanes are ours to count and to move. Where all rows go the same way a loop over single rows reads as
//! mathematics, and the compiler puts as many of them side by side as the registers of the processor hold. Both give
//! the same bits: every operation is exact, or rounded once, whatever the width.

use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use bytemuck::Pod;
use wide::{f32x8, i32x8, u32x8};

/// An `f32`, or eight.
pub trait Real:
    Pod
    + PartialEq
    + core::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// As many words.
    type Word: Word<Real = Self>;
    /// As many answers to a comparison.
    type Mask: Mask<Self>;

    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The same number in every row.
    fn splat(number: f32) -> Self;
    /// `self * a + b`, rounded once where the build has such an instruction.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `self * a - b`, likewise.
    fn mul_sub(self, a: Self, b: Self) -> Self;
    /// `b - self * a`, likewise.
    fn mul_neg_add(self, a: Self, b: Self) -> Self;
    /// The square root, rounded once.
    fn sqrt(self) -> Self;
    /// Its magnitude with the sign of another number.
    fn copysign(self, sign: Self) -> Self;
    /// The larger of two numbers; the second, if one is none.
    fn fast_max(self, other: Self) -> Self;
    /// The smaller of two numbers; the second, if one is none.
    fn fast_min(self, other: Self) -> Self;
    /// The nearest whole number, of two the even one, and the same as an `i32`, of which the lowest 22 bits are right; of
    /// numbers up to 2^22.
    fn rounded(self) -> (Self, Self::Word);
    /// Whether `self < other`.
    fn simd_lt(self, other: Self) -> Self::Mask;
    /// Whether `self <= other`.
    fn simd_le(self, other: Self) -> Self::Mask;
    /// Whether `self > other`.
    fn simd_gt(self, other: Self) -> Self::Mask;

    /// The numbers as bits.
    #[inline(always)]
    fn to_bits(self) -> Self::Word {
        bytemuck::cast(self)
    }
}

/// A `u32`, or eight; sums and products wrap.
pub trait Word: Pod + PartialEq + core::fmt::Debug + BitOr<Output = Self> + BitXor<Output = Self> {
    /// As many real numbers.
    type Real: Real<Word = Self>;

    /// The same word in every row.
    fn splat(word: u32) -> Self;
    /// `self + other`.
    fn wrapping_add(self, other: Self) -> Self;
    /// `self - other`.
    fn wrapping_sub(self, other: Self) -> Self;
    /// `self * other`.
    fn wrapping_mul(self, other: Self) -> Self;
    /// `self << bits`.
    fn shifted_left(self, bits: u32) -> Self;
    /// `self >> bits`.
    fn shifted_right(self, bits: u32) -> Self;
    /// `self >> bits` of the `i32` that the word stands for, whose sign is kept.
    fn shifted_right_signed(self, bits: u32) -> Self;
    /// The `i32` that the word stands for as a real number.
    fn to_real(self) -> Self::Real;
    /// Whether two words are the same.
    fn is(self, other: Self) -> <Self::Real as Real>::Mask;

    /// The real number that has these bits.
    #[inline(always)]
    fn as_real(self) -> Self::Real {
        bytemuck::cast(self)
    }
}

/// An answer for one row, or for eight.
pub trait Mask<F>: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// `yes` where the answer is yes, `no` elsewhere.
    fn select(self, yes: F, no: F) -> F;
}

impl Real for f32x8 {
    type Word = u32x8;
    type Mask = f32x8;

    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;

    #[inline(always)]
    fn splat(number: f32) -> Self {
        Self::splat(number)
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }

    #[inline(always)]
    fn mul_sub(self, a: Self, b: Self) -> Self {
        self.mul_sub(a, b)
    }

    #[inline(always)]
    fn mul_neg_add(self, a: Self, b: Self) -> Self {
        self.mul_neg_add(a, b)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }

    #[inline(always)]
    fn fast_max(self, other: Self) -> Self {
        self.fast_max(other)
    }

    #[inline(always)]
    fn fast_min(self, other: Self) -> Self {
        self.fast_min(other)
    }

    #[inline(always)]
    fn rounded(self) -> (Self, u32x8) {
        let whole = self.round_ties_even();
        (whole, bytemuck::cast(whole.fast_trunc_int()))
    }

    #[inline(always)]
    fn simd_lt(self, other: Self) -> Self {
        self.simd_lt(other)
    }

    #[inline(always)]
    fn simd_le(self, other: Self) -> Self {
        self.simd_le(other)
    }

    #[inline(always)]
    fn simd_gt(self, other: Self) -> Self {
        self.simd_gt(other)
    }
}

impl Word for u32x8 {
    type Real = f32x8;

    #[inline(always)]
    fn splat(word: u32) -> Self {
        Self::splat(word)
    }

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn wrapping_sub(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        self * other
    }

    #[inline(always)]
    fn shifted_left(self, bits: u32) -> Self {
        self << bits
    }

    #[inline(always)]
    fn shifted_right(self, bits: u32) -> Self {
        self >> bits
    }

    #[inline(always)]
    fn shifted_right_signed(self, bits: u32) -> Self {
        bytemuck::cast(bytemuck::cast::<Self, i32x8>(self) >> bits)
    }

    #[inline(always)]
    fn to_real(self) -> f32x8 {
        f32x8::from_i32x8(bytemuck::cast(self))
    }

    #[inline(always)]
    fn is(self, other: Self) -> f32x8 {
        bytemuck::cast(self.simd_eq(other))
    }
}

impl Mask<f32x8> for f32x8 {
    #[inline(always)]
    fn select(self, yes: Self, no: Self) -> Self {
        self.select(yes, no)
    }
}

/// Whether products and sums are rounded together, as they are in eight rows: without the instruction a library would
/// do it, which takes longer than all else.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

impl Real for f32 {
    type Word = u32;
    type Mask = bool;

    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn splat(number: f32) -> Self {
        number
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        if FUSED { self.mul_add(a, b) } else { self * a + b }
    }

    #[inline(always)]
    fn mul_sub(self, a: Self, b: Self) -> Self {
        Real::mul_add(self, a, -b)
    }

    #[inline(always)]
    fn mul_neg_add(self, a: Self, b: Self) -> Self {
        Real::mul_add(-self, a, b)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }

    #[inline(always)]
    fn fast_max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn fast_min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// No conversion, which would have to care for numbers that do not fit, and keep loops from being put side by side.
    #[inline(always)]
    fn rounded(self) -> (Self, u32) {
        /// 1.5 * 2^23: sums with it have no digits behind the point, and end with the bits of what is added.
        const SHIFT: f32 = 12_582_912.0;
        let shifted = self + SHIFT;
        (shifted - SHIFT, shifted.to_bits())
    }

    #[inline(always)]
    fn simd_lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn simd_le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn simd_gt(self, other: Self) -> bool {
        self > other
    }
}

impl Word for u32 {
    type Real = f32;

    #[inline(always)]
    fn splat(word: u32) -> Self {
        word
    }

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        self.wrapping_add(other)
    }

    #[inline(always)]
    fn wrapping_sub(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }

    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        self.wrapping_mul(other)
    }

    #[inline(always)]
    fn shifted_left(self, bits: u32) -> Self {
        self << bits
    }

    #[inline(always)]
    fn shifted_right(self, bits: u32) -> Self {
        self >> bits
    }

    #[inline(always)]
    fn shifted_right_signed(self, bits: u32) -> Self {
        (self.cast_signed() >> bits).cast_unsigned()
    }

    #[inline(always)]
    fn to_real(self) -> f32 {
        self.cast_signed() as f32
    }

    #[inline(always)]
    fn is(self, other: Self) -> bool {
        self == other
    }
}

impl Mask<f32> for bool {
    #[inline(always)]
    fn select(self, yes: f32, no: f32) -> f32 {
        if self { yes } else { no }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert_alike!("products", |w| {
            let x = number(w);
            x.mul_add(x, x) + x.mul_sub(x, x * x) - x.mul_neg_add(x * x, x)
        });
        assert_alike!("quotient and root", |w| number(w) / (number(w) * number(w)).sqrt());
        assert_alike!("bounds", |w| number(w).fast_max(uniform_f32(w)).fast_min(-number(w)).copysign(number(w)));
        assert_alike!("choice", |w| {
            let (x, y) = (number(w), uniform_f32(w));
            (x.simd_lt(y) & !x.simd_le(-y) | x.simd_gt(y + y) & w.is(w)).select(x, y)
        });
        assert_alike!("rounded", |w| number(w).rounded().0);
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
            let masks =
                [(a.simd_lt(b), a8.simd_lt(b8)), (a.simd_le(b), a8.simd_le(b8)), (a.simd_gt(b), a8.simd_gt(b8))];
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
                assert_eq!(
                    f32x8::splat(density),
                    eight.inverse_density(splat(from), splat(to)),
                    "g {g}, word {word:#x}"
                );
            }
        }
    }
}
