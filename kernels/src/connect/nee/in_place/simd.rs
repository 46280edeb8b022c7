//! ```text
//! y = light point,    s = |y - x|
//! weight = profile cos_light / (reach(n) cos_light + reach(n - 1) p_A P_l s^2 e^tau / p_w)
//! radiance += weight Le T          per channel, where cos_light > 0
//! ```
//!
//! 1. Whole batches are read, weighed and written; rows of dead lanes are blended out in the end.
//! 2. Light points are drawn for a stretch of rows before any is weighed. Of one row everything waits for what came
//!    before: numbers, point, distance, cosine, density. Halves of that are short enough for the processor to begin with
//!    the next rows.
//! 3. One disk and one lobe leave nothing to decide, so that it goes row by row; all else, by eight rows.
//! 4. Nothing but the weight can fail to be finite: see [`accumulate`](crate::accumulate::simd).

use core::marker::PhantomData;

use fogbow_avx512::Avx512;
use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::View3;
use crate::columns::paths::PathRows;
use crate::connect::light_sample::lights::{LightsIn, OneDisk};
use crate::connect::light_sample::simd::Draw;
use crate::lanes::{LANES, STRETCH};
use crate::media::Kind;
use crate::mis_weight::straight::Line;
use crate::phase::{Lobe, PhaseFunction, Turns};
use crate::real::{Real, Word};
use crate::survival::LogSurvival;
use crate::vec3::Vec3;
use crate::{Step, WalkLimits, lanes, random, with_phase};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let (lights, phase) = (columns.lights, &columns.medium.phase);
    match (OneDisk::of(lights), OneDisk::of(lights), phase) {
        (Some(disk), _, PhaseFunction::HenyeyGreenstein(lobe)) => connect(step, columns, disk, Lobe::<f32>::new(*lobe)),
        (_, Some(disk), _) => with_phase!(phase, |phase| connect::<f32x8, _>(step, columns, disk, phase)),
        (_, None, _) => with_phase!(phase, |phase| connect::<f32x8, _>(step, columns, lights, phase)),
    }
}

/// The same, for the widest registers that there are.
pub fn run_widest(step: Step, columns: Columns<'_, '_>) {
    let (Some(avx512), Some(disk), PhaseFunction::HenyeyGreenstein(lobe)) =
        (Avx512::detect(), OneDisk::of(columns.lights), &columns.medium.phase)
    else {
        return run(step, columns);
    };
    avx512.run(
        #[inline(always)]
        || connect(step, columns, disk, Lobe::<f32>::new(*lobe)),
    );
}

#[inline(always)]
fn connect<F: Real, L: LightsIn<F>>(step: Step, columns: Columns<'_, '_>, lights: L, phase: impl Turns<F>) {
    let Columns { medium, walk, live, paths, outlook, vertex, before, throughput, radiance, dropped, tally, .. } = columns;
    let Kind::Homogeneous(medium) = &medium.kind else { unreachable!("where extinction varies there is more to it") };
    let extinction = F::splat(medium.extinction(0));
    let depends_on_start = columns.lights.selection_depends_on_start();
    let survival = LogSurvival::of(&walk.survival);
    let mut lines = Lines::<F, L>::new();
    for batches in (0..live.stretches()).filter_map(|k| live.stretch(k)) {
        let starts = Starts {
            step,
            paths: paths.stretch::<F>(batches.clone()),
            position: vertex.position.stretch(batches.clone()),
            arriving: before.direction.stretch(batches.clone()),
            light_sum: outlook.light_sum.stretch::<F>(batches.clone()),
            depends_on_start,
        };
        for (k, b) in batches.clone().enumerate() {
            let depth = u32x8::splat(step.clock) - paths.birth.batch(b);
            (lines.reach_start[k], lines.reach_light[k]) = reach(survival, walk, depth);
        }
        lines.draw(&starts, lights);
        lines.weigh(&starts, lights, phase, extinction);
        for (k, b) in batches.enumerate() {
            let (live, weight) = (live.batch(b), lines.weight[k]);
            let counts = lanes::bits(!weight.simd_eq(f32x8::ZERO)) & live;
            let finite = counts & lanes::bits(weight.is_finite());
            for lane in lanes::each(counts & !finite).map(|i| b * LANES + i) {
                dropped.note(paths.pixel.rows()[lane], paths.sample.rows()[lane]);
            }
            let channels = radiance.channels_mut().iter_mut().zip(throughput.channels()).enumerate();
            for (channel, (radiance, throughput)) in channels {
                let emitted = lights.radiance(&lines.emitters, k * LANES, channel);
                let contribution = weight * emitted * throughput.batch(b);
                let found = radiance.batch(b);
                radiance.set_batch(b, lanes::mask(finite).select(found + contribution, found));
            }
            let faces = lanes::bits(lines.cos_light[k].simd_gt(f32x8::ZERO)) & live;
            tally.tried += u64::from(faces.count_ones());
            tally.weighted += u64::from(counts.count_ones());
        }
    }
}

/// Vertices of a stretch.
struct Starts<'a, F: Real> {
    step: Step,
    paths: PathRows<'a, F>,
    position: View3<'a, F>,
    arriving: View3<'a, F>,
    /// Normalisation of the selection of lights, if it depends on the vertex.
    light_sum: &'a [F],
    depends_on_start: bool,
}

impl<F: Real> Starts<'_, F> {
    /// Draws emitters and points on them.
    #[inline(always)]
    fn draw<L: LightsIn<F>>(&self, lights: L, emitters: &mut [L::Emitters], x: &mut [F], y: &mut [F], z: &mut [F]) {
        let n = self.light_sum.len();
        let PathRows { pixel, sample, birth } = self.paths.first(n);
        let (emitters, x, y, z) = (&mut emitters[..n], &mut x[..n], &mut y[..n], &mut z[..n]);
        let (position, light_sum) = (self.position.first(n), &self.light_sum[..n]);
        let Step { clock, seed } = self.step;
        for i in 0..n {
            let depth = F::Word::splat(clock).wrapping_sub(birth[i]);
            let draw = Draw { pixel: pixel[i], sample: sample[i], depth, purpose: random::NEE_LIGHT, seed };
            let sum = if self.depends_on_start { light_sum[i] } else { F::ONE };
            let point;
            (emitters[i], point) = draw.light_point(lights, position.at(i), sum);
            (x[i], y[i], z[i]) = (point.x, point.y, point.z);
        }
    }
}

/// Their connections, eight by eight or one by one.
struct Lines<F: Real, L: LightsIn<F>> {
    emitters: [L::Emitters; STRETCH * LANES],
    /// Points on them, by component.
    point: [[f32x8; STRETCH]; 3],
    /// Shares of walks that get to the vertices, and on to the lights.
    reach_start: [f32x8; STRETCH],
    reach_light: [f32x8; STRETCH],
    weight: [f32x8; STRETCH],
    cos_light: [f32x8; STRETCH],
    numbers: PhantomData<F>,
}

impl<F: Real, L: LightsIn<F>> Lines<F, L> {
    fn new() -> Self {
        let zero = [f32x8::ZERO; STRETCH];
        Self {
            emitters: [L::Emitters::default(); STRETCH * LANES],
            point: [zero; 3],
            reach_start: zero,
            reach_light: zero,
            weight: zero,
            cos_light: zero,
            numbers: PhantomData,
        }
    }

    /// Draws their light points.
    #[inline(always)]
    fn draw(&mut self, starts: &Starts<'_, F>, lights: L) {
        let [x, y, z] = &mut self.point;
        starts.draw(lights, &mut self.emitters, rows_mut(x), rows_mut(y), rows_mut(z));
    }

    /// Weighs them.
    #[inline(always)]
    fn weigh(&mut self, starts: &Starts<'_, F>, lights: L, phase: impl Turns<F>, extinction: F) {
        let n = starts.light_sum.len();
        let (position, arriving, light_sum) = (starts.position.first(n), starts.arriving.first(n), starts.light_sum);
        let [x, y, z] = &self.point;
        let (x, y, z) = (&rows(x)[..n], &rows(y)[..n], &rows(z)[..n]);
        let (reach_start, reach_light) = (&rows(&self.reach_start)[..n], &rows(&self.reach_light)[..n]);
        let (weight, cos_light) = (&mut rows_mut(&mut self.weight)[..n], &mut rows_mut(&mut self.cos_light)[..n]);
        let emitters = &self.emitters[..n];
        for i in 0..n {
            let line = Line::new(lights, emitters[i], position.at(i), Vec3::new(x[i], y[i], z[i]));
            let inverse_density = phase.inverse_density_of(arriving.at(i), line.leaving);
            let sum = if starts.depends_on_start { light_sum[i] } else { F::ONE };
            weight[i] = line.weight(extinction * line.distance, sum, inverse_density, [reach_start[i], reach_light[i]]);
            cos_light[i] = line.cos_light;
        }
    }
}

/// Batches of a stretch one by one or eight by eight.
#[inline(always)]
fn rows<F: Real>(batches: &[f32x8; STRETCH]) -> &[F] {
    bytemuck::cast_slice(batches)
}

/// The same, to fill.
#[inline(always)]
fn rows_mut<F: Real>(batches: &mut [f32x8; STRETCH]) -> &mut [F] {
    bytemuck::cast_slice_mut(batches)
}

/// Shares of walks that get to vertices at this depth, and to the lights behind them.
#[inline(always)]
fn reach(survival: LogSurvival<'_>, walk: &WalkLimits, depth: u32x8) -> (f32x8, f32x8) {
    let segments = depth + u32x8::splat(1);
    let walks = lanes::as_mask(segments.simd_le(u32x8::splat(walk.segments)));
    (survival.reach(depth), walks.select(survival.reach(segments), f32x8::ZERO))
}
