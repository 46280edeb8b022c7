//! ```text
//! y = light point,    s = |y - x|
//! weight = profile cos_light / (reach(n) cos_light + reach(n - 1) p_A P_l s^2 e^tau / p_w)
//! weight = weight / q  if u < q,  else 0,     q = min(1, weight max(Le T) / threshold)
//! radiance += weight Le T          per channel, where cos_light > 0
//! ```
//!
//! 1. Whole batches are read, weighed and written; rows of dead lanes are blended out in the end.
//! 2. Light points are drawn for a stretch of rows before any is weighed. Of one row everything waits for what came
//!    before: numbers, point, distance, cosine, density. Halves of that are short enough for the processor to begin with
//!    the next rows.
//! 3. One disk and one lobe leave nothing to decide, so that it goes row by row; all else, by eight rows.
//! 4. Nothing but the weight can fail to be finite: see [`accumulate`](crate::accumulate::simd).

use core::f32::consts::PI;
use core::marker::PhantomData;

use fogbow_processor::Avx512;
use wide::{f32x8, u32x8};

use super::{Columns, Tally};
use crate::columns::paths::PathRows;
use crate::columns::queues::CandidateBatch;
use crate::columns::{Column, View3};
use crate::connect::light_sample::lights::{LightsIn, OneDisk};
use crate::connect::light_sample::simd::Draw;
use crate::lanes::{LANES, STRETCH};
use crate::media::Kind;
use crate::mis_weight::straight::Line;
use crate::phase::{Lobe, PhaseFunction, Turns};
use crate::real::{Mask, Real, Word};
use crate::roulette::{Threshold, simd as roulette};
use crate::survival::LogSurvival;
use crate::vec3::Vec3;
use crate::{Step, WalkLimits, lanes, random, with_phase};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let (lights, phase) = (columns.lights, &columns.medium.phase);
    if let Some((disk, lobe)) = disk_and_lobe(&columns) {
        return connect(step, columns, disk, lobe);
    }
    match OneDisk::of(lights) {
        Some(disk) => with_phase!(phase, |phase| connect_by_eight(step, columns, disk, phase)),
        None => with_phase!(phase, |phase| connect_by_eight(step, columns, lights, phase)),
    }
}

/// A function of its own for every kind of lights and phase function.
#[inline(never)]
fn connect_by_eight<L: LightsIn<f32x8>>(step: Step, columns: Columns<'_, '_>, lights: L, phase: impl Turns<f32x8>) {
    connect::<f32x8, _>(step, columns, lights, phase);
}

/// The same, for the widest registers that there are.
pub fn run_widest(step: Step, columns: Columns<'_, '_>) {
    let (Some(avx512), Some((disk, lobe))) = (Avx512::detect(), disk_and_lobe(&columns)) else {
        return run(step, columns);
    };
    avx512.run(
        #[inline(always)]
        || connect(step, columns, disk, lobe),
    );
}

/// The one light, if it is a plain disk, and the phase function, if it is a single lobe.
fn disk_and_lobe(columns: &Columns<'_, '_>) -> Option<(OneDisk<f32>, Lobe<f32>)> {
    match columns.medium.phase {
        PhaseFunction::HenyeyGreenstein(lobe) => Some((OneDisk::of(columns.lights)?, Lobe::new(lobe))),
        _ => None,
    }
}

#[inline(always)]
fn connect<F: Real, L: LightsIn<F>>(step: Step, mut columns: Columns<'_, '_>, lights: L, phase: impl Turns<F>) {
    let Columns { medium, walk, live, paths, outlook, last_surface, solid, vertex, before, .. } = columns;
    let Kind::Homogeneous(medium) = &medium.kind else { unreachable!("where extinction varies there is more to it") };
    let extinction = F::splat(medium.extinction(0));
    let depends_on_start = columns.lights.selection_depends_on_start();
    let survival = LogSurvival::of(&walk.survival);
    let mut lines = Lines::<F, L>::new();
    for batches in live.each_stretch() {
        let starts = Starts {
            step,
            paths: paths.stretch::<F>(batches.clone()),
            position: vertex.position.stretch(batches.clone()),
            arriving: before.direction.stretch(batches.clone()),
            light_sum: outlook.light_sum.stretch::<F>(batches.clone()),
            depends_on_start,
            last_surface: last_surface.depth.stretch::<F>(batches.clone()),
            normal: last_surface.normal.stretch(batches.clone()),
        };
        for (k, b) in batches.clone().enumerate() {
            let depth = u32x8::splat(step.clock) - paths.birth.batch(b);
            (lines.reach_start[k], lines.reach_light[k]) = reach(survival, walk, depth);
        }
        lines.draw(&starts, lights);
        if solid {
            lines.weigh::<true>(&starts, lights, phase, extinction);
        } else {
            lines.weigh::<false>(&starts, lights, phase, extinction);
        }
        for (k, b) in batches.enumerate() {
            lines.settle(k, b, lights, &mut columns);
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
    /// Depth and normal of the last vertex on a surface, where there are any.
    last_surface: &'a [F::Word],
    normal: View3<'a, F>,
}

impl<F: Real> Starts<'_, F> {
    /// Draws emitters, points on them, and the words for the roulette.
    #[inline(always)]
    fn draw<L: LightsIn<F>>(
        &self,
        lights: L,
        emitters: &mut [L::Emitters],
        [x, y, z]: [&mut [F]; 3],
        last: &mut [F::Word],
    ) {
        let n = self.light_sum.len();
        let PathRows { pixel, sample, birth } = self.paths.first(n);
        let (emitters, x, y, z, last) = (&mut emitters[..n], &mut x[..n], &mut y[..n], &mut z[..n], &mut last[..n]);
        let (position, light_sum) = (self.position.first(n), &self.light_sum[..n]);
        let Step { clock, seed } = self.step;
        for i in 0..n {
            let depth = F::Word::splat(clock).wrapping_sub(birth[i]);
            let draw = Draw { pixel: pixel[i], sample: sample[i], depth, purpose: random::NEE_LIGHT, seed };
            let sum = if self.depends_on_start { light_sum[i] } else { F::ONE };
            let point;
            (emitters[i], point, last[i]) = draw.light_point(lights, position.at(i), sum);
            (x[i], y[i], z[i]) = (point.x, point.y, point.z);
        }
    }

    /// The depth of a vertex.
    #[inline(always)]
    fn depth(&self, i: usize) -> F::Word {
        F::Word::splat(self.step.clock).wrapping_sub(self.paths.birth[i])
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
    /// Words for the roulette.
    last: [u32x8; STRETCH],
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
            last: [u32x8::splat(0); STRETCH],
            numbers: PhantomData,
        }
    }

    /// Draws their light points.
    #[inline(always)]
    fn draw(&mut self, starts: &Starts<'_, F>, lights: L) {
        let [x, y, z] = &mut self.point;
        let last = bytemuck::cast_slice_mut(&mut self.last);
        starts.draw(lights, &mut self.emitters, [rows_mut(x), rows_mut(y), rows_mut(z)], last);
    }

    /// Weighs them. `SOLID`: whether some start on surfaces, where light is reflected towards one side, with a density of
    /// `cos theta / pi`.
    #[inline(always)]
    fn weigh<const SOLID: bool>(&mut self, starts: &Starts<'_, F>, lights: L, phase: impl Turns<F>, extinction: F) {
        let n = starts.light_sum.len();
        let (position, arriving, light_sum) = (starts.position.first(n), starts.arriving.first(n), starts.light_sum);
        let (last_surface, normal) = (&starts.last_surface[..n], starts.normal.first(n));
        let [x, y, z] = &self.point;
        let (x, y, z) = (&rows(x)[..n], &rows(y)[..n], &rows(z)[..n]);
        let (reach_start, reach_light) = (&rows(&self.reach_start)[..n], &rows(&self.reach_light)[..n]);
        let (weight, cos_light) = (&mut rows_mut(&mut self.weight)[..n], &mut rows_mut(&mut self.cos_light)[..n]);
        let emitters = &self.emitters[..n];
        for i in 0..n {
            let line = Line::new(lights, emitters[i], position.at(i), Vec3::new(x[i], y[i], z[i]));
            let mut inverse_density = phase.inverse_density_of(arriving.at(i), line.leaving);
            let on_surface = last_surface[i].is(starts.depth(i));
            let cosine = line.leaving.dot(normal.at(i));
            if SOLID {
                inverse_density = on_surface.select(F::splat(PI) / cosine, inverse_density);
            }
            let sum = if starts.depends_on_start { light_sum[i] } else { F::ONE };
            let (depth, reach) = (extinction * line.distance, [reach_start[i], reach_light[i]]);
            weight[i] = line.weight(depth, sum, inverse_density, reach);
            cos_light[i] = line.cos_light;
            if SOLID {
                weight[i] = (!on_surface | cosine.simd_gt(F::ZERO)).select(weight[i], F::ZERO);
            }
        }
    }

    /// Counts or lists what batch number `k` of a stretch, batch `b` of all, brings.
    #[inline(always)]
    fn settle(&self, k: usize, b: usize, lights: L, columns: &mut Columns<'_, '_>) {
        let Columns { live, paths, throughput, blocked, threshold, .. } = *columns;
        let emitted = |channel: usize| lights.radiance(&self.emitters, k * LANES, channel);
        let (live, mut weight) = (live.batch(b), self.weight[k]);
        let counts = |weight: f32x8| lanes::bits(!weight.simd_eq(f32x8::ZERO)) & live;
        let weighted = counts(weight);
        if let Some(Threshold { contribution, .. }) = threshold {
            let brightness = |(channel, throughput): (usize, &Column<'_, f32>)| emitted(channel) * throughput.batch(b);
            let brightnesses = throughput.channels().iter().enumerate().map(brightness);
            let brightest = brightnesses.fold(f32x8::ZERO, |brightest, channel| brightest.fast_max(channel));
            let survival = weight * brightest * f32x8::splat(1.0 / contribution);
            weight = roulette::play(weight, survival, weighted, || random::uniform_f32(self.last[k]));
        }
        let kept = counts(weight);
        if blocked {
            self.list(k, b, lights, kept, weight, columns);
        } else {
            let finite = kept & lanes::bits(weight.is_finite());
            for lane in lanes::each(kept & !finite).map(|i| b * LANES + i) {
                columns.dropped.note(paths.pixel.rows()[lane], paths.sample.rows()[lane]);
            }
            let channels = columns.radiance.channels_mut().iter_mut().zip(throughput.channels()).enumerate();
            for (channel, (radiance, throughput)) in channels {
                let contribution = weight * emitted(channel) * throughput.batch(b);
                let found = radiance.batch(b);
                radiance.set_batch(b, lanes::mask(finite).select(found + contribution, found));
            }
        }
        let faces = lanes::bits(self.cos_light[k].simd_gt(f32x8::ZERO)) & live;
        let Tally { tried, weighted: all_weighted, kept: all_kept } = &mut *columns.tally;
        *tried += u64::from(faces.count_ones());
        *all_weighted += u64::from(weighted.count_ones());
        *all_kept += u64::from(kept.count_ones());
    }

    /// Lists the `kept` ones of a batch.
    #[inline(always)]
    fn list(&self, k: usize, b: usize, lights: L, kept: u32, weight: f32x8, columns: &mut Columns<'_, '_>) {
        if kept == 0 {
            return;
        }
        let [x, y, z] = &self.point;
        columns.worth.store_packed(columns.candidates.len, lanes::pack_order(kept), weight);
        let candidates = CandidateBatch {
            lane: lanes::indices(b),
            emitter: lights.indices(&self.emitters, k * LANES),
            start: columns.vertex.position.batch(b),
            arriving: columns.before.direction.batch(b),
            point: Vec3::new(x[k], y[k], z[k]),
        };
        columns.candidates.push_batch(kept, candidates);
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
