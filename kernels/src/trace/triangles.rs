//! Eight triangles against a ray, watertight.
//!
//! ```text
//! in the view along the ray (see `ray`), with corners A, B, C:
//!     U = C_x B_y - C_y B_x,    V = A_x C_y - A_y C_x,    W = B_x A_y - B_y A_x
//!     missed if U, V, W have different signs, or all are 0
//!     t = (U t_A + V t_B + W t_C) / (U + V + W)
//!     hit if 0 < t < bound
//! ```
//!
//! 1. Edge functions are differences of two rounded products, not fused. Rounding is monotonic, so that their sign is
//!    right or they are 0; and the neighbour across the edge, which goes along it the other way, gets the same number
//!    with the other sign. At 0 the lane is settled in f64, where products of f32 are exact, and so is the sign.
//! 2. U, V and W have one sign, so t is a mean of the corners' t. Its sign is certain where these are all positive. A
//!    triangle with corners before and behind the origin is settled in f64, with t from its plane: this tells a ray
//!    that leaves a surface from one that meets it.
//! 3. The nearest plane of the triangle's own box bounds t from below, in the arithmetic of boxes. A mean of rounded
//!    numbers may be less; then t is that bound, so that no box around the triangle is ever beyond its t.
//! 4. Few rays get past the signs, so that everything after is done for those alone.

use glam::{DVec2, DVec3};
use wide::f32x8;

use super::ray::Ready;
use crate::lanes;
use crate::tables::geometry::Leaf;

/// Crossings of the ray and the triangles of a leaf.
pub(super) struct Crossings {
    /// Lanes that cross.
    pub bits: u32,
    /// Parameter of the ray.
    pub distance: [f32; 8],
    /// Weight of the second corner.
    pub u: [f32; 8],
    /// Weight of the third corner.
    pub v: [f32; 8],
}

/// Where the ray crosses the triangles of a leaf with t in `(0, max]`; `None` where nowhere.
#[inline(always)]
pub(super) fn cross(leaf: &Leaf, ray: &Ready, max: f32) -> Option<Crossings> {
    let [kx, ky, kz] = ray.axes;
    let relative = |corner: usize, axis: usize| leaf.corners[corner][axis] - ray.origin[axis];
    let z = [relative(0, kz), relative(1, kz), relative(2, kz)];
    let shear = |corner: usize, axis: usize, slope: f32x8| slope.mul_neg_add(z[corner], relative(corner, axis));
    let x = [shear(0, kx, ray.shear[0]), shear(1, kx, ray.shear[0]), shear(2, kx, ray.shear[0])];
    let y = [shear(0, ky, ray.shear[1]), shear(1, ky, ray.shear[1]), shear(2, ky, ray.shear[1])];
    let u = x[2] * y[1] - y[2] * x[1];
    let v = x[0] * y[2] - y[0] * x[2];
    let w = x[1] * y[0] - y[1] * x[0];
    let least = u.fast_min(v).fast_min(w);
    let most = u.fast_max(v).fast_max(w);
    let inside = least.simd_ge(f32x8::ZERO) | most.simd_le(f32x8::ZERO);
    if !inside.any() {
        return None;
    }
    finish(leaf, ray, max, Seen { x, y, z, edges: [u, v, w], inside })
}

/// The triangles of a leaf along the ray.
struct Seen {
    x: [f32x8; 3],
    y: [f32x8; 3],
    z: [f32x8; 3],
    edges: [f32x8; 3],
    /// Lanes whose edge functions have one sign, or are 0.
    inside: f32x8,
}

#[inline(always)]
fn finish(leaf: &Leaf, ray: &Ready, max: f32, seen: Seen) -> Option<Crossings> {
    let [u, v, w] = seen.edges;
    let t = seen.z.map(|z| z * ray.shear[2]);
    let first = t[0].fast_min(t[1]).fast_min(t[2]);
    let last = t[0].fast_max(t[1]).fast_max(t[2]);
    let zero = f32x8::ZERO;
    let tie = u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero);
    let ahead = seen.inside & last.simd_gt(zero);
    let unclear = ahead & (tie | first.simd_le(zero));
    let inverse = f32x8::ONE / (u + v + w);
    let [a, b, c] = [u * inverse, v * inverse, w * inverse];
    let mut distance = a.mul_add(t[0], b.mul_add(t[1], c * t[2]));
    let mut weights = [b.to_array(), c.to_array()];
    let mut bits = lanes::bits(ahead);
    if unclear.any() {
        let decided = distance.as_mut_array();
        for lane in lanes::each(lanes::bits(unclear)) {
            match decide(leaf, ray, &seen, lane) {
                Some(hit) => [decided[lane], weights[0][lane], weights[1][lane]] = hit,
                None => bits &= !(1 << lane),
            }
        }
    }
    let distance = distance.fast_max(entry(leaf, ray));
    bits &= lanes::bits(distance.simd_gt(zero) & distance.simd_le(f32x8::splat(max)));
    (bits != 0).then(|| Crossings { bits, distance: distance.to_array(), u: weights[0], v: weights[1] })
}

/// Where the ray enters the triangles' own boxes.
#[inline(always)]
fn entry(leaf: &Leaf, ray: &Ready) -> f32x8 {
    let axis = |axis: usize| {
        let [a, b, c] = leaf.corners.map(|corner| corner[axis]);
        let near = if ray.near_planes[axis] < 3 { a.fast_min(b).fast_min(c) } else { a.fast_max(b).fast_max(c) };
        near.mul_add(ray.inverse[axis], ray.near[axis])
    };
    axis(0).fast_max(axis(1)).fast_max(axis(2))
}

/// Distance and barycentrics of one lane in f64, from the same view along the ray.
#[cold]
#[inline(never)]
fn decide(leaf: &Leaf, ray: &Ready, seen: &Seen, lane: usize) -> Option<[f32; 3]> {
    let at = |rows: &[f32x8; 3]| rows.map(|row| f64::from(row.to_array()[lane]));
    let (x, y, z) = (at(&seen.x), at(&seen.y), at(&seen.z));
    let corner = |i: usize| DVec2::new(x[i], y[i]);
    let edges = [corner(2).perp_dot(corner(1)), corner(0).perp_dot(corner(2)), corner(1).perp_dot(corner(0))];
    let sum: f64 = edges.iter().sum();
    let one_sided = edges.iter().all(|edge| *edge >= 0.0) || edges.iter().all(|edge| *edge <= 0.0);
    if !one_sided || sum == 0.0 {
        return None;
    }
    let weights = edges.map(|edge| edge / sum);
    let over_z = f64::from(ray.shear[2].to_array()[lane]);
    let t = z.map(|z| z * over_z);
    let first = t.into_iter().fold(f64::INFINITY, f64::min);
    let last = t.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let mean = weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
    let distance = if first > 0.0 { mean } else { to_plane(leaf, ray, lane).unwrap_or(mean).clamp(first, last) };
    (distance > 0.0).then_some([distance as f32, weights[1] as f32, weights[2] as f32])
}

/// Parameter at which the ray meets the plane of one lane's triangle, unless it runs along it.
fn to_plane(leaf: &Leaf, ray: &Ready, lane: usize) -> Option<f64> {
    let vector = |rows: &[f32x8; 3]| DVec3::from(rows.map(|row| f64::from(row.to_array()[lane])));
    let [a, b, c] = [vector(&leaf.corners[0]), vector(&leaf.corners[1]), vector(&leaf.corners[2])];
    let normal = (b - a).cross(c - a);
    let distance = normal.dot(a - vector(&ray.origin)) / normal.dot(DVec3::from(ray.direction.map(f64::from)));
    distance.is_finite().then_some(distance)
}
