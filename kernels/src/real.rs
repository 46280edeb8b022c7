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
    fn from_bits(self) -> Self::Real {
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
