//! Weights where next event estimation alone competes with walks, in media without colour.
//!
//! ```text
//! weight = profile cos_light / (reach(n) cos_light + reach(n - 1) p_A P_l s^2 e^tau / p_w)
//! ```
//!
//! One vertex is looked at, so that there is neither a suffix to fill nor a history to read.

use wide::{f32x8, u32x8};

use super::starts::Starts;
use super::{Columns, factors};
use crate::connect::light_sample::lights::LightsIn;
use crate::media::{MediumLanes, MediumX8};
use crate::phase::PhaseX8;
use crate::real::{Mask, Real};
use crate::survival::LogSurvival;
use crate::transcendental::exp;
use crate::vec3::Vec3;
use crate::{Step, lanes};

/// Whether this is all that a bucket of candidates needs.
pub(super) fn suffices<M: MediumLanes>(columns: &Columns<'_, '_>) -> bool {
    let is_plain = !M::COLOURED && !columns.lights.has_distant();
    is_plain && columns.bucket.inserted == 0 && columns.techniques.are_nee_alone()
}

/// Weighs a bucket of candidates for which this [`suffices`].
#[inline(never)]
pub(super) fn weigh<M: MediumLanes, P: PhaseX8>(step: Step, columns: Columns<'_, '_>, medium: M, phase: P) {
    let Columns { lights, walk, solid, bucket, candidates, paths, last_surface, outlook, worth, .. } = columns;
    factors::fill(columns.medium, bucket, columns.chains, worth);
    let (medium, survival) = (medium.own(), LogSurvival::of(&walk.survival));
    for (b, rows) in bucket.batches() {
        let lane_of = candidates.lane.batch(b).to_array();
        let starts = Starts::new(&lane_of, rows, 0, paths, last_surface, walk, step);
        let line = Line::new(
            lights,
            candidates.emitter.batch(b).to_array(),
            candidates.start.batch(b),
            candidates.point.batch(b),
        );
        let mut inverse_density = phase.inverse_density(candidates.arriving.batch(b), line.leaving);
        let mut outside = lanes::mask(lanes::ALL);
        let on_surface = starts.surface & lanes::as_mask(starts.most_edges.simd_eq(u32x8::splat(1)));
        if solid && on_surface.any() {
            let cosine = line.leaving.dot(last_surface.normal.gather(&lane_of));
            outside = !on_surface | cosine.simd_gt(f32x8::ZERO);
            inverse_density = on_surface.select(f32x8::splat(core::f32::consts::PI) / cosine, inverse_density);
        }
        let light_sum =
            if lights.selection_depends_on_start() { outlook.light_sum.gather(&lane_of) } else { f32x8::ONE };
        let reach_start = starts.eligible(1).select(survival.reach(starts.depth(1)), f32x8::ZERO);
        let reach_light = starts.reach_of_walk(survival, walk);
        let depth = medium.optical_depth(line.start, line.point, line.distance);
        let weight = line.weight(depth, light_sum, inverse_density, [reach_start, reach_light]);
        worth.weight.set_batch(b, outside.select(weight, f32x8::ZERO));
    }
}

/// Straight connections from starts to points on emitters.
pub(crate) struct Line<F: Real, L: LightsIn<F>> {
    lights: L,
    emitters: L::Emitters,
    start: Vec3<F>,
    point: Vec3<F>,
    /// Their lengths.
    pub distance: F,
    /// Directions at the starts.
    pub leaving: Vec3<F>,
    /// Cosines at the lights.
    pub cos_light: F,
}

impl<F: Real, L: LightsIn<F>> Line<F, L> {
    /// Those from `start` to `point`.
    #[inline(always)]
    pub fn new(lights: L, emitters: L::Emitters, start: Vec3<F>, point: Vec3<F>) -> Self {
        let (distance, leaving) = (point - start).length_and_direction();
        let cos_light = lights.cosine(&emitters, point, leaving);
        Self { lights, emitters, start, point, distance, leaving, cos_light }
    }

    /// The weight through this optical `depth`, where a share `reach_start` of walks gets to the starts and `reach_light`
    /// to the light, and where the density of turns is one over `inverse_density` [1/sr].
    #[inline(always)]
    pub fn weight(&self, depth: F, light_sum: F, inverse_density: F, [reach_start, reach_light]: [F; 2]) -> F {
        let attempt = self.lights.probability(&self.emitters, self.start, light_sum) * reach_start;
        let area = self.lights.density(&self.emitters) * attempt * (self.distance * self.distance);
        let connected = reach_start.simd_gt(F::ZERO).select(area * inverse_density * exp(depth), F::ZERO);
        let sum = reach_light.mul_add(self.cos_light, connected);
        // A sum that is no number makes a weight that is dropped and counted.
        let weighs = self.cos_light.simd_gt(F::ZERO) & !sum.simd_le(F::ZERO);
        let profile = self.lights.profile(&self.emitters, self.cos_light);
        weighs.select(profile * self.cos_light / sum, F::ZERO)
    }
}
