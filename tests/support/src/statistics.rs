//! Means, tests and p-values.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Sum, sum of squares and number of observations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of observations.
    pub count: f64,
    /// Their sum.
    pub sum: f64,
    /// The sum of their squares.
    pub squares: f64,
}

impl Moments {
    /// Adds an observation.
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    /// Their mean.
    pub fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// Their sample variance.
    pub fn variance(&self) -> f64 {
        ((self.squares - self.sum * self.sum / self.count) / (self.count - 1.0)).max(0.0)
    }

    /// Standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count).sqrt()
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|value| moments.add(value));
        moments
    }
}

/// Two-sided p-value of a standard normal deviate.
pub fn p_of_z(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z.abs())
}

/// Deviate of the difference of two means from zero (Welch).
pub fn z_of_means(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0) / a.1.hypot(b.1)
}

/// P-value of a chi-square statistic of so many degrees of freedom.
pub fn p_of_chi_square(statistic: f64, freedom: usize) -> f64 {
    ChiSquared::new(freedom as f64).expect("degrees of freedom above 0").sf(statistic)
}

/// P-value of observed counts against expected ones. Cells that expect fewer than five are pooled.
pub fn p_of_counts(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells, mut pool) = (0.0, 0_usize, (0.0, 0.0));
    let mut add = |observed: f64, expected: f64| {
        statistic += (observed - expected).powi(2) / expected;
        cells += 1;
    };
    for (observed, expected) in observed.iter().zip(expected) {
        if *expected >= 5.0 {
            add(*observed, *expected);
        } else {
            pool = (pool.0 + observed, pool.1 + expected);
        }
    }
    if pool.1 > 0.0 {
        add(pool.0, pool.1.max(1e-3));
    }
    p_of_chi_square(statistic, cells.saturating_sub(1).max(1))
}

/// Whether p-values look uniform: Kolmogorov-Smirnov p-value (asymptotic series).
pub fn p_of_uniformity(p_values: &[f64]) -> f64 {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let gap = |(i, p): (usize, &f64)| ((i + 1) as f64 / n - p).max(p - i as f64 / n);
    let largest = sorted.iter().enumerate().map(gap).fold(0.0, f64::max);
    let x = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * largest;
    let term = |k: i32| (-1.0_f64).powi(k - 1) * (-2.0 * f64::from(k * k) * x * x).exp();
    (2.0 * (1..=100).map(term).sum::<f64>()).clamp(0.0, 1.0)
}
