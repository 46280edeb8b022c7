//! Whether MVNEE finds what it has to.
//!
//! With p_M and p_B the densities of MVNEE and of bridges and f the integrand, and only paths that contribute less than
//! some limit W as MVNEE makes them,
//!
//! ```text
//! mean over MVNEE's paths of (f / p_M where f / p_M < W)  =  mean over bridges' paths of (f / p_B where f / p_M < W)
//! ```
//!
//! Both sides have a small variance, on the left because W bounds it. If they agree for every W, MVNEE's density is
//! that of its sampler, and what its mean lacks is in contributions that are larger than any of its samples.

use super::world::{MAKERS, Sample, World};
use crate::error::Result;
use crate::paper::bench::Bench;
use crate::paper::section::{Cell, Column, Plot, Show, Table};
use crate::plot::{self, Axis, Chart, Curve, Look};

/// Vertices between start and light, the light's distance and radius in mean free paths, and mean cosine.
const FEW: usize = 3;
const DISTANCE: f64 = 2.0;
const RADIUS: f64 = 1.0;
const G: f64 = 0.9;
/// Samples of each technique.
const SAMPLES: u32 = 200_000;
/// Powers of ten over the mean, on which contributions are limited.
const POWERS: core::ops::RangeInclusive<i32> = -2..=9;

/// Share of the integral, by samples of bridges, in paths that MVNEE never makes.
pub fn never_made(world: &World, bridges: &[Sample]) -> f64 {
    let largest = bridges.iter().map(|sample| sample.ln).fold(f64::NEG_INFINITY, f64::max);
    let [never, all] = bridges.iter().fold([0.0; 2], |[never, all], sample| {
        let weight = (sample.ln - largest).exp();
        let is_made = world.worth_by_mvnee(&sample.path) < f64::INFINITY;
        [never + if is_made { 0.0 } else { weight }, all + weight]
    });
    never / all
}

/// What is found below one limit.
#[derive(Clone, Copy, Debug)]
struct Below {
    /// The limit, over the mean.
    limit: f64,
    /// By MVNEE, with its standard error, over the mean.
    found: (f64, f64),
    /// By bridges: what is there.
    there: (f64, f64),
}

/// Mean and standard error of numbers.
fn mean(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (count, sum, squares) = values.fold((0.0, 0.0, 0.0), |(n, s, q), x| (n + 1.0, s + x, q + x * x));
    let mean = sum / count;
    (mean, ((squares / count - mean * mean) / count).max(0.0).sqrt())
}

/// What is found and what is there below every limit.
fn below(world: &World, samples: u32) -> Vec<Below> {
    let [mvnee, bridges] =
        [1, 3].map(|maker: usize| (0..samples).map(|sample| (MAKERS[maker].make)(world, sample)).collect::<Vec<_>>());
    let unit = mean(bridges.iter().map(|sample| sample.ln.exp())).0.ln();
    let worths: Vec<f64> = bridges.iter().map(|sample| world.worth_by_mvnee(&sample.path) - unit).collect();
    let at = |power: i32| {
        let limit = f64::from(power) * core::f64::consts::LN_10;
        let of = |ln: f64, worth: f64| if worth < limit { ln.exp() } else { 0.0 };
        Below {
            limit: 10.0_f64.powi(power),
            found: mean(mvnee.iter().map(|sample| of(sample.ln - unit, sample.ln - unit))),
            there: mean(bridges.iter().zip(&worths).map(|(sample, worth)| of(sample.ln - unit, *worth))),
        }
    };
    POWERS.map(at).collect()
}

/// The table and the plot of paths of few vertices.
pub fn of_few_vertices(bench: &Bench<'_>, item: &str) -> Result<(Table, Plot)> {
    let all = below(&World::new(FEW, DISTANCE, RADIUS, G), SAMPLES);
    let row =
        |Below { limit, found, there }: &Below| [*limit, found.0, found.1, there.0, there.1].map(Cell::from).to_vec();
    let table = Table {
        caption: format!(
            "Paths of {FEW} vertices to a light {DISTANCE} mean free paths away, {SAMPLES} samples: their mean where \
             only those count that contribute less than a limit as MVNEE makes them."
        ),
        columns: Column::all([
            ("limit over the mean", Show::Digits(2)),
            ("mean of MVNEE", Show::Digits(4)),
            ("standard error of it", Show::PlusMinus(2)),
            ("of bridges", Show::Digits(4)),
            ("standard error of that", Show::PlusMinus(2)),
        ]),
        rows: all.iter().map(row).collect(),
    };
    let points = |value: fn(&Below) -> f64| all.iter().map(|below| (below.limit, value(below))).collect();
    let chart = Chart {
        title: format!("mean of paths of {FEW} vertices, below a limit"),
        x: Axis::logarithmic("limit on contributions over the mean"),
        y: Axis::linear("mean, relative"),
        curves: vec![
            Curve::new("bridges: what is there", points(|below| below.there.0), Look::Line, plot::COLOURS[2]),
            Curve::new("MVNEE: what it finds", points(|below| below.found.0), Look::Marks, plot::COLOURS[0]),
        ],
        from_zero: true,
    };
    let caption = "What MVNEE finds in contributions below a limit, and what is there. Where its marks leave the line, \
                   so large a contribution is too rare for as many samples.";
    Ok((table, bench.plot(item, "skew", caption, &chart)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where limits are far below what a rare sample may bring, so that both sides are normal.
    #[test]
    fn mvnee_finds_what_there_is_below_any_limit() {
        let samples = 200_000;
        for (vertices, g) in [(1, 0.9), (3, 0.3), (3, 0.9), (5, 0.9)] {
            for Below { limit, found, there } in below(&World::new(vertices, DISTANCE, RADIUS, g), samples) {
                // A sample of this size has to be one of many.
                if limit > 1e-3 * f64::from(samples) * there.0 {
                    continue;
                }
                let off = (found.0 - there.0).abs() / found.1.hypot(there.1);
                assert!(off < 4.5, "{vertices} vertices, g = {g}, below {limit}: {found:?} of {there:?}");
            }
        }
    }
}
