//! ```text
//! trail(lane, clock) = (position, arc, leaving, light sum)
//! ```
//!
//! 1. Eight columns of eight rows are transposed into eight rows of eight numbers.

use super::Columns;
use crate::Step;
use crate::columns::trail::MarkBatch;

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { live, vertex, ray, outlook, trail } = columns;
    let n = live.batches();
    let (position, leaving) = (vertex.position.view(n), ray.direction.view(n));
    let (arc, light_sum) = (vertex.arc.view(n), outlook.light_sum.view(n));
    for (b, _) in live.each_batch() {
        let (position, leaving) = (position.at(b), leaving.at(b));
        trail.set_batch(b, step.clock, MarkBatch { position, arc: arc[b], leaving, light_sum: light_sum[b] });
    }
}
