//! ```text
//! weight = cos_light > 0  and  |v_1 - start| > 0  and  mu(v) > 0 at every inserted vertex v
//! ```
//!
//! 1. Vertices are asked for one after the other, until no row of the batch is left.

use wide::f32x8;

use super::Columns;
use crate::media::MediumX8;
use crate::media::field::FieldX8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, bucket, candidates, chains, worth } = columns;
    let field = medium.field().map(FieldX8::of);
    let inserted = &chains.vertices[..bucket.inserted];
    for (b, rows) in bucket.batches() {
        let emitters = candidates.emitter.batch(b).to_array();
        let point = candidates.point.batch(b);
        let last = inserted.last().unwrap_or(&candidates.start).batch(b);
        let (_, direction) = (point - last).length_and_direction();
        let mut counts = lights.cosine(&emitters, point, direction).simd_gt(f32x8::ZERO);
        if let [first, ..] = inserted {
            let edge = first.batch(b) - candidates.start.batch(b);
            counts &= edge.length_squared().simd_gt(f32x8::ZERO);
        }
        if let Some(field) = field {
            for vertex in inserted {
                if lanes::bits(counts) & rows == 0 {
                    break;
                }
                let at = vertex.batch(b);
                if !field.stays_even([at], rows) {
                    counts &= field.extinction(at).simd_gt(f32x8::ZERO);
                }
            }
        }
        worth.weight.set_batch(b, counts & f32x8::ONE);
    }
}
