//! The choice among several lights for eight rows: probabilities `P_l(x)` and the draw.
//!
//! ```text
//! uniform, intensity:   P_l = share_l
//! intensity/distance:   P_l(x) = share_l / |x - c_l| / sum(x),   sum(x) = sum_k share_k / |x - c_k|
//! draw: the first l with u < P_0 + .. + P_l
//! ```

use wide::{f32x8, u32x8};

use crate::tables::lights::{Choices, LEAST_SELECTION_DISTANCE, Lights};
use crate::vec3::Vec3x8;

/// One over the distance from `position` to `center` [1/m], capped.
#[inline(always)]
fn inverse_distance(position: Vec3x8, center: Vec3x8) -> f32x8 {
    let distance = (position - center).length_squared().sqrt();
    f32x8::ONE / distance.fast_max(f32x8::splat(LEAST_SELECTION_DISTANCE))
}

/// What the probability of light `index` is proportional to, at `position`.
#[inline(always)]
fn score(lights: &Lights, index: usize, position: Vec3x8) -> f32x8 {
    let light = &lights.lights()[index];
    let share = f32x8::splat(light.share);
    if lights.selection_depends_on_start() {
        share * inverse_distance(position, Vec3x8::splat(light.center))
    } else {
        share
    }
}

/// The normalisation of the choice at `position`; 1 where it does not depend on it.
#[inline(always)]
pub fn light_sum(lights: &Lights, position: Vec3x8) -> f32x8 {
    if !lights.selection_depends_on_start() {
        return f32x8::ONE;
    }
    (0..lights.lights().len()).fold(f32x8::ZERO, |sum, index| sum + score(lights, index, position))
}

/// Rows from which some light may be within `limit` `[m]`, with a margin of 10^-4: rounding never hides a light.
#[inline(always)]
pub fn may_be_within(lights: &Lights, limit: f32, position: Vec3x8) -> f32x8 {
    const MARGIN: f32 = 1.0 + 1e-4;
    lights.lights().iter().fold(f32x8::ZERO, |near, light| {
        let limit = (limit + light.radius) * MARGIN;
        let distance_squared = (position - Vec3x8::splat(light.center)).length_squared();
        near | distance_squared.simd_le(f32x8::splat(limit * limit))
    })
}

/// Draws a light from the uniform number `u`, with `sum` from [`light_sum`].
#[inline(always)]
pub fn choose(lights: &Lights, position: Vec3x8, sum: f32x8, u: f32x8) -> u32x8 {
    let goal = u * sum;
    let (mut below, mut chosen) = (f32x8::ZERO, u32x8::splat(0));
    for index in 0..lights.lights().len() - 1 {
        below += score(lights, index, position);
        let beyond: u32x8 = bytemuck::cast(goal.simd_ge(below));
        chosen -= beyond; // a mask of all ones is -1
    }
    chosen
}

/// Probability of choosing the lights of emitters from `position`, with `sum` from [`light_sum`].
#[inline(always)]
pub fn probability(lights: &Lights, emitters: &Choices, position: Vec3x8, sum: f32x8) -> f32x8 {
    let Choices { center, share, .. } = *emitters;
    if lights.selection_depends_on_start() { share * inverse_distance(position, center) / sum } else { share }
}
