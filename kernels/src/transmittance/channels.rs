//! Where channels are [apart](crate::media::field::Apart): the transmittances of one after the other, each through a field
//! of its own; where flights have got through, those of the rows of one hero.

use wide::{f32x8, u32x8};

use super::Columns;
use super::simd::vertex;
use crate::Step;
use crate::lanes::{self, LANES};
use crate::media::field::tracking::RaysX8;
use crate::media::field::{Apart, Unknown};
use crate::random::{self, Stream};

/// The whole stage.
pub(super) fn estimate(step: Step, mut columns: Columns<'_, '_>, apart: &Apart) {
    for segment in 0..=columns.bucket.inserted {
        if columns.flown {
            apart.beyond_flights().for_each(|unknown| multiply(step, &mut columns, segment, unknown));
        } else {
            apart.transmittances().for_each(|unknown| multiply(step, &mut columns, segment, unknown));
        }
    }
}

/// Multiplies the factors of one channel by what one segment lets through.
fn multiply(step: Step, columns: &mut Columns<'_, '_>, segment: usize, unknown: Unknown<'_>) {
    let Columns { bucket, purpose, candidates, chains, paths, immersion, estimates, worth, .. } = columns;
    let block = random::TRANSMITTANCE.nth(purpose.number());
    let [from, to] = [segment, segment + 1].map(|number| vertex(number, *bucket, candidates, chains));
    let asked = |b: usize| unknown.asked(immersion.hero.gather(&candidates.lane.batch(b).to_array()));
    let factors = &mut worth.factor.channels_mut()[unknown.channel];
    let weights = &worth.weight;
    let counting = |b: usize, rows: u32, factor: f32x8| {
        let counts = !weights.batch(b).simd_eq(f32x8::ZERO) & !factor.simd_eq(f32x8::ZERO);
        counts & lanes::mask(rows & asked(b))
    };
    let rays = bucket.batches().map(|(b, rows)| {
        let of = candidates.lane.batch(b).to_array();
        let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.gather(&of));
        let block = random::block(u32x8::splat(step.clock) - birth, block);
        let origin = from.batch(b);
        RaysX8 {
            first: LANES * b,
            live: lanes::bits(counting(b, rows, factors.batch(b))),
            origin,
            direction: to.batch(b) - origin,
            stream: Stream::new_x8(pixel, sample, block, step.seed, segment as u32),
            hues: [f32x8::ONE],
        }
    });
    unknown.estimate(rays, &mut estimates.product, &mut estimates.depth);
    for (b, rows) in bucket.batches() {
        let (from, to, before) = (from.batch(b), to.batch(b), factors.batch(b));
        let counts = counting(b, rows, before);
        if counts.any() {
            let through = unknown.factor(b, estimates, from, to, (to - from).length_squared().sqrt());
            factors.set_batch(b, counts.select(before * through, before));
        }
    }
}
