//! Rays through a ball or a box of one extinction and what is around it, of which everything is known.
//!
//! ```text
//! [t0, t1]: the part of the ray in the shape, of extinction mu;     mu_a: extinction around it
//! budget: mean free paths that are left
//! flight:        budget / mu_a                                              if budget < mu_a t0
//!                t0 + (budget - mu_a t0) / mu                               if that is below t1
//!                t1 + (budget - mu_a t0 - mu (t1 - t0)) / mu_a              otherwise: endless in vacuum
//! transmittance: e^{-length (mu (t1 - t0) + mu_a (1 - (t1 - t0)))}
//! ```

use wide::f32x8;

use super::{FlightsX8, RaysX8};
use crate::lanes;
use crate::media::field::Field;
use crate::media::field::known::OneShape;
use crate::vec3::Vec3x8;

/// The part of rays within the shape; nothing of it at their `end` where they miss it.
#[inline(always)]
fn part(field: &Field, shape: &OneShape, origin: Vec3x8, direction: Vec3x8, end: f32x8) -> [f32x8; 2] {
    let (start, way) = (field.in_cells(origin), field.to_cells.directions(direction));
    let [enter, exit] = shape.part(start, way, end);
    let hits = enter.simd_lt(exit);
    [hits.select(enter, end), hits.select(exit, end)]
}

/// The lengths of the flights of a batch.
#[inline(always)]
pub(super) fn flights(field: &Field, shape: &OneShape, batch: &FlightsX8) -> f32x8 {
    let infinity = f32x8::splat(f32::INFINITY);
    let [enter, exit] = part(field, shape, batch.origin, batch.direction, infinity);
    let missed = enter.simd_eq(infinity);
    let scale = batch.direction.length_squared().sqrt() * batch.hue;
    let [within, around] = [shape.extinction, field.around()].map(|extinction| f32x8::splat(extinction) * scale);

    let early = if field.around() > 0.0 { batch.budget.simd_lt(around * enter) } else { f32x8::ZERO };
    let before = if field.around() > 0.0 { around * enter } else { f32x8::ZERO };
    let left = batch.budget - before;
    let depth = missed.select(f32x8::ZERO, within * (exit - enter));
    let inside = left.simd_lt(depth);
    let after = (left - depth) / around; // in vacuum: without end, as is an exit that is never reached
    early.select(batch.budget / around, inside.select(enter + left / within, exit + after))
}

/// Hands what is known of every segment of a batch to `end`.
#[inline(always)]
pub(super) fn transmittances<const N: usize>(
    field: &Field,
    shape: &OneShape,
    batch: &RaysX8<N>,
    end: &mut impl FnMut(usize, [f32; N], f32),
) {
    let [enter, exit] = part(field, shape, batch.origin, batch.direction, f32x8::ONE);
    let share = exit - enter;
    let mean = f32x8::splat(shape.extinction - field.around()).mul_add(share, f32x8::splat(field.around()));
    let depth = (mean * batch.direction.length_squared().sqrt()).to_array();
    lanes::each(batch.live).for_each(|lane| end(batch.first + lane, [1.0; N], depth[lane]));
}
