//! Eight rows side by side.

use wide::{f32x8, i32x8, u32x8};

use super::{Mask, Real, Word};

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
