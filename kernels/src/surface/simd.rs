//! ```text
//! n   = geometric normal, on the side from which d comes;   end the path if that side is black
//! x'  = point of the triangle, moved along n beyond its rounding error,   arc' = arc + distance, or 0 after the camera
//! d'  = sqrt(1 - u) n + sqrt(u) (cos(2 pi v) tangent + sin(2 pi v) bitangent)
//! T   = T * albedo
//! ```
//!
//! 1. Triangles differ from row to row: their points and normals are fetched one by one, the directions drawn eight at
//!    a time.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::queues::SurfaceHit;
use crate::lanes::LANES;
use crate::random::uniform_x8;
use crate::tables::geometry::TriangleHit;
use crate::tables::surfaces::Surfaces;
use crate::trace::surface;
use crate::transcendental::sin_cos_turn;
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { surfaces, surface_hits, paths, flights, live, .. } = columns;
    let Columns { last_surface, vertex, next, ray, next_ray, throughput, .. } = columns;
    for b in 0..surface_hits.len.div_ceil(LANES) {
        let count = (surface_hits.len - b * LANES).min(LANES);
        let lane_of = surface_hits.lane.batch(b).to_array();
        let direction = ray.direction.gather(&lane_of);

        let mut points = Points::default();
        let directions = direction.to_arrays();
        for i in 0..count {
            points.set(i, surfaces, surface_hits.row(b * LANES + i), directions.map(|component| component[i]));
        }
        let normal = Vec3x8::new(points.normal[0].into(), points.normal[1].into(), points.normal[2].into());

        let u = uniform_x8(flights.cosine.gather(&lane_of));
        let (sin, cos) = sin_cos_turn(uniform_x8(flights.azimuth.gather(&lane_of)));
        let (tangent, bitangent) = normal.frame();
        let sine = u.sqrt();
        let reflected = tangent.mul_add(sine * cos, bitangent.mul_add(sine * sin, normal * (f32x8::ONE - u).sqrt()));

        let birth = paths.birth.gather(&lane_of);
        let at_camera = lanes::as_mask(birth.simd_eq(u32x8::splat(step.clock)));
        let arc = at_camera.select(f32x8::ZERO, vertex.arc.gather(&lane_of) + surface_hits.distance.batch(b));
        let depth = u32x8::splat(step.clock + 1) - birth;
        let position = Vec3x8::new(points.position[0].into(), points.position[1].into(), points.position[2].into());
        next.position.scatter(&lane_of, count, position);
        next.arc.scatter(&lane_of, count, arc);
        next_ray.direction.scatter(&lane_of, count, reflected);
        last_surface.normal.scatter(&lane_of, count, normal);
        last_surface.depth.scatter(&lane_of, count, depth);
        for (throughput, albedo) in throughput.channels_mut().iter_mut().zip(points.albedo) {
            let product = throughput.gather(&lane_of) * f32x8::new(albedo);
            throughput.scatter(&lane_of, count, product);
        }
        for i in lanes::each(points.black) {
            live.remove(lane_of[i] as usize);
        }
    }
}

/// Where eight paths met surfaces, component by component.
#[derive(Default)]
struct Points {
    position: [[f32; LANES]; 3],
    normal: [[f32; LANES]; 3],
    albedo: [[f32; LANES]; 3],
    /// Rows that end there.
    black: u32,
}

impl Points {
    /// Fills row `i` with what a ray in `direction` found.
    #[inline(always)]
    fn set(&mut self, i: usize, surfaces: &Surfaces, found: SurfaceHit, direction: [f32; 3]) {
        let SurfaceHit { triangle, distance, second, third, .. } = found;
        let hit = TriangleHit { triangle, distance, barycentric: [second, third] };
        let corners = surfaces.geometry().corners(triangle as usize);
        let front = surface::normal(corners);
        let is_front = dot(front, direction) < 0.0;
        let normal = if is_front { front } else { front.map(|component| -component) };
        let position = surface::leave(&surface::point(corners, hit.barycentric), normal, normal);
        let albedo = surfaces.albedo(&hit);
        if albedo == [0.0; 3] || !(is_front || surfaces.material(triangle).double_sided) {
            self.black |= 1 << i;
        }
        for axis in 0..3 {
            self.position[axis][i] = position[axis];
            self.normal[axis][i] = normal[axis];
            self.albedo[axis][i] = albedo[axis];
        }
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
