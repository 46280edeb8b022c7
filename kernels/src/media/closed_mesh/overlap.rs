//! Whether a triangle touches a box.

use glam::DVec3;

/// A box with its edges along the axes.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    middle: DVec3,
    half: DVec3,
}

impl Block {
    /// That between two corners, made larger by `slack` on all sides.
    pub fn new([low, high]: [DVec3; 2], slack: f64) -> Self {
        Self { middle: 0.5 * (low + high), half: 0.5 * (high - low) + slack }
    }

    /// Whether a triangle touches it: unless one of the directions that can separate the two does. These are the axes,
    /// the triangle's normal, and what is perpendicular to an axis and an edge.
    pub fn touches(&self, triangle: [[f32; 3]; 3]) -> bool {
        let corners = triangle.map(|corner| DVec3::from(corner.map(f64::from)) - self.middle);
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let across = edges.into_iter().flat_map(|edge| DVec3::AXES.map(|axis| axis.cross(edge)));
        let mut directions = DVec3::AXES.into_iter().chain([edges[0].cross(edges[1])]).chain(across);
        !directions.any(|direction| self.is_separated(corners, direction))
    }

    fn is_separated(&self, corners: [DVec3; 3], direction: DVec3) -> bool {
        let [a, b, c] = corners.map(|corner| corner.dot(direction));
        let reach = self.half.dot(direction.abs());
        a.min(b).min(c) > reach || a.max(b).max(c) < -reach
    }
}
