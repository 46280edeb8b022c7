//! Making the connections of light importance sampling, in f64 (after Weber, Hanika, Dachsbacher 2017).
//!
//! ```text
//! cos theta = u_1^{1 / (k + 2)},   phi = 2 pi u_2,   tau~(t) = -ln(1 - u_3) along the ray
//! y = x_n + t (cos theta normal + sin theta (cos phi tangent + sin phi bitangent))
//! ```
//!
//! The cosine inverts the distribution of p_dir: `int_c^1 (k + 2) x^{k+1} dx = 1 - c^{k+2}`, and u may stand for 1 - u.

use glam::DVec3;

use super::{JoinColumns, VertexColumns};
use crate::columns::queues::{Candidate, End};
use crate::connect::lis::Lis;
use crate::emission::reference::emit;
use crate::media::reference::{Medium, flight, reach};
use crate::tables::lights::Emitter;
use crate::{Step, random};

/// The twin; see [`VertexKernel`](super::VertexKernel).
pub fn vertex(step: Step, columns: VertexColumns<'_, '_>) {
    let VertexColumns { medium, lights, lis, paths, immersion, connections, ends } = columns;
    let rows: Vec<Candidate> = (0..connections.len).map(|row| connections.row(row)).collect();
    (connections.len, ends.len) = (0, 0);
    for connection in rows {
        let lane = connection.lane as usize;
        let [start, end] = [connection.start, connection.point].map(|v| DVec3::from(v.map(f64::from)));
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let u = uniforms(pixel, sample, paths.depth_of(step.clock, lane), step.seed);
        let medium = medium.twin_of_connections(immersion.hero.rows()[lane] as usize);
        let vertex = place(&lights.emitters()[connection.emitter as usize], &medium, end, u);
        if let Some(vertex) = vertex.filter(|vertex| is_within_reach(lis, start, *vertex)) {
            connections.push(Candidate { point: vertex.as_vec3().to_array(), ..connection });
            ends.push(End { lane: connection.lane, point: connection.point });
        }
    }
}

/// The numbers that decide on cosine, azimuth, flight and side.
pub fn uniforms(pixel: u32, sample: u32, depth: u32, seed: u32) -> [f64; 4] {
    random::words(pixel, sample, random::block(depth, random::LIS_VERTEX), seed).map(random::uniform)
}

/// The vertex made from `point` on the emitter `[m]`; none where the flight leaves everything or ends in vacuum.
pub fn place(emitter: &Emitter, medium: &dyn Medium, point: DVec3, u: [f64; 4]) -> Option<DVec3> {
    let direction = emit(emitter, point, u);
    let length = reach(&medium.strata_of_ray(point, direction), flight(u[2], 1.0));
    let vertex = point + length * direction;
    (length.is_finite() && medium.extinction(vertex) > 0.0).then_some(vertex)
}

/// Whether the connector may join `start` with `vertex`.
pub fn is_within_reach(lis: &Lis, start: DVec3, vertex: DVec3) -> bool {
    start.distance(vertex) <= f64::from(lis.max_distance())
}

/// The twin; see [`JoinKernel`](super::JoinKernel).
pub fn join(_: Step, columns: JoinColumns<'_, '_>) {
    let JoinColumns { buckets, ends, candidates, chains } = columns;
    for bucket in buckets.buckets() {
        for row in bucket.rows() {
            let end = ends.row(buckets.order.rows()[row] as usize);
            chains.vertices[bucket.inserted].set_row(row, candidates.point.row(row));
            candidates.point.set_row(row, end.point);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::lis::reference::vertex_density;
    use crate::media::reference::Homogeneous;

    fn made(emitter: &Emitter, medium: &dyn Medium, u: [f64; 4]) -> DVec3 {
        place(emitter, medium, DVec3::ONE, u).expect("a flight that ends")
    }

    /// Cells of the unit cube of random numbers are mapped to cells of space; where the map has the Jacobian J, the
    /// density must be 1 / |J|.
    #[test]
    fn the_density_is_one_over_the_jacobian() {
        let medium = Homogeneous::isotropic(0.7);
        let plain = Emitter::disk(DVec3::new(0.3, -1.0, 2.0), DVec3::new(0.2, -0.4, 0.9), 0.5, [1.0; 3]);
        let sphere = Emitter::sphere(DVec3::ONE - 0.5 * DVec3::Y, 0.5, [1.0; 3]);
        for disk in [plain, plain.focused(0.0), plain.focused(7.0), plain.focused(200.0), sphere] {
            for u in [[0.2, 0.3, 0.1, 0.0], [0.5, 0.7, 0.4, 0.0], [0.9, 0.1, 0.8, 0.9], [0.7, 0.95, 0.6, 0.5]] {
                let step = 1e-6;
                let slope = |k: usize| {
                    let moved = |by: f64| {
                        let mut u = u;
                        u[k] += by;
                        made(&disk, &medium, u)
                    };
                    (moved(step) - moved(-step)) / (2.0 * step)
                };
                let jacobian = slope(0).cross(slope(1)).dot(slope(2)).abs();
                let p = vertex_density(&disk, &medium, DVec3::ONE, made(&disk, &medium, u)).value();
                assert!((p * jacobian - 1.0).abs() < 1e-5, "{disk:?}, u = {u:?}: {}", p * jacobian);
            }
        }
    }
}
