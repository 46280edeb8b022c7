//! The published experiment: the irradiance that one scattering event casts on a plane one mean free path ahead,
//! averaged over rings, and the widths of the curves that fit it best (Weber et al. 2017, Eq. 4 and Table 1).

use crate::phase::henyey_greenstein::reference::density;

/// Pixels along a side of the plane.
pub const PIXELS: usize = 256;
/// Side of the published plane, in mean free paths.
pub const SIDE: f64 = 8.0;

/// Radius `[m]` and mean irradiance `[1/m^2]` of a ring.
pub type Ring = (f64, f64);

/// Rings one pixel wide, from the middle out, on a plane of `side` mean free paths, one `mean_free_path` `[m]` ahead:
/// `phase(cos) / distance^2` at pixel centres (Eq. 4 of the paper).
pub fn rings(g: f64, mean_free_path: f64, side: f64) -> Vec<Ring> {
    let pixel = side * mean_free_path / PIXELS as f64;
    let center = |i: usize| (i as f64 + 0.5 - 0.5 * PIXELS as f64) * pixel;
    let mut sums = vec![(0.0, 0.0); PIXELS];
    for (x, y) in (0..PIXELS).flat_map(|y| (0..PIXELS).map(move |x| (center(x), center(y)))) {
        let radius_squared = x * x + y * y;
        let distance_squared = mean_free_path * mean_free_path + radius_squared;
        let ring = &mut sums[(radius_squared.sqrt() / pixel).round() as usize];
        *ring = (ring.0 + density(g, mean_free_path / distance_squared.sqrt()) / distance_squared, ring.1 + 1.0);
    }
    let filled = sums.into_iter().enumerate().filter(|(_, ring)| ring.1 > 0.0);
    filled.map(|(k, (sum, count))| (k as f64 * pixel, sum / count)).collect()
}

/// A fitted curve, `height * shape(radius / width)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Its width `[m]`: sigma of a Gaussian, alpha of GGX.
    pub width: f64,
    /// Its value in the middle `[1/m^2]`.
    pub height: f64,
}

/// Least-squares fit of a profile `shape(radius / width)` of free height.
pub fn fit(rings: &[Ring], shape: impl Fn(f64) -> f64) -> Fit {
    let products = |width: f64| {
        rings.iter().fold((0.0, 0.0, 0.0), |(sv, ss, vv), (radius, value)| {
            let s = shape(radius / width);
            (sv + s * value, ss + s * s, vv + value * value)
        })
    };
    let misfit = |width: f64| {
        let (sv, ss, vv) = products(width);
        vv - sv * sv / ss
    };
    // The misfit has one minimum; shrink a bracket around it.
    let reach = rings.last().map_or(1.0, |ring| ring.0);
    let (mut low, mut high) = (1e-6 * reach, 2.0 * reach);
    for _ in 0..200 {
        let third = (high / low).powf(1.0 / 3.0);
        if misfit(low * third) < misfit(high / third) { high /= third } else { low *= third }
    }
    let width = (low * high).sqrt();
    let (sv, ss, _) = products(width);
    Fit { width, height: sv / ss }
}

/// The shape of a Gaussian of sigma 1.
pub fn gaussian(r: f64) -> f64 {
    (-0.5 * r * r).exp()
}

/// The shape of GGX of alpha 1.
pub fn ggx(r: f64) -> f64 {
    (1.0 + r * r).powi(-2)
}
