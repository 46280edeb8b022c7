//! Real numbers and words that kernels compute with: those of one row, or of eight rows side by side.
//!
//! What is written for [`Real`] serves both. Where rows go different ways they are taken eight at a time, masks decide,
//! and the lanes are ours to count and to move. Where all rows go the same way a loop over single rows reads as
//! mathematics, and the compiler puts as many of them side by side as the registers of the processor hold. Both give
//! the same bits: every operation is exact, or rounded once, whatever the width.

/// Declares operations that a type has by itself, under the same names.
macro_rules! its_own {
    ($(fn $name:ident($self:ident $(, $argument:ident)*) -> $Result:ty;)*) => {$(
        #[inline(always)]
        fn $name($self $(, $argument: Self)*) -> $Result {
            $self.$name($($argument),*)
        }
    )*};
}

mod eight;
mod one;
#[cfg(test)]
mod tests;

use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use bytemuck::Pod;

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
    /// Its magnitude.
    fn abs(self) -> Self;
    /// Its magnitude with the sign of another number.
    fn copysign(self, sign: Self) -> Self;
    /// The larger of two numbers; the second, if one is none.
    fn fast_max(self, other: Self) -> Self;
    /// The smaller of two numbers; the second, if one is none.
    fn fast_min(self, other: Self) -> Self;
    /// The nearest whole number, of two the even one, and the same as an `i32`, of which the lowest 22 bits are right; of
    /// numbers up to 2^22. Zeros may have either sign.
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
