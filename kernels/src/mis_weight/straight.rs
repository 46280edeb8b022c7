//! Weights where next event estimation alone competes with walks, in media without colour.
//!
//! ```text
//! weight = profile / (reach(n) + reach(n - 1) r),    r = p_A P_l s^2 e^tau / (p_w cos_light)
//! ```
//!
//! One vertex is looked at, so that there is neither a suffix to fill nor a history to read.

use wide::{f32x8, u32x8};

use super::starts::Starts;
use super::{Columns, albedos};
use crate::connect::Techniques;
use crate::connect::light_sample::selection;
use crate::media::{MediumLanes, MediumX8};
use crate::phase::PhaseX8;
use crate::survival::LogSurvival;
use crate::transcendental::exp;
use crate::{Step, lanes};

/// Whether this is all that a bucket of candidates needs.
pub(super) fn suffices<M: MediumLanes>(columns: &Columns<'_, '_>) -> bool {
    let alone = Techniques { nee: true, ..Techniques::default() };
    let is_plain = !M::COLOURED && !columns.lights.has_distant();
    is_plain && columns.bucket.inserted == 0 && *columns.techniques == alone
}

/// Weighs a bucket of candidates for which this [`suffices`].
#[inline(always)]
pub(super) fn weigh<M: MediumLanes, P: PhaseX8>(step: Step, columns: Columns<'_, '_>, medium: M, phase: P) {
    let Columns { lights, walk, solid, bucket, candidates, paths, last_surface, outlook, worth, .. } = columns;
    albedos::fill(columns.medium, bucket, columns.chains, worth);
    let (medium, survival) = (medium.own(), LogSurvival::of(&walk.survival));
    for (b, rows) in bucket.batches() {
        let lane_of = candidates.lane.batch(b).to_array();
        let emitter_of = candidates.emitter.batch(b).to_array();
        let (start, point) = (candidates.start.batch(b), candidates.point.batch(b));
        let starts = Starts::new(&lane_of, rows, 0, paths, last_surface, walk, step);
        let (distance, leaving) = (point - start).length_and_direction();
        let cos_light = lights.cosine(&emitter_of, point, leaving);
        let mut inverse_density = phase.inverse_density(candidates.arriving.batch(b), leaving);
        let mut outside = lanes::mask(lanes::ALL);
        let on_surface = starts.surface & lanes::as_mask(starts.most_edges.simd_eq(u32x8::splat(1)));
        if solid && on_surface.any() {
            let cosine = leaving.dot(last_surface.normal.gather(&lane_of));
            outside = !on_surface | cosine.simd_gt(f32x8::ZERO);
            inverse_density = on_surface.select(f32x8::splat(core::f32::consts::PI) / cosine, inverse_density);
        }
        let light_sum =
            if lights.selection_depends_on_start() { outlook.light_sum.gather(&lane_of) } else { f32x8::ONE };
        let choices = lights.choices(&emitter_of);
        let selected = selection::probability(lights, &choices, start, light_sum);
        let attempt = selected * survival.reach(starts.depth(1));
        let geometry = choices.density * attempt * (distance * distance) / cos_light;
        let depth = medium.optical_depth(start, point, distance);
        let connected = starts.eligible(1).select(geometry * inverse_density * exp(depth), f32x8::ZERO);
        let sum = starts.reach_of_walk(survival, walk) + connected;
        let weighs = cos_light.simd_gt(f32x8::ZERO) & sum.simd_gt(f32x8::ZERO) & outside;
        worth.weight.set_batch(b, weighs.select(lights.profile(&emitter_of, cos_light) / sum, f32x8::ZERO));
    }
}
