//! Roulette on the contribution, in f64.
//!
//! ```text
//! q = min(1, C / threshold),      C = max over channels of weight factor Le T
//! weight' = weight / q  if u < q,  else 0
//! ```
//!
//! so that the expectation of what is added stays C.

use super::Columns;
use crate::accumulate::reference::contribution;
use crate::random::Purpose;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, threshold, bucket, candidates, paths, throughput, worth } = columns;
    for row in bucket.rows() {
        let lane = candidates.lane.rows()[row] as usize;
        let weight = f64::from(worth.weight.rows()[row]);
        let channels = contribution(
            weight,
            worth.factor.row(row).map(f64::from),
            lights.emitters()[candidates.emitter.rows()[row] as usize].radiance.map(f64::from),
            throughput.row(lane).map(f64::from),
        );
        let used = &channels[..throughput.channels().len()];
        let survival = survival(f64::from(threshold.contribution), largest(used));
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let u = uniform(pixel, sample, paths.depth_of(step.clock, lane), threshold.purpose, step.seed);
        worth.weight.rows_mut()[row] = if u < survival { (weight / survival) as f32 } else { 0.0 };
    }
}

/// The number that decides: the fourth of the block in which a technique draws its light point.
pub fn uniform(pixel: u32, sample: u32, depth: u32, purpose: Purpose, seed: u32) -> f64 {
    let [_, _, _, word] = random::words(pixel, sample, random::block(depth, purpose), seed);
    random::uniform(word)
}

/// The largest of `channels`; not a number if one of them is none, so that such a candidate is kept and counted.
pub fn largest(channels: &[f64]) -> f64 {
    channels.iter().copied().fold(0.0, |largest, channel| if channel <= largest { largest } else { channel })
}

/// Probability with which a candidate of this contribution is kept. All are if the threshold is 0.
pub fn survival(threshold: f64, contribution: f64) -> f64 {
    if contribution < threshold {
        return contribution / threshold;
    }
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Spectrum;
    use crate::columns::paths::PathColumns;
    use crate::columns::queues::{Candidate, CandidateQueue, WorthTable};
    use crate::roulette::Threshold;
    use crate::tables::lights::{Emitter, Lights, Selection};
    use bumpalo::Bump;
    use glam::DVec3;

    #[test]
    fn the_expectation_is_the_contribution() {
        for contribution in [1e-30, 0.003, 0.0999, 0.1, 7.0] {
            let q = survival(0.1, contribution);
            let kept = contribution / q;
            assert!(q > 0.0 && q <= 1.0 && (kept / contribution.max(0.1) - 1.0).abs() < 1e-15, "{contribution}: {q}");
        }
        assert_eq!([0.0, 1e-9, 5.0].map(|contribution| survival(0.0, contribution)), [1.0; 3]);
        assert_eq!(survival(0.1, 0.0), 0.0);
    }

    #[test]
    fn the_brightest_channel_in_use_decides() {
        assert_eq!(largest(&[0.25, 1.0, 0.5]), 1.0);
        assert_eq!(largest(&[0.0; 3]), 0.0);
        assert!(largest(&[0.5, f64::NAN]).is_nan());
        assert_eq!(survival(0.1, f64::NAN), 1.0);
    }

    #[test]
    fn faint_candidates_survive_as_often_as_they_should() {
        let arena = Bump::new();
        let disk = Emitter::disk(DVec3::Z, -DVec3::Z, 1.0, [2.0, 1.0, 9.0]);
        let lights = Lights::new(vec![disk], Selection::Uniform);
        let rows = 4000;
        // One channel is in use: C = 0.5 * 0.25 * 2 * 0.8 = 0.2.
        let mut paths = PathColumns::new_in(&arena, rows);
        let mut throughput = Spectrum::new_in(&arena, rows, 1);
        let mut candidates = CandidateQueue::new_in(&arena, rows);
        let mut worth = WorthTable::new_in(&arena, rows, 1);
        let nowhere = [0.0; 3];
        for lane in 0..rows {
            paths.pixel.rows_mut()[lane] = lane as u32;
            throughput.set_row(lane, [0.8, 1.0, 1.0]);
            worth.weight.rows_mut()[lane] = 0.5;
            worth.factor.set_row(lane, [0.25, 1.0, 1.0]);
            let lane = lane as u32;
            candidates.push(Candidate { lane, emitter: 0, start: nowhere, arriving: nowhere, point: nowhere });
        }
        let columns = Columns {
            lights: &lights,
            threshold: Threshold { contribution: 0.8, purpose: random::BRIDGE_LIGHT },
            bucket: candidates.direct(),
            candidates: &candidates,
            paths: &paths,
            throughput: &throughput,
            worth: &mut worth,
        };
        run(Step { seed: 3, clock: 2 }, columns);
        let kept: Vec<_> = worth.weight.rows()[..rows].iter().filter(|weight| **weight > 0.0).collect();
        assert!(kept.iter().all(|weight| (**weight - 2.0).abs() < 1e-6), "{:?}", kept[0]);
        // Five standard deviations of a binomial count.
        assert!((kept.len() as f64 - 1000.0).abs() < 137.0, "{} of {rows}", kept.len());
    }
}
