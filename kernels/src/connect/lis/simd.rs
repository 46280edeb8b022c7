//! ```text
//! y = vertex next to the light, at arc t
//! scale = p_A (k + 2) / (2 pi) cos^k theta / phase(c_y),    half of it where both sides shine
//!         * mu~(t) e^{tau~(y, x_n) - tau~(t)} / mu_t(y)      where extinction varies
//! r     = scale * ratios of the connector on the suffix that ends at y: sums less those of the segment from y
//! ```
//!
//! 1. The connector's own kernel sees the suffix from y on, as if y were the light point: `scale` stands in the place
//!    of p_A, and 1 in that of cos_light.
//! 2. p_dir / cos theta is one power, so that grazing light needs no division.
//! 3. mu~(t) and tau~(t) are those of the ray from x_n through y, once per candidate: starts share them.
//! 4. Rows without a start have no vertex before y. What stands in its place, and with it the quotient of extinctions,
//!    is anything, even beyond all numbers, so their scale is 0.

use core::ops::RangeInclusive;

use wide::f32x8;

use super::{Connector, Lis};
use crate::connect::suffix::{Arrival, Passage, Suffix};
use crate::connect::{bridge, mvnee};
use crate::media::{AxisX8, MediumX8};
use crate::phase::PhaseX8;
use crate::transcendental::{exp, neg_ln};

/// Sum of the ratios of all `starts`, >= 2, counted from the light; `room(a)` are the most edges from start `a` to the
/// vertex made from the light.
#[inline(always)]
pub fn ratios<M: MediumX8>(
    lis: &Lis,
    phase: &impl PhaseX8,
    emission: f32x8,
    arrival: &Arrival<'_, M>,
    suffix: &mut Suffix<'_>,
    starts: RangeInclusive<usize>,
    room: impl Fn(usize) -> f32x8,
) -> f32x8 {
    let [_, vertex, before, ..] = &suffix.vertices[..] else {
        return f32x8::ZERO;
    };
    let flight = Flight::new(arrival, suffix);
    let hues = arrival.hues.map(|hues| hues.after_flight(flight.depth));
    let mut scale = arrival.inverse_area * emission * vertex.inverse_density;
    if M::VARIES {
        let has_start = suffix.vertices[starts.clone()].iter().fold(f32x8::ZERO, |any, start| any | start.eligible);
        scale = has_start.select(scale * flight.quotient, f32x8::ZERO);
    }
    let arrival = &Arrival {
        medium: arrival.medium,
        hues: hues.as_ref(),
        inverse_area: scale,
        last_squared: (vertex.position - before.position).length_squared(),
        // Nobody asks for it beyond the companion.
        last_depth: f32x8::ZERO,
        cos_light: f32x8::ONE,
        last_arc: f32x8::ZERO,
        skipped: Passage { depth: arrival.last_depth, log_extinction: before.log_extinction },
    };
    let suffix = &mut Suffix {
        vertices: &mut suffix.vertices[1..],
        projections: suffix.projections,
        likelihoods: suffix.likelihoods,
        shares: &mut suffix.shares[1..],
        apart: &mut suffix.apart[1..],
    };
    let starts = starts.start() - 1..=starts.end() - 1;
    match &lis.connector {
        Connector::Bridge(bridge) => bridge::simd::ratios(bridge, phase, arrival, suffix, starts, |a| room(a + 1)),
        Connector::Mvnee(mvnee) => mvnee::simd::ratios(mvnee, arrival, suffix, starts),
    }
}

/// The flight from the light to the vertex made there, in the row's own channel.
struct Flight {
    /// Optical depth that it passes, as its density has it.
    depth: f32x8,
    /// That density over the one of a walk that comes from the vertex to the light; 1 in a homogeneous medium.
    quotient: f32x8,
}

impl Flight {
    #[inline(always)]
    fn new<M: MediumX8>(arrival: &Arrival<'_, M>, suffix: &Suffix<'_>) -> Self {
        if !M::VARIES {
            return Self { depth: arrival.last_depth, quotient: f32x8::ONE };
        }
        let [point, vertex, before] = [0, 1, 2].map(|a| &suffix.vertices[a]);
        let length = arrival.last_squared.sqrt();
        let ray = arrival.medium.ray(point.position, -vertex.leaving);
        let [depth, _] = ray.depths(length, f32x8::splat(f32::INFINITY));
        let extinction = ray.extinction(length);
        let log = arrival.last_depth - depth - arrival.medium.log_extinction_along(1, before.log_extinction);
        // No flight ends where the ray has no extinction.
        let ends = extinction.simd_gt(f32x8::ZERO);
        Self { depth, quotient: ends.select(exp(log - neg_ln(extinction)), f32x8::ZERO) }
    }
}
