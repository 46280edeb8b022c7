//! ```text
//! if cos > 0:                                     the ray sees what shines
//!     depth == 0: push view with weight share e^{-tau}, factor_k = e^{tau - tau_k} colour_k, tau = min tau_k
//!     depth >= 1: push light hit
//! if distance < flight and the light is no part of a surface: the path ends
//! ```
//!
//! 1. Rows are few and scattered over the lanes, so they are gathered.
//! 2. Camera rays may be listed although their flight is shorter: those paths go on.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::Field;
use crate::columns::queues::CandidateBatch;
use crate::connect::distant;
use crate::lanes::LANES;
use crate::media::{MediumLanes, MediumX8};
use crate::transcendental::exp;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    with_medium!(columns.medium, |medium| meet(step, columns, medium));
}

#[inline(always)]
fn meet<M: MediumLanes>(step: Step, columns: Columns<'_, '_>, medium: M) {
    let Columns { lights, hits, paths, vertex, ray, before, flight, outlined, share, live, .. } = columns;
    let Columns { views, worth, light_hits, .. } = columns;
    for b in 0..hits.len.div_ceil(LANES) {
        let rows = lanes::first(hits.len - b * LANES);
        let (lane, emitter, distance) = (hits.lane.batch(b), hits.emitter.batch(b), hits.distance.batch(b));
        let (lane_of, emitter_of) = (lane.to_array(), emitter.to_array());
        let (start, direction) = (vertex.position.gather(&lane_of), ray.direction.gather(&lane_of));
        let arriving = before.direction.gather(&lane_of);
        let birth = paths.birth.gather(&lane_of);
        let at_camera = lanes::bits(lanes::as_mask(birth.simd_eq(u32x8::splat(step.clock))));
        let point = direction.mul_add(distance, start);
        let cosine = lights.cosine(&emitter_of, point, direction);
        let front = lanes::bits(cosine.simd_gt(f32x8::ZERO)) & rows;

        let view = CandidateBatch { lane, emitter, start, arriving: Vec3x8::ZERO, point };
        let apart = lanes::each(front & at_camera).filter(|i| outlined.contains(lane_of[*i] as usize));
        let seen = front & at_camera & !apart.fold(0, |bits, i| bits | 1 << i);
        if seen != 0 {
            let profile = lights.profile(&emitter_of, cosine);
            let depth = |c: usize| medium.channel(c).optical_depth(start, point, distance);
            let least = if M::COLOURED { depth(0).fast_min(depth(1)).fast_min(depth(2)) } else { depth(0) };
            let order = lanes::pack_order(seen);
            let colour = lights.has_panorama().then(|| distant::simd::see(lights, &emitter_of, direction).colour);
            f32::store_packed(&mut worth.weight, views.len, order, exp(-least) * profile * f32x8::splat(share));
            for (factor, c) in worth.factor.channels_mut().iter_mut().zip(0..) {
                let quotient = if M::COLOURED { exp(least - depth(c)) } else { f32x8::ONE };
                let quotient = colour.map_or(quotient, |colour| quotient * colour[c]);
                f32::store_packed(factor, views.len, order, quotient);
            }
            views.push_batch(seen, view);
        }
        light_hits.push_batch(front & !at_camera, CandidateBatch { arriving, ..view });

        let black = lights.gather(&emitter_of, |emitter| emitter.radius).simd_gt(f32x8::ZERO);
        let ends = lanes::bits(distance.simd_le(flight.gather(&lane_of)) & black) & rows;
        for i in lanes::each(ends) {
            live.remove(lane_of[i] as usize);
        }
    }
}
