//! ```text
//! if lengths.min <= depth + inserted + 1 <= lengths.max:
//!     radiance += weight factor Le T          per channel
//! ```
//!
//! 1. Products are taken for eight rows; sums go to the lanes one by one, in row order, so that a path's radiance does
//!    not depend on its neighbours.
//! 2. Emission and throughput are finite (the weight of a first flight is at most one over the share of free ones), so
//!    only weight and factor can fail to be: an estimated transmittance over what the weight took it for has no bound.
//! 3. Paths of every length up to the longest are made and none longer, so only the lower limit is tested, and only
//!    where there is one.
//! 4. Parts of the radiance are asked for rarely. They are added to one by one, by the same contributions.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::Column;
use crate::lanes::LANES;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let lights = columns.lights;
    match lights.emitters() {
        [only] => add(step, columns, |_, channel| f32x8::splat(only.radiance[channel])),
        _ => add(step, columns, |emitters, channel| lights.gather(emitters, |emitter| emitter.radiance[channel])),
    }
}

/// Adds contributions, where `emitted` is the radiance of eight emitters in a channel.
#[inline(always)]
fn add(step: Step, columns: Columns<'_, '_>, emitted: impl Fn(&[u32; LANES], usize) -> f32x8) {
    let Columns { lengths, bucket, candidates, worth, paths, throughput, .. } = columns;
    let Columns { radiance, origin, parts, dropped, .. } = columns;
    let has_parts = !parts.is_empty();
    for (b, rows) in bucket.batches() {
        let (lane_of, emitter_of) = (candidates.lane.batch(b).to_array(), candidates.emitter.batch(b).to_array());
        let weight = worth.weight.batch(b);
        let mut counts = lanes::bits(!weight.simd_eq(f32x8::ZERO)) & rows;
        if lengths.min > 1 {
            let depth = u32x8::splat(step.clock) - paths.birth.gather(&lane_of);
            let segments = depth + u32x8::splat(bucket.inserted as u32 + 1);
            counts &= lanes::bits(lanes::as_mask(segments.simd_ge(u32x8::splat(lengths.min))));
        }
        let finite = |factor: &Column<'_, f32>| lanes::bits((weight * factor.batch(b)).is_finite());
        let lost = counts & !worth.factor.channels().iter().map(finite).fold(lanes::ALL, |all, channel| all & channel);
        for lane in lanes::each(lost).map(|i| lane_of[i] as usize) {
            dropped.note(paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        }
        for (channel, radiance) in radiance.channels_mut().iter_mut().enumerate() {
            let emitted = emitted(&emitter_of, channel);
            let throughput = throughput.channels()[channel].gather(&lane_of);
            let contribution = (weight * emitted * throughput * worth.factor.channels()[channel].batch(b)).to_array();
            let radiance = radiance.rows_mut();
            if counts & !lost == lanes::ALL {
                (0..LANES).for_each(|i| radiance[lane_of[i] as usize] += contribution[i]);
            } else {
                lanes::each(counts & !lost).for_each(|i| radiance[lane_of[i] as usize] += contribution[i]);
            }
            if has_parts {
                for (i, lane) in lanes::each(counts & !lost).map(|i| (i, lane_of[i] as usize)) {
                    let segments = paths.depth_of(step.clock, lane) + bucket.inserted as u32 + 1;
                    parts.of(origin, segments).for_each(|part| {
                        part.channels_mut()[channel].rows_mut()[lane] += contribution[i];
                    });
                }
            }
        }
    }
}
