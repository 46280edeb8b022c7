//! ```text
//! vertex: y = x_n + t d,   d drawn in proportion to the emission at x_n,   tau~(t) = -ln(1 - u) along the ray
//!         keep if |y - x| <= max_distance,   and mu_t(y) > 0 where extinction varies
//! join:   chain = .. y,   point = x_n
//! ```
//!
//! 1. Connections are packed in place: rows are written no farther than they have been read.
//! 2. Flights that never end have no vertex, and none that is far beyond all numbers is asked about.

use wide::f32x8;

use super::{JoinColumns, VertexColumns};
use crate::columns::queues::{CandidateBatch, EndBatch};
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::media::{AxisX8, MediumLanes, MediumX8};
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, random, with_medium};

/// The SIMD kernel; see [`VertexKernel`](super::VertexKernel).
pub fn vertex(step: Step, columns: VertexColumns<'_, '_>) {
    with_medium!(columns.medium, |medium| make(step, columns, medium));
}

#[inline(always)]
fn make<M: MediumLanes>(step: Step, columns: VertexColumns<'_, '_>, medium: M) {
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
        let mut ray = medium.ray(end, direction);
        let mut point = direction.mul_add(ray.advance(neg_ln(f32x8::ONE - flight)), end);
        let mut ends_well = lanes::mask(lanes::ALL);
        if M::Channel::VARIES {
            let ends_somewhere = ray.reached().simd_gt(f32x8::ZERO);
            point = Vec3x8::select(ends_somewhere, point, end);
            ends_well = ends_somewhere & medium.extinction(point).simd_gt(f32x8::ZERO);
        }
        let near = (point - start).length_squared().simd_le(longest_squared);
        let keep = lanes::bits(near & ends_well) & lanes::first(count - b * LANES);
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
