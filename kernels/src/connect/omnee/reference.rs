//! The full density of once-more next event estimation, in f64 (Hanika, Weidlich, Droske, EGSR 2022).
//!
//! One vertex is inserted between a start and a point at distance s, at distances d_1 and d_2 from them. With theta the
//! turn there,
//!
//! ```text
//! p = p_A P_l * phase(cos theta) / F * s (sin theta / theta) / (d_1^2 d_2^2)      (volume and area measure)
//! ```
//!
//! with F the phase function's share of the forward hemisphere: the density 2 pi sin theta phase / F of theta, 1 /
//! theta of the angle at the start and 1 / (2 pi) of the azimuth, over the volume `d_1^2 d_2^2 / s` that the three
//! angles span.

use glam::DVec3;

use crate::connect::BLUR;
use crate::connect::density::Density;
use crate::phase::reference::Phase;

/// Density of making `chain`, the vertices from the start to the point on the light; `light_density` is p_A P_l at the
/// start. Zero unless exactly one vertex is inserted, and turns the path forward, or back by no more than [`BLUR`].
pub fn density(phase: &dyn Phase, chain: &[DVec3], light_density: f64) -> Density {
    let [start, vertex, point] = chain else {
        return Density::ZERO;
    };
    let (first, second) = (*vertex - *start, *point - *vertex);
    if first.length() == 0.0 || second.length() == 0.0 {
        return Density::ZERO;
    }
    let (along, across) = (first.dot(second), first.cross(second).length());
    let distance = (*point - *start).length();
    let blur = f64::from(BLUR) * (point.length() + distance);
    if along <= -blur * (first.length() + second.length()) {
        return Density::ZERO;
    }
    let theta = across.atan2(along);
    let sine_over_angle = if theta == 0.0 { 1.0 } else { theta.sin() / theta };
    Density::new(light_density)
        .times(phase.density(theta.cos()) / phase.forward_share())
        .times(distance * sine_over_angle)
        .times(1.0 / first.length_squared())
        .times(1.0 / second.length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::HenyeyGreenstein;
    use core::f64::consts::{PI, TAU};

    #[test]
    fn the_density_integrates_to_one_over_the_forward_ball() {
        let start = DVec3::new(0.3, -1.0, 2.0);
        let (axis, distance) = (DVec3::new(1.0, 2.0, -0.5).normalize(), 1.7);
        let side = axis.any_orthonormal_vector();
        let point = start + distance * axis;
        for g in [-0.6, 0.0, 0.4, 0.9] {
            let (angles, shares) = (400, 64);
            let mut sum = 0.0;
            for (i, j) in (0..angles).flat_map(|i| (0..shares).map(move |j| (i, j))) {
                // The forward ball is the set of points that see both ends under a right angle or more.
                let theta = 0.5 * PI * (f64::from(i) + 0.5) / f64::from(angles);
                let alpha = theta * (f64::from(j) + 0.5) / f64::from(shares);
                let [d1, d2] = [theta - alpha, alpha].map(|angle| distance * angle.sin() / theta.sin());
                let vertex = start + d1 * (alpha.cos() * axis + alpha.sin() * side);
                let volume = TAU * d1 * d1 * d2 * d2 / distance * theta / f64::from(shares);
                sum += density(&HenyeyGreenstein { g }, &[start, vertex, point], 0.25).value() * volume * 0.5 * PI
                    / f64::from(angles);
            }
            assert!((sum / 0.25 - 1.0).abs() < 1e-4, "g = {g}: {sum}");
        }
    }

    /// The same in cylindrical coordinates, which know nothing of the law of sines: volume 2 pi rho drho dz.
    #[test]
    fn the_density_integrates_to_one_over_a_sphere_cut_into_rings() {
        let (steps, distance) = (3000, 2.0);
        let point = DVec3::new(0.0, 0.0, distance);
        let width = 1.0 / f64::from(steps);
        let mut sum = 0.0;
        for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
            // Squares of cells towards the ends and the axis, where the density is largest.
            let (u, v) = ((f64::from(i) + 0.5) * width, (f64::from(j) + 0.5) * width);
            let z = distance * u * u * (3.0 - 2.0 * u);
            let widest = (z * (distance - z)).sqrt();
            let rho = widest * v;
            let ring = TAU * rho * widest * distance * 6.0 * u * (1.0 - u) * width * width;
            sum += density(&HenyeyGreenstein { g: 0.5 }, &[DVec3::ZERO, DVec3::new(rho, 0.0, z), point], 1.0).value()
                * ring;
        }
        assert!((sum - 1.0).abs() < 3e-3, "{sum}");
    }

    #[test]
    fn chains_of_another_length_and_backward_turns_are_never_made() {
        let (start, point) = (DVec3::ZERO, DVec3::X);
        let made = |inner: &[DVec3]| {
            let chain = [&[start], inner, &[point]].concat();
            density(&HenyeyGreenstein { g: 0.5 }, &chain, 1.0).value() > 0.0
        };
        assert!(made(&[DVec3::new(0.5, 0.1, 0.0)]) && made(&[0.25 * point]));
        assert!(!made(&[]) && !made(&[0.25 * point, 0.5 * point]));
        for vertex in [start, point, DVec3::new(-1.0, 0.1, 0.0), DVec3::new(0.5, 0.6, 0.0)] {
            assert!(!made(&[vertex]), "{vertex}");
        }
    }
}
