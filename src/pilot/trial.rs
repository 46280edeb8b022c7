//! What a setting turned out to be worth, and which one to go by.

use core::cmp::Ordering;

use super::{NEARLY, SHARE, Setting};

/// Standard errors by which the means of two settings may differ.
const AGREEMENT: f64 = 5.0;

/// What a setting turned out to be worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// What was tried.
    pub setting: Setting,
    /// Samples of every pixel that were taken for it.
    pub samples: u32,
    /// Variance of a sample, mean over pixels, sum over channels.
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
        let variance = mean_of(&|look| look.variance);
        let spread = mean_of(&|look| (look.variance - variance).powi(2));
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

    /// What a render should maximise: one over variance, at its worst, times cost; a setting that found nothing has
    /// none.
    pub fn efficiency(&self) -> f64 {
        let work = (self.variance + 2.0 * self.variance_error) * self.cost;
        if work > 0.0 { 1.0 / work } else { 0.0 }
    }

    /// Whether it has less than so much efficiency, even if its variance is no more than it seems.
    pub(super) fn is_below(&self, efficiency: f64) -> bool {
        self.variance * self.cost * efficiency > 1.0
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

/// What one part of the samples says of a setting; see [`Trial`].
pub(super) struct Look {
    pub variance: f64,
    pub cost: f64,
    pub mean: f64,
    pub mean_error: f64,
}
