//! Rays among few disks and spheres, and few triangles in few planes: row by row.
//!
//! ```text
//! for each disk, sphere and plane: whether the flight reaches what is there of it        (`trace::reach`)
//! batches that a light is near, or that leave the camera:  look for it, and trace all rays if there is one
//! others:  flights near one plane alone wait in the pile of that, those near several in another  (`trace::waiting`)
//! ```
//!
//! 1. Rooms and plates are made of few planes, and most flights in fog reach none. That is the same for all rows: one
//!    bit per plane and row, and one for lights, is all that their loops say.
//! 2. A flight near one plane alone meets nothing but the triangles in it.
//! 3. A batch of which any ray meets a light is traced as it is: what hides a light may be behind the end of a flight.

use wide::{f32x8, u32x8};

use super::Columns;
use super::rows::Beams;
use super::simd::{Flights, Listed, trace_batch};
use crate::columns::queues::HitQueue;
use crate::lanes::{LANES, STRETCH};
use crate::tables::geometry::{Facet, Few, MOST_FACETS};
use crate::tables::lights::{Emitter, Lights};
use crate::tables::surfaces::Surfaces;
use crate::trace::bodies::{Nearest, closest_among};
use crate::trace::reach::Reach;
use crate::trace::{Rays, Search, Waited, Waiting};
use crate::{Step, lanes};

/// Rows of a stretch.
const ROWS: usize = STRETCH * LANES;

/// The triangles, if there is no more than that.
pub(super) fn triangles<'a>(lights: &Lights, surfaces: &'a Surfaces) -> Option<&'a Few> {
    let few = surfaces.geometry().few().filter(|few| !few.parts.is_empty())?;
    (lights.tree().is_none() && !lights.has_distant() && !lights.has_meshes()).then_some(few)
}

/// Lists the lights and surfaces that rays meet, where these [`triangles`] are all.
#[inline(always)]
pub(super) fn extend(step: Step, columns: Columns<'_, '_>, few: &Few) {
    let Columns { lights, surfaces, live, paths, vertex, ray, flight, on_surface, hits, surface_hits } = columns;
    on_surface.clear();
    let facets = &surfaces.geometry().tree().facets;
    let bodies = lights.bodies();
    let extent = bodies.iter().flat_map(box_around).fold(few.extent, |extent, plane| extent.max(plane.abs()));
    let flights = Flights { vertex, ray, flight };
    let mut piles = Piles { few, flights: &flights, waiting: [Waiting::default(); PILES] };
    let mut listed = Listed { on_surface, surface_hits };
    let mut near = Near::new();
    for batches in live.each_stretch() {
        let beams = Beams::new(step, batches.clone(), paths, vertex, ray, flight);
        near.find(&beams, facets, bodies, extent);
        let mut to_wait = ToWait::new();
        for (k, b) in batches.clone().enumerate() {
            let (live, marks) = (live.batch(b), near.marks[k]);
            if lanes::bits(lanes::as_mask(marks)) & live != 0 {
                let at_camera = lanes::as_mask(paths.birth.batch(b).simd_eq(u32x8::splat(step.clock)));
                if meet_light(few, lights, (b, live), &flights.batch(b), at_camera, &mut listed, hits) {
                    continue;
                }
            }
            to_wait.add(b, live & !lanes::equal(marks & u32x8::splat(!LIGHT), 0));
        }
        let marks: &[u32] = bytemuck::cast_slice(&near.marks);
        for lane in to_wait.lanes() {
            piles.add(*lane, marks[*lane as usize - batches.start * LANES] & !LIGHT, &mut listed);
        }
    }
    piles.settle_rest(&mut listed);
}

/// Flights of a stretch that are to wait. They are listed without a branch: a loop over those of a batch would end where
/// no processor foresees it.
struct ToWait {
    count: usize,
    lane: [u32; ROWS + LANES],
}

impl ToWait {
    #[inline(always)]
    fn new() -> Self {
        Self { count: 0, lane: [0; ROWS + LANES] }
    }

    /// Those of batch `b` in the set `bits`.
    #[inline(always)]
    fn add(&mut self, b: usize, bits: u32) {
        let packed = lanes::indices(b).shuffle(lanes::pack_order(bits));
        self.lane[self.count..self.count + LANES].copy_from_slice(packed.as_array());
        self.count += bits.count_ones() as usize;
    }

    #[inline(always)]
    fn lanes(&self) -> &[u32] {
        &self.lane[..self.count]
    }
}

/// The box around the ball of a body `[m]`: whatever meets it is in there, wherever rounding takes it.
fn box_around(body: &Emitter) -> [f32; 6] {
    let reach = body.radius * (1.0 + 1e-4);
    let [[x, y, z], [u, v, w]] = [-reach, reach].map(|reach| body.origin.map(|center| center + reach));
    [x, y, z, u, v, w]
}

/// Lists what eight rays, of which these are live and some leave the camera, meet of lights and surfaces; or nothing, if
/// none of them meets a light.
#[inline(never)]
fn meet_light(
    few: &Few,
    lights: &Lights,
    (b, live): (usize, u32),
    flights: &Rays,
    at_camera: f32x8,
    listed: &mut Listed<'_, '_>,
    hits: &mut HitQueue<'_>,
) -> bool {
    let max = at_camera.select(f32x8::splat(f32::INFINITY), flights.max);
    let Nearest { body, distance } = closest_among(lights.bodies(), &Rays { max, ..*flights });
    let met = lanes::bits(distance.simd_lt(max)) & live;
    if met != 0 {
        let batch = (b, live, lanes::bits(at_camera));
        trace_batch(few, lights, batch, flights, (met, body, distance), listed, hits);
    }
    met != 0
}

/// Mark of what may meet a light: its sign.
const LIGHT: u32 = 1 << 31;

/// What is near the flights of a stretch.
struct Near {
    /// One bit per facet, and [`LIGHT`].
    marks: [u32x8; STRETCH],
    /// How far flights reach: lower and upper x, y and z, and L, by row.
    reach: [[f32; ROWS]; 7],
}

impl Near {
    fn new() -> Self {
        Self { marks: [u32x8::splat(0); STRETCH], reach: [[0.0; ROWS]; 7] }
    }

    #[inline(always)]
    fn find(&mut self, beams: &Beams<'_>, facets: &[Facet], bodies: &[Emitter], extent: f32) {
        reach_out(beams, extent, &mut self.reach);
        let marks: &mut [u32] = bytemuck::cast_slice_mut(&mut self.marks);
        mark_at_camera(beams, marks);
        bodies.iter().for_each(|body| mark_within(&self.reach, &box_around(body), LIGHT, marks));
        for (k, facet) in facets.iter().enumerate() {
            if facet.is_upright {
                mark_within(&self.reach, &facet.planes, 1 << k, marks);
            } else {
                mark_crossing(beams, &self.reach, facet, 1 << k, marks);
            }
        }
    }
}

/// How far flights reach.
#[inline(always)]
fn reach_out(beams: &Beams<'_>, extent: f32, reach: &mut [[f32; ROWS]; 7]) {
    let n = beams.flight.len().min(ROWS);
    let (origin, direction, flight) = (beams.origin.first(n), beams.direction.first(n), &beams.flight[..n]);
    for i in 0..n {
        let Reach { lower, upper, scale } = Reach::<f32>::new(origin.at(i), direction.at(i), flight[i], extent);
        (reach[0][i], reach[1][i], reach[2][i]) = (lower[0], lower[1], lower[2]);
        (reach[3][i], reach[4][i], reach[5][i]) = (upper[0], upper[1], upper[2]);
        reach[6][i] = scale;
    }
}

#[inline(always)]
fn reach_of(reach: &[[f32; ROWS]; 7], i: usize) -> Reach<f32> {
    let [a, b, c, d, e, f, scale] = reach;
    Reach { lower: [a[i], b[i], c[i]], upper: [d[i], e[i], f[i]], scale: scale[i] }
}

/// Sets [`LIGHT`] for rays that leave the camera, which sees lights at any distance, and nothing else for any.
#[inline(always)]
fn mark_at_camera(beams: &Beams<'_>, marks: &mut [u32]) {
    let n = beams.birth.len().min(ROWS);
    let (birth, marks) = (&beams.birth[..n], &mut marks[..n]);
    for (mark, birth) in marks.iter_mut().zip(birth) {
        *mark = if *birth == beams.clock { LIGHT } else { 0 };
    }
}

/// Sets `bit` for the flights that reach a box.
#[inline(always)]
fn mark_within(reach: &[[f32; ROWS]; 7], planes: &[f32; 6], bit: u32, marks: &mut [u32]) {
    let planes = *planes;
    for (i, mark) in marks[..ROWS].iter_mut().enumerate() {
        *mark |= if reach_of(reach, i).overlaps(&planes) { bit } else { 0 };
    }
}

/// The same for those that cross a leaning facet.
#[inline(always)]
fn mark_crossing(beams: &Beams<'_>, reach: &[[f32; ROWS]; 7], facet: &Facet, bit: u32, marks: &mut [u32]) {
    let n = beams.flight.len().min(ROWS);
    let (origin, direction, flight) = (beams.origin.first(n), beams.direction.first(n), &beams.flight[..n]);
    let marks = &mut marks[..n];
    for i in 0..n {
        let crosses = reach_of(reach, i).crosses(origin.at(i), direction.at(i), flight[i], facet);
        marks[i] |= if crosses { bit } else { 0 };
    }
}

/// One for each facet, and one for flights that are near several.
const PILES: usize = MOST_FACETS + 1;

/// Flights that wait.
struct Piles<'a, 'q> {
    few: &'a Few,
    flights: &'a Flights<'a, 'q>,
    waiting: [Waiting; PILES],
}

impl Piles<'_, '_> {
    /// A flight that is near these planes waits, or is traced with the seven that do already.
    #[inline(always)]
    fn add(&mut self, lane: u32, planes: u32, listed: &mut Listed<'_, '_>) {
        let pile = if planes.is_power_of_two() { planes.trailing_zeros() as usize } else { MOST_FACETS };
        if let Some(waited) = self.waiting[pile].add_one(lane) {
            self.settle(pile, waited, listed);
        }
    }

    fn settle_rest(&mut self, listed: &mut Listed<'_, '_>) {
        for pile in 0..PILES {
            if let Some(waited) = self.waiting[pile].rest() {
                self.settle(pile, waited, listed);
            }
        }
    }

    #[inline(never)]
    fn settle(&self, pile: usize, waited: Waited, listed: &mut Listed<'_, '_>) {
        let part = self.few.parts.get(pile).unwrap_or(self.few);
        let hits = part.closest(&self.flights.gather(&waited.lane), waited.live);
        listed.push_waited(&waited, &hits);
    }
}
