//! ```text
//! n   = geometric normal, on the side from which d comes;   end the path if that side is black
//! x'  = point of the triangle, moved along n beyond its rounding error,   arc' = arc + distance, or 0 after the camera
//! d'  = sqrt(1 - u) n + sqrt(u) (cos(2 pi v) tangent + sin(2 pi v) bitangent)
//! T   = T * albedo
//! ```
//!
//! 1. Triangles differ from row to row: corners, normals and albedos are fetched one by one, all else is done eight at a
//!    time.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::queues::SurfaceHit;
use crate::lanes::LANES;
use crate::random::uniform_f32;
use crate::tables::geometry::TriangleHit;
use crate::tables::surfaces::Surfaces;
use crate::trace::surface;
use crate::transcendental::sin_cos_turn;
use crate::vec3::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { surfaces, surface_hits, paths, flights, live, .. } = columns;
    let Columns { last_surface, vertex, next, ray, next_ray, throughput, .. } = columns;
    for b in 0..surface_hits.len.div_ceil(LANES) {
        let count = (surface_hits.len - b * LANES).min(LANES);
        let lane_of = surface_hits.lane.batch(b).to_array();
        let direction = ray.direction.gather(&lane_of);

        let mut met = Met::default();
        for i in 0..count {
            met.set(i, surfaces, surface_hits.row(b * LANES + i));
        }
        let front = Vec3x8::from_arrays(met.front);
        let is_front = front.dot(direction).simd_lt(f32x8::ZERO);
        let normal = Vec3x8::select(is_front, front, -front);
        let barycentric = [surface_hits.second.batch(b), surface_hits.third.batch(b)];
        let position = surface::leave(&surface::points(met.corners.map(Vec3x8::from_arrays), barycentric), normal);

        let u = uniform_f32(flights.cosine.gather(&lane_of));
        let (sin, cos) = sin_cos_turn(uniform_f32(flights.azimuth.gather(&lane_of)));
        let (tangent, bitangent) = normal.frame();
        let sine = u.sqrt();
        let reflected = tangent.mul_add(sine * cos, bitangent.mul_add(sine * sin, normal * (f32x8::ONE - u).sqrt()));

        let birth = paths.birth.gather(&lane_of);
        let at_camera = lanes::as_mask(birth.simd_eq(u32x8::splat(step.clock)));
        let arc = at_camera.select(f32x8::ZERO, vertex.arc.gather(&lane_of) + surface_hits.distance.batch(b));
        let depth = u32x8::splat(step.clock + 1) - birth;
        next.position.scatter(&lane_of, count, position);
        next.arc.scatter(&lane_of, count, arc);
        next_ray.direction.scatter(&lane_of, count, reflected);
        last_surface.normal.scatter(&lane_of, count, normal);
        last_surface.depth.scatter(&lane_of, count, depth);
        for (throughput, albedo) in throughput.channels_mut().iter_mut().zip(met.albedo) {
            let product = throughput.gather(&lane_of) * f32x8::new(albedo);
            throughput.scatter(&lane_of, count, product);
        }
        let black = met.black | (met.one_sided & !lanes::bits(is_front));
        for i in lanes::each(black & lanes::first(count)) {
            live.remove(lane_of[i] as usize);
        }
    }
}

/// The triangles that eight paths met, component by component.
#[derive(Default)]
struct Met {
    corners: [[[f32; LANES]; 3]; 3],
    /// Unit normals of their fronts.
    front: [[f32; LANES]; 3],
    albedo: [[f32; LANES]; 3],
    /// Rows that end there.
    black: u32,
    /// Rows that end there if they come from the back.
    one_sided: u32,
}

impl Met {
    /// Fills row `i` with what a ray found.
    #[inline(always)]
    fn set(&mut self, i: usize, surfaces: &Surfaces, found: SurfaceHit) {
        let SurfaceHit { triangle, distance, second, third, .. } = found;
        let corners = surfaces.geometry().corners(triangle as usize);
        let front = surfaces.geometry().normal(triangle as usize, corners);
        let albedo = surfaces.albedo(&TriangleHit { triangle, distance, barycentric: [second, third] });
        self.black |= u32::from(albedo == [0.0; 3]) << i;
        self.one_sided |= u32::from(!surfaces.material(triangle).double_sided) << i;
        for axis in 0..3 {
            for (rows, corner) in self.corners.iter_mut().zip(corners) {
                rows[axis][i] = corner[axis];
            }
            self.front[axis][i] = front[axis];
            self.albedo[axis][i] = albedo[axis];
        }
    }
}
