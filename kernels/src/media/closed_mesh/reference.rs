//! Whether a point is inside, in f64.
//!
//! ```text
//! number = sum over triangles of their solid angle from the point, signed by which side is seen, / (4 pi)
//! tan(angle / 2) = a . (b x c) / (|a| |b| |c| + (a . b) |c| + (b . c) |a| + (c . a) |b|)
//! ```
//!
//! with a, b, c from the point to the corners (Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, IEEE
//! Transactions on Biomedical Engineering 30, 1983). The number is whole everywhere but on the surface.

use core::f64::consts::PI;

use glam::DVec3;

use super::ClosedMesh;

impl ClosedMesh {
    /// Whether a point is inside.
    pub fn contains_reference(&self, at: DVec3) -> bool {
        let angles = self.triangles().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| DVec3::from(corner.map(f64::from)) - at);
            let [la, lb, lc] = [a, b, c].map(DVec3::length);
            2.0 * a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        });
        (angles.sum::<f64>() / (4.0 * PI)).round() != 0.0
    }
}
