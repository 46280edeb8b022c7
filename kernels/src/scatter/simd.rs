//! ```text
//! x' = x + flight d,   arc' = arc + flight, but 0 at the first vertex after the camera
//! d' = d turned by the phase function's cosine, at azimuth 2 pi u
//! T  = T * albedo
//! ```
//!
//! 1. Where albedos differ between places, they are asked for where paths scatter. A white medium (albedo 1) leaves the
//!    throughput alone; that is settled before the loop.
//! 2. Where phase functions differ, all turn by the first one, and then those elsewhere by theirs.
//! 3. Lanes that end on a surface are moved along with the others: reflection comes later and overwrites what was
//!    filled.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::phase::PhaseX8;
use crate::random::uniform_x8;
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes, with_phase};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, mut columns: Columns<'_, '_>) {
    let Columns { medium, .. } = columns;
    let [first, others @ ..] = medium.all_phases() else { return };
    with_phase!(first, |phase| scatter(step, &mut columns, phase));
    let Some(places) = medium.phases_by_place() else { return };
    for (number, phase) in (1..).zip(others) {
        with_phase!(phase, |phase| turn_there(&mut columns, phase, |at| places.are(number, at)));
    }
}

/// Turns those that scattered where `is_there` holds by another phase function.
#[inline(always)]
fn turn_there(columns: &mut Columns<'_, '_>, phase: impl PhaseX8, is_there: impl Fn(Vec3x8) -> f32x8) {
    let Columns { live, flights, next, ray, next_ray, .. } = columns;
    for (b, _) in live.each_batch() {
        let there = is_there(next.position.batch(b));
        if there.any() {
            let deflection = phase.sample(uniform_x8(flights.cosine.batch(b)));
            let turned = deflection.apply(ray.direction.batch(b), uniform_x8(flights.azimuth.batch(b)));
            let before = next_ray.direction.batch(b);
            next_ray.direction.set_batch(b, Vec3x8::select(there, turned, before));
        }
    }
}

#[inline(always)]
fn scatter(step: Step, columns: &mut Columns<'_, '_>, phase: impl PhaseX8) {
    let Columns { medium, live, on_surface, paths, flights, vertex, next, ray, next_ray, throughput } = columns;
    let n = live.batches();
    let (origins, directions) = (vertex.position.view(n), ray.direction.view(n));
    let (flight, cosine, azimuth) = (flights.flight.view(n), flights.cosine.view(n), flights.azimuth.view(n));
    let (mut positions, mut leaving) = (next.position.view_mut(n), next_ray.direction.view_mut(n));
    let (arc, next_arc) = (vertex.arc.view(n), next.arc.view_mut(n));
    let birth = paths.birth.view(n);
    for (b, _) in live.each_batch() {
        let direction = directions.at(b);
        positions.set(b, direction.mul_add(flight[b], origins.at(b)));
        let at_camera = lanes::as_mask(birth[b].simd_eq(u32x8::splat(step.clock)));
        next_arc[b] = at_camera.select(f32x8::ZERO, arc[b] + flight[b]);
        let deflection = phase.sample(uniform_x8(cosine[b]));
        leaving.set(b, deflection.apply(direction, uniform_x8(azimuth[b])));
    }
    if let Some(albedos) = medium.albedos_by_place() {
        for (b, bits) in live.each_batch() {
            let scattered = lanes::mask(bits & !on_surface.batch(b));
            for (throughput, albedo) in throughput.channels_mut().iter_mut().zip(albedos.at(next.position.batch(b))) {
                throughput.set_batch(b, throughput.batch(b) * scattered.select(albedo, f32x8::ONE));
            }
        }
        return;
    }
    for (throughput, albedo) in throughput.channels_mut().iter_mut().zip(medium.albedo) {
        if albedo != 1.0 {
            for b in 0..n {
                let scattered = live.batch(b) & !on_surface.batch(b);
                let factor = lanes::mask(scattered).select(f32x8::splat(albedo), f32x8::ONE);
                throughput.set_batch(b, throughput.batch(b) * factor);
            }
        }
    }
}
