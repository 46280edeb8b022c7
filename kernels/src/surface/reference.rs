//! Reflection in f64.
//!
//! A path that met a triangle goes on from the point where it did, on the side from which it came. The surface scatters
//! light as Lambert says, albedo / pi per steradian and cosine. With n the normal on that side, d the direction in
//! which the path arrived and u_1, u_2 the two random numbers:
//!
//! ```text
//! for every listed hit, at the distance r, with weights b1, b2 of the corners B, C of a triangle A B C
//!     m  = (B - A) x (C - A) / |(B - A) x (C - A)|                    the front's normal
//!     n  = -m if d . m > 0, m otherwise
//!     x' = A + b1 (B - A) + b2 (C - A) + D n
//!     d' = sqrt(1 - u_1) n + sqrt(u_1) (cos(2 pi u_2) s + sin(2 pi u_2) t),    s, t, n a right-handed frame
//!     T' = T albedo
//!     Lambda' = 0 if x is the camera, Lambda + r otherwise            the arc
//!     the last surface is the one at x', its normal n
//!     the path ends if the albedo is 0, or if n = -m and the back does not reflect
//! ```
//!
//! **The direction.** Density `cos theta / pi` per steradian means that `cos^2 theta` is uniform, and so is `1 - u_1`.
//! Reflected light, `albedo / pi cos theta`, over this density is the albedo.
//!
//! **The clearance.** D bounds how far the point, were it computed in f32, could be from the plane
//! ([`trace::surface`](crate::trace::surface)): with u = 2^-24, n = (n_x, n_y, n_z) and `b0 = max(0, 1 - b1 - b2)`
//!
//! ```text
//! e = 9 u / (1 - 9 u) (|b0 A| + |b1 B| + |b2 C|)                      per component
//! D = (1 + 16 u) (|n_x| e_x + |n_y| e_y + |n_z| e_z)
//! ```
//!
//! The point itself needs none of it in f64. But it is kept in f32, so every component is rounded, and then moved to
//! the next number in the direction of n, or, next to 0, to 2^-96 m: it ends strictly on n's side.

use glam::DVec3;

use super::Columns;
use crate::columns::paths::{LastSurface, Vertex};
use crate::columns::queues::SurfaceHit;
use crate::phase::reference as phase;
use crate::tables::geometry::TriangleHit;
use crate::tables::surfaces::Surfaces;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { surfaces, surface_hits, paths, flights, live, last_surface, .. } = columns;
    let Columns { vertex, next, ray, next_ray, throughput, .. } = columns;
    for hit in (0..surface_hits.len).map(|row| surface_hits.row(row)) {
        let lane = hit.lane as usize;
        let direction = DVec3::from(ray.direction.row(lane).map(f64::from));
        let triangle = surfaces.geometry().corners(hit.triangle as usize);
        let barycentric = [hit.second, hit.third].map(f64::from);
        let normal = side(triangle, direction);
        let position = point(triangle, barycentric) + clearance(triangle, barycentric, normal) * normal;
        let flight = flights.row(lane);
        let reflected = reflect(normal, [flight.cosine, flight.azimuth].map(random::uniform));

        let depth = paths.depth_of(step.clock, lane);
        let arc = if depth == 0 { 0.0 } else { f64::from(vertex.arc.rows()[lane]) + f64::from(hit.distance) };
        next.set_row(lane, Vertex { position: round_along(position, normal), arc: arc as f32 });
        next_ray.direction.set_row(lane, reflected.as_vec3().to_array());
        last_surface.set_row(lane, LastSurface { depth: depth + 1, normal: normal.as_vec3().to_array() });
        for (channel, albedo) in throughput.channels_mut().iter_mut().zip(albedo(surfaces, hit)) {
            let throughput = &mut channel.rows_mut()[lane];
            *throughput = (f64::from(*throughput) * f64::from(albedo)) as f32;
        }
        if is_black(surfaces, hit, direction) {
            live.remove(lane);
        }
    }
}

/// Whether a path ends where it meets a surface, arriving in `direction`: on the back of a one-sided one, and where
/// nothing is reflected.
pub fn is_black(surfaces: &Surfaces, hit: SurfaceHit, direction: DVec3) -> bool {
    let triangle = surfaces.geometry().corners(hit.triangle as usize);
    let on_back = direction.dot(front(triangle)) > 0.0;
    if on_back && !surfaces.material(hit.triangle).double_sided {
        return true;
    }
    albedo(surfaces, hit) == [0.0; 3]
}

/// Reflected share of the light where a surface was met, per channel, [0, 1].
pub fn albedo(surfaces: &Surfaces, hit: SurfaceHit) -> [f32; 3] {
    let SurfaceHit { triangle, distance, second, third, .. } = hit;
    surfaces.albedo(&TriangleHit { triangle, distance, barycentric: [second, third] })
}

/// The unit normal of a triangle on its front, from where its corners run counterclockwise.
fn front(triangle: [[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = corners(triangle);
    (b - a).cross(c - a).normalize()
}

/// The unit normal of a triangle on the side from which a path comes that arrives in `direction`.
pub fn side(triangle: [[f32; 3]; 3], direction: DVec3) -> DVec3 {
    let front = front(triangle);
    if direction.dot(front) > 0.0 { -front } else { front }
}

/// The point of a triangle with the weights `barycentric` of its second and third corner `[m]`. Whatever the weights,
/// it is in the triangle's plane.
pub fn point(triangle: [[f32; 3]; 3], barycentric: [f64; 2]) -> DVec3 {
    let [a, b, c] = corners(triangle);
    a + barycentric[0] * (b - a) + barycentric[1] * (c - a)
}

/// How far from a triangle's plane, along its unit `normal`, its point with the weights `barycentric` may be where it
/// is known in f32: D of the bound `[m]`.
pub fn clearance(triangle: [[f32; 3]; 3], barycentric: [f64; 2], normal: DVec3) -> f64 {
    let unit = 0.5_f64.powi(24);
    let [a, b, c] = corners(triangle).map(DVec3::abs);
    let [b1, b2] = barycentric;
    let b0 = (1.0 - b1 - b2).max(0.0);
    let error = 9.0 * unit / (1.0 - 9.0 * unit) * (b0 * a + b1 * b + b2 * c);
    (1.0 + 16.0 * unit) * normal.abs().dot(error)
}

/// The unit direction in which a path leaves a surface with this unit `normal`; `u` decides on cosine and azimuth.
pub fn reflect(normal: DVec3, u: [f64; 2]) -> DVec3 {
    phase::turn(normal, (1.0 - u[0]).sqrt(), u[1])
}

/// A position in f32, rounded and then moved to the next number wherever `normal` points, but none so near 0 that it is
/// hardly a number: strictly on its side.
fn round_along(position: DVec3, normal: DVec3) -> [f32; 3] {
    let least = 0.5_f32.powi(96);
    [0, 1, 2].map(|axis| {
        let rounded = position[axis] as f32;
        match normal[axis] {
            component if component != 0.0 && rounded.abs() < least => least * component.signum() as f32,
            component if component > 0.0 => rounded.next_up(),
            component if component < 0.0 => rounded.next_down(),
            _ => rounded,
        }
    })
}

fn corners(triangle: [[f32; 3]; 3]) -> [DVec3; 3] {
    triangle.map(|corner| DVec3::from(corner.map(f64::from)))
}

#[cfg(test)]
mod tests;
