//! Contributions in f64.
//!
//! ```text
//! C = weight Le T albedo^inserted,      segments = depth + inserted + 1
//! ```

use super::Columns;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;
use crate::{PathLengths, Step};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, lengths: PathLengths, step: Step, columns: Columns<'_, '_>) {
    let Columns { bucket, candidates, paths, dropped } = columns;
    for row in bucket.rows() {
        let lane = candidates.lane.rows()[row] as usize;
        if !counts(lengths, paths.depth(step.clock, lane), bucket.inserted) {
            continue;
        }
        let contribution = contribution(
            f64::from(candidates.weight.rows()[row]),
            lights.emitters()[candidates.emitter.rows()[row] as usize].radiance.map(f64::from),
            paths.columns.throughput.row(lane).map(f64::from),
            medium.albedo.map(f64::from),
            bucket.inserted,
        );
        let used = &contribution[..paths.channels];
        if used.iter().any(|channel| !(*channel as f32).is_finite()) {
            dropped.note(paths.columns.pixel.rows()[lane], paths.columns.sample.rows()[lane]);
            continue;
        }
        for (sum, channel) in paths.columns.radiance.channels_mut().into_iter().zip(used) {
            let sum = &mut sum.rows_mut()[lane];
            *sum = (f64::from(*sum) + channel) as f32;
        }
    }
}

/// Whether a path of `depth + inserted + 1` segments is among those asked for.
pub fn counts(lengths: PathLengths, depth: u32, inserted: usize) -> bool {
    let segments = depth as usize + inserted + 1;
    (lengths.min as usize..=lengths.max as usize).contains(&segments)
}

/// What a candidate adds to its pixel, per channel [W/(m^2 sr)].
pub fn contribution(
    weight: f64,
    radiance: [f64; 3],
    throughput: [f64; 3],
    albedo: [f64; 3],
    inserted: usize,
) -> [f64; 3] {
    core::array::from_fn(|channel| {
        let inserted_albedo: f64 = core::iter::repeat_n(albedo[channel], inserted).product();
        weight * radiance[channel] * throughput[channel] * inserted_albedo
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contribution_carries_one_albedo_per_inserted_vertex() {
        let c = contribution(0.5, [2.0, 4.0, 8.0], [1.0, 0.5, 0.25], [0.5, 1.0, 0.0], 3);
        assert_eq!(c, [0.125, 1.0, 0.0]);
        assert_eq!(contribution(1.0, [1.0; 3], [1.0; 3], [0.0; 3], 0), [1.0; 3]);
    }

    #[test]
    fn lengths_count_segments_from_camera_to_light() {
        let lengths = PathLengths { min: 2, max: 4 };
        let counted = [(0, 0), (1, 0), (1, 2), (1, 3), (3, 0), (4, 0)].map(|(d, m)| counts(lengths, d, m));
        assert_eq!(counted, [false, true, true, false, true, false]);
    }
}
