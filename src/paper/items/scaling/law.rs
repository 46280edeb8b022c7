//! The power of a law, from what is measured of it.
//!
//! Time per sample is `a + b x^p`: something that every sample costs, and something that grows. The power p is that which
//! fits best, with the best a and b for it; all times are taken to be off by the same share of themselves.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::paper::ratio::CONFIDENCE;

/// Powers among which is looked.
const POWERS: [f64; 2] = [0.05, 4.0];
const STEPS: u32 = 4000;

/// A power with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// The power.
    pub value: f64,
    /// How far its interval reaches on either side; infinite if that is not known.
    pub reach: f64,
}

impl Power {
    /// That of the law by which every one of `turns` goes, given as values for `places`.
    pub fn of(places: &[f64], turns: &[Vec<f64>]) -> Self {
        Self::mean(turns.iter().map(|times| fitted(places, times)).collect())
    }

    /// The mean of independent results.
    pub fn mean(values: Vec<f64>) -> Self {
        let count = values.len() as f64;
        let value = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|one| (one - value).powi(2)).sum();
        let error = (squares / (count * (count - 1.0))).sqrt();
        let law = StudentsT::new(0.0, 1.0, count - 1.0).ok().filter(|_| values.len() > 1);
        let reach = law.map_or(f64::INFINITY, |law| law.inverse_cdf(0.5 + 0.5 * CONFIDENCE) * error);
        Self { value, reach }
    }
}

/// The power that fits best.
pub fn fitted(places: &[f64], times: &[f64]) -> f64 {
    let power = |step: u32| POWERS[0] + (POWERS[1] - POWERS[0]) * f64::from(step) / f64::from(STEPS);
    let misfits = (0..=STEPS).map(|step| (power(step), misfit(places, times, power(step))));
    misfits.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(f64::NAN, |best| best.0)
}

/// Sum of squares of relative misfits of the best `a + b x^power`.
fn misfit(places: &[f64], times: &[f64], power: f64) -> f64 {
    // Over the time all of them are to be 1: a u + b v = 1.
    let terms = || places.iter().zip(times).map(|(place, time)| (1.0 / time, place.powf(power) / time));
    let [uu, uv, vv, u, v] = terms().fold([0.0; 5], |sums, (u, v)| {
        let terms = [u * u, u * v, v * v, u, v];
        core::array::from_fn(|k| sums[k] + terms[k])
    });
    let determinant = uu * vv - uv * uv;
    let (a, b) = ((u * vv - v * uv) / determinant, (v * uu - u * uv) / determinant);
    terms().map(|(u, v)| (a * u + b * v - 1.0).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 80.0];

    #[test]
    fn what_every_sample_costs_does_not_hide_the_power() {
        for power in [0.5, 1.0, 2.0, 3.0] {
            for a in [0.0, 100.0, 10_000.0] {
                let times = PLACES.map(|x| a + 3.0 * x.powf(power));
                let found = fitted(&PLACES, &times);
                assert!((found - power).abs() < 2e-3, "{found} for {power} above {a}");
            }
        }
    }

    #[test]
    fn turns_that_differ_leave_an_interval() {
        let turn = |shake: f64| PLACES.map(|x| (100.0 + x * x) * (1.0 + shake * (x / 10.0).sin())).to_vec();
        let turns = [0.0, 0.01, -0.01, 0.005, -0.005].map(turn);
        let Power { value, reach } = Power::of(&PLACES, &turns);
        assert!((value - 2.0).abs() < reach && reach < 0.1, "{value} +- {reach}");
        assert_eq!(Power::of(&PLACES, &turns[..1]).reach, f64::INFINITY);
    }
}
