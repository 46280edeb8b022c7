//! How many samples a noise takes.

use serde::{Deserialize, Serialize};

/// Share by which two estimates may differ to be believed.
const AGREEMENT: f64 = 0.1;

/// Estimates of what a noise takes, as samples of the mean pixel times the square of the noise: noise falls with the root
/// of the number of samples, so that this is the same whatever noise is asked for. Early ones may be far off, as long as
/// few paths have found the light, so none counts unless the one before was about the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Estimates {
    last: Option<f64>,
    agreed: Option<f64>,
}

impl Estimates {
    /// Adds the `next` one.
    pub fn add(&mut self, next: Option<f64>) {
        let last = core::mem::replace(&mut self.last, next);
        self.agreed = next.filter(|next| last.is_some_and(|last| (next / last - 1.0).abs() <= AGREEMENT));
    }

    /// The samples of the mean pixel that `noise` takes, if the last two estimates agree.
    pub fn samples(self, noise: f64) -> Option<f64> {
        self.agreed.map(|agreed| agreed / (noise * noise)).filter(|samples| samples.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_counts_once_the_next_one_agrees() {
        let mut estimates = Estimates::default();
        let told = [None, Some(40.0), Some(90.0), Some(97.0), Some(93.0), Some(200.0), None, Some(200.0), Some(190.0)]
            .map(|next| {
                estimates.add(next);
                estimates.samples(1.0)
            });
        assert_eq!(told, [None, None, None, Some(97.0), Some(93.0), None, None, None, Some(190.0)]);
        assert_eq!(estimates.samples(0.5), Some(760.0), "half the noise takes four times the samples");
        assert_eq!(estimates.samples(0.0), None);
    }
}
