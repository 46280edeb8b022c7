//! Phase functions that differ between the volumes of a field.
//!
//! A path turns by the phase function of the medium it scatters in. Connections and weights go by one that stands for all
//! of them: wherever a vertex of a suffix is, its density of turns is taken to be that of the *stand-in* `p~`, by every
//! technique and for every start. Weights of all techniques then add up to one as before, and what a connection leaves
//! out at each of its turns,
//!
//! ```text
//! p(turn) / p~(turn)        with the phase function p of the medium that the vertex is in,
//! ```
//!
//! is a factor of the candidate, as the albedo there is: the stage [`phase_quotient`](crate::phase_quotient). It costs
//! variance and no bias, less so the better the stand-in covers them all: its choice is that of the smallest largest
//! quotient.

use glam::DVec3;
use wide::{f32x8, u32x8};

use super::Field;
use crate::lanes;
use crate::phase::PhaseFunction;
use crate::vec3::Vec3x8;

/// The phase functions of a field and who has which.
#[derive(Clone, Debug, PartialEq)]
pub struct Phases {
    /// All that there are, each once.
    distinct: Vec<PhaseFunction>,
    /// Which of them is around all volumes and in the volumes.
    of: Vec<u32>,
}

impl Phases {
    /// Those around all volumes and in the volumes of a field.
    pub fn new(all: &[PhaseFunction]) -> Self {
        let mut distinct: Vec<PhaseFunction> = Vec::new();
        let of = all.iter().map(|phase| {
            distinct.iter().position(|other| other == phase).unwrap_or_else(|| {
                distinct.push(phase.clone());
                distinct.len() - 1
            }) as u32
        });
        Self { of: of.collect(), distinct }
    }

    /// All that there are, each once.
    pub fn distinct(&self) -> &[PhaseFunction] {
        &self.distinct
    }

    /// That of what is around all volumes.
    pub fn around(&self) -> &PhaseFunction {
        &self.distinct[self.of[0] as usize]
    }

    /// That of the medium at a point of `field`, for twins.
    pub fn at(&self, field: &Field, point: DVec3) -> &PhaseFunction {
        let (who, _) = field.here(field.cells_of(point));
        &self.distinct[self.of[who as usize] as usize]
    }

    /// What stands for all of them: of each of them, and of both the most forward and the most backward lobe, the one that
    /// the others exceed least.
    pub fn stand_in(&self) -> PhaseFunction {
        let lobes = self.distinct.iter().map(|phase| phase.twin().lobe().g);
        let [low, high] = lobes.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], g| [low.min(g), high.max(g)]);
        let both = PhaseFunction::two_lobe([high, low], 0.5);
        let all = self.distinct.iter().chain([&both]);
        let best = all.min_by(|a, b| self.largest_quotient(a).total_cmp(&self.largest_quotient(b)));
        best.expect("there is one").clone()
    }

    /// By how much the largest of them exceeds `stand_in` where it does so most.
    pub fn largest_quotient(&self, stand_in: &PhaseFunction) -> f64 {
        let largest = |cosine: f64| self.distinct.iter().map(|phase| phase.twin().density(cosine)).fold(0.0, f64::max);
        cosines().map(|cosine| largest(cosine) / stand_in.twin().density(cosine)).fold(0.0, f64::max)
    }
}

/// Cosines of turns, the closer to each other the closer they are to 1 and -1, where lobes are sharp.
fn cosines() -> impl Iterator<Item = f64> {
    const STEPS: i32 = 200;
    let towards = |end: f64| (0..=STEPS).map(move |i| end * (1.0 - 1e-10_f64.powf(f64::from(i) / f64::from(STEPS))));
    towards(1.0).chain(towards(-1.0))
}

/// Phase functions that differ between the volumes of a field, for eight points.
#[derive(Clone, Copy)]
pub struct PhasesX8<'a> {
    /// The field.
    pub field: &'a Field,
    /// Its phase functions.
    pub phases: &'a Phases,
}

impl PhasesX8<'_> {
    /// Where points are in a medium whose phase function is the distinct one of this `number`.
    #[inline(never)]
    pub fn are(self, number: usize, at: Vec3x8) -> f32x8 {
        let which = self.field.who(at).to_array().map(|who| self.phases.of[who as usize]);
        lanes::as_mask(u32x8::new(which).simd_eq(u32x8::splat(number as u32)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lobes_stand_in_for_two_lobes() {
        let [forward, backward] = [0.9, -0.3].map(PhaseFunction::henyey_greenstein);
        let phases = Phases::new(&[forward.clone(), backward.clone(), forward.clone()]);
        assert_eq!((phases.distinct.len(), &phases.of[..]), (2, &[0, 1, 0][..]));
        let stand_in = phases.stand_in();
        assert_eq!(stand_in, PhaseFunction::two_lobe([0.9, -0.3], 0.5));
        assert!(phases.largest_quotient(&stand_in) <= 2.0);
        assert!(phases.largest_quotient(&forward) > 30.0 && phases.largest_quotient(&backward) > 30.0);
    }

    #[test]
    fn droplets_stand_in_for_themselves_and_what_is_wider() {
        let [droplets, wide] = [PhaseFunction::droplets(20.0), PhaseFunction::isotropic()];
        let phases = Phases::new(&[droplets.clone(), wide]);
        assert_eq!(phases.stand_in(), droplets);
    }
}
