//! The weight of a complete path x_0 .. x_n, from full densities in f64.
//!
//! From start i, path tracing makes x_{i+1} .. x_n with density (volume and area measure)
//!
//! ```text
//! p_PT(i) = prod_{j=i..n-1} phase(c_j) exp(-mu_t l_j) / l_j^2 * (mu_t, or cos_light for j = n - 1)
//! ```
//!
//! where l_j is the length of the segment from x_j to x_{j+1} and c_j the cosine of the turn at x_j. With p_k(i) for
//! the density of technique k doing the same, the balance heuristic (Veach and Guibas 1995) gives, whichever technique
//! made the path,
//!
//! ```text
//! weight = 1 / (1 + sum over starts i and techniques k of p_k(i) / p_PT(i))
//! ```
//!
//! Starts run from the first eligible vertex to x_{n-1}.

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::connect::light_sample::reference::light_density;
use crate::connect::{Techniques, mvnee, nee};
use crate::phase::reference as phase;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, techniques: &Techniques, step: Step, columns: Columns<'_, '_>) {
    let Columns { bucket, candidates, chains, paths, vertices, suffix: _ } = columns;
    let mut path = Vec::new();
    for row in bucket.rows() {
        let lane = candidates.lane.rows()[row] as usize;
        path.clear();
        for back in (1..=paths.depth(step.clock, lane)).rev() {
            path.push(DVec3::from(vertices.at(step.clock - back).position.row(lane).map(f64::from)));
        }
        path.push(DVec3::from(candidates.start.row(row).map(f64::from)));
        for vertex in &chains.vertices[..bucket.inserted] {
            path.push(DVec3::from(vertex.row(row).map(f64::from)));
        }
        path.push(DVec3::from(candidates.point.row(row).map(f64::from)));
        let light = candidates.light.rows()[row] as usize;
        let weight = weight(medium, lights, techniques, &path, paths.first_start(lane) as usize, light);
        candidates.weight.rows_mut()[row] = weight as f32;
    }
}

/// The weight of `path`, from the camera vertex to a point on `light`, with starts from `first_start` on.
pub fn weight(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    path: &[DVec3],
    first_start: usize,
    light: usize,
) -> f64 {
    let normal = DVec3::from(lights.disks()[light].normal.map(f64::from));
    let [.., before, point] = path else {
        return 0.0;
    };
    if (*point - *before).dot(normal) >= 0.0 {
        return 0.0;
    }
    let extinction = f64::from(medium.extinction);
    let mut sum = 0.0;
    for start in first_start..path.len() - 1 {
        let Some(traced) = path_tracing_density(extinction, f64::from(medium.phase.g), path, start, normal) else {
            continue;
        };
        let chain = &path[start..];
        let light_density = light_density(lights, light, path[start]);
        if techniques.nee {
            sum += nee::reference::density(chain, normal, light_density).over(traced);
        }
        if let Some(mvnee) = &techniques.mvnee {
            sum += mvnee::reference::density(&mvnee.into(), extinction, chain, light_density).over(traced);
        }
    }
    1.0 / (1.0 + sum)
}

/// Density with which path tracing, at vertex `start`, makes the rest of `path`, which ends on a light that faces
/// `normal`. None if it cannot: in vacuum, or where a segment has no length and so no direction.
pub fn path_tracing_density(extinction: f64, g: f64, path: &[DVec3], start: usize, normal: DVec3) -> Option<Density> {
    let mut density = Density::new(1.0);
    let mut arriving = (path[start] - path[start - 1]).try_normalize()?;
    for j in start..path.len() - 1 {
        let edge = path[j + 1] - path[j];
        let length = edge.length();
        let leaving = edge.try_normalize()?;
        let ends_on_light = j + 2 == path.len();
        density = density
            .times(phase::density(g, arriving.dot(leaving)))
            .times_exp(-extinction * length)
            .times(1.0 / (length * length))
            .times(if ends_on_light { -leaving.dot(normal) } else { extinction });
        arriving = leaving;
    }
    (density.mantissa > 0.0).then_some(density)
}

/// A density, `mantissa * e^exponent`: a plain product, except that its range does not end where that of f64 does.
///
/// It would be left soon: with a mean free path of a kilometre every vertex brings a factor of about 1e-9 per cubic
/// metre, and the product of 36 of them is no longer a number. So is `exp(-mu_t s)` past 745 mean free paths, although
/// the quotient of two such densities is of the order of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    mantissa: f64,
    exponent: f64,
}

impl Density {
    /// The density of what is never made.
    pub const ZERO: Self = Self { mantissa: 0.0, exponent: 0.0 };

    /// A density of one factor.
    pub fn new(factor: f64) -> Self {
        Self { mantissa: factor, exponent: 0.0 }
    }

    /// Multiplied by `factor`, >= 0.
    pub fn times(self, factor: f64) -> Self {
        let product = Self { mantissa: self.mantissa * factor, ..self };
        if product.mantissa == 0.0 || (1e-100..1e100).contains(&product.mantissa) {
            return product;
        }
        Self { mantissa: 1.0, exponent: product.exponent + product.mantissa.ln() }
    }

    /// Multiplied by `e^exponent`.
    pub fn times_exp(self, exponent: f64) -> Self {
        Self { exponent: self.exponent + exponent, ..self }
    }

    /// The quotient of two densities.
    pub fn over(self, other: Self) -> f64 {
        if self.mantissa == 0.0 {
            return 0.0;
        }
        self.mantissa / other.mantissa * (self.exponent - other.exponent).exp()
    }

    /// The density as a number, as far as it is one.
    pub fn value(self) -> f64 {
        self.over(Self::new(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::mvnee::{Mvnee, Offset};
    use crate::phase::HenyeyGreenstein;
    use crate::tables::lights::{Disk, Selection};
    use core::f64::consts::PI;

    fn medium(extinction: f32, g: f32) -> Medium {
        Medium { extinction, albedo: [1.0; 3], phase: HenyeyGreenstein { g } }
    }

    fn light(center: DVec3) -> Lights {
        Lights::new(vec![Disk::new(center, -DVec3::Z, 0.5, [1.0; 3])], Selection::Uniform)
    }

    fn both(medium: &Medium) -> Techniques {
        Techniques { nee: true, mvnee: Some(Mvnee::new(medium, f64::INFINITY, Offset::Ggx)) }
    }

    #[test]
    fn a_straight_connection_has_the_ratios_of_the_closed_form() {
        let (medium, lights) = (medium(0.5, 0.0), light(DVec3::new(0.0, 1.0, 3.0)));
        let path = [DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0), DVec3::new(0.0, 1.0, 3.0)];
        // p_A s^2 / (p_w cos_light), with and without the probability of a flight past the light.
        let ratio = 1.0 / (0.25 * PI) * 4.0 * 4.0 * PI;
        let weight = |techniques: &Techniques| weight(&medium, &lights, techniques, &path, 1, 0);
        assert_eq!(weight(&Techniques::default()), 1.0);
        let nee = weight(&Techniques { nee: true, mvnee: None });
        assert!((nee - 1.0 / (1.0 + ratio * 1.0_f64.exp())).abs() < 1e-12, "{nee}");
        let mvnee = weight(&Techniques { nee: false, ..both(&medium) });
        assert!((mvnee - 1.0 / (1.0 + ratio)).abs() < 1e-12, "{mvnee}");
        let all = weight(&both(&medium));
        assert!((all - 1.0 / (1.0 + ratio + ratio * 1.0_f64.exp())).abs() < 1e-12, "{all}");
    }

    #[test]
    fn backs_and_paths_without_a_last_segment_weigh_nothing() {
        let (medium, lights) = (medium(0.5, 0.3), light(DVec3::ZERO));
        let weight = |before: DVec3| weight(&medium, &lights, &both(&medium), &[DVec3::X, before, DVec3::ZERO], 1, 0);
        assert!(weight(-DVec3::Z) > 0.0);
        assert_eq!([DVec3::Z, DVec3::Y, DVec3::ZERO].map(weight), [0.0; 3]);
    }

    #[test]
    fn starts_whose_suffix_has_an_empty_segment_have_no_ratio() {
        let (medium, lights) = (medium(0.5, 0.3), light(DVec3::new(0.0, 0.0, 2.0)));
        let path = [-DVec3::Z, DVec3::X, DVec3::X, DVec3::ZERO, DVec3::new(0.0, 0.1, 2.0)];
        let weight = |first: usize| weight(&medium, &lights, &both(&medium), &path, first, 0);
        assert_eq!(weight(1), weight(3));
        assert!(weight(3) < 1.0);
    }

    #[test]
    fn weights_do_not_depend_on_the_unit_of_length() {
        let zigzag = |k: usize| DVec3::new(0.1 * (k % 3) as f64, 0.2 * (k % 2) as f64, 0.5 * k as f64);
        let weights = [1e-5_f64, 1.0, 1e4].map(|mfp| {
            let mut path: Vec<_> = (0..200).map(|k| mfp * zigzag(k)).collect();
            path.push(mfp * DVec3::new(0.0, 0.0, 101.0));
            let disk = Disk::new(path[200], -DVec3::Z, 20.0 * mfp, [1.0; 3]);
            let lights = Lights::new(vec![disk], Selection::Uniform);
            let medium = medium((1.0 / mfp) as f32, 0.6);
            weight(&medium, &lights, &both(&medium), &path, 1, 0)
        });
        assert!(weights[1] > 0.0 && weights[1] < 1.0, "{weights:?}");
        assert!(weights.iter().all(|weight| (weight / weights[1] - 1.0).abs() < 1e-4), "{weights:?}");
    }
}
