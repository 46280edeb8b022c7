//! Where channels are [apart](crate::media::field::Apart): for each hero the two others one after the other, each through
//! the field of what it has more or less than the hero.

use wide::f32x8;

use super::Columns;
use super::simd::stream;
use crate::lanes::LANES;
use crate::media::field::tracking::RaysX8;
use crate::media::field::{Apart, Unknown};
use crate::{Step, lanes};

/// The whole stage, once lengths are known.
pub(super) fn estimate(step: Step, mut columns: Columns<'_, '_>, apart: &Apart) {
    apart.beyond_flights().for_each(|unknown| multiply(step, &mut columns, unknown));
}

/// Multiplies one channel of the paths of one hero by what is missing.
fn multiply(step: Step, columns: &mut Columns<'_, '_>, unknown: Unknown<'_>) {
    let Columns { live, paths, immersion, vertex, ray, estimates, throughput, .. } = columns;
    let channel = &mut throughput.channels_mut()[unknown.channel];
    let asked = |(b, live): (usize, u32)| (b, live & unknown.asked(immersion.hero.batch(b)));
    let rays = live.each_batch().map(asked).map(|(b, live)| RaysX8 {
        first: LANES * b,
        live,
        origin: vertex.position.batch(b),
        direction: ray.direction.batch(b) * estimates.length.batch(b),
        stream: stream(step, paths, b),
        hues: [f32x8::ONE],
    });
    unknown.estimate(rays, &mut estimates.product, &mut estimates.depth);
    for (b, bits) in live.each_batch().map(asked).filter(|(_, bits)| *bits != 0) {
        let (from, length) = (vertex.position.batch(b), estimates.length.batch(b));
        let missing = unknown.factor(b, estimates, from, ray.direction.batch(b).mul_add(length, from), length);
        let before = channel.batch(b);
        channel.set_batch(b, lanes::mask(bits).select(before * missing, before));
    }
}
