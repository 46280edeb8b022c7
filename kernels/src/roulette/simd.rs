//! ```text
//! survival = min(1, C / threshold),   C = weight * max over channels of factor Le T
//! weight   = u < survival ? weight / survival : 0
//! ```
//!
//! 1. Batches in which nothing is faint need no random numbers.

use wide::f32x8;

use super::Columns;
use crate::connect::sequence::Sequence;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, threshold, bucket, candidates, paths, throughput, worth } = columns;
    let inverse_threshold = f32x8::splat(1.0 / threshold.contribution);
    for (b, rows) in bucket.batches() {
        let (lane_of, emitter_of) = (candidates.lane.batch(b).to_array(), candidates.emitter.batch(b).to_array());
        let weight = worth.weight.batch(b);
        let mut brightest = f32x8::ZERO;
        for (channel, (throughput, factor)) in throughput.channels().iter().zip(worth.factor.channels()).enumerate() {
            let emitted = lights.gather(&emitter_of, |emitter| emitter.radiance[channel]);
            brightest = brightest.fast_max(emitted * throughput.gather(&lane_of) * factor.batch(b));
        }
        let drawn = || {
            let [.., u] = Sequence::new(step, paths, &lane_of).uniforms(threshold.purpose);
            u
        };
        worth.weight.set_batch(b, play(weight, weight * brightest * inverse_threshold, rows, drawn));
    }
}

/// The weights of eight candidates after a roulette that they survive with these probabilities, if those are below 1; by
/// numbers that are `drawn` if that is so of any of the `rows` in use.
#[inline(always)]
pub(crate) fn play(weight: f32x8, survival: f32x8, rows: u32, drawn: impl FnOnce() -> f32x8) -> f32x8 {
    let faint = survival.simd_lt(f32x8::ONE);
    if lanes::bits(faint) & rows == 0 {
        return weight;
    }
    let kept = drawn().simd_lt(survival).select(weight / survival, f32x8::ZERO);
    faint.select(kept, weight)
}
