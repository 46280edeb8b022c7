//! What renders are worth, one over the other, and how sure that is.
//!
//! Renders that take turns have worth anew in every turn: samples, seconds, and the squared error of the image of that
//! turn alone. A ratio of two of them is therefore known with an interval, by the jackknife: it is formed anew without
//! each turn, and with T turns
//!
//! ```text
//! SE(ln ratio)^2 = (T - 1) / T * sum over turns of (ln ratio without t - mean of these)^2
//! ```
//!
//! The same turn is left out of both, as whatever else the machine did then slowed both.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability that an interval contains the ratio.
pub const CONFIDENCE: f64 = 0.95;

/// Factor by which a published ratio may be off, as it stands: they have one or two digits.
const ROUNDING: f64 = 1.05;

/// What is found of something published.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It agrees.
    Agrees,
    /// It agrees in kind, and not in size.
    InPart,
    /// It does not.
    Differs,
    /// What is found covers both answers.
    Undecided,
}

impl Verdict {
    /// That of something known for sure.
    pub fn of(agrees: bool) -> Self {
        if agrees { Self::Agrees } else { Self::Differs }
    }

    /// That of two things that both have to hold.
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Agrees, Self::Agrees) => Self::Agrees,
            (Self::Differs, _) | (_, Self::Differs) => Self::Differs,
            (Self::Undecided, _) | (_, Self::Undecided) => Self::Undecided,
            _ => Self::InPart,
        }
    }

    /// As people read it.
    pub fn text(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::InPart => "agrees in part",
            Self::Differs => "differs",
            Self::Undecided => "not decided",
        }
    }
}

/// One turn of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// How long it took `[s]`.
    pub seconds: f64,
    /// Samples of every pixel.
    pub samples: f64,
    /// Mean squared error of the image of these samples, of all channels; not a number if there is no reference.
    pub squared: f64,
    /// The same of green alone.
    pub green: f64,
}

/// Whose errors are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// All of them.
    All,
    /// Green, of which there are published numbers.
    Green,
}

/// What of a render is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worth {
    /// Samples per second.
    Rate,
    /// What a sample is worth: one over the squared error of one per pixel.
    Sample,
    /// What a second is worth: both.
    Second,
}

impl Worth {
    /// That of some turns, per pixel.
    fn of<'a>(self, channels: Channels, turns: impl Iterator<Item = &'a Turn>) -> f64 {
        let mut sums = [0.0; 3];
        for Turn { seconds, samples, squared, green } in turns {
            let squared = if channels == Channels::Green { green } else { squared };
            // Squared error falls as one over samples.
            let of_one = squared * samples;
            [*seconds, *samples, of_one * samples].into_iter().zip(&mut sums).for_each(|(value, sum)| *sum += value);
        }
        let [seconds, samples, squared] = sums;
        let (rate, variance) = (samples / seconds, squared / samples);
        match self {
            Self::Rate => rate,
            Self::Sample => 1.0 / variance,
            Self::Second => rate / variance,
        }
    }
}

/// A ratio with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// Ends of its interval of [`CONFIDENCE`]: from 0 to infinity where nothing is known.
    pub interval: [f64; 2],
}

impl Ratio {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { value: f64::NAN, interval: [0.0, f64::INFINITY] };

    /// The worth of the renders that took `turns` over that of those that took `others`, in the same turns.
    pub fn of(worth: Worth, channels: Channels, turns: &[Turn], others: &[Turn]) -> Self {
        let ratio = |left_out: Option<usize>| {
            let all_but = |turns: &'_ [Turn]| {
                let kept = turns.iter().enumerate().filter(|(turn, _)| Some(*turn) != left_out).map(|(_, turn)| *turn);
                worth.of(channels, kept.collect::<Vec<_>>().iter())
            };
            all_but(turns) / all_but(others)
        };
        let value = ratio(None);
        if turns.len() != others.len() || !(value.is_finite() && value > 0.0) {
            return Self { value, ..Self::UNKNOWN };
        }
        let logs: Vec<f64> = (0..turns.len()).map(|turn| ratio(Some(turn)).ln()).collect();
        Self { value, interval: interval(value, &logs) }
    }

    /// Whether it is above `limit`, or not.
    pub fn is_above(self, limit: f64) -> Verdict {
        match self.interval {
            [low, _] if low > limit => Verdict::Agrees,
            [_, high] if high < limit => Verdict::Differs,
            _ => Verdict::Undecided,
        }
    }

    /// Whether it is below `limit`, or not.
    pub fn is_below(self, limit: f64) -> Verdict {
        match self.is_above(limit) {
            Verdict::Agrees => Verdict::Differs,
            Verdict::Differs => Verdict::Agrees,
            undecided => undecided,
        }
    }

    /// Whether it is what was `published`: on the same side of 1, and of that size.
    pub fn is_about(self, published: f64) -> Verdict {
        let side = if published > 1.0 { self.is_above(1.0) } else { self.is_below(1.0) };
        let [low, high] = self.interval;
        let is_so_large = (low / ROUNDING..=high * ROUNDING).contains(&published);
        if side == Verdict::Agrees && !is_so_large { Verdict::InPart } else { side }
    }

    /// The ratio the other way round.
    pub fn inverse(self) -> Self {
        let [low, high] = self.interval;
        Self { value: 1.0 / self.value, interval: [1.0 / high, 1.0 / low] }
    }
}

/// The interval of a ratio whose logarithms without each turn are `logs`.
fn interval(value: f64, logs: &[f64]) -> [f64; 2] {
    let count = logs.len() as f64;
    let Ok(law) = StudentsT::new(0.0, 1.0, count - 1.0) else { return Ratio::UNKNOWN.interval };
    if logs.len() < 2 || logs.iter().any(|log| !log.is_finite()) {
        return Ratio::UNKNOWN.interval;
    }
    let mean = logs.iter().sum::<f64>() / count;
    let squares: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
    let error = ((count - 1.0) / count * squares).sqrt();
    let reach = (law.inverse_cdf(0.5 + 0.5 * CONFIDENCE) * error).exp();
    [value / reach, value * reach]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fogbow_kernels::random;

    fn uniform(run: u32, turn: u32) -> f64 {
        random::uniform(random::words(run, turn, 0, 5)[0])
    }

    /// Turns at a rate of 100 samples a second that the machine slows now and then, and errors that scatter by a third.
    fn turns(run: u32, variance: f64, scatter: f64) -> Vec<Turn> {
        (0..12)
            .map(|turn| {
                let error = 1.0 + scatter * 12.0_f64.sqrt() * (uniform(run, turn) - 0.5);
                let squared = variance * error / 100.0;
                let seconds = if turn % 3 == 0 { 4.0 } else { 1.0 };
                Turn { seconds, samples: 100.0, squared, green: 2.0 * squared }
            })
            .collect()
    }

    /// Of many intervals about as many contain the truth as they say.
    #[test]
    fn intervals_contain_the_ratio() {
        let cases = 1000;
        let contain = |case: u32| {
            let ratio =
                Ratio::of(Worth::Second, Channels::All, &turns(2 * case, 1.0, 0.33), &turns(2 * case + 1, 2.0, 0.33));
            let [low, high] = ratio.interval;
            assert!(low < ratio.value && ratio.value < high, "{ratio:?}");
            u32::from(low <= 2.0 && 2.0 <= high)
        };
        let found = (0..cases).map(contain).sum::<u32>();
        assert!((920..=980).contains(&found), "{found} of {cases}");
    }

    #[test]
    fn what_slows_both_alike_leaves_the_rate_sure() {
        let ratio = Ratio::of(Worth::Rate, Channels::All, &turns(1, 1.0, 0.3), &turns(2, 1.0, 0.3));
        assert!(
            (ratio.value - 1.0).abs() < 1e-9 && ratio.interval.iter().all(|end| (end - 1.0).abs() < 1e-9),
            "{ratio:?}"
        );
    }

    #[test]
    fn verdicts_need_the_whole_interval() {
        let ratio = |low, high| Ratio { value: 0.5 * (low + high), interval: [low, high] };
        assert_eq!(ratio(1.1, 1.5).is_above(1.0), Verdict::Agrees);
        assert_eq!(ratio(0.5, 0.9).is_above(1.0), Verdict::Differs);
        assert_eq!(ratio(0.9, 1.2).is_above(1.0), Verdict::Undecided);
        assert_eq!(ratio(0.5, 0.9).is_below(1.0), Verdict::Agrees);
        assert_eq!(Ratio::UNKNOWN.is_below(1.0), Verdict::Undecided);
        assert_eq!(ratio(2.0, 4.0).inverse().interval, [0.25, 0.5]);
        let one = turns(1, 1.0, 0.3)[..1].to_vec();
        assert_eq!(
            Ratio::of(Worth::Second, Channels::All, &one, &one).is_above(0.5),
            Verdict::Undecided,
            "one turn says nothing"
        );
        assert_eq!(Verdict::Agrees.and(Verdict::Undecided), Verdict::Undecided);
        assert_eq!(Verdict::Differs.and(Verdict::Undecided), Verdict::Differs);
        assert_eq!(Verdict::Differs.and(Verdict::InPart), Verdict::Differs);
        assert_eq!(Verdict::InPart.and(Verdict::Agrees), Verdict::InPart);
    }

    #[test]
    fn what_is_published_has_a_size() {
        let verdict =
            |low, high, published| Ratio { value: 0.5 * (low + high), interval: [low, high] }.is_about(published);
        assert_eq!(verdict(2.6, 3.3, 3.0), Verdict::Agrees);
        assert_eq!(verdict(4.4, 5.4, 3.0), Verdict::InPart);
        assert_eq!(verdict(1.2, 1.5, 3.0), Verdict::InPart);
        assert_eq!(verdict(0.5, 0.9, 3.0), Verdict::Differs);
        assert_eq!(verdict(0.8, 4.0, 3.0), Verdict::Undecided);
        assert_eq!(verdict(0.56, 0.84, 0.5), Verdict::InPart);
        assert_eq!(verdict(0.45, 0.84, 0.5), Verdict::Agrees);
        assert_eq!(Ratio::UNKNOWN.is_about(0.5), Verdict::Undecided);
    }

    #[test]
    fn green_has_a_worth_of_its_own() {
        let (a, b) = (turns(1, 1.0, 0.3), turns(2, 1.0, 0.3));
        let [all, green] = [Channels::All, Channels::Green].map(|channels| Ratio::of(Worth::Sample, channels, &a, &b));
        assert!((all.value - green.value).abs() < 1e-9, "{all:?} {green:?}");
        let pale: Vec<_> = a.iter().map(|turn| Turn { green: turn.squared, ..*turn }).collect();
        let [all, green] =
            [Channels::All, Channels::Green].map(|channels| Ratio::of(Worth::Sample, channels, &pale, &b));
        assert!((green.value / all.value - 2.0).abs() < 1e-9, "{all:?} {green:?}");
    }
}
