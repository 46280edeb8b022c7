//! A triangle as a ray along z sees it.
//!
//! ```text
//! corners A, B, C with A_y <= B_y <= C_y;   turn = 1 if they go around as the triangle does, or else -1
//! short = A to B if y < B_y, or else B to C
//! left(P, Q) = (Q_x - P_x) (y - P_y) > (Q_y - P_y) (x - P_x)      whether (x, y) is on the left of an edge upward
//! crossings = turn (left(short) - left(A, C))                     if A_y <= y < C_y, or else 0
//! above     = z below the corners, or z not above them and (x, y, z) under the plane
//! ```
//!
//! 1. This is the number of times that the triangle's outline winds around (x, y), by its crossings with a ray from
//!    there to the right. An upward edge counts if y is in [P_y, Q_y): corners and level edges need no rule of their
//!    own.
//! 2. The neighbour across an edge passes it from the same P to the same Q and counts it with the other sign. Over a
//!    closed surface all crossings cancel exactly, however `left` is rounded.
//! 3. `left` compares two rounded products, of differences that are rounded: it is off by rounding of the edge's
//!    length. A triangle that is seen edge-on may therefore be crossed next to its edge; there the corners alone decide
//!    what is above.

use glam::DVec3;

/// Along which axis rays go: a cyclic change of the axes, so that what turns left still does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// The axis that is seen as z.
    pub along: usize,
}

/// A triangle in the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Its corners, by rising y.
    corners: [[f32; 3]; 3],
    /// A normal of its plane, not downward.
    normal: [f32; 3],
    /// 1 if the corners go around as the triangle does, or else -1.
    turn: i32,
}

impl View {
    /// The axis along which the most of the surface is seen: walls that are seen edge-on take long.
    pub fn of(triangles: &[[[f32; 3]; 3]]) -> Self {
        let area = |triangle: &[[f32; 3]; 3]| cross(*triangle).abs();
        let seen: DVec3 = triangles.iter().map(area).sum();
        Self { along: seen.max_position() }
    }

    /// A point in the view.
    #[inline(always)]
    pub fn place<T: Copy>(self, at: [T; 3]) -> [T; 3] {
        match self.along {
            0 => [at[1], at[2], at[0]],
            1 => [at[2], at[0], at[1]],
            _ => at,
        }
    }

    /// A point of the view in the world.
    pub fn undo<T: Copy>(self, at: [T; 3]) -> [T; 3] {
        match self.along {
            0 => [at[2], at[0], at[1]],
            1 => [at[1], at[2], at[0]],
            _ => at,
        }
    }
}

impl Facet {
    /// The triangle of these corners in the view.
    pub fn new(triangle: [[f32; 3]; 3]) -> Self {
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| triangle[*a][1].total_cmp(&triangle[*b][1]));
        let turn = if (order[0] + 1) % 3 == order[1] { 1 } else { -1 };
        let normal = cross(triangle).normalize_or_zero();
        let normal = if normal.z < 0.0 { -normal } else { normal };
        Self { corners: order.map(|corner| triangle[corner]), normal: normal.as_vec3().to_array(), turn }
    }

    /// Its corners in the view, as they go around.
    pub fn triangle(&self) -> [[f32; 3]; 3] {
        let [a, b, c] = self.corners;
        if self.turn > 0 { [a, b, c] } else { [a, c, b] }
    }

    /// Least and largest coordinate along an axis of the view.
    #[inline(always)]
    pub fn extent(&self, axis: usize) -> [f32; 2] {
        let [a, b, c] = self.corners.map(|corner| corner[axis]);
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// The signed number of its crossings with the ray upward from a point.
    #[inline(always)]
    pub fn crossings(&self, at: [f32; 3]) -> i32 {
        let [a, b, c] = self.corners;
        let y = at[1];
        let (from, to) = if y < b[1] { (a, b) } else { (b, c) };
        let passes = (a[1] <= y) & (y < c[1]) & self.is_above(at);
        let crossed = i32::from(is_left(at, from, to)) - i32::from(is_left(at, a, c));
        self.turn * crossed * i32::from(passes)
    }

    /// Whether it is above a point that it is above or below.
    #[inline(always)]
    fn is_above(&self, at: [f32; 3]) -> bool {
        let [low, high] = self.extent(2);
        let [x, y, z] = [0, 1, 2].map(|axis| self.normal[axis] * (at[axis] - self.corners[0][axis]));
        (at[2] < low) | ((at[2] < high) & (x + y + z < 0.0))
    }
}

/// Whether a point is on the left of an edge upward.
#[inline(always)]
fn is_left(at: [f32; 3], from: [f32; 3], to: [f32; 3]) -> bool {
    (to[0] - from[0]) * (at[1] - from[1]) > (to[1] - from[1]) * (at[0] - from[0])
}

/// A normal, as long as twice the area.
fn cross(triangle: [[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|corner| DVec3::from(corner.map(f64::from)));
    (b - a).cross(c - a)
}
