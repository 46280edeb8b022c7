//! ```text
//! for each disk and sphere:  t, where the ray meets it      (`trace::bodies`)
//! keep the nearest; if there is none, and no triangle either, list all lights at infinity within |d - axis|^2 <= 4 S
//! ```
//!
//! 1. Eight rays against one light at a time, so lanes are full whatever their number. Where lights are many, rays go
//!    through a tree over them. Which it is, is settled outside the loop.
//! 2. Triangles are traced up to the light or the end of the flight: as far as anything may matter. Where triangles
//!    shine, the camera looks at all distances. How eight rays look for triangles is chosen once, outside the loop
//!    ([`Search`]).
//! 3. Flights that are near one of few surfaces wait until they are eight ([`Waiting`]). A batch of which any ray has met
//!    a light, or goes on to infinity, does not wait, nor do others where triangles shine.
//! 4. In fog most batches meet nothing, and have nothing to list. Few lights in nothing but fog are met row by row
//!    (`open`), and so are few planes (`flat`).
//! 5. Few rays go on to infinity, and each of them once: they are listed one by one.

use fogbow_processor::Avx512;
use wide::{f32x8, u32x8};

use super::{Columns, flat, open};
use crate::columns::paths::{RayColumns, VertexColumns};
use crate::columns::queues::{Hit, HitBatch, HitQueue, SurfaceHitBatch, SurfaceHitQueue};
use crate::columns::{Column, View3};
use crate::lanes::{LANES, LaneSet};
use crate::tables::lights::{FAR, Lights};
use crate::trace::bodies::{self, Nearest};
use crate::trace::{Hits, Rays, Search, ThroughTree, Waited, Waiting, may_meet};
use crate::vec3::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    if open::suffices(columns.lights, columns.surfaces) {
        return open::extend(step, columns);
    }
    match flat::triangles(columns.lights, columns.surfaces) {
        Some(few) => flat::extend(step, columns, few),
        None => run_by_eight(step, columns),
    }
}

/// The same, eight rows at a time, whatever there is.
pub fn run_by_eight(step: Step, columns: Columns<'_, '_>) {
    let geometry = columns.surfaces.geometry();
    match (geometry.few(), columns.lights.tree().is_some()) {
        (Some(few), false) => run_with::<false, _>(few, step, columns),
        (Some(few), true) => run_with::<true, _>(few, step, columns),
        (None, false) => run_with::<false, _>(&ThroughTree(geometry), step, columns),
        (None, true) => run_with::<true, _>(&ThroughTree(geometry), step, columns),
    }
}

/// The same, for the widest registers that there are.
pub fn run_widest(step: Step, columns: Columns<'_, '_>) {
    let Some(avx512) = Avx512::detect() else { return run(step, columns) };
    if open::suffices(columns.lights, columns.surfaces) {
        return avx512.run(
            #[inline(always)]
            || open::extend(step, columns),
        );
    }
    match flat::triangles(columns.lights, columns.surfaces) {
        Some(few) => avx512.run(
            #[inline(always)]
            || flat::extend(step, columns, few),
        ),
        None => run(step, columns),
    }
}

/// `MANY`: whether there is a tree over the disks and spheres.
#[inline(always)]
fn run_with<const MANY: bool, S: Search>(search: &S, step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, surfaces, live, paths, vertex, ray, flight, on_surface, hits, surface_hits } = columns;
    on_surface.clear();
    let n = live.batches();
    let (origins, directions) = (vertex.position.view(n), ray.direction.view(n));
    let flights = Flights { vertex, ray, flight };
    let (birth, flight) = (paths.birth.view(n), flight.view(n));
    let mut waiting = Waiting::default();
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
            let mut listed = Listed { on_surface, surface_hits };
            let beams = Beams { b, origin, direction, flight: flight[b], at_camera: lanes::bits(at_camera) };
            if S::WAITS && (found.bits | found.open) == 0 && !lights.has_meshes() {
                // Nothing but surfaces ends these flights.
                let rays = flights.batch(b);
                if let Some(waited) = waiting.add(b, may_meet(surfaces.geometry(), &rays, live)) {
                    listed.push_waited(&waited, &search.closest(&flights.gather(&waited.lane), waited.live));
                }
                continue;
            }
            beams.trace(search, lights, live, &mut found, &mut listed);
        }
        if found.open != 0 {
            found.list(b, lights, directions, hits);
            continue;
        }
        let (emitter, distance) = (u32x8::new(found.emitter), f32x8::new(found.distance));
        hits.push_batch(found.bits, HitBatch { lane: lanes::indices(b), emitter, distance });
    }
    if let Some(waited) = waiting.rest() {
        let hits = search.closest(&flights.gather(&waited.lane), waited.live);
        Listed { on_surface, surface_hits }.push_waited(&waited, &hits);
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
    /// Lists the surfaces at which flights end. What is `found` behind a surface is forgotten, and replaced by the surface
    /// itself if that shines.
    #[inline(always)]
    fn trace(&self, search: &impl Search, lights: &Lights, live: u32, found: &mut Found, listed: &mut Listed<'_, '_>) {
        // The camera sees a light at any distance, so what may hide it, or shine itself, counts as far.
        let distance = f32x8::new(found.distance);
        let sees = if lights.has_meshes() { lanes::ALL } else { found.bits | found.open };
        let max = lanes::mask(self.at_camera & sees).select(distance, self.flight.fast_min(distance));
        let rays = Rays { origin: self.origin, direction: self.direction, max };
        let hits = search.closest(&rays, live);
        found.forget(lanes::bits(hits.met));
        if lights.has_meshes() {
            found.shine(lights, lanes::bits(hits.met), hits.triangle, hits.distance);
        }
        let on_surface = lanes::bits(hits.met & hits.distance.simd_lt(self.flight));
        listed.on_surface.insert_batch(self.b, on_surface);
        listed.push(lanes::indices(self.b), on_surface, &hits);
    }
}

/// All flights.
pub(super) struct Flights<'a, 'q> {
    pub vertex: &'a VertexColumns<'q>,
    pub ray: &'a RayColumns<'q>,
    pub flight: &'a Column<'q, f32>,
}

impl Flights<'_, '_> {
    #[inline(always)]
    pub fn batch(&self, b: usize) -> Rays {
        let Self { vertex, ray, flight } = self;
        Rays { origin: vertex.position.batch(b), direction: ray.direction.batch(b), max: flight.batch(b) }
    }

    #[inline(always)]
    pub fn gather(&self, lane: &[u32; LANES]) -> Rays {
        let Self { vertex, ray, flight } = self;
        Rays { origin: vertex.position.gather(lane), direction: ray.direction.gather(lane), max: flight.gather(lane) }
    }
}

/// Traces batch `b` of `rays`, which are bounded by their flights and of which some have met a body, some are at the
/// camera: lists all that they meet.
#[inline(never)]
pub(super) fn trace_batch(
    search: &impl Search,
    lights: &Lights,
    (b, live, at_camera): (usize, u32, u32),
    rays: &Rays,
    (met, body, distance): (u32, u32x8, f32x8),
    listed: &mut Listed<'_, '_>,
    hits: &mut HitQueue<'_>,
) {
    let distance = lanes::mask(met).select(distance, f32x8::splat(f32::INFINITY));
    let mut found = Found { bits: met, open: 0, emitter: body.to_array(), distance: distance.to_array() };
    let Rays { origin, direction, max: flight } = *rays;
    Beams { b, origin, direction, flight, at_camera }.trace(search, lights, live, &mut found, listed);
    hits.push_batch(found.bits, HitBatch { lane: lanes::indices(b), emitter: body, distance });
}

/// Flights that end on surfaces.
pub(super) struct Listed<'a, 'q> {
    pub on_surface: &'a mut LaneSet<'q>,
    pub surface_hits: &'a mut SurfaceHitQueue<'q>,
}

impl Listed<'_, '_> {
    /// Lists those of flights that have waited.
    #[inline(always)]
    pub(super) fn push_waited(&mut self, waited: &Waited, hits: &Hits) {
        let met = lanes::bits(hits.met);
        lanes::each(met).for_each(|i| self.on_surface.insert(waited.lane[i] as usize));
        self.push(u32x8::new(waited.lane), met, hits);
    }

    #[inline(always)]
    fn push(&mut self, lane: u32x8, bits: u32, hits: &Hits) {
        let Hits { triangle, distance, second, third, .. } = *hits;
        self.surface_hits.push_batch(bits, SurfaceHitBatch { lane, triangle, distance, second, third });
    }
}
