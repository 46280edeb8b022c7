//! Eight pairs of a ray and a triangle, watertight: one ray and eight triangles, or eight rays and one triangle.
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
//! 2. U, V and W have one sign, so t is a mean of the corners' t. Its sign is certain where these are all positive, and
//!    where t is more than rounding makes of it. Let R be the largest coordinate across the ray, M the largest of all, and
//!    D the spread of the corners' t. Coordinates are off by 7 u M; U, V and W are exact weights for what they were
//!    rounded to, so that this moves t by 7 u M 4 R D / (U + V + W) at most. The products' roundings make 4 u R^2 D / (U +
//!    V + W), those of t, weights and sum no more than 24. Together 56 u M R D / (U + V + W), of which we allow 64. What
//!    is left, a triangle with corners before and behind an origin that is next to it, is settled in f64, with t from its
//!    plane: this tells a ray that leaves a surface from one that meets it. Where all corners are behind the origin along
//!    an axis, as only rounding puts a ray into the triangle, it is missed, as boxes around it are.
//! 3. The nearest plane of the triangle's own box bounds t from below, in the arithmetic of boxes. A mean of rounded
//!    numbers may be less; then t is that bound, so that no box around the triangle is ever beyond its t.
//! 4. Few rays get past the signs, so that everything after is done for those alone.

use glam::{DVec2, DVec3};
use wide::f32x8;

use super::Ray;
use crate::lanes;

/// Rounding that t may suffer from, in units of M R D / (U + V + W): 64 u.
const DOUBT: f32 = 32.0 * f32::EPSILON;

/// Eight pairs of a ray and a triangle.
pub(super) trait Pairs {
    /// A corner less the origin along an axis of the view along the ray `[m]`.
    fn relative(&self, corner: usize, axis: usize) -> f32x8;

    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z` along the axes of the view.
    fn shear(&self) -> [f32x8; 3];

    /// Where the rays enter the triangles' own boxes.
    fn entry(&self) -> f32x8;

    /// Corners and ray of one pair.
    fn pair(&self, lane: usize) -> ([[f32; 3]; 3], Ray);
}

/// Crossings of rays and triangles.
pub(super) struct Crossings {
    /// Pairs that cross, as a mask.
    pub met: f32x8,
    /// Parameter of the ray.
    pub distance: f32x8,
    /// Weight of the second corner.
    pub second: f32x8,
    /// Weight of the third corner.
    pub third: f32x8,
}

/// Where the rays of the `live` pairs cross their triangles with t in `(0, max]`; `None` where nowhere.
#[inline(always)]
pub(super) fn cross(pairs: &impl Pairs, max: f32x8, live: f32x8) -> Option<Crossings> {
    let shear = pairs.shear();
    let relative = |axis: usize| [0, 1, 2].map(|corner| pairs.relative(corner, axis));
    let z = relative(2);
    let sheared = |axis: usize| {
        let along = relative(axis);
        [0, 1, 2].map(|corner| shear[axis].mul_neg_add(z[corner], along[corner]))
    };
    let (x, y) = (sheared(0), sheared(1));
    let u = x[2] * y[1] - y[2] * x[1];
    let v = x[0] * y[2] - y[0] * x[2];
    let w = x[1] * y[0] - y[1] * x[0];
    let least = u.fast_min(v).fast_min(w);
    let most = u.fast_max(v).fast_max(w);
    let inside = live & (least.simd_ge(f32x8::ZERO) | most.simd_le(f32x8::ZERO));
    if !inside.any() {
        return None;
    }
    finish(pairs, max, Seen { x, y, z, edges: [u, v, w], inside })
}

/// Triangles along the rays.
struct Seen {
    x: [f32x8; 3],
    y: [f32x8; 3],
    z: [f32x8; 3],
    edges: [f32x8; 3],
    /// Pairs whose edge functions have one sign, or are 0, as a mask.
    inside: f32x8,
}

#[inline(always)]
fn finish(pairs: &impl Pairs, max: f32x8, seen: Seen) -> Option<Crossings> {
    let [u, v, w] = seen.edges;
    let over_z = pairs.shear()[2];
    let t = seen.z.map(|z| z * over_z);
    let first = t[0].fast_min(t[1]).fast_min(t[2]);
    let last = t[0].fast_max(t[1]).fast_max(t[2]);
    let zero = f32x8::ZERO;
    let tie = u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero);
    let entry = pairs.entry();
    let mut met = seen.inside & last.simd_gt(zero) & entry.simd_le(max);
    let inverse = f32x8::ONE / (u + v + w);
    let [a, b, c] = [u * inverse, v * inverse, w * inverse];
    let mut distance = a.mul_add(t[0], b.mul_add(t[1], c * t[2]));
    // What rounding may make of t is asked only where a corner is behind the origin.
    let ahead = first.simd_gt(zero);
    let mut unclear = met & (tie | !ahead);
    let mut weights = [b, c];
    if unclear.any() {
        unclear &= tie | !(ahead | distance.simd_gt(doubt(&seen, last - first, inverse)));
        let [second, third] = &mut weights;
        let decided = [&mut distance, second, third].map(f32x8::as_mut_array);
        let mut missed = 0;
        for lane in lanes::each(lanes::bits(unclear)) {
            let (corners, ray) = pairs.pair(lane);
            match decide(corners, &ray, &seen, over_z, lane) {
                Some(hit) => (0..3).for_each(|i| decided[i][lane] = hit[i]),
                None => missed |= 1 << lane,
            }
        }
        met &= !lanes::mask(missed);
    }
    let distance = distance.fast_max(entry);
    let met = met & distance.simd_gt(zero) & distance.simd_le(max);
    met.any().then(|| Crossings { met, distance, second: weights[0], third: weights[1] })
}

/// What rounding may make of t where corners are `apart` in t: see 2.
#[inline(always)]
fn doubt(seen: &Seen, apart: f32x8, inverse: f32x8) -> f32x8 {
    let largest = |of: &[f32x8; 3]| of[0].abs().fast_max(of[1].abs()).fast_max(of[2].abs());
    let across = largest(&seen.x).fast_max(largest(&seen.y));
    let far = across.fast_max(largest(&seen.z));
    // In this order nothing underflows: sizes of the triangle come and go.
    f32x8::splat(DOUBT) * apart * (across * inverse.abs()) * far
}

/// Distance and barycentrics of one lane in f64, from the same view along the ray.
#[cold]
#[inline(never)]
fn decide(corners: [[f32; 3]; 3], ray: &Ray, seen: &Seen, over_z: f32x8, lane: usize) -> Option<[f32; 3]> {
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
    let over_z = f64::from(over_z.to_array()[lane]);
    let t = z.map(|z| z * over_z);
    let first = t.into_iter().fold(f64::INFINITY, f64::min);
    let last = t.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let mean = weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
    if first <= 0.0 && is_behind(corners, ray) {
        return None;
    }
    let distance = if first > 0.0 { mean } else { to_plane(corners, ray).unwrap_or(mean).clamp(first, last) };
    (distance > 0.0).then_some([distance as f32, weights[1] as f32, weights[2] as f32])
}

/// Whether all corners are behind the origin along an axis.
fn is_behind(corners: [[f32; 3]; 3], ray: &Ray) -> bool {
    (0..3).any(|axis| {
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        let behind = |corner: [f32; 3]| if d > 0.0 { corner[axis] < o } else { d < 0.0 && corner[axis] > o };
        corners.into_iter().all(behind)
    })
}

/// Parameter at which the ray meets the plane of the triangle, unless it runs along it.
fn to_plane(corners: [[f32; 3]; 3], ray: &Ray) -> Option<f64> {
    let [a, b, c, origin, direction] =
        [corners[0], corners[1], corners[2], ray.origin, ray.direction].map(|v| DVec3::from(v.map(f64::from)));
    let normal = (b - a).cross(c - a);
    let distance = normal.dot(a - origin) / normal.dot(direction);
    distance.is_finite().then_some(distance)
}
