//! When a render is done.

use core::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// One thing that can end a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// After this many samples per pixel, beginning with the first sample of the session's settings. Adaptive renders
    /// take that many in the mean of their pixels.
    Samples(u32),
    /// After this much time.
    Time(Duration),
    /// At this relative noise.
    Noise(f64),
}

impl Target {
    /// What it is about, in a word: `samples`, `time` or `noise`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Samples(_) => "samples",
            Self::Time(_) => "time",
            Self::Noise(_) => "noise",
        }
    }
}

/// The targets of a render, of which the first one that is met ends it. Without any it goes on until it is
/// interrupted.
///
/// Of these only the time depends on the machine: renders that samples or noise end have the same bits everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// [`Target::Samples`].
    pub samples: Option<u32>,
    /// [`Target::Time`].
    pub time: Option<Duration>,
    /// [`Target::Noise`].
    pub noise: Option<f64>,
}

impl Limits {
    /// Whether there are several targets.
    pub fn are_several(self) -> bool {
        usize::from(self.samples.is_some()) + usize::from(self.time.is_some()) + usize::from(self.noise.is_some()) > 1
    }
}

/// What was asked for, as in `samples 64, time 1m, noise 0.01`; nothing if it was nothing.
impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let samples = self.samples.map(|samples| format!("samples {samples}"));
        let time = self.time.map(|time| format!("time {}", humantime::format_duration(time)));
        let noise = self.noise.map(|noise| format!("noise {noise}"));
        f.write_str(&[samples, time, noise].into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}

impl From<Target> for Limits {
    fn from(target: Target) -> Self {
        Self::from_iter([target])
    }
}

impl FromIterator<Target> for Limits {
    /// Of targets of a kind the first to be met counts.
    fn from_iter<I: IntoIterator<Item = Target>>(targets: I) -> Self {
        let mut limits = Self::default();
        for target in targets {
            match target {
                Target::Samples(n) => limits.samples = Some(limits.samples.map_or(n, |other| other.min(n))),
                Target::Time(time) => limits.time = Some(limits.time.map_or(time, |other| other.min(time))),
                Target::Noise(noise) => limits.noise = Some(limits.noise.map_or(noise, |other| other.max(noise))),
            }
        }
        limits
    }
}

impl<const N: usize> From<[Target; N]> for Limits {
    fn from(targets: [Target; N]) -> Self {
        targets.into_iter().collect()
    }
}

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// A target was met.
    Met(Target),
    /// Somebody stopped it before.
    Interrupted,
}

/// `samples`, `time`, `noise` or `interrupted`.
impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Met(target) => target.name(),
            Self::Interrupted => "interrupted",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_targets_of_a_kind_the_first_to_be_met_counts() {
        let limits = Limits::from([Target::Noise(0.01), Target::Samples(9), Target::Noise(0.1), Target::Samples(4)]);
        assert_eq!(limits, Limits { samples: Some(4), noise: Some(0.1), time: None });
        assert_eq!(limits.to_string(), "samples 4, noise 0.1");
        assert!(limits.are_several() && !Limits::from(Target::Noise(0.1)).are_several());
    }
}
