//! Reflection in f64.
//!
//! ```text
//! x' = A + u (B - A) + v (C - A),     n along (B - A) x (C - A), turned to where the ray comes from
//! d' = cos theta n + sin theta (cos phi tangent + sin phi bitangent),     cos^2 theta = 1 - u_1,  phi = 2 pi u_2
//! ```
//!
//! `cos theta` then has density `2 cos theta`, the direction `cos theta / pi`, and Lambert's reflection `albedo / pi` times
//! `cos theta` over it is the albedo.

use core::f64::consts::TAU;

use glam::DVec3;

use super::Columns;
use crate::columns::queues::SurfaceHit;
use crate::phase::reference::frame;
use crate::tables::surfaces::Surfaces;
use crate::trace::Hit;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(surfaces: &Surfaces, step: Step, columns: Columns<'_, '_>) {
    let Columns { surface_hits, flights, paths, vertices, rays } = columns;
    let (vertex, next) = vertices.step(step.clock);
    let (arriving, leaving) = rays.step(step.clock);
    for row in 0..surface_hits.len {
        let hit = surface_hits.row(row);
        let lane = hit.lane as usize;
        let direction = DVec3::from(arriving.direction.row(lane).map(f64::from));
        let depth = paths.depth(step.clock, lane);
        let triangle = surfaces.geometry().corners(hit.triangle as usize);
        let side = side(triangle, direction);
        let words = [flights.cosine.rows()[lane], flights.azimuth.rows()[lane]];
        let distance = f64::from(hit.distance);
        let arc = if depth == 0 { 0.0 } else { f64::from(vertex.arc.rows()[lane]) + distance };

        let position = point(triangle, [hit.second, hit.third].map(f64::from));
        let position = position + side * margin(triangle, side);
        next.position.set_row(lane, position.as_vec3().to_array());
        next.arc.rows_mut()[lane] = arc as f32;
        leaving.direction.set_row(lane, reflect(side, words.map(random::uniform)).as_vec3().to_array());
        paths.columns.last_surface.rows_mut()[lane] = depth + 1;
        paths.columns.surface_normal.set_row(lane, side.as_vec3().to_array());
        let albedo = albedo(surfaces, hit);
        for (throughput, albedo) in paths.columns.throughput.channels_mut().into_iter().take(paths.channels).zip(albedo)
        {
            let throughput = &mut throughput.rows_mut()[lane];
            *throughput = (f64::from(*throughput) * f64::from(albedo)) as f32;
        }
        if is_black(surfaces, hit, direction) {
            paths.live.remove(hit.lane);
        }
    }
}

/// The point of a triangle with the weights of its second and third corner.
pub fn point(triangle: [[f32; 3]; 3], [u, v]: [f64; 2]) -> DVec3 {
    let [a, b, c] = triangle.map(|corner| DVec3::from(corner.map(f64::from)));
    a + u * (b - a) + v * (c - a)
}

/// How far vertices are kept off the triangle along the unit vector `side` `[m]`: some roundings of its coordinates.
pub fn margin(triangle: [[f32; 3]; 3], side: DVec3) -> f64 {
    let size = |corner: [f32; 3]| side.abs().dot(DVec3::from(corner.map(f64::from)).abs());
    let largest = triangle.map(size).into_iter().fold(0.0, f64::max);
    10.0 * 2.0_f64.powi(-24) * largest
}

/// The unit normal of a triangle on the side from which `direction` comes.
pub fn side(triangle: [[f32; 3]; 3], direction: DVec3) -> DVec3 {
    let [a, b, c] = triangle.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize();
    if direction.dot(normal) < 0.0 { normal } else { -normal }
}

/// The direction in which a Lambert surface with the unit normal `normal` reflects, for two numbers.
pub fn reflect(normal: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    let (tangent, bitangent) = frame(normal);
    let (sin, cos) = (TAU * v).sin_cos();
    (1.0 - u).sqrt() * normal + u.sqrt() * (cos * tangent + sin * bitangent)
}

/// Reflected share of the light per channel.
pub fn albedo(surfaces: &Surfaces, hit: SurfaceHit) -> [f32; 3] {
    surfaces.albedo(&Hit { triangle: hit.triangle, distance: hit.distance, barycentric: [hit.second, hit.third] })
}

/// Whether nothing is reflected to where a ray in `direction` comes from.
pub fn is_black(surfaces: &Surfaces, hit: SurfaceHit, direction: DVec3) -> bool {
    let [a, b, c] = surfaces.geometry().corners(hit.triangle as usize).map(|corner| DVec3::from(corner.map(f64::from)));
    let from_back = direction.dot((b - a).cross(c - a)) >= 0.0;
    albedo(surfaces, hit) == [0.0; 3] || (from_back && !surfaces.material(hit.triangle).double_sided)
}
