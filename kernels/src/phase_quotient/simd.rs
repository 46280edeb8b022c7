//! ```text
//! for every turn j of the chain:   factor_c *= p(j) / p~(j),    p = phase function of the medium at its vertex
//! ```
//!
//! 1. Phase functions are asked one after the other, each for whole buckets: a kernel is compiled per kind, not per
//!    pair of kinds.
//! 2. Vertex by vertex, so that the product never strays far: one over `p~` of many turns is beyond all numbers.

use wide::f32x8;

use super::Columns;
use crate::columns::Column3;
use crate::connect::sequence::Sequence;
use crate::phase::PhaseX8;
use crate::vec3::Vec3x8;
use crate::{Step, with_phase};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, mut columns: Columns<'_, '_>) {
    let Some(places) = columns.medium.phases_by_place() else { return };
    for turn in 0..=columns.bucket.inserted {
        with_phase!(&columns.medium.phase, |stand_in| multiply(step, &mut columns, turn, |_, ways| {
            stand_in.inverse_density(ways[0], ways[1])
        }));
        for (number, phase) in places.phases.distinct().iter().enumerate() {
            with_phase!(phase, |phase| multiply(step, &mut columns, turn, |at, ways| {
                let density = f32x8::ONE / phase.inverse_density(ways[0], ways[1]);
                places.are(number, at).select(density, f32x8::ONE)
            }));
        }
    }
}

/// Multiplies factors by a `quantity` of vertex number `turn` and the directions before and behind it, of rows that
/// weigh anything and turn there in a medium.
#[inline(always)]
fn multiply(step: Step, columns: &mut Columns<'_, '_>, turn: usize, quantity: impl Fn(Vec3x8, [Vec3x8; 2]) -> f32x8) {
    let Columns { solid, bucket, candidates, chains, paths, last_surface, worth, .. } = columns;
    let vertex = |number: usize| -> &Column3<'_> {
        match number {
            0 => &candidates.start,
            number if number <= bucket.inserted => &chains.vertices[number - 1],
            _ => &candidates.point,
        }
    };
    for (b, _) in bucket.batches() {
        let at = vertex(turn).batch(b);
        let (_, behind) = (vertex(turn + 1).batch(b) - at).length_and_direction();
        let weighs = !worth.weight.batch(b).simd_eq(f32x8::ZERO);
        let (before, turns) = if turn > 0 {
            ((at - vertex(turn - 1).batch(b)).length_and_direction().1, weighs)
        } else if *solid {
            let lane_of = candidates.lane.batch(b).to_array();
            let on_surface = Sequence::new(step, paths, &lane_of).on_surface(last_surface, &lane_of);
            (candidates.arriving.batch(b), weighs & !on_surface)
        } else {
            (candidates.arriving.batch(b), weighs)
        };
        let factor = turns.select(quantity(at, [before, behind]), f32x8::ONE);
        for channel in worth.factor.channels_mut() {
            channel.set_batch(b, channel.batch(b) * factor);
        }
    }
}
