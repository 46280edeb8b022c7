//! Rays among few disks and spheres, where there is nothing else: row by row.
//!
//! ```text
//! for each disk and sphere:  t, where the ray meets it      (`trace::bodies`)
//! keep the nearest, list it
//! ```
//!
//! Most stretches of rows meet nothing. Whether one does is all that their loop says; who has met what is looked at
//! by eight rows.

use core::ops::Range;

use wide::{f32x8, u32x8};

use super::Columns;
use super::rows::Beams;
use crate::columns::queues::{HitBatch, HitQueue};
use crate::lanes::{LANES, LaneSet, STRETCH};
use crate::real::Real;
use crate::tables::lights::{Emitter, Lights, Shape};
use crate::tables::surfaces::Surfaces;
use crate::trace::bodies::Bodies;
use crate::{Step, lanes};

/// Whether lights and surfaces are no more than that.
pub fn suffices(lights: &Lights, surfaces: &Surfaces) -> bool {
    surfaces.is_empty() && lights.tree().is_none() && !lights.has_distant()
}

/// Lists the lights that rays meet, where this [`suffices`].
#[inline(always)]
pub fn extend(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, live, paths, vertex, ray, flight, on_surface, hits, .. } = columns;
    on_surface.clear();
    let mut found = Found::new();
    for batches in live.each_stretch() {
        let beams = Beams::new(step, batches.clone(), paths, vertex, ray, flight);
        if beams.meet(lights.bodies(), &mut found) {
            list(&beams, batches, live, &found, hits);
        }
    }
}

/// What they meet.
struct Found {
    /// Index of the nearest body, 0 if there is none.
    body: [u32x8; STRETCH],
    /// Its distance; the end of the flight if there is none `[m]`.
    distance: [f32x8; STRETCH],
}

impl Found {
    fn new() -> Self {
        Self { body: [u32x8::splat(0); STRETCH], distance: [f32x8::ZERO; STRETCH] }
    }

    /// The rays of batch `k` of the stretch that meet anything, as bits.
    #[inline(always)]
    fn met(&self, beams: &Beams<'_>, k: usize) -> u32 {
        let end = f32x8::new(core::array::from_fn(|i| beams.end(k * LANES + i)));
        lanes::bits(self.distance[k].simd_lt(end))
    }
}

impl Beams<'_> {
    /// The nearest bodies, and whether any ray meets one.
    #[inline(always)]
    fn meet(&self, bodies: &[Emitter], found: &mut Found) -> bool {
        let distance: &mut [f32] = bytemuck::cast_slice_mut(&mut found.distance);
        let body: &mut [u32] = bytemuck::cast_slice_mut(&mut found.body);
        let n = self.flight.len();
        let (distance, body) = (&mut distance[..n], &mut body[..n]);
        for i in 0..n {
            (distance[i], body[i]) = (self.end(i), 0);
        }
        let mut any = false;
        for (index, emitter) in (0..).zip(bodies) {
            any |= match emitter.shape {
                Shape::Sphere => self.meet_one(Shape::Sphere, emitter, index, distance, body),
                _ => self.meet_one(Shape::Disk, emitter, index, distance, body),
            };
        }
        any
    }

    /// Takes one body where it is nearer than what was found, and says whether it is anywhere.
    #[inline(always)]
    fn meet_one(&self, shape: Shape, emitter: &Emitter, index: u32, distance: &mut [f32], body: &mut [u32]) -> bool {
        let n = distance.len();
        let (origin, direction, body) = (self.origin.first(n), self.direction.first(n), &mut body[..n]);
        let one = Bodies::<f32>::one(emitter);
        let mut met = 0;
        for i in 0..n {
            let found = one.meet(shape, origin.at(i), direction.at(i), distance[i]);
            let nearer = found.simd_lt(distance[i]);
            distance[i] = if nearer { found } else { distance[i] };
            body[i] = if nearer { index } else { body[i] };
            met |= u32::from(nearer);
        }
        met != 0
    }
}

/// Lists what live rays of a stretch meet.
#[inline(never)]
fn list(beams: &Beams<'_>, batches: Range<usize>, live: &LaneSet<'_>, found: &Found, hits: &mut HitQueue<'_>) {
    for (k, b) in batches.enumerate() {
        let met = found.met(beams, k) & live.batch(b);
        hits.push_batch(met, HitBatch { lane: lanes::indices(b), emitter: found.body[k], distance: found.distance[k] });
    }
}
