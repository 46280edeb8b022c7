//! ```text
//! P = (1 - share) e^{-c mu_t d} + share beyond,      beyond = sum_l share_l atan2(D, d - delta) / span
//! weight = 1 / ((1 - share) e^{(1 - c) mu_t d} + share beyond e^{mu_t d})
//! ```
//!
//! Hits are gathered; rows of paths that did not just leave the camera keep what they have.

use wide::f32x8;

use super::Columns;
use crate::first_flight::Aim;
use crate::first_flight::simd::Sight;
use crate::lanes::LANES;
use crate::media::{MediumLanes, MediumX8};
use crate::transcendental::exp;
use crate::{Step, lanes, with_homogeneous};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    with_homogeneous!(columns.medium, |medium| weigh(columns, medium));
}

#[inline(always)]
fn weigh<M: MediumLanes>(columns: Columns<'_, '_>, medium: M) {
    let Columns { lights, aim, requested, surface_hits, vertex, ray, weight, density: densities, .. } = columns;
    let Aim { share, thinned } = aim;
    let (share, free) = (f32x8::splat(share), f32x8::splat(1.0 - share));
    for b in 0..surface_hits.len.div_ceil(LANES) {
        let count = (surface_hits.len - b * LANES).min(LANES);
        let lane_of = surface_hits.lane.batch(b).to_array();
        let first = requested.among(&lane_of, count);
        if first == 0 {
            continue;
        }
        let first = lanes::mask(first);
        let (origin, direction) = (vertex.position.gather(&lane_of), ray.direction.gather(&lane_of));
        let distance = surface_hits.distance.batch(b);
        let end = direction.mul_add(distance, origin);
        let mut beyond = f32x8::ZERO;
        for light in lights.lights() {
            beyond += f32x8::splat(light.intensity) * Sight::new(light, origin, direction).probability(distance);
        }
        if !M::COLOURED {
            let depth = medium.channel(0).optical_depth(origin, end, distance);
            let not_aimed = free * exp(depth * f32x8::splat(1.0 - thinned));
            let quotient = f32x8::ONE / (share * beyond).mul_add(exp(depth), not_aimed);
            weight.scatter(&lane_of, count, first.select(quotient, weight.gather(&lane_of)));
            continue;
        }
        for (densities, c) in densities.channels_mut().iter_mut().zip(0..) {
            let depth = medium.channel(c).optical_depth(origin, end, distance);
            let mixed = share.mul_add(beyond, free * exp(-depth * f32x8::splat(thinned)));
            densities.scatter(&lane_of, count, first.select(mixed, densities.gather(&lane_of)));
        }
    }
}
