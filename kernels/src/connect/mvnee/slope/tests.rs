//! The experiment behind the table, repeated.

use super::{TABLE, of};
use crate::connect::mvnee::GGX_WIDTH;
use crate::phase::henyey_greenstein::reference::density;

/// Pixels along a side of the plane.
const PIXELS: usize = 256;

/// Radii `[m]` and mean irradiance of rings one pixel wide, on a plane of side `width` one metre ahead (Eq. 4 of the
/// paper): `phase(cos) / distance^2` at pixel centres.
fn rings(g: f64, width: f64) -> Vec<(f64, f64)> {
    let pixel = width / PIXELS as f64;
    let center = |i: usize| (i as f64 + 0.5) * pixel - 0.5 * width;
    let mut sums = vec![(0.0, 0.0); PIXELS];
    for (x, y) in (0..PIXELS).flat_map(|y| (0..PIXELS).map(move |x| (center(x), center(y)))) {
        let radius_squared = x * x + y * y;
        let distance_squared = 1.0 + radius_squared;
        let ring = &mut sums[(radius_squared.sqrt() / pixel).round() as usize];
        *ring = (ring.0 + density(g, 1.0 / distance_squared.sqrt()) / distance_squared, ring.1 + 1.0);
    }
    let filled = sums.into_iter().enumerate().filter(|(_, ring)| ring.1 > 0.0);
    filled.map(|(k, (sum, count))| (k as f64 * pixel, sum / count)).collect()
}

/// Least-squares width of a profile `shape(radius / width)` of free height.
fn fit(rings: &[(f64, f64)], shape: impl Fn(f64) -> f64) -> f64 {
    let misfit = |width: f64| {
        let (mut sv, mut ss, mut vv) = (0.0, 0.0, 0.0);
        for (radius, value) in rings {
            let s = shape(radius / width);
            (sv, ss, vv) = (sv + s * value, ss + s * s, vv + value * value);
        }
        vv - sv * sv / ss
    };
    // The misfit has one minimum; shrink a bracket around it.
    let (mut low, mut high) = (1e-5_f64, 10.0_f64);
    for _ in 0..200 {
        let third = (high / low).powf(1.0 / 3.0);
        if misfit(low * third) < misfit(high / third) { high /= third } else { low *= third }
    }
    (low * high).sqrt()
}

fn gaussian(rings: &[(f64, f64)]) -> f64 {
    fit(rings, |r| (-0.5 * r * r).exp())
}

fn ggx(rings: &[(f64, f64)]) -> f64 {
    fit(rings, |r| (1.0 + r * r).powi(-2))
}

#[test]
fn the_published_table_follows_from_the_published_experiment() {
    for (g, slope) in &TABLE[..10] {
        let found = gaussian(&rings(*g, 8.0));
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
    let (published, shrunk) = (gaussian(&rings(0.9, 8.0)), gaussian(&rings(0.9, 80.0 * (1.0 - 0.9))));
    assert!((published / shrunk - 1.0).abs() < 1e-6, "{published} {shrunk}");
    let limit = gaussian(&rings(0.999, 80.0 * (1.0 - 0.999)));
    assert!((limit / of(0.999) - 1.0).abs() < 0.01, "g = 0.999: {limit} instead of {}", of(0.999));
}

#[test]
fn the_width_of_ggx_is_the_mean_over_the_published_range() {
    let ratios = TABLE[..10].iter().map(|(g, _)| rings(*g, 8.0)).map(|rings| ggx(&rings) / gaussian(&rings));
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
