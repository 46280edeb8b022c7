//! What a setting turned out to be worth, and which one to go by.

use core::cmp::Ordering;

use super::{NEARLY, SHARE, Setting};
use crate::film::NOISIEST;

/// Standard errors by which the means of two settings may differ.
const AGREEMENT: f64 = 5.0;
/// What the variance may be of walks that end early, over the one that was found. The few that get far count so much
/// more, and a short look meets too few of them: where it found a survival of 0.9 up to 1.5 times as efficient as 1, long
/// renders found 0.9 to 1.1 times (BENCHMARKS, *What the pilot goes by*).
const UNSEEN: f64 = 1.5;

/// What a setting turned out to be worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// What was tried.
    pub setting: Setting,
    /// Samples of every pixel that were taken for it.
    pub samples: u32,
    /// Variance of a sample, mean over pixels, of which the noisiest hundredth count as the noisiest of the others, sum
    /// over channels.
    pub variance: f64,
    /// Standard error of that variance.
    pub variance_error: f64,
    /// Work of a sample in about nanoseconds of one core.
    pub cost: f64,
    /// Mean radiance, of the brightest channel [W/(m^2 sr)].
    pub mean: f64,
    /// Standard error of that mean [W/(m^2 sr)].
    pub mean_error: f64,
}

impl Trial {
    /// What the looks at parts of its samples say, two or more.
    pub(super) fn of(setting: Setting, looks: &[Look]) -> Self {
        let parts = looks.len() as f64;
        let mean_of = |figure: &dyn Fn(&Look) -> f64| looks.iter().map(figure).sum::<f64>() / parts;
        let variances = capped_variances(looks);
        let variance = variances.iter().sum::<f64>() / parts;
        let spread = variances.iter().map(|part| (part - variance).powi(2)).sum::<f64>() / parts;
        Self {
            setting,
            samples: looks.len() as u32 * SHARE,
            variance,
            variance_error: (spread / (parts - 1.0)).sqrt(),
            cost: mean_of(&|look| look.cost),
            mean: mean_of(&|look| look.mean),
            mean_error: (mean_of(&|look| look.mean_error.powi(2)) / parts).sqrt(),
        }
    }

    /// What a render should maximise: one over variance, at its worst and with what it may not have seen, times cost; a
    /// setting that found nothing has none.
    pub fn efficiency(&self) -> f64 {
        let work = (self.variance + 2.0 * self.variance_error) * self.unseen() * self.cost;
        if work > 0.0 { 1.0 / work } else { 0.0 }
    }

    /// Whether it has less than so much efficiency, even if its variance is no more than it seems.
    pub(super) fn is_below(&self, efficiency: f64) -> bool {
        self.variance * self.unseen() * self.cost * efficiency > 1.0
    }

    /// By how much its variance may be larger than what was met of it.
    fn unseen(&self) -> f64 {
        if self.setting.survival.is_certain() { 1.0 } else { UNSEEN }
    }

    /// Whether both may have the same mean.
    pub fn agrees_with(&self, other: &Self) -> bool {
        (self.mean - other.mean).abs() <= AGREEMENT * self.mean_error.hypot(other.mean_error)
    }

    /// What leaves most to luck first: by starts, then by survival.
    fn compare_walks(&self, other: &Self) -> Ordering {
        let [a, b] = [self.setting, other.setting];
        a.starts.cmp(&b.starts).then(a.survival.at(1).total_cmp(&b.survival.at(1)))
    }

    /// The same, then by roulette.
    fn compare_luck(&self, other: &Self) -> Ordering {
        self.compare_walks(other).then(other.setting.roulette.total_cmp(&self.setting.roulette))
    }
}

/// The trial to go by: of those that agree with the fullest and are nearly as efficient as the most efficient one, the
/// one with most starts and longest walks, and of such the most efficient. A look this short knows variances to a tenth
/// or so, and more of everything has fewer surprises; roulette, of the same samples, has none.
pub fn best(trials: &[Trial]) -> Option<Trial> {
    let fullest = trials.iter().max_by(|a, b| a.compare_luck(b))?;
    let sound = || trials.iter().filter(|trial| trial.agrees_with(fullest));
    let most = sound().map(Trial::efficiency).fold(0.0, f64::max);
    let good = sound().filter(|trial| trial.efficiency() >= NEARLY * most);
    good.copied().max_by(|a, b| a.compare_walks(b).then(a.efficiency().total_cmp(&b.efficiency())))
}

/// The variance that each of several looks at the same pixels found, mean over pixels. The hundredth of the pixels that
/// were noisiest in all looks together count as much as the noisiest of the others: rare bright samples have a large part
/// of the variance among surfaces, and whether so few looks met one or two of them tells nothing. Left out altogether,
/// pixels that are nearly as noisy as each other would change places for nothing. Pixels without any noise do not count:
/// all light may be in a few of them.
fn capped_variances(looks: &[Look]) -> Vec<f64> {
    let pixels = looks[0].variances.len();
    let totals: Vec<f64> = (0..pixels).map(|pixel| looks.iter().map(|look| look.variances[pixel]).sum()).collect();
    let mut noisy: Vec<f64> = totals.iter().copied().filter(|total| *total > 0.0).collect();
    let noisiest_of_others = (noisy.len() - noisy.len() / NOISIEST).saturating_sub(1);
    noisy.sort_unstable_by(f64::total_cmp);
    let cap = noisy.get(noisiest_of_others).copied().unwrap_or_default();
    let share = |total: &f64| if *total > cap { cap / total } else { 1.0 };
    let capped = |(variance, total): (&f64, &f64)| variance * share(total);
    let mean = |look: &Look| look.variances.iter().zip(&totals).map(capped).sum::<f64>() / pixels as f64;
    looks.iter().map(mean).collect()
}

/// What one part of the samples says of a setting; see [`Trial`].
pub(super) struct Look {
    /// Variance of a sample of each pixel, sum over channels.
    pub variances: Vec<f64>,
    pub cost: f64,
    pub mean: f64,
    pub mean_error: f64,
}

#[cfg(test)]
mod tests {
    use fogbow_kernels::survival::Survival;

    use super::*;

    fn trial(looks: &[Look]) -> Trial {
        Trial::of(Setting { starts: 1, survival: Survival::CERTAIN, roulette: 0.0 }, looks)
    }

    fn look(variances: Vec<f64>) -> Look {
        Look { variances, cost: 1.0, mean: 1.0, mean_error: 0.1 }
    }

    #[test]
    fn a_few_bright_samples_do_not_decide() {
        let even = trial(&[look(vec![2.0; 200]), look(vec![4.0; 200])]);
        assert_eq!((even.variance, even.variance_error), (3.0, 1.0));
        // As many times as much in one of them as in the other are capped to the same sum.
        let mut noisy = [vec![2.0; 200], vec![4.0; 200]];
        (noisy[0][7], noisy[1][7]) = (2e6, 4e6);
        (noisy[0][50], noisy[1][50]) = (2e3, 4e3);
        let noisy = trial(&noisy.map(look));
        let close = |found: f64, truth: f64| (found / truth - 1.0).abs() < 1e-12;
        assert!(close(noisy.variance, 3.0) && close(noisy.variance_error, 1.0), "{noisy:?}");
    }

    #[test]
    fn walks_that_end_early_have_to_be_far_better() {
        let of = |starts: u32, survival: f32, variance: f64, cost: f64| {
            let looks = [0, 1].map(|_| Look { cost, ..look(vec![variance; 10]) });
            Trial::of(Setting { starts, survival: survival.into(), roulette: 0.0 }, &looks)
        };
        let certain = of(3, 1.0, 2.0, 2.0);
        let chosen = |other: Trial| best(&[certain, other]).expect("one").setting;
        // 1.4 and 1.8 times as efficient.
        assert_eq!(chosen(of(3, 0.9, 2.0, 2.0 / 1.4)), certain.setting);
        assert_eq!(chosen(of(3, 0.9, 2.0, 2.0 / 1.8)).survival, 0.9.into());
        // How much they fall behind is judged alike.
        assert!(of(3, 0.9, 2.0, 2.0 / 1.4).is_below(certain.efficiency()));
        assert!(!of(3, 0.9, 2.0, 2.0 / 1.8).is_below(certain.efficiency()));
    }

    #[test]
    fn what_is_as_noisy_may_change_places() {
        let looks = |first: f64, second: f64| {
            let mut looks = [vec![1e-3; 100], vec![1e-3; 100]];
            looks[0][3] = first;
            (looks[0][4], looks[1][4]) = (0.5 * second, 0.5 * second);
            trial(&looks.map(look))
        };
        let [one, other] = [looks(1.0, 1.0 + 1e-9), looks(1.0 + 1e-9, 1.0)];
        assert!((one.variance_error - other.variance_error).abs() < 1e-9, "{one:?}, {other:?}");
    }

    #[test]
    fn all_light_may_be_in_a_few_pixels() {
        let lit = |pixel: usize| if pixel < 3 { 1000.0 } else { 0.0 };
        let found = trial(&[0, 1].map(|_| look((0..1000).map(lit).collect())));
        assert!((found.variance - 3.0).abs() < 1e-12, "{found:?}");
        assert_eq!(trial(&[0, 1].map(|_| look(vec![0.0; 1000]))).efficiency(), 0.0);
    }

    #[test]
    fn what_is_noisy_in_more_than_a_hundredth_of_the_pixels_counts() {
        let noise = |pixel: usize| if pixel < 10 { 101.0 } else { 1.0 };
        let found = trial(&[0, 1].map(|_| look((0..200).map(noise).collect())));
        assert!((found.variance - 6.0).abs() < 1e-12 && found.variance_error == 0.0, "{found:?}");
    }
}
