//! Leaving a surface: where a hit is, how wrong that is, and how far from there a ray has to start.
//!
//! A ray that starts on the computed point may start on the wrong side, and hit the surface it leaves, or miss what it
//! should hit. So the point comes with a bound of its error, and rays start beyond it (Pharr, Jakob and Humphreys,
//! Physically Based Rendering, 4th ed., 6.8). With u = 2^-24 and `gamma(n) = n u / (1 - n u)`, n roundings in a row are
//! a factor within `1 +- gamma(n)`.
//!
//! **The point.** With weights b1, b2 and `b0 = max(0, (1 - b1) - b2)` the point is `p = b0 A + b1 B + b2 C`. Every
//! term rounds at most three times, a product and two sums: p is off by at most `gamma(3) (|b0 A| + |b1 B| + |b2 C|)`
//! from the sum with these very weights. Their sum S is off 1 by less than 4 u, so that the sum is off by less than `4
//! u (|b0 A| + ..)` from the same over S, which is a point of the triangle. Together, and with two u for the bound's
//! own rounding,
//!
//! ```text
//! error = gamma(9) (|b0 A| + |b1 B| + |b2 C|)        per component
//! ```
//!
//! Moving p into the triangle's box moves it towards every point of the triangle, so the bound stands; and a point of
//! an upright wall is in that wall exactly.
//!
//! **The start.** The point is within `D = |n_x| e_x + |n_y| e_y + |n_z| e_z` of the plane with unit normal n. A start
//! at `p + D n` is on n's side or on the plane. D is taken 16 u larger, for the roundings of n, of D and of their
//! product, and every component is then moved to the next number in its direction, which makes up for the last sum and
//! leaves the plane where all errors are 0. All of it goes the way of n, so nothing takes the start back.
//!
//! Next to 0 the next number would be a subnormal one, with which a product takes some processors a hundred times as
//! long, and a wall in a plane of coordinates is where models are put. So a component that would be nearer to 0 than
//! 2^-96 m, beyond all that rounding leaves of any coordinate, is moved to there.
//!
//! The tracer settles in f64 on which side of its plane the start is, where that is close. What this cannot do: a start
//! within D of a second surface, in the corner that it makes with the first, may lie beyond that. D is a few u of the
//! coordinates.

use glam::DVec3;
use wide::{f32x8, u32x8};

use crate::lanes;
use crate::vec3::Vec3x8;

/// Half a unit in the last place of 1.
const UNIT: f32 = f32::EPSILON / 2.0;

/// How far starts are from 0, by component, unless they are at 0 `[m]`: 2^-96.
const LEAST: f32 = 1.0 / (1_u128 << 96) as f32;

/// Bound of the relative error of n roundings.
const fn gamma(n: u32) -> f32 {
    n as f32 * UNIT / (1.0 - n as f32 * UNIT)
}

/// Points of eight triangles as f32 knows them.
#[derive(Clone, Copy, Debug)]
pub struct Points {
    /// Where they are `[m]`.
    pub position: Vec3x8,
    /// Bounds of the distance of every component from that of a point of the triangle `[m]`, >= 0.
    pub error: Vec3x8,
}

/// The points with the weights `barycentric` of the second and third corner, `[0, 1]` and of sum up to 1 but for
/// rounding.
#[inline(always)]
pub fn points(corners: [Vec3x8; 3], barycentric: [f32x8; 2]) -> Points {
    let [b1, b2] = barycentric;
    let b0 = ((f32x8::ONE - b1) - b2).fast_max(f32x8::ZERO);
    let component = |a: f32x8, b: f32x8, c: f32x8| {
        let [x, y, z] = [b0 * a, b1 * b, b2 * c];
        let (least, most) = (a.fast_min(b).fast_min(c), a.fast_max(b).fast_max(c));
        let error = f32x8::splat(gamma(9)) * (x.abs() + y.abs() + z.abs());
        ((x + y + z).fast_max(least).fast_min(most), error)
    };
    let [a, b, c] = corners;
    let [x, y, z] = [component(a.x, b.x, c.x), component(a.y, b.y, c.y), component(a.z, b.z, c.z)];
    Points { position: Vec3x8::new(x.0, y.0, z.0), error: Vec3x8::new(x.1, y.1, z.1) }
}

/// The unit normal of a triangle's plane, right-handed around its corners; every component is off by one rounding.
/// Zero where the triangle has no area.
#[inline]
pub fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array()
}

/// The starts of rays from points of planes: beyond the points' error, on the side to which the unit normals `outwards`
/// point.
#[inline(always)]
pub fn leave(points: &Points, outwards: Vec3x8) -> Vec3x8 {
    let Points { position, error } = *points;
    let [x, y, z] = [outwards.x.abs() * error.x, outwards.y.abs() * error.y, outwards.z.abs() * error.z];
    let clearance = (x + y + z) * f32x8::splat(1.0 + 16.0 * UNIT);
    let start = |position: f32x8, outwards: f32x8| {
        let moved = position + clearance * outwards;
        let least = f32x8::splat(LEAST);
        // The next number away from 0 has the next bits; towards 0, those before.
        let away = lanes::as_integer_mask(!(moved.is_sign_negative() ^ outwards.is_sign_negative()));
        let step = away.select(u32x8::splat(1), u32x8::splat(u32::MAX));
        let next: f32x8 = bytemuck::cast(bytemuck::cast::<f32x8, u32x8>(moved) + step);
        let next = moved.abs().simd_lt(least).select(outwards.is_sign_negative().select(-least, least), next);
        outwards.simd_eq(f32x8::ZERO).select(position, next)
    };
    Vec3x8::new(start(position.x, outwards.x), start(position.y, outwards.y), start(position.z, outwards.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;
    use crate::random::{uniform, words};

    /// Corners of a triangle, and weights of a point in it.
    type Case = ([[f32; 3]; 3], [f32; 2]);

    /// Triangles near and far, large and small, and weights in them.
    fn cases() -> impl Iterator<Item = [Case; LANES]> {
        (0..12_500).map(|batch| {
            lanes::per_lane(|lane| {
                let random = |block: u32| words(8 * batch + lane as u32, 0, block, 3).map(|word| uniform(word) as f32);
                let [far, size, u, v] = random(0);
                let (far, size) = (10_f32.powf(12.0 * far - 6.0), 10_f32.powf(12.0 * size - 6.0));
                let center = random(1);
                let corner = |block: u32| {
                    let offset = random(block);
                    [0, 1, 2].map(|axis| far * (2.0 * center[axis] - 1.0) + size * (offset[axis] - 0.5))
                };
                let weights = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
                ([corner(2), corner(3), corner(4)], weights)
            })
        })
    }

    fn vectors(rows: [[f32; 3]; LANES]) -> Vec3x8 {
        Vec3x8::from_arrays([0, 1, 2].map(|axis| rows.map(|row| row[axis])))
    }

    fn points_of(cases: &[Case; LANES]) -> Points {
        let corners = [0, 1, 2].map(|i| vectors(cases.map(|(corners, _)| corners[i])));
        points(corners, [0, 1].map(|i| f32x8::new(cases.map(|(_, weights)| weights[i]))))
    }

    #[test]
    fn points_are_within_their_error_of_the_triangle() {
        for cases in cases() {
            let Points { position, error } = points_of(&cases);
            let (position, error) = (position.to_arrays(), error.to_arrays());
            for (lane, (corners, [b1, b2])) in cases.into_iter().enumerate() {
                let weights = [1.0 - f64::from(b1) - f64::from(b2), f64::from(b1), f64::from(b2)];
                for axis in 0..3 {
                    let exact: f64 = (0..3).map(|i| weights[i] * f64::from(corners[i][axis])).sum();
                    let off = (f64::from(position[axis][lane]) - exact).abs();
                    let error = f64::from(error[axis][lane]);
                    assert!(off <= error, "{corners:?} at {b1}, {b2}, axis {axis}: off by {off:e}");
                }
            }
        }
    }

    #[test]
    fn starts_from_planes_of_coordinates_are_normal_numbers() {
        let floor = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for side in [1.0, -1.0] {
            let outwards = Vec3x8::splat(normal(floor).map(|component| side * component));
            let [x, y, z] = leave(&points_of(&[(floor, [0.25, 0.5]); LANES]), outwards).to_arrays().map(|axis| axis[0]);
            assert!([x, y] == [0.25, 0.5] && z * side > 0.0 && z.is_normal(), "{z:e}");
        }
    }

    #[test]
    fn starts_of_upright_walls_are_the_next_numbers() {
        for (axis, at) in [0, 1, 2].into_iter().flat_map(|axis| [1.0_f32, -3.0, 1e6].map(|at| (axis, at))) {
            for side in [1.0, -1.0] {
                // Only rounding takes a point from such a wall: what is left is one step.
                let mut outwards = [0.0; 3];
                outwards[axis] = side;
                let on_wall = Points { position: Vec3x8::splat([at; 3]), error: Vec3x8::ZERO };
                let start = leave(&on_wall, Vec3x8::splat(outwards)).to_arrays().map(|axis| axis[3]);
                let next = if side > 0.0 { at.next_up() } else { at.next_down() };
                let expected = [0, 1, 2].map(|other| if other == axis { next } else { at });
                assert_eq!(start, expected, "axis {axis} at {at}, side {side}");
            }
        }
    }

    #[test]
    fn starts_are_strictly_on_the_side_that_the_ray_goes_to() {
        for cases in cases() {
            let normals = cases.map(|(corners, _)| normal(corners));
            for sign in [1.0, -1.0] {
                let outwards = vectors(normals.map(|normal| normal.map(|component| sign * component)));
                let starts = leave(&points_of(&cases), outwards).to_arrays();
                for (lane, (corners, weights)) in cases.into_iter().enumerate() {
                    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
                    let exact_normal = (b - a).cross(c - a).normalize_or_zero();
                    // Differences of corners that are hardly apart are in line by chance.
                    if exact_normal == DVec3::ZERO {
                        continue;
                    }
                    let start = starts.map(|axis| axis[lane]);
                    let height = (DVec3::from(start.map(f64::from)) - a).dot(exact_normal);
                    assert!(
                        f64::from(sign) * height > 0.0,
                        "{corners:?} at {weights:?}: {height:e} on the side {sign}"
                    );
                }
            }
        }
    }
}
