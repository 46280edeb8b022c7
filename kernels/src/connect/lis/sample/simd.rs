//! ```text
//! vertex: y = x_n + t d,   d drawn in proportion to the emission at x_n,   t = -ln(1 - u) / mu_t
//!         keep if |y - x| <= max_distance
//! join:   chain = .. y,   point = x_n
//! ```
//!
//! 1. Connections are packed in place: rows are written no farther than they have been read.

use wide::f32x8;

use super::{JoinColumns, VertexColumns};
use crate::columns::queues::{CandidateBatch, EndBatch};
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::transcendental::neg_ln;
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
        let uniforms @ [_, _, flight, _] = sequence.uniforms(random::LIS_VERTEX);
        let direction = lights.emit(&emitter.to_array(), end, uniforms);
        let flight = neg_ln(f32x8::ONE - flight) * mean_free_path;
        let point = direction.mul_add(flight, end);
        let near = (point - start).length_squared().simd_le(reach_squared);
        let keep = lanes::bits(near) & lanes::first(count - b * LANES);
        connections.push_batch(keep, CandidateBatch { point, ..connection });
        ends.push_batch(keep, EndBatch { lane, point: end });
    }
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
