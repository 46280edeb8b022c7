//! Contributions in f64.
//!
//! ```text
//! C = weight factor Le T,      segments = depth + inserted + 1
//! ```

use super::Columns;
use crate::columns::Spectrum;
use crate::{PathLengths, Step};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, lengths, bucket, candidates, worth, paths, throughput, .. } = columns;
    let Columns { radiance, origin, parts, dropped, .. } = columns;
    for row in bucket.rows() {
        let lane = candidates.lane.rows()[row] as usize;
        let weighs = worth.weight.rows()[row] != 0.0;
        if !weighs || !counts(lengths, paths.depth_of(step.clock, lane), bucket.inserted) {
            continue;
        }
        let contribution = contribution(
            f64::from(worth.weight.rows()[row]),
            worth.factor.row(row).map(f64::from),
            lights.emitters()[candidates.emitter.rows()[row] as usize].radiance.map(f64::from),
            throughput.row(lane).map(f64::from),
        );
        let Some(used) = used(&contribution, radiance) else {
            dropped.note(paths.pixel.rows()[lane], paths.sample.rows()[lane]);
            continue;
        };
        add(radiance, lane, used);
        let segments = paths.depth_of(step.clock, lane) + bucket.inserted as u32 + 1;
        parts.of(origin, segments).for_each(|part| add(part, lane, used));
    }
}

/// Adds to what a path has found.
pub(crate) fn add(found: &mut Spectrum<'_>, lane: usize, contribution: &[f64]) {
    for (sum, channel) in found.channels_mut().iter_mut().zip(contribution) {
        let sum = &mut sum.rows_mut()[lane];
        *sum = (f64::from(*sum) + channel) as f32;
    }
}

/// The part of a contribution that is for the channels in use, unless it is not finite.
pub(crate) fn used<'c>(contribution: &'c [f64; 3], radiance: &Spectrum<'_>) -> Option<&'c [f64]> {
    let used = &contribution[..radiance.channels().len()];
    used.iter().all(|channel| (*channel as f32).is_finite()).then_some(used)
}

/// Whether a path of `depth + inserted + 1` segments is among those asked for.
#[inline]
pub fn counts(lengths: PathLengths, depth: u32, inserted: usize) -> bool {
    let segments = depth as usize + inserted + 1;
    (lengths.min as usize..=lengths.max as usize).contains(&segments)
}

/// What a candidate of this weight and factor adds to its pixel, per channel [W/(m^2 sr)].
#[inline]
pub fn contribution(weight: f64, factor: [f64; 3], radiance: [f64; 3], throughput: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|channel| weight * factor[channel] * radiance[channel] * throughput[channel])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Medium;
    use crate::mis_weight::reference::factor;
    use crate::phase::PhaseFunction;
    use glam::DVec3;

    #[test]
    fn a_contribution_carries_one_albedo_per_inserted_vertex() {
        let of = |albedo: [f32; 3], inserted: usize| {
            factor(&Medium::homogeneous(1.0, albedo, PhaseFunction::isotropic()), &vec![DVec3::ZERO; inserted])
        };
        assert_eq!(contribution(0.5, of([0.5, 1.0, 0.0], 3), [2.0, 4.0, 8.0], [1.0, 0.5, 0.25]), [0.125, 1.0, 0.0]);
        assert_eq!(of([0.0; 3], 0), [1.0; 3]);
    }

    #[test]
    fn lengths_count_segments_from_camera_to_light() {
        let lengths = PathLengths { min: 2, max: 4 };
        let counted = [(0, 0), (1, 0), (1, 2), (1, 3), (3, 0), (4, 0)].map(|(d, m)| counts(lengths, d, m));
        assert_eq!(counted, [false, true, true, false, true, false]);
    }
}
