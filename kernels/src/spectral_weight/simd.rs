//! ```text
//! z_c = ln posterior_c + ln p_c,      ln P = ln sum_c e^{z_c}
//! ln posterior_c = z_c - ln P,        T_k = T_k e^{ln f_k - ln P}
//! ```
//!
//! 1. First all lanes that scatter, batch by batch; then, gathered, those that met a surface.
//! 2. The largest z_c is taken out of the sum, so that one term of it is 1.

use wide::f32x8;

use super::Columns;
use crate::columns::Spectrum;
use crate::lanes::LANES;
use crate::media::spectral::CHANNELS;
use crate::media::{MediumLanes, log_event};
use crate::transcendental::{exp, neg_ln};
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    with_medium!(columns.medium, |medium| weigh(columns, medium));
}

#[inline(always)]
fn weigh(columns: Columns<'_, '_>, medium: impl MediumLanes) {
    let Columns { live, on_surface, aimed, density, flight, surface_hits, vertex, ray, .. } = columns;
    let Columns { log_posterior, throughput, .. } = columns;
    for (b, bits) in live.each_batch() {
        let scattered = bits & !on_surface.batch(b);
        if scattered == 0 {
            continue;
        }
        let (start, direction) = (vertex.position.batch(b), ray.direction.batch(b));
        let free = log_densities(medium, start, direction, flight.batch(b), [scattered, lanes::ALL]);
        let drawn = match aimed.map(|aimed| aimed.batch(b)) {
            None | Some(0) => free,
            Some(aimed) => {
                core::array::from_fn(|c| lanes::mask(aimed).select(ln(density.channels()[c].batch(b)), free[c]))
            }
        };
        let before = core::array::from_fn(|c| log_posterior.channels()[c].batch(b));
        let (after, quotients) = update(before, drawn, free);
        for c in 0..CHANNELS {
            blend(log_posterior, c, b, scattered, after[c]);
            let weighed = throughput.channels()[c].batch(b) * quotients[c];
            blend(throughput, c, b, scattered, weighed);
        }
    }
    for b in 0..surface_hits.len.div_ceil(LANES) {
        let count = (surface_hits.len - b * LANES).min(LANES);
        let lane_of = surface_hits.lane.batch(b).to_array();
        let own = lanes::mask(aimed.map_or(0, |aimed| aimed.among(&lane_of, count)));
        let (start, direction) = (vertex.position.gather(&lane_of), ray.direction.gather(&lane_of));
        let length = surface_hits.distance.batch(b);
        let free = log_densities(medium, start, direction, length, [lanes::ALL >> (LANES - count), 0]);
        let drawn = core::array::from_fn(|c| own.select(ln(density.channels()[c].gather(&lane_of)), free[c]));
        let before = core::array::from_fn(|c| log_posterior.channels()[c].gather(&lane_of));
        let (after, quotients) = update(before, drawn, free);
        for c in 0..CHANNELS {
            log_posterior.channels_mut()[c].scatter(&lane_of, count, after[c]);
            let weighed = throughput.channels()[c].gather(&lane_of) * quotients[c];
            throughput.channels_mut()[c].scatter(&lane_of, count, weighed);
        }
    }
}

/// ln of the densities of free flights of these `rows` and this `length` per channel, or, in rows that do not scatter,
/// of the probabilities that they are longer.
#[inline(always)]
fn log_densities(
    medium: impl MediumLanes,
    start: Vec3x8,
    direction: Vec3x8,
    length: f32x8,
    [rows, scatter]: [u32; 2],
) -> [f32x8; CHANNELS] {
    let passed = medium.passed(rows, start, direction.mul_add(length, start), length);
    passed.map(|[depth, extinction]| lanes::mask(scatter).select(log_event(extinction), f32x8::ZERO) - depth)
}

/// ln posterior_c and f_k / P, from ln posterior_c before, ln p_c and ln f_c.
#[inline(always)]
fn update(
    before: [f32x8; CHANNELS],
    drawn: [f32x8; CHANNELS],
    free: [f32x8; CHANNELS],
) -> ([f32x8; CHANNELS], [f32x8; CHANNELS]) {
    let joint: [f32x8; CHANNELS] = core::array::from_fn(|c| before[c] + drawn[c]);
    let top = joint[0].fast_max(joint[1]).fast_max(joint[2]);
    let [x, y, z] = joint.map(|joint| exp(joint - top));
    let sum = top + ln(x + y + z);
    (joint.map(|joint| joint - sum), free.map(|free| exp(free - sum)))
}

#[inline(always)]
fn ln(x: f32x8) -> f32x8 {
    -neg_ln(x)
}

/// Overwrites the rows `bits` of batch `b` of channel `c`.
#[inline(always)]
fn blend(spectrum: &mut Spectrum<'_>, c: usize, b: usize, bits: u32, value: f32x8) {
    let channel = &mut spectrum.channels_mut()[c];
    channel.set_batch(b, lanes::mask(bits).select(value, channel.batch(b)));
}
