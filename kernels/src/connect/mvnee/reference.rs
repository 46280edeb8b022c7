//! The full density of multiple-vertex next event estimation, in f64 (Weber, Hanika, Dachsbacher 2017).
//!
//! A given chain x_i .. x_n is measured against the axis w from x_i to x_n, of length s. Its m inner vertices have the
//! projections t_j on the axis and lie at distances rho_j from it; d_j = t_j - t_{j-1} are the m + 1 seed segments.
//!
//! ```text
//! p = p_A P_l(x_i) * mu_t^m exp(-mu_t s) * prod_j offset(rho_j; sigma_j)      (volume and area measure)
//!
//! sigma_j^2 = slope^2 L_j R_j / (L_j + R_j),  L_j = sum_{k <= j} d_k^2,  R_j = sum_{k > j} d_k^2    (Eqs. 5-7)
//! GGX:        offset = alpha^2 / (pi (alpha^2 + rho^2)^2),  alpha = 1.637618734 sigma
//! Gaussian:   offset = exp(-rho^2 / (2 sigma^2)) / (2 pi sigma^2)
//! ```
//!
//! or what [rounding of positions](Offset::grain) makes of it, where that is more.
//!
//! The middle factor is the product of the seeds' flight densities `mu_t exp(-mu_t d_j)` and of the probability
//! `exp(-mu_t d_{m+1})` that the last flight passes the light. Where extinction varies, it is
//!
//! ```text
//! coarse:  prod_j mu~(t_j) exp(-tau~(s))
//! fast:    mu~(t_1)^m exp(-tau~(t_1) - mu~(t_1) (s - t_1))
//! ```

use core::f64::consts::PI;

use glam::DVec3;

use super::{GGX_WIDTH, Mvnee, Offset, Seeds};
use crate::connect::BLUR;
use crate::connect::density::Density;
use crate::media::reference::{Medium, Stratum, depth_until, extinction_along};

/// [`Mvnee`] in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Longest connection `[m]`.
    pub max_distance: f64,
    /// Largest optical depth of a connection's axis.
    pub max_depth: f64,
    /// Most inner vertices.
    pub max_inserted: u32,
    /// Shape of the perturbation.
    pub offset: Offset,
    /// How seeds are spread where extinction varies.
    pub seeds: Seeds,
    /// Standard deviation of the perturbation per unit of distance.
    pub slope: f64,
}

impl From<&Mvnee> for Settings {
    fn from(mvnee: &Mvnee) -> Self {
        let [max_distance, max_depth, slope] = [mvnee.max_distance, mvnee.max_depth, mvnee.slope].map(f64::from);
        let Mvnee { max_inserted, offset, seeds, .. } = *mvnee;
        Self { max_distance, max_depth, max_inserted, offset, seeds, slope }
    }
}

/// Density of making `chain`, the vertices from the start to the point on the light; `light_density` is p_A P_l at the
/// start. Zero if the chain is longer than a limit or turns back along its axis, by more than [`BLUR`].
pub fn density(settings: &Settings, medium: &dyn Medium, chain: &[DVec3], light_density: f64) -> Density {
    let [start, inner @ .., point] = chain else {
        return Density::ZERO;
    };
    let distance = (*point - *start).length();
    if distance == 0.0 || distance > settings.max_distance || inner.len() > settings.max_inserted as usize {
        return Density::ZERO;
    }
    let axis = (*point - *start) / distance;
    let segments = seed_segments(*start, inner, axis, distance);
    let [blur, grain] = [BLUR, settings.offset.grain()].map(|share| f64::from(share) * (point.length() + distance));
    if segments.iter().any(|segment| *segment <= -blur) {
        return Density::ZERO;
    }
    let strata = medium.strata(*start, *point);
    if depth_until(&strata, distance) > settings.max_depth * medium.over_clearest() {
        return Density::ZERO;
    }
    let mut density = seeds_density(settings.seeds, &strata, &segments).times(light_density);
    for (j, vertex) in inner.iter().enumerate() {
        let arm = *vertex - *start;
        let seed = *start + arm.dot(axis) * axis;
        let sigma = sigma(settings.slope, &segments, j).max(grain);
        density = density.times(offset_density(settings.offset, sigma, vertex.distance(seed)));
    }
    density
}

/// Density of seeds that leave these `segments` between start, seeds and light point on their axis.
fn seeds_density(seeds: Seeds, strata: &[Stratum], segments: &[f64]) -> Density {
    let distance: f64 = segments.iter().sum();
    let (_, to_seeds) = segments.split_last().expect("there is a segment that arrives at the light");
    let places = to_seeds.iter().scan(0.0, |place, segment| {
        *place += segment;
        Some(*place)
    });
    let coarse = |density: Density, place: f64| density.times(extinction_along(strata, place));
    match (seeds, to_seeds) {
        (Seeds::Fast, [first, ..]) => {
            let rate = extinction_along(strata, *first);
            let depth = depth_until(strata, *first) + rate * (distance - first);
            to_seeds.iter().fold(Density::new(1.0), |density, _| density.times(rate)).times_exp(-depth)
        }
        _ => places.fold(Density::new(1.0), coarse).times_exp(-depth_until(strata, distance)),
    }
}

/// The segments d_1 .. d_{m+1} between the projections of start, inner vertices and light point on the axis `[m]`.
fn seed_segments(start: DVec3, inner: &[DVec3], axis: DVec3, distance: f64) -> Vec<f64> {
    let mut segments = Vec::with_capacity(inner.len() + 1);
    let mut reached = 0.0;
    for vertex in inner {
        let projection = (*vertex - start).dot(axis);
        segments.push(projection - reached);
        reached = projection;
    }
    segments.push(distance - reached);
    segments
}

/// Standard deviation of the perturbation of seed `j`, counted from 0, between the given segments `[m]`.
pub fn sigma(slope: f64, segments: &[f64], j: usize) -> f64 {
    let squares = |part: &[f64]| part.iter().map(|d| d * d).sum::<f64>();
    let (left, right) = (squares(&segments[..=j]), squares(&segments[j + 1..]));
    if left + right == 0.0 {
        return 0.0;
    }
    slope * (left * right / (left + right)).sqrt()
}

/// Density of a perturbation by `rho` [1/m^2].
pub fn offset_density(offset: Offset, sigma: f64, rho: f64) -> f64 {
    match offset {
        Offset::Ggx => {
            let alpha = GGX_WIDTH * sigma;
            alpha * alpha / (PI * (alpha * alpha + rho * rho).powi(2))
        }
        Offset::Gaussian if sigma == 0.0 => 0.0,
        Offset::Gaussian => (-0.5 * (rho / sigma).powi(2)).exp() / (2.0 * PI * sigma * sigma),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::reference::Homogeneous;

    const GGX: Settings = Settings {
        max_distance: f64::INFINITY,
        max_depth: f64::INFINITY,
        max_inserted: u32::MAX,
        offset: Offset::Ggx,
        seeds: Seeds::Coarse,
        slope: 0.4,
    };
    const GAUSSIAN: Settings = Settings { offset: Offset::Gaussian, ..GGX };

    #[test]
    fn without_inserted_vertices_only_the_flight_past_the_light_counts() {
        let chain = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 5.0)];
        let p = density(&GGX, &Homogeneous::isotropic(0.7), &chain, 0.25).value();
        assert!((p - 0.25 * (-1.4_f64).exp()).abs() < 1e-15, "{p}");
    }

    #[test]
    fn the_density_of_one_inserted_vertex_integrates_to_its_poisson_probability() {
        let (extinction, distance) = (0.8, 2.0);
        let medium = Homogeneous::isotropic(extinction);
        let point = DVec3::new(0.0, 0.0, distance);
        for settings in [GGX, GAUSSIAN] {
            let mut sum = 0.0;
            for (i, j) in (0..50).flat_map(|i| (0..1000).map(move |j| (i, j))) {
                let t = distance * (f64::from(i) + 0.5) / 50.0;
                // Radius by the substitution r = v / (1 - v), dr = dv / (1 - v)^2.
                let v = (f64::from(j) + 0.5) / 1000.0;
                let rho = v / (1.0 - v);
                let p = density(&settings, &medium, &[DVec3::ZERO, DVec3::new(0.0, rho, t), point], 1.0).value();
                sum += p * 2.0 * PI * rho / (1.0 - v).powi(2) / 1000.0 * distance / 50.0;
            }
            let mean = extinction * distance;
            assert!((sum / (mean * (-mean).exp()) - 1.0).abs() < 2e-3, "{:?}: {sum}", settings.offset);
        }
    }

    #[test]
    fn chains_that_turn_back_or_exceed_the_reach_are_never_made() {
        let at = |z: f64| DVec3::new(0.1, 0.0, z);
        let density_of = |settings: &Settings, inner: &[f64]| {
            let mut chain = vec![DVec3::ZERO];
            chain.extend(inner.iter().map(|z| at(*z)));
            chain.push(DVec3::new(0.0, 0.0, 1.0));
            density(settings, &Homogeneous::isotropic(1.0), &chain, 1.0).value()
        };
        let made = |settings: &Settings, inner: &[f64]| density_of(settings, inner) > 0.0;
        // Of seeds at the same place, nobody knows which came first.
        assert!(made(&GGX, &[0.2, 0.5]) && made(&GGX, &[0.5, 0.5]));
        for inner in [[0.5, 0.2], [0.5, 0.499], [-0.1, 0.5], [0.5, 1.1]] {
            assert!(!made(&GGX, &inner), "{inner:?}");
        }
        // A seed beside either end has the width of rounding, and all but never leaves its axis.
        for inner in [[0.0, 0.5], [0.5, 1.0]] {
            assert!(density_of(&GGX, &inner) < 1e-9 * density_of(&GGX, &[0.2, 0.5]), "{inner:?}");
            assert!(!made(&GAUSSIAN, &inner), "{inner:?}");
        }
        assert!(!made(&Settings { max_distance: 0.99, ..GGX }, &[0.2, 0.5]));
        assert!(made(&Settings { max_distance: 1.0, ..GGX }, &[]));
        let [one, two] = [1, 2].map(|max_inserted| Settings { max_inserted, ..GGX });
        assert!(!made(&one, &[0.2, 0.5]) && made(&two, &[0.2, 0.5]));
        assert_eq!(density(&GGX, &Homogeneous::isotropic(1.0), &[DVec3::ONE; 3], 1.0).value(), 0.0);
    }
}
