//! Radiances by quadrature, from the formulas alone: nothing here is shared with what renders.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

/// The Henyey-Greenstein phase function [1/sr].
pub fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    let h = 1.0 + g * g - 2.0 * g * cosine;
    (1.0 - g * g) / (4.0 * PI * h * h.sqrt())
}

/// How a flat light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emission {
    /// Alike in all directions.
    Even,
    /// `(n + 1) / (2 pi) cos^n` of the angle to the normal.
    Power(f64),
    /// With an intensity that is the same up to the inner angle and falls to 0 at the outer one `[rad]`, as
    /// `KHR_lights_punctual` recommends.
    Cone(f64, f64),
}

impl Emission {
    /// Radiance at this cosine of the angle to the normal, over that of the light.
    pub fn radiance(self, cosine: f64) -> f64 {
        match self {
            _ if cosine <= 0.0 => 0.0,
            Self::Even => 1.0,
            Self::Power(n) => (n + 1.0) / TAU * cosine.powf(n),
            Self::Cone(inner, outer) => {
                let fall = (cosine - outer.cos()) / (inner.cos() - outer.cos());
                fall.clamp(0.0, 1.0).powi(2) / cosine
            }
        }
    }
}

/// A disk in a medium.
#[derive(Clone, Copy, Debug)]
pub struct LitFog {
    /// Scattering coefficient [1/m].
    pub scattering: f64,
    /// Extinction [1/m].
    pub extinction: f64,
    /// Mean cosine.
    pub g: f64,
    /// Centre of the disk `[m]`.
    pub center: DVec3,
    /// Normal of its front, of any length but 0.
    pub normal: DVec3,
    /// Its radius `[m]`.
    pub radius: f64,
    /// How it shines.
    pub emission: Emission,
}

impl LitFog {
    /// What is scattered once into a ray from the origin along +z that starts at `near` `[m]` and passes the disk by,
    /// over the radiance of the disk.
    pub fn scattered_once(&self, near: f64) -> f64 {
        self.scattered_once_by(near, 1500, [12, 24])
    }

    /// The same by so many steps along the ray, and rings and spokes of the disk.
    fn scattered_once_by(&self, near: f64, steps: u32, [rings, spokes]: [u32; 2]) -> f64 {
        // Optical depth up to which the ray is followed: beyond are 2e-9 of it.
        const DEPTH: f64 = 20.0;
        let normal = self.normal.normalize();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let mut sum = 0.0;
        for i in 0..steps {
            let t = (f64::from(i) + 0.5) / f64::from(steps) * DEPTH / self.extinction;
            let vertex = DVec3::new(0.0, 0.0, near + t);
            for j in 0..rings * spokes {
                let r = self.radius * ((f64::from(j / spokes) + 0.5) / f64::from(rings)).sqrt();
                let (sin, cos) = ((f64::from(j % spokes) + 0.5) / f64::from(spokes) * TAU).sin_cos();
                let way = self.center + r * (cos * tangent + sin * bitangent) - vertex;
                let (distance, direction) = (way.length(), way.normalize());
                let cosine = -direction.dot(normal);
                sum += henyey_greenstein(self.g, direction.z)
                    * self.emission.radiance(cosine)
                    * cosine.max(0.0)
                    * (-self.extinction * (t + distance)).exp()
                    / (distance * distance);
            }
        }
        let area = PI * self.radius * self.radius / f64::from(rings * spokes);
        self.scattering * sum * area * DEPTH / self.extinction / f64::from(steps)
    }
}

/// Nodes and weights of Gauss and Legendre on (0, 1).
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=count {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

/// Fog that fills the space on one side of a shining plane: radiance depends on the optical distance from the plane and
/// on the cosine of the direction one looks to, 1 straight to the plane, and on nothing else.
///
/// With p the phase function averaged over azimuths, and L_0 = Le exp(-t / mu) for mu > 0,
///
/// ```text
/// J_n(t, mu) = albedo 2 pi integral p(mu, mu') L_{n-1}(t, mu') dmu'
/// L_n(t, mu) = integral J_n(t - s mu, mu) exp(-s) ds,      s from 0 to the plane, or without end
/// ```
///
/// is the light that was scattered n times. Directions are the nodes of Gauss and Legendre; between distances from the
/// plane J is linear, and the exponential function is integrated as it is.
pub struct HalfSpace {
    emission: Emission,
    /// Cosines and weights, those towards the plane first.
    directions: Vec<(f64, f64)>,
    /// Optical distances from the plane.
    depths: Vec<f64>,
    /// `2 pi p(mu_i, mu_j) dmu_j`, row by row.
    turns: Vec<f64>,
    g: f64,
}

impl HalfSpace {
    /// Optical distance beyond which there is no light.
    const DEEPEST: f64 = 32.0;

    /// The quadrature with so many directions to either side and so many steps from the plane.
    pub fn new(emission: Emission, g: f64, directions: usize, steps: usize) -> Self {
        let nodes = gauss_legendre(directions);
        let directions: Vec<_> =
            [1.0, -1.0].iter().flat_map(|side| nodes.iter().map(move |(x, w)| (side * x, *w))).collect();
        let depths = (0..=steps).map(|i| Self::DEEPEST * (i as f64 / steps as f64).powi(2)).collect();
        let turns = directions.iter().flat_map(|(mu, _)| turns(g, *mu, &directions)).collect();
        Self { emission, directions, depths, turns, g }
    }

    /// Optical distance from the plane to the end of step `index`.
    pub fn depth(&self, index: usize) -> f64 {
        self.depths[index]
    }

    /// Radiance, over that of the plane, of the light that was scattered 0 .. `orders` times in a medium of albedo 1,
    /// at the end of step `index`, in the direction of cosine `mu`.
    pub fn radiance(&self, index: usize, mu: f64, orders: usize) -> Vec<f64> {
        let unscattered = |mu: f64| self.depths.iter().map(move |t| if mu > 0.0 { (-t / mu).exp() } else { 0.0 });
        let straight = |mu: f64| unscattered(mu).map(|left| left * self.emission.radiance(mu)).collect::<Vec<_>>();
        let mut before: Vec<Vec<f64>> = self.directions.iter().map(|(mu, _)| straight(*mu)).collect();
        let mut found = vec![straight(mu)[index]];
        let towards = turns(self.g, mu, &self.directions);
        for _ in 1..orders {
            found.push(self.gathered(mu, &scattered(&towards, &before))[index]);
            let rows = self.turns.chunks_exact(self.directions.len());
            before = self
                .directions
                .iter()
                .zip(rows)
                .map(|((mu, _), row)| self.gathered(*mu, &scattered(row, &before)))
                .collect();
        }
        found
    }

    /// What a ray of cosine `mu` gathers of `source` up to every distance from the plane.
    fn gathered(&self, mu: f64, source: &[f64]) -> Vec<f64> {
        let mut radiance = vec![0.0; source.len()];
        let mut step = |from: usize, to: usize| {
            let length = ((self.depths[to] - self.depths[from]) / mu).abs();
            // The means of 1 and of s / length over exp(-s).
            let all = -(-length).exp_m1();
            let far =
                if length < 1e-3 { length * (0.5 - length / 3.0) } else { (all - length * (-length).exp()) / length };
            radiance[to] = radiance[from] * (-length).exp() + source[to] * (all - far) + source[from] * far;
        };
        match mu > 0.0 {
            true => (1..source.len()).for_each(|to| step(to - 1, to)),
            false => (0..source.len() - 1).rev().for_each(|to| step(to + 1, to)),
        }
        radiance
    }
}

/// Share of the light from each of `directions` that is scattered to the cosine `mu` [1].
fn turns(g: f64, mu: f64, directions: &[(f64, f64)]) -> Vec<f64> {
    const AZIMUTHS: u32 = 512;
    let sine = |mu: f64| (1.0 - mu * mu).sqrt();
    let share = |(other, weight): &(f64, f64)| {
        let cosine = |i: u32| (f64::from(i) / f64::from(AZIMUTHS) * TAU).cos();
        let phase = |i: u32| henyey_greenstein(g, mu * other + sine(mu) * sine(*other) * cosine(i));
        (0..AZIMUTHS).map(phase).sum::<f64>() / f64::from(AZIMUTHS) * TAU * weight
    };
    directions.iter().map(share).collect()
}

/// The sum over directions of `radiance` by `shares`, at every distance from the plane.
fn scattered(shares: &[f64], radiance: &[Vec<f64>]) -> Vec<f64> {
    let mut source = vec![0.0; radiance[0].len()];
    for (share, radiance) in shares.iter().zip(radiance) {
        source.iter_mut().zip(radiance).for_each(|(sum, radiance)| *sum += share * radiance);
    }
    source
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phase_functions_and_emissions_have_the_flux_that_they_should() {
        let nodes = gauss_legendre(64);
        let integral = |f: &dyn Fn(f64) -> f64| nodes.iter().map(|(x, w)| f(*x) * w).sum::<f64>();
        for g in [-0.9, -0.3, 0.0, 0.7] {
            let both = |x: f64| TAU * (henyey_greenstein(g, x) + henyey_greenstein(g, -x));
            let mean = |x: f64| TAU * x * (henyey_greenstein(g, x) - henyey_greenstein(g, -x));
            assert!((integral(&both) - 1.0).abs() < 1e-6 && (integral(&mean) - g).abs() < 1e-6, "g = {g}");
        }
        for n in [0.0, 1.0, 2.0, 3.0] {
            let flux = integral(&|x| TAU * x * Emission::Power(n).radiance(x));
            assert!((flux - (n + 1.0) / (n + 2.0)).abs() < 1e-9, "{flux} of exponent {n}");
        }
        let intensity = |angle: f64| Emission::Cone(0.3, 0.9).radiance(angle.cos()) * angle.cos();
        assert!((intensity(0.2) - 1.0).abs() < 1e-12 && intensity(0.91) == 0.0);
    }

    #[test]
    fn light_scattered_once_back_to_the_plane_has_a_closed_form() {
        // mu (1 - mu ln(1 + 1 / mu)) albedo / 2 over mu, of isotropic scattering.
        let half_space = HalfSpace::new(Emission::Even, 0.0, 64, 320);
        for mu in [0.1, 0.5, 1.0_f64] {
            let expected = 0.5 * (1.0 - mu * (1.0 + 1.0 / mu).ln());
            let found = half_space.radiance(0, -mu, 2);
            assert!(found[0] == 0.0 && (found[1] / expected - 1.0).abs() < 1e-3, "{found:?}, expected {expected}");
        }
    }

    #[test]
    fn finer_steps_find_the_same_light_scattered_once() {
        for emission in [Emission::Even, Emission::Power(40.0), Emission::Cone(0.2, 0.7), Emission::Cone(0.6, 0.65)] {
            for g in [-0.9, 0.8] {
                let (center, normal) = (DVec3::new(0.8, 0.5, 4.0), DVec3::new(-0.5, -0.3, -1.0));
                let fog = LitFog { scattering: 0.8, extinction: 1.1, g, center, normal, radius: 0.5, emission };
                let (coarse, fine) = (fog.scattered_once(0.0), fog.scattered_once_by(0.0, 3000, [24, 48]));
                assert!((coarse / fine - 1.0).abs() < 5e-4, "{emission:?}, g = {g}: {coarse} and {fine}");
            }
        }
    }

    #[test]
    fn finer_quadratures_find_the_same() {
        for (emission, g) in [
            (Emission::Even, -0.9),
            (Emission::Power(2.0), -0.5),
            (Emission::Cone(0.4, 1.1), -0.5),
            (Emission::Even, 0.7),
        ] {
            let with = |directions: usize, steps: usize| {
                let half_space = HalfSpace::new(emission, g, directions, steps);
                assert!((half_space.depth(steps / 5) - 1.28).abs() < 1e-12);
                [0.6, -0.3].map(|mu| half_space.radiance(steps / 5, mu, 5))
            };
            for (coarse, fine) in with(64, 320).iter().flatten().zip(with(90, 480).iter().flatten()) {
                assert!((coarse - fine).abs() <= 1e-3 * fine, "{emission:?}, g = {g}: {coarse} and {fine}");
            }
        }
    }
}
