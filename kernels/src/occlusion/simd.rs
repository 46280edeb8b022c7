//! ```text
//! for each segment a -> b of start, inserted vertices .., point:
//!     blocked if it crosses any disk or sphere, but the candidate's own where b is the point      (`trace::bodies`)
//! ```
//!
//! 1. Rows of a bucket have the same number of segments, so lanes stay full. Where lights are many, segments go through
//!    a tree over them.
//! 2. Lanes that are blocked, or weigh nothing, are carried along; a batch of them stops.
//! 3. Triangles are traced for what no disk or sphere blocks; a row is done with at the first segment that is blocked.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::queues::{CandidateQueue, ChainTable};
use crate::lanes::LANES;
use crate::tables::geometry::Geometry;
use crate::tables::lights::{Emitter, Lights};
use crate::trace::bodies::{self, Bodies};
use crate::trace::{self, Rays};
use crate::vec3::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    if columns.lights.tree().is_some() { run_with::<true>(columns) } else { run_with::<false>(columns) }
}

/// `MANY`: whether there is a tree over the disks and spheres.
#[inline(always)]
fn run_with<const MANY: bool>(columns: Columns<'_, '_>) {
    let Columns { lights, surfaces, bucket, candidates, chains, worth } = columns;
    for (b, rows) in bucket.batches() {
        let weight = worth.weight.batch(b);
        let mut free = !weight.simd_eq(f32x8::ZERO) & lanes::mask(rows);
        let mut from = candidates.start.batch(b);
        for segment in 0..=bucket.inserted {
            if !free.any() {
                break;
            }
            let last = segment == bucket.inserted;
            let to = if last { candidates.point.batch(b) } else { chains.vertices[segment].batch(b) };
            let own = if last { candidates.emitter.batch(b) } else { u32x8::splat(u32::MAX) };
            free = pass_bodies::<MANY>(lights, free, from, to, own);
            from = to;
        }
        if !surfaces.is_empty() {
            let geometry = surfaces.geometry();
            free &= lanes::mask(unhidden(geometry, lights, bucket.inserted, b, lanes::bits(free), candidates, chains));
        }
        let blocked = !free & !weight.simd_eq(f32x8::ZERO);
        for factor in worth.factor.channels_mut() {
            factor.set_batch(b, blocked.select(f32x8::ZERO, factor.batch(b)));
        }
    }
}

/// Which of the segments `free` no disk or sphere blocks but their `own` ones.
#[inline(always)]
fn pass_bodies<const MANY: bool>(lights: &Lights, mut free: f32x8, from: Vec3x8, to: Vec3x8, own: u32x8) -> f32x8 {
    let tree = if MANY { lights.tree() } else { None };
    let Some(tree) = tree else {
        for (index, body) in lights.bodies().iter().enumerate() {
            free &= passes(body, index, from, to, own);
        }
        return free;
    };
    free & !lanes::mask(bodies::blocked(tree, from, to, own, lanes::bits(free)))
}

/// Which segments the body of this index does not block, or is their own.
#[inline(always)]
fn passes(body: &Emitter, index: usize, from: Vec3x8, to: Vec3x8, own: u32x8) -> f32x8 {
    lanes::as_mask(own.simd_eq(u32x8::splat(index as u32))) | !Bodies::one(body).cross(body.shape, from, to)
}

/// Which of the rows `free` of batch `b` no triangle hides.
#[inline(always)]
fn unhidden(
    geometry: &Geometry,
    lights: &Lights,
    inserted: usize,
    b: usize,
    mut free: u32,
    candidates: &CandidateQueue<'_>,
    chains: &ChainTable<'_>,
) -> u32 {
    let mut from = candidates.start.batch(b);
    for segment in 0..=inserted {
        if free == 0 {
            break;
        }
        let last = segment == inserted;
        let to = if last { candidates.point.batch(b) } else { chains.vertices[segment].batch(b) };
        let spared =
            if last { own_triangles(lights, free, candidates.emitter.batch(b)) } else { u32x8::splat(u32::MAX) };
        let rays = Rays { origin: from, direction: to - from, max: f32x8::ONE };
        free &= !trace::hidden(geometry, &rays, free, spared);
        from = to;
    }
    free
}

/// The triangles that the emitters of the rows `live` are; `u32::MAX` for all else.
#[inline(always)]
fn own_triangles(lights: &Lights, live: u32, emitter: u32x8) -> u32x8 {
    let mut own = [u32::MAX; LANES];
    if lights.has_meshes() {
        lanes::each(live).for_each(|i| own[i] = lights.emitters()[emitter.to_array()[i] as usize].triangle);
    }
    u32x8::new(own)
}
