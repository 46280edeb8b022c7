//! The experiment behind the table, repeated.

use super::projection::{Ring, SIDE, fit, rings as rings_at};
use super::{TABLE, of, projection};
use crate::connect::mvnee::GGX_WIDTH;

/// Rings on a plane of side `width` one metre ahead.
fn rings(g: f64, width: f64) -> Vec<Ring> {
    rings_at(g, 1.0, width)
}

fn gaussian(rings: &[Ring]) -> f64 {
    fit(rings, projection::gaussian).width
}

fn ggx(rings: &[Ring]) -> f64 {
    fit(rings, projection::ggx).width
}

#[test]
fn the_published_table_follows_from_the_published_experiment() {
    for (g, slope) in &TABLE[..10] {
        let found = gaussian(&rings(*g, SIDE));
        assert!((found / slope - 1.0).abs() < 0.012, "g = {g}: {found} instead of {slope}");
    }
}

#[test]
fn the_table_beyond_the_published_one_follows_from_a_plane_that_shrinks_with_the_spot() {
    for (g, slope) in &TABLE[10..] {
        let found = gaussian(&rings(*g, 80.0 * (1.0 - g)));
        assert!((found / slope - 1.0).abs() < 1.5e-3, "g = {g}: {found} instead of {slope}");
    }
    // Where both planes resolve the spot they agree.
    let (published, shrunk) = (gaussian(&rings(0.9, SIDE)), gaussian(&rings(0.9, 80.0 * (1.0 - 0.9))));
    assert!((published / shrunk - 1.0).abs() < 1e-6, "{published} {shrunk}");
    let limit = gaussian(&rings(0.999, 80.0 * (1.0 - 0.999)));
    assert!((limit / of(0.999) - 1.0).abs() < 0.01, "g = 0.999: {limit} instead of {}", of(0.999));
}

#[test]
fn the_width_of_ggx_is_the_mean_over_the_published_range() {
    let ratios = TABLE[..10].iter().map(|(g, _)| rings(*g, SIDE)).map(|rings| ggx(&rings) / gaussian(&rings));
    let mean = ratios.sum::<f64>() / 10.0;
    assert!((mean / GGX_WIDTH - 1.0).abs() < 0.005, "{mean} instead of {GGX_WIDTH}");
}

#[test]
fn slopes_are_positive_falling_and_continuous() {
    assert_eq!((of(-0.99), of(0.0)), (TABLE[0].1, TABLE[0].1));
    let slopes: Vec<_> = (0..1000).map(|i| of(f64::from(i) / 1000.0)).collect();
    assert!(slopes.windows(2).all(|pair| pair[1] < pair[0] && pair[0] - pair[1] < 2e-3 && pair[1] > 0.0));
    assert_eq!(of(0.6), 0.365761);
}

/// A minimum is found to about the root of what sums are rounded by.
#[test]
fn widths_are_proportional_to_the_mean_free_path() {
    for g in [0.0, 0.5, 0.9] {
        let [near, far] = [1.0, 10.0].map(|mean_free_path| gaussian(&rings_at(g, mean_free_path, SIDE)));
        assert!((far / near / 10.0 - 1.0).abs() < 1e-6, "g = {g}: {near} and {far}");
    }
}
