//! ```text
//! survival = min(1, C / threshold),   C = weight * max over channels of Le T albedo^inserted
//! weight   = u < survival ? weight / survival : 0
//! ```
//!
//! 1. Batches in which nothing is faint need no random numbers.

use wide::f32x8;

use super::{Columns, Threshold};
use crate::connect::sequence::Sequence;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, threshold: Threshold, step: Step, columns: Columns<'_, '_>) {
    let Columns { bucket, candidates, paths } = columns;
    let inserted = medium.albedo.map(|albedo| albedo.powi(bucket.inserted as i32));
    let inverse_threshold = f32x8::splat(1.0 / threshold.contribution);
    for (b, rows) in bucket.batches() {
        let (lane_of, emitter_of) = (candidates.lane.batch(b).to_array(), candidates.emitter.batch(b).to_array());
        let weight = candidates.weight.batch(b);
        let mut brightest = f32x8::ZERO;
        for (channel, inserted) in inserted.into_iter().enumerate().take(paths.channels) {
            let emitted = lights.gather(&emitter_of, |disk| disk.radiance[channel]);
            let throughput = paths.columns.throughput.channels()[channel].gather(&lane_of);
            brightest = brightest.fast_max(emitted * throughput * f32x8::splat(inserted));
        }
        let survival = weight * brightest * inverse_threshold;
        let faint = survival.simd_lt(f32x8::ONE);
        if lanes::bits(faint) & rows == 0 {
            continue;
        }
        let [.., u] = Sequence::new(step, paths, &lane_of).uniforms(threshold.purpose);
        let kept = u.simd_lt(survival).select(weight / survival, f32x8::ZERO);
        candidates.weight.set_batch(b, faint.select(kept, weight));
    }
}
