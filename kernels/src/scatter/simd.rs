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

use fogbow_processor::Avx512;
use wide::f32x8;

use super::Columns;
use crate::columns::{View3, ViewMut3};
use crate::phase::{Lobe, PhaseFunction, PhaseX8, Turns};
use crate::random::uniform_f32;
use crate::real::{Mask, Real, Word};
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_phase};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, mut columns: Columns<'_, '_>) {
    let [first, others @ ..] = columns.medium.all_phases() else { return };
    match first {
        PhaseFunction::HenyeyGreenstein(lobe) => scatter::<f32>(step, &mut columns, Lobe::new(*lobe)),
        other => with_phase!(other, |phase| scatter::<f32x8>(step, &mut columns, phase)),
    }
    finish(columns, others);
}

/// The same, for the widest registers that there are.
pub fn run_widest(step: Step, mut columns: Columns<'_, '_>) {
    let (Some(avx512), [PhaseFunction::HenyeyGreenstein(lobe), others @ ..]) =
        (Avx512::detect(), columns.medium.all_phases())
    else {
        return run(step, columns);
    };
    avx512.run(
        #[inline(always)]
        || scatter::<f32>(step, &mut columns, Lobe::new(*lobe)),
    );
    finish(columns, others);
}

/// What steps leave open: albedos, and other phase functions elsewhere.
fn finish(mut columns: Columns<'_, '_>, others: &[PhaseFunction]) {
    scale(&mut columns);
    let Some(places) = columns.medium.phases_by_place() else { return };
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
            let deflection = phase.sample(uniform_f32(flights.cosine.batch(b)));
            let turned = deflection.apply(ray.direction.batch(b), uniform_f32(flights.azimuth.batch(b)));
            let before = next_ray.direction.batch(b);
            next_ray.direction.set_batch(b, Vec3x8::select(there, turned, before));
        }
    }
}

/// Moves paths on and turns them, by single rows or by eight.
#[inline(always)]
fn scatter<F: Real>(step: Step, columns: &mut Columns<'_, '_>, phase: impl Turns<F>) {
    let Columns { live, paths, flights, vertex, next, ray, next_ray, .. } = columns;
    for batches in live.each_stretch() {
        let steps = Steps::<F> {
            clock: step.clock,
            birth: paths.birth.stretch::<F>(batches.clone()),
            origin: vertex.position.stretch(batches.clone()),
            arc: vertex.arc.stretch::<F>(batches.clone()),
            direction: ray.direction.stretch(batches.clone()),
            flight: flights.flight.stretch::<F>(batches.clone()),
            cosine: flights.cosine.stretch::<F>(batches.clone()),
            azimuth: flights.azimuth.stretch::<F>(batches.clone()),
        };
        let ViewMut3 { x, y, z } = next.position.stretch_mut(batches.clone());
        let ViewMut3 { x: to_x, y: to_y, z: to_z } = next_ray.direction.stretch_mut(batches.clone());
        steps.take(phase, x, y, z, next.arc.stretch_mut::<F>(batches), to_x, to_y, to_z);
    }
}

/// Steps from one vertex to the next.
struct Steps<'a, F: Real> {
    clock: u32,
    birth: &'a [F::Word],
    origin: View3<'a, F>,
    arc: &'a [F],
    direction: View3<'a, F>,
    flight: &'a [F],
    cosine: &'a [F::Word],
    azimuth: &'a [F::Word],
}

impl<F: Real> Steps<'_, F> {
    /// Fills in where they end, x, y, z, with the arc there, and where paths go on to.
    #[expect(clippy::too_many_arguments, reason = "slices that are arguments are known not to overlap")]
    #[inline(always)]
    fn take(
        &self,
        phase: impl Turns<F>,
        x: &mut [F],
        y: &mut [F],
        z: &mut [F],
        arc: &mut [F],
        to_x: &mut [F],
        to_y: &mut [F],
        to_z: &mut [F],
    ) {
        let n = x.len();
        let (birth, flight, before) = (&self.birth[..n], &self.flight[..n], &self.arc[..n]);
        let (origin, direction) = (self.origin.first(n), self.direction.first(n));
        let (cosine, azimuth) = (&self.cosine[..n], &self.azimuth[..n]);
        let (y, z, arc) = (&mut y[..n], &mut z[..n], &mut arc[..n]);
        let (to_x, to_y, to_z) = (&mut to_x[..n], &mut to_y[..n], &mut to_z[..n]);
        for i in 0..n {
            let arriving = direction.at(i);
            let position = arriving.mul_add(flight[i], origin.at(i));
            (x[i], y[i], z[i]) = (position.x, position.y, position.z);
            let at_camera = birth[i].is(F::Word::splat(self.clock));
            arc[i] = at_camera.select(F::ZERO, before[i] + flight[i]);
            let deflection = phase.turn(uniform_f32(cosine[i]));
            let leaving = deflection.apply(arriving, uniform_f32(azimuth[i]));
            (to_x[i], to_y[i], to_z[i]) = (leaving.x, leaving.y, leaving.z);
        }
    }
}

/// Multiplies throughputs by albedos.
#[inline(always)]
fn scale(columns: &mut Columns<'_, '_>) {
    let Columns { medium, live, on_surface, next, throughput, .. } = columns;
    let n = live.batches();
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
