//! Eight rows side by side.

use wide::{f32x8, i32x8, u32x8};

use super::{Mask, Real, Word};

impl Real for f32x8 {
    type Word = u32x8;
    type Mask = f32x8;

    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;

    its_own! {
        fn mul_add(self, a, b) -> Self;
        fn mul_sub(self, a, b) -> Self;
        fn mul_neg_add(self, a, b) -> Self;
        fn sqrt(self) -> Self;
        fn abs(self) -> Self;
        fn copysign(self, sign) -> Self;
        fn fast_max(self, other) -> Self;
        fn fast_min(self, other) -> Self;
        fn simd_lt(self, other) -> Self;
        fn simd_le(self, other) -> Self;
        fn simd_gt(self, other) -> Self;
    }

    #[inline(always)]
    fn splat(number: f32) -> Self {
        Self::splat(number)
    }

    #[inline(always)]
    fn rounded(self) -> (Self, u32x8) {
        let whole = self.round_ties_even();
        (whole, bytemuck::cast(whole.fast_trunc_int()))
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
