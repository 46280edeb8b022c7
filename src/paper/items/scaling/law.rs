//! The power by which times grow.
//!
//! No law `a + b x^p` fits them all the way: what every sample costs, half-filled batches and caches that are too small
//! have their share here and there. What is asked for is how times go on growing: the power between the last two
//! places,
//!
//! ```text
//! p = ln (time at the last place / time at the one before) / ln (last place / place before)
//! ```

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::paper::ratio::CONFIDENCE;

/// A power with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// The power.
    pub value: f64,
    /// How far its interval reaches on either side; infinite if that is not known.
    pub reach: f64,
}

impl Power {
    /// That by which every one of `turns` grows at the end, given as values for `places`.
    pub fn of(places: &[f64], turns: &[Vec<f64>]) -> Self {
        Self::mean(turns.iter().map(|times| at_the_end(places, times)).collect())
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

    /// Whether its interval reaches up to `power`, or beyond.
    pub fn may_be(self, power: f64) -> bool {
        self.value + self.reach >= power
    }
}

/// The power between the last two places; not a number if there are none.
fn at_the_end(places: &[f64], times: &[f64]) -> f64 {
    match (places, times) {
        ([.., a, b], [.., first, last]) => (last / first).ln() / (b / a).ln(),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 80.0];

    #[test]
    fn the_power_is_that_at_the_end() {
        for power in [0.5, 1.0, 2.0, 3.0] {
            let times = PLACES.map(|x| if x < 30.0 { 1.0 } else { 3.0 * x.powf(power) });
            assert!((at_the_end(&PLACES, &times) - power).abs() < 1e-9);
        }
        assert!(at_the_end(&PLACES[..1], &[1.0]).is_nan());
    }

    #[test]
    fn turns_that_differ_leave_an_interval() {
        let turn = |shake: f64| PLACES.map(|x| x * x * (1.0 + shake * (x / 10.0).sin())).to_vec();
        let turns = [0.0, 0.01, -0.01, 0.005, -0.005].map(turn);
        let power = Power::of(&PLACES, &turns);
        assert!((power.value - 2.0).abs() < power.reach && power.reach < 0.1, "{power:?}");
        assert!(power.may_be(2.0) && !power.may_be(2.2));
        assert_eq!(Power::of(&PLACES, &turns[..1]).reach, f64::INFINITY);
    }
}
