//! ```text
//! for each disk and sphere:  t, where the ray meets it      (`trace::bodies`)
//! keep the nearest; if there is none, and no triangle either, list all lights at infinity within |d - axis|^2 <= 4 S
//! ```
//!
//! 1. Eight rays against one light at a time, so lanes are full whatever their number. Where lights are many, rays go
//!    through a tree over them one by one. Which it is, is settled outside the loop.
//! 2. Triangles are traced up to the light or the end of the flight: as far as anything may matter. Where triangles
//!    shine, the camera looks at all distances. How eight rays look for triangles is chosen once, outside the loop
//!    ([`Search`]).
//! 3. In fog most batches meet nothing, and have nothing to list.
//! 4. Few rays go on to infinity, and each of them once: they are listed one by one.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::View3;
use crate::columns::queues::{Hit, HitBatch, HitQueue, SurfaceHitBatch, SurfaceHitQueue};
use crate::lanes::LANES;
use crate::tables::lights::{FAR, Lights};
use crate::trace::bodies::{self, Nearest};
use crate::trace::{Hits, OneByOne, Rays, Search};
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let geometry = columns.surfaces.geometry();
    match (geometry.few(), columns.lights.tree().is_some()) {
        (Some(few), false) => run_with::<false>(few, step, columns),
        (Some(few), true) => run_with::<true>(few, step, columns),
        (None, false) => run_with::<false>(&OneByOne(geometry), step, columns),
        (None, true) => run_with::<true>(&OneByOne(geometry), step, columns),
    }
}

/// `MANY`: whether there is a tree over the disks and spheres.
#[inline(always)]
fn run_with<const MANY: bool>(search: &impl Search, step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, surfaces, live, paths, vertex, ray, flight, on_surface, hits, surface_hits } = columns;
    on_surface.clear();
    let n = live.batches();
    let (origins, directions) = (vertex.position.view(n), ray.direction.view(n));
    let (birth, flight) = (paths.birth.view(n), flight.view(n));
    for (b, live) in live.each_batch() {
        let (origin, direction) = (origins.at(b), directions.at(b));
        let at_camera = lanes::as_mask(birth[b].simd_eq(u32x8::splat(step.clock)));
        let max = at_camera.select(f32x8::splat(f32::INFINITY), flight[b]);
        let Nearest { body, distance: nearest } = nearest::<MANY>(lights, &Rays { origin, direction, max }, live);
        let any = nearest.simd_lt(max);
        let bits = lanes::bits(any) & live;
        // The bound that hits have lowered is that of rays which meet something.
        let open =
            if lights.has_distant() { lanes::bits(nearest.simd_eq(f32x8::splat(f32::INFINITY))) & live } else { 0 };
        if bits == 0 && surfaces.is_empty() && open == 0 {
            continue;
        }
        let mut found = Found {
            bits,
            open,
            emitter: body.to_array(),
            distance: any.select(nearest, f32x8::splat(f32::INFINITY)).to_array(),
        };
        if !surfaces.is_empty() {
            let beams = Beams { b, origin, direction, flight: flight[b], at_camera: lanes::bits(at_camera) };
            on_surface.insert_batch(b, beams.trace(search, lights, live, &mut found, surface_hits));
        }
        if found.open != 0 {
            found.list(b, lights, directions, hits);
            continue;
        }
        let (emitter, distance) = (u32x8::new(found.emitter), f32x8::new(found.distance));
        hits.push_batch(found.bits, HitBatch { lane: lanes::indices(b), emitter, distance });
    }
}

/// The nearest disk or sphere on each of eight rays; on dead ones, any.
#[inline(always)]
fn nearest<const MANY: bool>(lights: &Lights, rays: &Rays, live: u32) -> Nearest {
    match if MANY { lights.tree() } else { None } {
        Some(tree) => bodies::closest(tree, rays, live),
        None => bodies::closest_among(lights.bodies(), rays),
    }
}

/// The emitters that eight rays meet.
struct Found {
    /// Rays that meet one.
    bits: u32,
    /// Rays that go on to infinity.
    open: u32,
    emitter: [u32; LANES],
    /// How far away, infinite where there is none.
    distance: [f32; LANES],
}

impl Found {
    /// Forgets what some rays met.
    #[inline(always)]
    fn forget(&mut self, hidden: u32) {
        self.bits &= !hidden;
        self.open &= !hidden;
    }

    /// Of the rays that met triangles, those whose triangle shines have found a light.
    #[inline(always)]
    fn shine(&mut self, lights: &Lights, met: u32, triangle: u32x8, distance: f32x8) {
        for i in lanes::each(met) {
            if let Some(emitter) = lights.of_triangle(triangle.to_array()[i]) {
                self.bits |= 1 << i;
                (self.emitter[i], self.distance[i]) = (emitter, distance.to_array()[i]);
            }
        }
    }

    /// Lists what the rays of batch `b` meet, of which some go on to infinity. It looks up their directions: were they
    /// handed over, every batch would write them to memory, and read them from there.
    fn list(&self, b: usize, lights: &Lights, directions: View3<'_>, hits: &mut HitQueue<'_>) {
        let direction = directions.at(b).to_arrays();
        for i in lanes::each(self.bits | self.open) {
            let lane = (b * LANES + i) as u32;
            if self.bits >> i & 1 == 1 {
                hits.push(Hit { lane, emitter: self.emitter[i], distance: self.distance[i] });
                continue;
            }
            for (emitter, light) in (lights.first_distant()..).zip(lights.distant()) {
                if light.is_met(direction.map(|component| component[i])) {
                    hits.push(Hit { lane, emitter, distance: FAR });
                }
            }
        }
    }
}

/// Eight rays on their way to triangles.
struct Beams {
    b: usize,
    origin: Vec3x8,
    direction: Vec3x8,
    flight: f32x8,
    /// Rays that leave the camera.
    at_camera: u32,
}

impl Beams {
    /// Lists the surfaces at which flights end, and gives their rays. What is `found` behind a surface is forgotten,
    /// and replaced by the surface itself if that shines.
    #[inline(always)]
    fn trace(
        &self,
        search: &impl Search,
        lights: &Lights,
        live: u32,
        found: &mut Found,
        surface_hits: &mut SurfaceHitQueue<'_>,
    ) -> u32 {
        // The camera sees a light at any distance, so what may hide it, or shine itself, counts as far.
        let distance = f32x8::new(found.distance);
        let sees = if lights.has_meshes() { lanes::ALL } else { found.bits | found.open };
        let max = lanes::mask(self.at_camera & sees).select(distance, self.flight.fast_min(distance));
        let rays = Rays { origin: self.origin, direction: self.direction, max };
        let Hits { met, triangle, distance, second, third } = search.closest(&rays, live);
        found.forget(lanes::bits(met));
        if lights.has_meshes() {
            found.shine(lights, lanes::bits(met), triangle, distance);
        }
        let on_surface = lanes::bits(met & distance.simd_lt(self.flight));
        let lane = lanes::indices(self.b);
        surface_hits.push_batch(on_surface, SurfaceHitBatch { lane, triangle, distance, second, third });
        on_surface
    }
}
