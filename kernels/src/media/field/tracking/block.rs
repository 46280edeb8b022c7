//! Rays through one extinction in a box in vacuum, of which everything is known.
//!
//! ```text
//! [t0, t1]: the part of the ray in the box
//! flight:        t0 - ln(1 - u) / (mu length),   if that is below t1;    u: the ray's first number
//! transmittance: e^{-mu length (t1 - t0)}
//! ```

use wide::{f32x8, u32x8};

use super::RaysX8;
use crate::lanes;
use crate::media::field::Field;
use crate::random::{Stream, uniform_x8};
use crate::transcendental::neg_ln;

/// Hands the length of every flight of a batch to `end`.
#[inline(always)]
pub(super) fn flights(field: &Field, extinction: f32, batch: &RaysX8<1>, end: &mut impl FnMut(usize, f32)) {
    let [enter, exit] = field.part(batch.origin, batch.direction, f32x8::splat(f32::INFINITY));
    let [first, ..] = Stream::words_x8(batch.stream, u32x8::splat(0));
    let scale = batch.direction.length_squared().sqrt() * batch.hues[0];
    let way = neg_ln(f32x8::ONE - uniform_x8(first)) / (f32x8::splat(extinction) * scale);
    let collides = enter.simd_lt(exit) & (exit - enter).simd_gt(way);
    let flights = collides.select(enter + way, f32x8::splat(f32::INFINITY)).to_array();
    lanes::each(batch.live).for_each(|lane| end(batch.first + lane, flights[lane]));
}

/// Hands what is known of every segment of a batch to `end`.
#[inline(always)]
pub(super) fn transmittances<const N: usize>(
    field: &Field,
    extinction: f32,
    batch: &RaysX8<N>,
    end: &mut impl FnMut(usize, [f32; N], f32),
) {
    let [enter, exit] = field.part(batch.origin, batch.direction, f32x8::ONE);
    let length = batch.direction.length_squared().sqrt();
    let depth = f32x8::splat(extinction) * length * (exit - enter).fast_max(f32x8::ZERO);
    let depth = depth.to_array();
    lanes::each(batch.live).for_each(|lane| end(batch.first + lane, [1.0; N], depth[lane]));
}
