//! Sums over starts and techniques, for eight paths.

use core::ops::RangeInclusive;

use wide::{f32x8, u32x8};

use crate::connect::lis::{self, Lis};
use crate::connect::suffix::{Arrival, Suffix};
use crate::connect::{Technique, Techniques, bridge, mvnee, nee, omnee};
use crate::lanes::{self, LANES};
use crate::media::MediumX8;
use crate::phase::PhaseX8;
use crate::tables::lights::Lights;

/// Eight paths that end on lights with a place, and the techniques that compete for them.
#[derive(Clone)]
pub struct Competition<'a, M, P> {
    /// The techniques.
    pub techniques: &'a Techniques,
    /// The phase function.
    pub phase: P,
    /// The lights.
    pub lights: &'a Lights,
    /// On which emitter each path ends.
    pub emitter_of: [u32; LANES],
    /// What all starts of a path have in common.
    pub arrival: Arrival<'a, M>,
    /// Segments of each path.
    pub segments: u32x8,
    /// Most segments of any path.
    pub longest: u32,
    /// The starts, counted from the light, that any technique can use.
    pub starts: RangeInclusive<usize>,
    /// The farthest of them that [`near`](crate::connect::Row::near) lets techniques use that are limited in distance.
    pub farthest_near: usize,
}

impl<M: MediumX8, P: PhaseX8> Competition<'_, M, P> {
    /// `sum`, and the ratios of all techniques times their starts' [attempts](crate::connect::suffix::SuffixVertex).
    /// One line each, where a loop would have to keep in memory what they share.
    #[inline(always)]
    pub fn add_ratios(&self, sum: f32x8, suffix: &mut Suffix<'_>) -> f32x8 {
        let sum = self.add(Technique::Nee, sum, suffix);
        let sum = self.add(Technique::Omnee, sum, suffix);
        let sum = self.add(Technique::Mvnee, sum, suffix);
        let sum = self.add(Technique::Bridge, sum, suffix);
        self.add(Technique::Lis, sum, suffix)
    }

    /// `sum`, and the ratios of one technique, if it is active and can use any of the starts.
    #[inline(always)]
    fn add(&self, technique: Technique, sum: f32x8, suffix: &mut Suffix<'_>) -> f32x8 {
        let Techniques { nee, mvnee, omnee, bridge, lis } = self.techniques;
        let (fewest, most) = (*self.starts.start(), *self.starts.end());
        let ratios = match technique {
            Technique::Nee if *nee && fewest == 1 => self.straight(suffix, lanes::mask(lanes::ALL)),
            Technique::Omnee if *omnee && fewest <= 2 && most >= 2 => {
                omnee::simd::ratio(&self.arrival, suffix, self.phase.forward_share())
            }
            Technique::Nee | Technique::Omnee => return sum,
            Technique::Mvnee => {
                let Some(mvnee) = mvnee else { return sum };
                mvnee::simd::ratios(mvnee, &self.arrival, suffix, fewest..=self.farthest_near)
            }
            Technique::Bridge => {
                let Some(bridge) = bridge else { return sum };
                let room = |a: usize| self.room(self.longest, bridge.max_inserted.saturating_add(1) as f32, a);
                bridge::simd::ratios(bridge, &self.phase, &self.arrival, suffix, fewest..=most, room)
            }
            Technique::Lis => {
                let Some(lis) = lis else { return sum };
                // A copy: what is lent would have to stay in memory for the other techniques, too.
                self.clone().light_sampled(lis, suffix)
            }
        };
        sum + ratios
    }

    /// The ratio of a straight connection, in rows where that is `possible`.
    #[inline(always)]
    fn straight(&self, suffix: &Suffix<'_>, possible: f32x8) -> f32x8 {
        let start = &suffix.vertices[1];
        (start.eligible & possible).select(nee::simd::ratio(&self.arrival, start), f32x8::ZERO)
    }

    /// Light importance sampling, and its companion close to the light.
    #[inline(never)]
    fn light_sampled(&self, lis: &Lis, suffix: &mut Suffix<'_>) -> f32x8 {
        let (fewest, most) = (*self.starts.start(), *self.starts.end());
        let mut sum = f32x8::ZERO;
        if let Some(companion) = self.techniques.companion().filter(|_| fewest == 1) {
            let longest = f32x8::splat(companion.max_distance * companion.max_distance);
            sum += self.straight(suffix, self.arrival.last_squared.simd_le(longest));
        }
        if most >= fewest.max(2) {
            let room = |a: usize| self.room(self.longest - 1, lis.most_edges(), a);
            let emission = self.lights.direction_density(&self.emitter_of, self.arrival.cos_light);
            sum += lis::simd::ratios(lis, &self.phase, emission, &self.arrival, suffix, fewest.max(2)..=most, room);
        }
        sum
    }

    /// The most edges that a connection from start `a` may have, where paths have at most `longest` segments and
    /// connections `most` edges.
    #[inline(always)]
    fn room(&self, longest: u32, most: f32, a: usize) -> f32x8 {
        let depth = self.segments - u32x8::splat(a as u32);
        lanes::to_f32(u32x8::splat(longest) - depth).fast_min(f32x8::splat(most))
    }
}
