//! What rays are tracked for, eight at a time: the rate of candidates, and what becomes of a ray at each.

use wide::{f32x8, i32x8};

use crate::lanes::{LANES, gather, per_lane};
use crate::media::field::blocks::{Blocks, Residual};

/// What is looked for along rays.
pub(super) trait Quest<const N: usize>: Copy {
    /// Whether the ray may end on its way.
    const FLIES: bool;

    /// Rate of candidates, and the extinction that is known, in the blocks at these indices [1/m].
    fn rates(blocks: &Blocks, at: i32x8) -> [f32x8; 2];

    /// Which blocks have one extinction, and so need not be asked where a candidate is, and that extinction [1/m].
    fn even(blocks: &Blocks, at: i32x8, rates: [f32x8; 2]) -> (f32x8, f32x8);

    /// What a candidate does to the ray's results, where extinction, rate and mean are these, for a number `u`; and
    /// where the ray ends with it.
    fn meet(
        results: [f32x8; N],
        hues: [f32x8; N],
        extinction: f32x8,
        rates: [f32x8; 2],
        u: f32x8,
    ) -> ([f32x8; N], f32x8);
}

/// Where a flight ends.
#[derive(Clone, Copy)]
pub(super) struct Flight;

/// How much light comes through.
#[derive(Clone, Copy)]
pub(super) struct Transmittance;

impl Quest<1> for Flight {
    const FLIES: bool = true;

    #[inline(always)]
    fn rates(blocks: &Blocks, at: i32x8) -> [f32x8; 2] {
        [gather(blocks.majorants(), bytemuck::cast(at)), f32x8::ZERO]
    }

    #[inline(always)]
    fn even(blocks: &Blocks, at: i32x8, _: [f32x8; 2]) -> (f32x8, f32x8) {
        let [spread, control] = residuals(blocks, at);
        (spread.simd_eq(f32x8::ZERO), control)
    }

    #[inline(always)]
    fn meet(
        results: [f32x8; 1],
        _: [f32x8; 1],
        extinction: f32x8,
        [most, _]: [f32x8; 2],
        u: f32x8,
    ) -> ([f32x8; 1], f32x8) {
        (results, (u * most).simd_lt(extinction))
    }
}

impl<const N: usize> Quest<N> for Transmittance {
    const FLIES: bool = false;

    #[inline(always)]
    fn rates(blocks: &Blocks, at: i32x8) -> [f32x8; 2] {
        residuals(blocks, at)
    }

    #[inline(always)]
    fn even(_: &Blocks, _: i32x8, _: [f32x8; 2]) -> (f32x8, f32x8) {
        // Of one extinction, a block has no candidates.
        (f32x8::ZERO, f32x8::ZERO)
    }

    #[inline(always)]
    fn meet(
        results: [f32x8; N],
        hues: [f32x8; N],
        extinction: f32x8,
        [spread, control]: [f32x8; 2],
        _: f32x8,
    ) -> ([f32x8; N], f32x8) {
        let residual = (extinction - control) / spread;
        let factor = |c: usize| (f32x8::ONE - hues[c] * residual).fast_max(f32x8::ZERO);
        let left: [f32x8; N] = core::array::from_fn(|c| results[c] * factor(c));
        (left, left.into_iter().fold(f32x8::ZERO, f32x8::fast_max).simd_le(f32x8::ZERO))
    }
}

/// Spreads and controls of blocks [1/m].
#[inline(always)]
fn residuals(blocks: &Blocks, at: i32x8) -> [f32x8; 2] {
    let at = at.to_array();
    let of: [&Residual; LANES] = per_lane(|lane| &blocks.residuals()[at[lane] as usize]);
    [f32x8::new(per_lane(|lane| of[lane].spread)), f32x8::new(per_lane(|lane| of[lane].control))]
}
