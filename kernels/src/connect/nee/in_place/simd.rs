//! ```text
//! y = light point,    s = |y - x|
//! weight = profile cos_light / (reach(n) cos_light + reach(n - 1) p_A P_l s^2 e^tau / p_w)
//! radiance += weight Le T          per channel, where cos_light > 0
//! ```
//!
//! 1. Whole batches are read, weighed and written; rows of dead lanes are blended out in the end.
//! 2. Light points are drawn for some batches ahead. Of one batch everything waits for what came before: numbers, point,
//!    distance, cosine, density. Halves of that are short enough for the processor to begin with the next batches.
//! 3. Nothing but the weight can fail to be finite: see [`accumulate`](crate::accumulate::simd).

use wide::{f32x8, u32x8};

use super::Columns;
use crate::connect::light_sample::lights::{LightsX8, OneDisk};
use crate::connect::light_sample::simd::Draw;
use crate::lanes::LANES;
use crate::media::homogeneous::{GreyLanes, HomogeneousX8};
use crate::media::{Kind, Medium, MediumLanes};
use crate::mis_weight::straight::Line;
use crate::phase::PhaseX8;
use crate::survival::LogSurvival;
use crate::vec3x8::Vec3x8;
use crate::{Step, WalkLimits, lanes, random, with_phase};

/// Batches whose light points are drawn before any is weighed.
const AHEAD: usize = 8;

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let lights = columns.lights;
    match OneDisk::of(lights) {
        Some(disk) => connect_with(step, columns, disk),
        None => connect_with(step, columns, lights),
    }
}

#[inline(always)]
fn connect_with(step: Step, columns: Columns<'_, '_>, lights: impl LightsX8) {
    let Medium { kind: Kind::Homogeneous(medium), phase, .. } = columns.medium else {
        unreachable!("where extinction varies there is more to it");
    };
    let medium = GreyLanes::new(medium).own();
    with_phase!(phase, |phase| connect(step, columns, lights, medium, phase));
}

#[inline(always)]
fn connect<L: LightsX8, P: PhaseX8>(step: Step, columns: Columns<'_, '_>, lights: L, medium: HomogeneousX8, phase: P) {
    let Columns { walk, live, paths, outlook, vertex, before, throughput, radiance, dropped, tally, .. } = columns;
    let depends_on_start = columns.lights.selection_depends_on_start();
    let n = live.batches();
    let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.view(n));
    let (starts, arriving, light_sum) = (vertex.position.view(n), before.direction.view(n), outlook.light_sum.view(n));
    let light_sum_of = |b: usize| if depends_on_start { light_sum[b] } else { f32x8::ONE };
    let depth_of = |b: usize| u32x8::splat(step.clock) - birth[b];
    let survival = LogSurvival::of(&walk.survival);
    let mut batches = live.each_batch();
    let nothing = Drawn { b: 0, live: 0, emitters: L::Emitters::default(), point: Vec3x8::ZERO };
    let mut ahead = [nothing; AHEAD];
    loop {
        let mut drawn = 0;
        for (to, (b, live)) in ahead.iter_mut().zip(&mut batches) {
            let (pixel, sample, depth) = (pixel[b], sample[b], depth_of(b));
            let draw = Draw { pixel, sample, depth, purpose: random::NEE_LIGHT, seed: step.seed };
            let (emitters, point) = draw.light_point(lights, starts.at(b), light_sum_of(b));
            *to = Drawn { b, live, emitters, point };
            drawn += 1;
        }
        if drawn == 0 {
            return;
        }
        for Drawn { b, live, emitters, point } in ahead[..drawn].iter().copied() {
            let line = Line::new(lights, emitters, starts.at(b), point);
            let inverse_density = phase.inverse_density(arriving.at(b), line.leaving);
            let reach = reach(survival, walk, depth_of(b));
            let weight = line.weight(medium, light_sum_of(b), inverse_density, reach);
            let counts = lanes::bits(!weight.simd_eq(f32x8::ZERO)) & live;
            let finite = counts & lanes::bits(weight.is_finite());
            for lane in lanes::each(counts & !finite).map(|i| b * LANES + i) {
                dropped.note(paths.pixel.rows()[lane], paths.sample.rows()[lane]);
            }
            let channels = radiance.channels_mut().iter_mut().zip(throughput.channels()).enumerate();
            for (channel, (radiance, throughput)) in channels {
                let contribution = weight * lights.radiance(&emitters, channel) * throughput.batch(b);
                let found = radiance.batch(b);
                radiance.set_batch(b, lanes::mask(finite).select(found + contribution, found));
            }
            let faces = lanes::bits(line.cos_light.simd_gt(f32x8::ZERO)) & live;
            tally.tried += u64::from(faces.count_ones());
            tally.weighted += u64::from(counts.count_ones());
        }
    }
}

/// Shares of walks that get to vertices at this depth, and to the lights behind them.
#[inline(always)]
fn reach(survival: LogSurvival<'_>, walk: &WalkLimits, depth: u32x8) -> [f32x8; 2] {
    let segments = depth + u32x8::splat(1);
    let walks = lanes::as_mask(segments.simd_le(u32x8::splat(walk.segments)));
    [survival.reach(depth), walks.select(survival.reach(segments), f32x8::ZERO)]
}

/// The light points of a batch.
#[derive(Clone, Copy)]
struct Drawn<E> {
    b: usize,
    live: u32,
    emitters: E,
    point: Vec3x8,
}
