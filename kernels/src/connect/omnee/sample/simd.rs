//! ```text
//! theta from the forward part of the phase function
//! alpha = u theta,    d = s sin(theta - alpha) / sin theta
//! vertex = start + d (cos alpha w + sin alpha (cos(2 pi u) tangent + sin(2 pi u) bitangent))
//! ```
//!
//! 1. `sin(theta - alpha) / sin theta = cos alpha - sin alpha cot theta`, which is 1 - u where theta vanishes.

use wide::f32x8;

use super::BuildColumns;
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::phase::PhaseX8;
use crate::random;
use crate::transcendental::sin_cos_turn;
use crate::{Step, with_phase};

/// The SIMD kernel; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_>) {
    with_phase!(&columns.medium.phase, |phase| place(step, columns, phase));
}

#[inline(always)]
fn place(step: Step, columns: BuildColumns<'_, '_>, phase: impl PhaseX8) {
    let BuildColumns { paths, connections, chains, .. } = columns;
    for b in 0..connections.len.div_ceil(LANES) {
        let sequence = Sequence::new(step, paths, &connections.lane.batch(b).to_array());
        let [turn, first, azimuth, _] = sequence.uniforms(random::OMNEE_VERTEX);

        let start = connections.start.batch(b);
        let to_light = connections.point.batch(b) - start;
        let distance = to_light.length_squared().sqrt();
        let axis = to_light * (f32x8::ONE / distance.fast_max(f32x8::splat(1e-30)));
        let deflection = phase.sample_forward(turn);
        let alpha = first * deflection.sine.atan2(deflection.cosine);
        let (sin, cos) = alpha.sin_cos();
        let straight = deflection.sine.simd_le(f32x8::splat(1e-6));
        let part = straight
            .select(f32x8::ONE - first, (sin * deflection.cosine / deflection.sine).mul_neg_add(f32x8::ONE, cos));
        let (sin_azimuth, cos_azimuth) = sin_cos_turn(azimuth);
        let (tangent, bitangent) = axis.frame();
        let across = tangent.mul_add(cos_azimuth, bitangent * sin_azimuth);
        let direction = axis.mul_add(cos, across * sin);
        chains.resampling.set_batch(b, f32x8::ONE);
        chains.vertices[0].set_batch(b, direction.mul_add(distance * part, start));
    }
}
