//! Making OMNEE's connections, in f64 (Hanika, Weidlich, Droske, EGSR 2022).
//!
//! ```text
//! cos theta = c_F(u_1),   alpha = u_2 theta,   phi = 2 pi u_3
//! d_1 = s sin(theta - alpha) / sin theta
//! vertex = x + d_1 (cos alpha w + sin alpha (cos phi tangent + sin phi bitangent))
//! ```
//!
//! where c_F draws from the phase function in the forward hemisphere.

use core::f64::consts::TAU;

use glam::DVec3;

use super::BuildColumns;
use crate::phase::reference::{Phase, frame};
use crate::{Step, random};

/// The twin; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_>) {
    let BuildColumns { medium, paths, connections, chains } = columns;
    for row in 0..connections.len {
        let connection = connections.row(row);
        let lane = connection.lane as usize;
        let [start, point] = [connection.start, connection.point].map(|v| DVec3::from(v.map(f64::from)));
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let u = uniforms(pixel, sample, paths.depth_of(step.clock, lane), step.seed);
        let vertex = place(medium.phase.twin(), start, point, u);
        chains.resampling.rows_mut()[row] = 1.0;
        chains.vertices[0].set_row(row, vertex.as_vec3().to_array());
    }
}

/// The numbers that decide on the turn, the angle at the start and the azimuth.
pub fn uniforms(pixel: u32, sample: u32, depth: u32, seed: u32) -> [f64; 3] {
    let [turn, angle, azimuth, _] = random::words(pixel, sample, random::block(depth, random::OMNEE_VERTEX), seed);
    [turn, angle, azimuth].map(random::uniform)
}

/// The vertex inserted between `start` and `point` `[m]`.
pub fn place(phase: &dyn Phase, start: DVec3, point: DVec3, u: [f64; 3]) -> DVec3 {
    let theta = phase.sample_forward_cosine(u[0]).acos();
    let alpha = u[1] * theta;
    let distance = (point - start).length();
    // A straight chain is cut in the ratio of its angles.
    let share = if theta == 0.0 { 1.0 - u[1] } else { (theta - alpha).sin() / theta.sin() };
    let axis = (point - start).normalize_or_zero();
    let (tangent, bitangent) = frame(axis);
    let (sin_azimuth, cos_azimuth) = (TAU * u[2]).sin_cos();
    let across = cos_azimuth * tangent + sin_azimuth * bitangent;
    start + distance * share * (alpha.cos() * axis + alpha.sin() * across)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::omnee::reference::density;
    use crate::phase::HenyeyGreenstein;

    /// The turn at the inserted vertex and the angle at the start, as a share of it.
    fn angles(start: DVec3, vertex: DVec3, point: DVec3) -> (f64, f64) {
        let (first, second) = (vertex - start, point - vertex);
        let theta = first.angle_between(second);
        (theta, first.angle_between(point - start) / theta)
    }

    #[test]
    fn vertices_have_the_drawn_angles() {
        let (start, point) = (DVec3::new(0.1, -0.4, 2.0), DVec3::new(1.0, 3.0, -1.0));
        let phase = HenyeyGreenstein { g: 0.4 };
        for u in [[0.1, 0.2, 0.3], [0.6, 0.9, 0.0], [0.95, 0.5, 0.75]] {
            let (theta, share) = angles(start, place(&phase, start, point, u), point);
            assert!((theta.cos() - phase.sample_cosine(1.0 - phase.forward_share() * (1.0 - u[0]))).abs() < 1e-9);
            assert!((share - u[1]).abs() < 1e-9, "{share}");
        }
    }

    /// Cells of the unit cube of random numbers are mapped to cells of space; where the map has the Jacobian J, the
    /// density must be 1 / |J|.
    #[test]
    fn the_density_is_one_over_the_jacobian() {
        let (start, point) = (DVec3::new(0.1, -0.4, 2.0), DVec3::new(1.0, 3.0, -1.0));
        for phase in [-0.5, 0.0, 0.6, 0.9].map(|g| HenyeyGreenstein { g }) {
            for u in [[0.2, 0.3, 0.1], [0.5, 0.7, 0.4], [0.9, 0.1, 0.8], [0.7, 0.95, 0.6]] {
                let step = 1e-5;
                let slope = |k: usize| {
                    let moved = |by: f64| {
                        let mut u = u;
                        u[k] += by;
                        place(&phase, start, point, u)
                    };
                    (moved(step) - moved(-step)) / (2.0 * step)
                };
                let jacobian = slope(0).cross(slope(1)).dot(slope(2)).abs();
                let p = density(&phase, &[start, place(&phase, start, point, u), point], 1.0).value();
                assert!((p * jacobian - 1.0).abs() < 1e-5, "{phase:?}, u = {u:?}: {}", p * jacobian);
            }
        }
    }
}
