//! ```text
//! if cos > 0:                                     the ray sees what shines
//!     depth == 0: push view with weight exp(-mu_t distance)
//!     depth >= 1: push light hit
//! if distance < flight and the light is no part of a surface: the path ends
//! ```
//!
//! 1. Rows are few and scattered over the lanes, so they are gathered.
//! 2. Camera rays may be listed although their flight is shorter: those paths go on.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::LANES;
use crate::columns::queues::CandidateBatch;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;
use crate::transcendental::exp;
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, step: Step, columns: Columns<'_, '_>) {
    let Columns { hits, vertices, rays, flights, paths, views, light_hits } = columns;
    let origins = &vertices.at(step.clock).position;
    let (now, before) = (&rays.at(step.clock).direction, &rays.at(step.clock - 1).direction);
    for b in 0..hits.len.div_ceil(LANES) {
        let rows = lanes::first(hits.len - b * LANES);
        let (lane, emitter, distance) = (hits.lane.batch(b), hits.emitter.batch(b), hits.distance.batch(b));
        let (lane_of, emitter_of) = (lane.to_array(), emitter.to_array());
        let (start, direction) = (origins.gather(&lane_of), now.gather(&lane_of));
        let arriving = before.gather(&lane_of);
        let birth = paths.columns.birth.gather(&lane_of);
        let at_camera = lanes::bits(lanes::as_mask(birth.simd_eq(u32x8::splat(step.clock))));
        let point = direction.mul_add(distance, start);
        let cosine = lights.cosine(&emitter_of, point, direction);
        let front = lanes::bits(cosine.simd_gt(f32x8::ZERO)) & rows;

        let profile = lights.profile(&emitter_of, cosine);
        let weight = exp(-f32x8::splat(medium.extinction) * distance) * profile;
        let view = CandidateBatch { lane, emitter, start, arriving: Vec3x8::ZERO, point, weight };
        views.push_batch(front & at_camera, view);
        light_hits.push_batch(front & !at_camera, CandidateBatch { arriving, weight: f32x8::ZERO, ..view });

        let black = lights.gather(&emitter_of, |emitter| emitter.radius).simd_gt(f32x8::ZERO);
        let ends = lanes::bits(distance.simd_le(flights.flight.gather(&lane_of)) & black) & rows;
        for i in lanes::each(ends) {
            paths.live.remove(lane_of[i]);
        }
    }
}
