//! ```text
//! vertex: cos theta = u^{1 / (k + 2)},   t = -ln(1 - u) / mu_t
//!         y = x_n + t (cos theta n + sin theta (cos(2 pi v) tangent + sin(2 pi v) bitangent))
//!         on a sphere n is the normal at x_n; where both sides shine it is turned for half of all numbers
//!         keep if |y - x| <= max_distance
//! join:   chain = .. y,   point = x_n
//! ```
//!
//! 1. With `a = -2 ln u / (k + 2)` the cosine is `e^{-a / 2}` and `sin^2 = 1 - e^{-a}`, by its series where a is small: narrow
//!    beams keep the digits of their angle.
//! 2. Connections are packed in place: rows are written no farther than they have been read.

use wide::f32x8;

use super::{JoinColumns, VertexColumns};
use crate::columns::queues::{CandidateBatch, EndBatch};
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::tables::lights::Lights;
use crate::transcendental::{exp, neg_ln, sin_cos_turn};
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes, random};

/// The SIMD kernel; see [`VertexKernel`](super::VertexKernel).
pub fn vertex(step: Step, columns: VertexColumns<'_, '_>) {
    let VertexColumns { medium, lights, lis, paths, connections, ends } = columns;
    let mean_free_path = f32x8::splat((1.0 / f64::from(medium.extinction)) as f32);
    let reach_squared = f32x8::splat(lis.max_distance() * lis.max_distance());
    let count = core::mem::take(&mut connections.len);
    ends.len = 0;
    for b in 0..count.div_ceil(LANES) {
        let connection = connections.batch(b);
        let CandidateBatch { lane, emitter, start, point: end, .. } = connection;
        let sequence = Sequence::new(step, paths, &lane.to_array());
        let [cosine, azimuth, flight, side] = sequence.uniforms(random::LIS_VERTEX);
        let normal = outwards(lights, &emitter.to_array(), end, side);
        let exponent = lights.gather(&emitter.to_array(), |emitter| emitter.exponent);
        let direction = emit(normal, exponent, cosine, azimuth);
        let flight = neg_ln(f32x8::ONE - flight) * mean_free_path;
        let point = direction.mul_add(flight, end);
        let near = (point - start).length_squared().simd_le(reach_squared);
        let keep = lanes::bits(near) & lanes::first(count - b * LANES);
        connections.push_batch(keep, CandidateBatch { point, ..connection });
        ends.push_batch(keep, EndBatch { lane, point: end });
    }
}

/// Unit normals of emitters at `point`, on a side that shines: one of two for the number `side`.
#[inline(always)]
fn outwards(lights: &Lights, emitters: &[u32; LANES], point: Vec3x8, side: f32x8) -> Vec3x8 {
    let normal = lights.normal(emitters, point);
    let back = lights.gather(emitters, |emitter| if emitter.double_sided { 0.5 } else { 0.0 });
    let sign = side.simd_lt(back).select(-f32x8::ONE, f32x8::ONE);
    normal * (sign / normal.length_squared().sqrt())
}

/// Directions about `normal` that follow the emission of lights of this exponent.
#[inline(always)]
fn emit(normal: Vec3x8, exponent: f32x8, u: f32x8, v: f32x8) -> Vec3x8 {
    let (tangent, bitangent) = normal.frame();
    let a = f32x8::splat(2.0) * neg_ln(u) / (exponent + f32x8::splat(2.0));
    let (cosine, sine) = (exp(a * f32x8::splat(-0.5)), one_minus_exp(a).sqrt());
    let (sin, cos) = sin_cos_turn(v);
    normal.mul_add(cosine, tangent.mul_add(sine * cos, bitangent * (sine * sin)))
}

/// `1 - e^{-a}` for a >= 0, accurate relative to itself.
#[inline(always)]
fn one_minus_exp(a: f32x8) -> f32x8 {
    let series =
        (2..=8).rev().fold(f32x8::ONE, |sum, k| (a * f32x8::splat(1.0 / k as f32)).mul_neg_add(sum, f32x8::ONE));
    a.simd_lt(f32x8::splat(0.5)).select(a * series, f32x8::ONE - exp(-a))
}

/// The SIMD kernel; see [`JoinKernel`](super::JoinKernel).
pub fn join(_: Step, columns: JoinColumns<'_, '_>) {
    let JoinColumns { buckets, ends, candidates, chains } = columns;
    for bucket in buckets.buckets() {
        for (b, _) in bucket.batches() {
            chains.vertices[bucket.inserted].set_batch(b, candidates.point.batch(b));
            candidates.point.set_batch(b, ends.point.gather(&buckets.order.batch(b).to_array()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_minus_exp_keeps_its_digits() {
        for a in [1e-12, 1e-7, 3e-4, 0.1, 0.4999, 0.5, 0.7, 3.0, 17.0_f32] {
            let (found, expected) = (one_minus_exp(f32x8::splat(a)).to_array()[0], -(-f64::from(a)).exp_m1());
            assert!((f64::from(found) / expected - 1.0).abs() < 3e-7, "{a}: {found}, not {expected}");
        }
    }
}
