//! ```text
//! y = vertex next to the light, at arc t
//! scale = p_A (k + 2) / (2 pi) cos^k theta / phase(c_y),    half of it where both sides shine
//! r     = scale * ratios of the connector on the suffix that ends at y, depths less tau(t)
//! ```
//!
//! 1. The connector's own kernel sees the suffix from y on, as if y were the light point: `scale` stands in the place
//!    of p_A, and 1 in that of cos_light.
//! 2. p_dir / cos theta is one power, so that grazing light needs no division.

use core::ops::RangeInclusive;

use wide::f32x8;

use super::{Connector, Lis};
use crate::connect::suffix::{Arrival, Suffix};
use crate::connect::{bridge, mvnee};
use crate::media::MediumX8;
use crate::phase::PhaseX8;

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
    let skipped = arrival.medium.optical_depth_along(vertex.arc, vertex.depth);
    let hues = arrival.hues.map(|hues| hues.after_flight(skipped));
    let arrival = &Arrival {
        medium: arrival.medium,
        hues: hues.as_ref(),
        inverse_area: arrival.inverse_area * emission * vertex.inverse_density,
        last_squared: (vertex.position - before.position).length_squared(),
        // Nobody asks for it beyond the companion.
        last_depth: f32x8::ZERO,
        cos_light: f32x8::ONE,
        skipped,
    };
    let suffix = &mut Suffix {
        vertices: &mut suffix.vertices[1..],
        projections: suffix.projections,
        likelihoods: suffix.likelihoods,
        shares: &mut suffix.shares[1..],
    };
    let starts = starts.start() - 1..=starts.end() - 1;
    match &lis.connector {
        Connector::Bridge(bridge) => bridge::simd::ratios(bridge, phase, arrival, suffix, starts, |a| room(a + 1)),
        Connector::Mvnee(mvnee) => mvnee::simd::ratios(mvnee, arrival, suffix, starts),
    }
}
