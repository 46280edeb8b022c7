//! ```text
//! for each start a, counted from the light (N = a edges), near enough:
//!     x = tau(L),   crowding = (x / L)^N / M
//!     r += p_A P_l crowding s^3 / cos_light * [ (1 - eps) P_table(N; tau(s), gamma) + eps / room ] (N - 1)! e^x / x^N * turn
//!     turn = 1 / phase  (uniform roll),   2 P(first) 2 pi p(psi) / phase  (aligned),   1 / p_w  (start on a surface)
//! ```
//!
//! 1. One start costs a logarithm, an exponential and four entries of the table, whatever lies between it and the
//!    light. All lanes have the same N at a time, so what depends on N alone is a scalar.
//! 2. `(N - 1)! e^x / x^N = exp(N (y - 1 - ln y) + c_N)` with `y = x / N` and `c_N = N - N ln N + ln (N - 1)!`: the
//!    exponent is small where the bridge is likely, and nothing of the size of N ln N cancels.
//! 3. A single edge has but one end, and P(first) is 1/2.

use wide::f32x8;

use super::ends::Ends;
use super::{Bridge, Roll};
use crate::connect::suffix::{Arrival, Suffix};
use crate::media::MediumX8;
use crate::phase::{PhaseX8, PlaneAngle};

/// Sum of the ratios of `starts`, counted from the light; `room(a)` are the most edges that a bridge from start `a` may
/// have.
#[inline(always)]
pub fn ratios<M: MediumX8>(
    bridge: &Bridge,
    phase: &impl PhaseX8,
    arrival: &Arrival<'_, M>,
    suffix: &Suffix<'_>,
    starts: core::ops::RangeInclusive<usize>,
    room: impl Fn(usize) -> f32x8,
) -> f32x8 {
    let mut sum = f32x8::ZERO;
    let (medium, lobe) = (arrival.medium, phase.lobe());
    let point = suffix.vertices[0].position;
    let longest_squared = f32x8::splat(bridge.max_distance * bridge.max_distance);
    let most_edges = (*starts.end()).min(bridge.max_inserted.saturating_add(1) as usize);
    for a in *starts.start()..=most_edges {
        let start = &suffix.vertices[a];
        let to_light = point - start.position;
        let distance_squared = to_light.length_squared();
        let possible = start.eligible & distance_squared.simd_le(longest_squared);
        let distance = distance_squared.sqrt();
        let axis = to_light.over(distance);

        let arriving = suffix.vertices[a + 1].leaving;
        let turn = match bridge.roll {
            Roll::Aligned => {
                let [before, first] = [arriving, start.leaving].map(|direction| PlaneAngle::between(direction, axis));
                let rolled = phase.rolled_shape([arriving, start.leaving], [before, first]);
                if a == 1 {
                    rolled
                } else {
                    let last = PlaneAngle::between(suffix.vertices[1].leaving, axis);
                    let share = Ends { lobe: &lobe, arriving: before }.share(first, last);
                    rolled * (share + share)
                }
            }
            Roll::Uniform => phase.inverse_shape(arriving, start.leaving),
        };
        let turn = start.on_surface.select(start.inverse_density / phase.scale(), turn);
        let straight = medium.optical_depth(start.position, point, distance);
        let tabled = |depth: f32x8| {
            let cell = bridge.counts.cell(depth, lobe.h(arriving, axis), start.on_surface);
            bridge.counts.probability(a, &cell)
        };
        let uniform = f32x8::splat(bridge.defensive) / room(a);
        let count = match arrival.hues {
            None => f32x8::splat(1.0 - bridge.defensive).mul_add(tabled(straight), uniform),
            Some(hues) => {
                let counts = hues
                    .depths(straight)
                    .map(|depth| f32x8::splat(1.0 - bridge.defensive).mul_add(tabled(depth), uniform));
                hues.mean(suffix.shares[a], counts)
            }
        };
        let way = arrival.way(start);
        let crowding = medium.crowding(a, way.arc, way.depth, way.log_extinction);
        let likelihood = suffix.likelihoods[a].inverse(way.depth, crowding.log);
        let crowded = crowding.scale * distance;
        let ratio = start.attempt * count * likelihood * distance_squared * crowded * turn;
        let most = f32x8::splat(bridge.max_depth) * arrival.medium.over_clearest();
        let possible = if M::VARIES { possible & straight.simd_le(most) } else { possible };
        sum += possible.select(ratio, f32x8::ZERO);
    }
    sum * phase.scale() * arrival.inverse_area / arrival.cos_light
}
