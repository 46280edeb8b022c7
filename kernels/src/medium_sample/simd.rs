//! ```text
//! flight = -ln(1 - u) / mu_t          u, v: first and last word of the SEGMENT block at the path's depth
//! end the path if v >= survival, unless its vertex is the camera
//! ```
//!
//! 1. The numbers `u` and `1 - u` have the same distribution, but only `1 - u` keeps the flight short where `u` is
//!    small.
//! 2. Uniform numbers are inside (0, 1), so that the endless mean free path of a vacuum makes endless flights.
//! 3. Flights are drawn for whole batches, dying paths included.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::random::{self, uniform_x8};
use crate::transcendental::neg_ln;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, walk, live, paths, flights } = columns;
    let mean_free_path = f32x8::splat((1.0 / f64::from(medium.extinction)) as f32);
    let n = live.batches();
    let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.view(n));
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
        flight[b] = neg_ln(f32x8::ONE - uniform_x8(words[0])) * mean_free_path;
        (cosine[b], azimuth[b]) = (words[1], words[2]);
        if walk.survival < 1.0 {
            let ends = uniform_x8(words[3]).simd_ge(survival) & lanes::as_mask(depth.simd_gt(u32x8::splat(0)));
            live.remove_batch(b, lanes::bits(ends));
        }
    }
}
