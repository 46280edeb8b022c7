//! ```text
//! vertex: y = x_n + t d,   d drawn in proportion to the emission at x_n,   t a free flight
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
use crate::media::MediumLanes;
use crate::media::homogeneous::HomogeneousX8;
use crate::{Step, lanes, random, with_homogeneous};

/// The SIMD kernel; see [`VertexKernel`](super::VertexKernel).
pub fn vertex(step: Step, columns: VertexColumns<'_, '_>) {
    with_homogeneous!(columns.medium, |medium| make(step, columns, medium));
}

#[inline(always)]
fn make(step: Step, columns: VertexColumns<'_, '_>, medium: impl MediumLanes<Channel = HomogeneousX8>) {
    let VertexColumns { lights, lis, paths, immersion, connections, ends, .. } = columns;
    let longest_squared = f32x8::splat(lis.max_distance() * lis.max_distance());
    let count = core::mem::take(&mut connections.len);
    ends.len = 0;
    for b in 0..count.div_ceil(LANES) {
        let connection = connections.batch(b);
        let CandidateBatch { lane, emitter, start, point: end, .. } = connection;
        let lane_of = lane.to_array();
        let sequence = Sequence::new(step, paths, &lane_of);
        let medium = medium.in_channel(|| immersion.hero.gather(&lane_of));
        let uniforms @ [_, _, flight, _] = sequence.uniforms(random::LIS_VERTEX);
        let direction = lights.emit(&emitter.to_array(), end, uniforms);
        let point = direction.mul_add(medium.flight(f32x8::ONE - flight), end);
        let near = (point - start).length_squared().simd_le(longest_squared);
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
