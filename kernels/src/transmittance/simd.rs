//! ```text
//! factor *= prod over segments of product e^{tau~ - known}
//! ```
//!
//! 1. The first segments of all rows that count go through the tracker, then the second ones: rays take the lanes of
//!    those that have ended, and still a row's factors are multiplied in the sequence of its segments.
//! 2. Their tau~ is found for whole batches afterwards.

use wide::f32x8;

use super::Columns;
use crate::media::MediumX8;
use crate::media::grid::GridX8;
use crate::media::grid::tracking::Ray;
use crate::media::grid::tracking::simd::{factor, transmittances};
use crate::random::{self, Stream};
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { grid, bucket, purpose, candidates, chains, paths, estimates, worth } = columns;
    let block = random::TRANSMITTANCE.nth(purpose.number());
    let vertex = |number: usize| match number {
        0 => &candidates.start,
        number if number <= bucket.inserted => &chains.vertices[number - 1],
        _ => &candidates.point,
    };
    for segment in 0..=bucket.inserted {
        let (from, to) = (vertex(segment), vertex(segment + 1));
        let counts = |row: &usize| worth.weight.rows()[*row] != 0.0 && worth.factor.any(*row);
        let rays = bucket.rows().filter(counts).map(|row| {
            let lane = candidates.lane.rows()[row] as usize;
            let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
            let block = random::block(paths.depth_of(step.clock, lane), block);
            let stream = Stream::new(pixel, sample, block, step.seed, segment as u32);
            let (origin, end) = (from.row(row), to.row(row));
            (row, Ray { origin, direction: [0, 1, 2].map(|axis| end[axis] - origin[axis]), stream })
        });
        transmittances(grid, rays, |row, product, known| {
            (estimates.product.rows_mut()[row], estimates.depth.rows_mut()[row]) = (product, known);
        });
        for (b, rows) in bucket.batches() {
            let (from, to) = (from.batch(b), to.batch(b));
            let depth = GridX8::of(grid).optical_depth(from, to, (to - from).length_squared().sqrt());
            let through = factor(estimates.product.batch(b), estimates.depth.batch(b), depth);
            // Rows that count nothing were not estimated: what stands there is of no meaning.
            let weighs = lanes::mask(rows) & !worth.weight.batch(b).simd_eq(f32x8::ZERO);
            for channel in worth.factor.channels_mut() {
                let before = channel.batch(b);
                let counts = weighs & !before.simd_eq(f32x8::ZERO);
                channel.set_batch(b, counts.select(before * through, before));
            }
        }
    }
}
