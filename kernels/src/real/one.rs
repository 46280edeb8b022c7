//! One row.

use super::{Mask, Real, Word};

/// Whether products and sums are rounded together, as they are in eight rows: without the instruction a library would
/// do it, which takes longer than all else.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

impl Real for f32 {
    type Word = u32;
    type Mask = bool;

    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    its_own! {
        fn sqrt(self) -> Self;
        fn abs(self) -> Self;
        fn copysign(self, sign) -> Self;
    }

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

    its_own! {
        fn wrapping_add(self, other) -> Self;
        fn wrapping_sub(self, other) -> Self;
        fn wrapping_mul(self, other) -> Self;
    }

    #[inline(always)]
    fn splat(word: u32) -> Self {
        word
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
