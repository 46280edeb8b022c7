//! Ray against triangle in f64, one after the other.
//!
//! With edges `e1 = B - A`, `e2 = C - A` the point `o + t d = A + u e1 + v e2` follows from Cramer's rule (Moeller and
//! Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997):
//!
//! ```text
//! [t, u, v] = [(s x e1) . e2, (d x e2) . s, (s x e1) . d] / ((d x e2) . e1),    s = o - A
//! ```
//!
//! and the triangle is hit where u, v and 1 - u - v are not negative.

use glam::DVec3;

use super::Ray;
use crate::tables::geometry::Geometry;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the triangle.
    pub triangle: usize,
    /// Parameter of the ray, `(0, max)`.
    pub distance: f64,
    /// Weights of the second and of the third corner.
    pub barycentric: [f64; 2],
}

/// The twin of [`closest`](super::closest).
pub fn closest(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for triangle in 0..geometry.len() {
        if let Some((distance, barycentric)) = meet(geometry.corners(triangle), ray)
            && best.is_none_or(|best| distance < best.distance)
        {
            best = Some(Hit { triangle, distance, barycentric });
        }
    }
    best
}

/// The twin of [`any`](super::any).
pub fn any(geometry: &Geometry, ray: &Ray) -> bool {
    (0..geometry.len()).any(|triangle| meet(geometry.corners(triangle), ray).is_some())
}

/// Parameter and barycentrics of the ray's meeting with a triangle.
pub fn meet(corners: [[f32; 3]; 3], ray: &Ray) -> Option<(f64, [f64; 2])> {
    let [distance, u, v] = plane(corners, ray)?;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (inside && distance > 0.0 && distance < f64::from(ray.max)).then_some((distance, [u, v]))
}

/// Parameter and barycentrics of the ray's meeting with a triangle's plane, inside the triangle or not. `None` where
/// the ray runs along it, or the triangle has no area.
pub fn plane(corners: [[f32; 3]; 3], ray: &Ray) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let (origin, direction) = (DVec3::from(ray.origin.map(f64::from)), DVec3::from(ray.direction.map(f64::from)));
    let (e1, e2) = (b - a, c - a);
    let across = direction.cross(e2);
    let determinant = across.dot(e1);
    if determinant == 0.0 || e1.cross(e2) == DVec3::ZERO {
        return None;
    }
    let s = origin - a;
    let turned = s.cross(e1);
    Some([turned.dot(e2) / determinant, across.dot(s) / determinant, turned.dot(direction) / determinant])
}
