//! ```text
//! flight outlasted by 1 - u of all flights       u, v: first and last word of the SEGMENT block at the path's depth
//! end the path if v >= survival, unless its vertex is the camera
//! ```
//!
//! 1. The numbers `u` and `1 - u` have the same distribution, but only `1 - u` keeps the flight short where `u` is
//!    small.
//! 2. Flights are drawn for whole batches, dying paths included.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::media::{MediumLanes, MediumX8};
use crate::random::{self, uniform_x8};
use crate::{Step, lanes, with_medium};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    with_medium!(columns.medium, |medium| sample(step, columns, medium));
}

#[inline(always)]
fn sample(step: Step, columns: Columns<'_, '_>, medium: impl MediumLanes) {
    let Columns { walk, live, paths, immersion, flights, .. } = columns;
    let n = live.batches();
    let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.view(n));
    let hero = immersion.hero.view(n);
    let flight = flights.flight.view_mut(n);
    let [cosine, azimuth] = [&mut flights.cosine, &mut flights.azimuth].map(|column| column.view_mut(n));
    let survival = f32x8::splat(walk.survival);
    for b in 0..n {
        if live.batch(b) == 0 {
            continue;
        }
        let depth = u32x8::splat(step.clock) - birth[b];
        let block = random::block_x8(depth, random::SEGMENT);
        let words = random::words_x8(pixel[b], sample[b], block, step.seed);
        flight[b] = medium.in_channel(|| hero[b]).flight(f32x8::ONE - uniform_x8(words[0]));
        (cosine[b], azimuth[b]) = (words[1], words[2]);
        if walk.survival < 1.0 {
            let ends = uniform_x8(words[3]).simd_ge(survival) & lanes::as_mask(depth.simd_gt(u32x8::splat(0)));
            live.remove_batch(b, lanes::bits(ends));
        }
    }
}
