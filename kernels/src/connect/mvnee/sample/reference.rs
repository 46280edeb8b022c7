//! Making MVNEE's connections, in f64 (Weber, Hanika, Dachsbacher 2017).
//!
//! ```text
//! seeds:    tau~(t_k) = tau~(t_{k-1}) - ln(1 - u)       while t_k < s,  or, fast, from the second one on
//!           t_k = t_{k-1} - ln(1 - u) / mu~(t_1)
//! vertices: x_k = x + t_k w + r (cos(phi) tangent + sin(phi) bitangent),   phi = 2 pi u'
//! GGX:      r = alpha sqrt(u / (1 - u)),        alpha = 1.637618734 sigma
//! Gaussian: r = sigma sqrt(-2 ln(1 - u))
//! ```
//!
//! with the sigma of Eqs. 5-7 from the segments between the seeds.

use core::f64::consts::TAU;

use glam::DVec3;

use crate::connect::buckets::{self, BuildColumns, CountColumns};
use crate::connect::mvnee::reference::{Settings, sigma};
use crate::connect::mvnee::{GGX_WIDTH, Mvnee, Offset, Seeds};
use crate::connect::sequence::Draws;
use crate::media::reference::{Medium, Stratum, depth_until, extinction_along, flight, reach};
use crate::phase::reference::frame;
use crate::{PathLengths, Step, random};

/// The twin; see [`CountKernel`](super::CountKernel).
pub fn count(step: Step, columns: CountColumns<'_, '_, Mvnee>) {
    let CountColumns { technique, medium, lengths, paths, immersion, connections, count, .. } = columns;
    let settings = Settings::from(technique);
    for row in 0..connections.len {
        let connection = connections.row(row);
        let lane = connection.lane as usize;
        let [start, point] = [connection.start, connection.point].map(|v| DVec3::from(v.map(f64::from)));
        let draws = Draws::new(step, paths, lane);
        let medium = medium.twin_of_connections(immersion.hero.rows()[lane] as usize);
        let inserted = count_seeds(&settings, &medium, start, point, lengths, &draws);
        count.rows_mut()[row] = inserted.unwrap_or(buckets::DROPPED);
    }
}

/// The twin; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_, Mvnee>) {
    let BuildColumns { technique, medium, paths, immersion, connections, buckets, candidates, chains, .. } = columns;
    let settings = Settings::from(technique);
    let mut inserted = Vec::new();
    for bucket in buckets.buckets() {
        for row in bucket.rows() {
            let connection = connections.row(buckets.order.rows()[row] as usize);
            let lane = connection.lane as usize;
            let [start, point] = [connection.start, connection.point].map(|v| DVec3::from(v.map(f64::from)));
            let draws = Draws::new(step, paths, lane);
            inserted.clear();
            inserted.resize(bucket.inserted, DVec3::ZERO);
            let medium = medium.twin_of_connections(immersion.hero.rows()[lane] as usize);
            place(&settings, &medium, start, point, &draws, &mut inserted);

            candidates.set_row(row, connection);
            chains.resampling.rows_mut()[row] = 1.0;
            for (vertex, position) in chains.vertices.iter_mut().zip(&inserted) {
                vertex.set_row(row, position.as_vec3().to_array());
            }
        }
    }
}

impl Draws {
    /// The number behind the flight to seed `k`.
    pub fn flight(&self, k: usize) -> f64 {
        self.uniforms(random::MVNEE_FLIGHTS.nth((k / 4) as u32))[k % 4]
    }

    /// The numbers behind radius and azimuth of the perturbation of seed `k`.
    pub fn offset(&self, k: usize) -> [f64; 2] {
        let block = self.uniforms(random::MVNEE_OFFSETS.nth((k / 2) as u32));
        let radius = 2 * (k % 2);
        [block[radius], block[radius + 1]]
    }
}

/// Number of seeds on the axis from `start` to `point`; None if that is thicker than the limit, or there would be too
/// many, or the path would exceed `lengths.max` segments.
pub fn count_seeds(
    settings: &Settings,
    medium: &dyn Medium,
    start: DVec3,
    point: DVec3,
    lengths: PathLengths,
    draws: &Draws,
) -> Option<u32> {
    let (distance, strata) = (start.distance(point), medium.strata(start, point));
    if depth_until(&strata, distance) > settings.max_depth * medium.over_clearest() {
        return None;
    }
    let mut walk = Walk::new(settings.seeds, &strata);
    let mut seeds = 0;
    while draws.depth + seeds < lengths.max && seeds <= settings.max_inserted {
        if walk.next(draws.flight(seeds as usize)) >= distance {
            return Some(seeds);
        }
        seeds += 1;
    }
    None
}

/// Goes from seed to seed.
struct Walk<'a> {
    seeds: Seeds,
    strata: &'a [Stratum],
    /// Optical depth passed.
    depth: f64,
    /// Place reached on the axis `[m]`, and the extinction at the first seed [1/m].
    reached: Option<(f64, f64)>,
}

impl<'a> Walk<'a> {
    fn new(seeds: Seeds, strata: &'a [Stratum]) -> Self {
        Self { seeds, strata, depth: 0.0, reached: None }
    }

    /// The place of the next seed on the axis `[m]`, after a flight that a share `u` of all does not reach.
    fn next(&mut self, u: f64) -> f64 {
        let depth = flight(u, 1.0);
        let (place, first) = match (self.seeds, self.reached) {
            (Seeds::Fast, Some((place, first))) => (place + depth / first, first),
            (_, reached) => {
                self.depth += depth;
                let place = reach(self.strata, self.depth);
                (place, reached.map_or_else(|| extinction_along(self.strata, place), |(_, first)| first))
            }
        };
        self.reached = Some((place, first));
        place
    }
}

/// Fills `inserted` with as many perturbed seeds, between `start` and `point` `[m]`.
pub fn place(
    settings: &Settings,
    medium: &dyn Medium,
    start: DVec3,
    point: DVec3,
    draws: &Draws,
    inserted: &mut [DVec3],
) {
    let strata = medium.strata(start, point);
    let mut walk = Walk::new(settings.seeds, &strata);
    let mut before = 0.0;
    let segment = |k: usize| {
        let place = walk.next(draws.flight(k));
        place - core::mem::replace(&mut before, place)
    };
    let mut segments: Vec<f64> = (0..inserted.len()).map(segment).collect();
    let distance = (point - start).length();
    segments.push(distance - segments.iter().sum::<f64>());
    let axis = (point - start).normalize_or_zero();
    let (tangent, bitangent) = frame(axis);
    let mut reached = 0.0;
    for (k, vertex) in inserted.iter_mut().enumerate() {
        reached += segments[k];
        let [radius_u, azimuth_u] = draws.offset(k);
        let radius = offset_radius(settings.offset, sigma(settings.slope, &segments, k), radius_u);
        let (sin_azimuth, cos_azimuth) = (TAU * azimuth_u).sin_cos();
        *vertex = start + reached * axis + radius * (cos_azimuth * tangent + sin_azimuth * bitangent);
    }
}

/// The distance from the axis that a share `u` of all perturbations does not exceed `[m]`.
pub fn offset_radius(offset: Offset, sigma: f64, u: f64) -> f64 {
    match offset {
        Offset::Ggx => GGX_WIDTH * sigma * (u / (1.0 - u)).sqrt(),
        Offset::Gaussian => sigma * (-2.0 * (1.0 - u).ln()).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::mvnee::reference::{density, offset_density};
    use crate::media::reference::Homogeneous;

    const FREE: PathLengths = PathLengths { min: 1, max: 1000 };
    const SETTINGS: Settings = Settings {
        max_distance: f64::INFINITY,
        max_depth: f64::INFINITY,
        max_inserted: u32::MAX,
        offset: Offset::Ggx,
        seeds: Seeds::Coarse,
        slope: 0.8,
    };

    /// Seeds on an axis of this length.
    fn count(medium: &dyn Medium, distance: f64, lengths: PathLengths, pixel: u32) -> Option<u32> {
        count_seeds(&SETTINGS, medium, DVec3::ZERO, distance * DVec3::X, lengths, &draws(pixel))
    }

    fn draws(pixel: u32) -> Draws {
        Draws { pixel, sample: 3, depth: 2, seed: 1 }
    }

    #[test]
    fn radii_follow_their_density() {
        for offset in [Offset::Ggx, Offset::Gaussian] {
            for u in [0.1, 0.5, 0.9] {
                let steps = 20_000;
                let width = offset_radius(offset, 0.3, u) / f64::from(steps);
                let ring = |i: i32| (f64::from(i) + 0.5) * width;
                let share: f64 = (0..steps).map(|i| TAU * ring(i) * offset_density(offset, 0.3, ring(i)) * width).sum();
                assert!((share - u).abs() < 1e-6, "{offset:?}, u = {u}: {share}");
            }
        }
    }

    #[test]
    fn seeds_are_poisson_distributed() {
        let (extinction, distance, samples) = (1.5, 1.6, 20_000);
        let mut shares = [0.0; 4];
        for pixel in 0..samples {
            let seeds =
                count(&Homogeneous::isotropic(extinction), distance, FREE, pixel).expect("room for all") as usize;
            if seeds < shares.len() {
                shares[seeds] += 1.0 / f64::from(samples);
            }
        }
        let mean: f64 = extinction * distance;
        let mut expected = (-mean).exp();
        for (seeds, share) in shares.iter().enumerate() {
            assert!((share - expected).abs() < 0.012, "{seeds} seeds: {share}, expected {expected}");
            expected *= mean / (seeds + 1) as f64;
        }
    }

    #[test]
    fn connections_beyond_the_length_limit_are_dropped() {
        let limit = |max: u32| count(&Homogeneous::isotropic(1e3), 1.0, PathLengths { min: 1, max }, 0);
        assert_eq!([1, 2, 3, 50].map(limit), [None; 4]);
        let direct = |max: u32| count(&Homogeneous::isotropic(0.0), 1.0, PathLengths { min: 1, max }, 0);
        assert_eq!([2, 3].map(direct), [None, Some(0)]);
    }

    #[test]
    fn what_is_made_has_a_density() {
        let (start, point) = (DVec3::new(0.1, -0.4, 2.0), DVec3::new(1.0, 3.0, -1.0));
        for offset in [Offset::Ggx, Offset::Gaussian] {
            let medium = Homogeneous::isotropic(1.0);
            let settings = Settings { offset, ..SETTINGS };
            for pixel in 0..200 {
                let seeds = count_seeds(&settings, &medium, start, point, FREE, &draws(pixel)).expect("room for all");
                let mut chain = vec![start; seeds as usize + 2];
                place(&settings, &medium, start, point, &draws(pixel), &mut chain[1..=seeds as usize]);
                chain[seeds as usize + 1] = point;
                let p = density(&settings, &medium, &chain, 1.0).value();
                assert!(p > 0.0 && p.is_finite(), "pixel {pixel}, {seeds} seeds: {p}");
            }
        }
    }
}
