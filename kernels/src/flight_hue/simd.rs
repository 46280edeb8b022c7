//! ```text
//! T_c *= product_c e^{(k_c - k_h) (tau~ - known)}
//! ```
//!
//! 1. All flights of live paths go through the tracker, those that end on surfaces among them.
//! 2. Their tau~ is found for whole batches afterwards.
//! 3. Where channels are [apart](crate::media::field::Apart), they follow one after the other.

use wide::u32x8;

use super::{Columns, channels};
use crate::columns::paths::PathColumns;
use crate::columns::queues::EstimateColumns;
use crate::lanes::LANES;
use crate::media::MediumX8;
use crate::media::field::FieldX8;
use crate::media::field::tracking::RaysX8;
use crate::media::field::tracking::simd::{factor, transmittances};
use crate::media::spectral::CHANNELS;
use crate::random::{self, Stream};
use crate::transmittance::simd::{hues, hues_x8};
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { live, flight, surface_hits, .. } = columns;
    let length = &mut columns.estimates.length;
    live.each_batch().for_each(|(b, _)| length.set_batch(b, flight.batch(b)));
    for hit in 0..surface_hits.len {
        length.rows_mut()[surface_hits.lane.rows()[hit] as usize] = surface_hits.distance.rows()[hit];
    }
    match columns.field.apart() {
        Some(apart) => channels::estimate(step, columns, apart),
        None => estimate(step, columns),
    }
}

fn estimate(step: Step, columns: Columns<'_, '_>) {
    let Columns { field, live, paths, immersion, vertex, ray, estimates, throughput, .. } = columns;
    let EstimateColumns { product, depth: known, length } = estimates;
    let hues_of = |lane: usize| hues(field, Some(immersion.hero.rows()[lane]));
    let rays = live.each_batch().map(|(b, live)| RaysX8 {
        first: LANES * b,
        live,
        origin: vertex.position.batch(b),
        direction: ray.direction.batch(b) * length.batch(b),
        stream: stream(step, paths, b),
        hues: hues_x8(|lane| hues_of(LANES * b + lane)),
    });
    transmittances(field, rays, |lane, products: [f32; CHANNELS], depth| {
        product.set_row(lane, products);
        known.rows_mut()[lane] = depth;
    });
    for (b, bits) in live.each_batch() {
        let (from, length) = (vertex.position.batch(b), length.batch(b));
        let to = ray.direction.batch(b).mul_add(length, from);
        let depth = FieldX8::of(field).optical_depth_of(bits, from, to, length);
        let (products, known) = (product.batch(b), known.batch(b));
        let hues = hues_x8(|lane| hues_of(LANES * b + lane));
        for (c, product) in [products.x, products.y, products.z].into_iter().enumerate() {
            let channel = &mut throughput.channels_mut()[c];
            let (before, missing) = (channel.batch(b), factor(product, hues[c], known, depth));
            channel.set_batch(b, lanes::mask(bits).select(before * missing, before));
        }
    }
}

/// What estimates of the flights of batch `b` draw from.
#[inline(always)]
pub(super) fn stream(step: Step, paths: &PathColumns<'_>, b: usize) -> [u32x8; 4] {
    let depth = u32x8::splat(step.clock) - paths.birth.batch(b);
    let block = random::block(depth, random::TRACKING);
    Stream::new_x8(paths.pixel.batch(b), paths.sample.batch(b), block, step.seed, 1)
}
