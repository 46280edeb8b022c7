//! A ray made ready: what the tests of boxes and of triangles need, once per ray.
//!
//! **Triangles** are seen along the ray (Woop, Benthin and Wald, Watertight Ray/Triangle Intersection, JCGT 2013). With
//! z the axis along which the direction d is longest, and A a corner less the origin,
//!
//! ```text
//! x = A_x - (d_x / d_z) A_z,    y = A_y - (d_y / d_z) A_z,    t = A_z / d_z
//! ```
//!
//! puts the ray on the t axis. A corner's x and y depend on the corner and on the ray alone, so that triangles which
//! share it place it alike.
//!
//! **Boxes.** The ray is within two planes b of an axis for t between the two values of `(b - o) / d`, computed as `b r
//! + c` with `r = 1 / d`, `c = -o r`, and in the box where the three intervals overlap. A box must not be missed whose
//! triangle is hit. Let u = 2^-24 and L be the largest size of a coordinate of any box and of the origin together, so
//! that no `b - o` exceeds it. To first order in u
//!
//! - a corner's x and y are off by at most 7 u L: A_x and A_z round once, the quotient twice, the product where it is
//!   not fused and the difference once each, and neither `|d_x / d_z|` nor `|d_y / d_z|` exceeds 1;
//! - `b r + c` is off by what 4 u L in b makes of it: r and c and their product and sum round once each.
//!
//! So the origin is moved by 12 u L against the box, once backwards for the near planes and once for the far ones, in
//! c: in the loop it costs nothing. A component of the direction that is less than 2^-40 of the longest is raised to
//! that, which moves the ray by less than 2^-40 L; so r is finite, no NaN can arise, and a ray that runs in a box's
//! plane is in the box.
//!
//! `b r + c` does not decrease when b r does not: a box's near value is never beyond that of a box within it.

use wide::f32x8;

use super::Ray;

/// Half a unit in the last place of 1.
const UNIT: f32 = f32::EPSILON / 2.0;
/// Rounding that boxes are widened by, in units of [`UNIT`] times the largest coordinates.
pub(super) const WIDENING: f32 = 12.0 * UNIT;
/// Least share of a direction's component in its longest: 2^-40.
pub(super) const LEAST: f32 = 1.0 / (1_u64 << 40) as f32;

/// Axes of the view by whether y is longest, + 2 if z is.
pub(super) const VIEWS: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];

/// A ray as boxes see it.
pub struct Line {
    /// r: one over the direction.
    pub inverse: [f32x8; 3],
    /// c of near planes.
    pub near: [f32x8; 3],
    /// c of far planes.
    pub far: [f32x8; 3],
    /// Which of a node's planes are near, by axis: 0 for the lower, 1 for the upper ones.
    pub near_side: [usize; 3],
}

/// What the tests need of a ray. `Sights` has it for eight, in the same bits.
pub struct Ready {
    /// Itself, as boxes see it.
    pub line: Line,
    /// The origin `[m]`.
    pub origin: [f32x8; 3],
    /// The ray itself.
    pub ray: Ray,
    /// Axes x, y and z of the view along the ray: z is the longest.
    pub axes: [usize; 3],
    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z` along those axes.
    pub shear: [f32x8; 3],
}

impl Line {
    /// From r and the constants of lower and upper planes.
    #[inline(always)]
    pub fn new(inverse: [f32; 3], lower: [f32; 3], upper: [f32; 3]) -> Self {
        let backwards = inverse.map(f32::is_sign_negative);
        let pick =
            |axis: usize, near: bool| f32x8::splat(if backwards[axis] == near { upper[axis] } else { lower[axis] });
        Self {
            inverse: inverse.map(f32x8::splat),
            near: [pick(0, true), pick(1, true), pick(2, true)],
            far: [pick(0, false), pick(1, false), pick(2, false)],
            near_side: backwards.map(usize::from),
        }
    }
}

impl Ready {
    /// Of a ray that meets boxes whose coordinates have sizes of up to `extent`; `None` if it has no direction.
    #[inline(always)]
    pub fn new(ray: &Ray, extent: f32) -> Option<Self> {
        let (o, d) = (ray.origin, ray.direction);
        let [x, y, z] = d.map(f32::abs);
        // Without branches: directions of incoherent rays are not predicted.
        let longest = x.max(y).max(z);
        let axes = VIEWS[usize::from(y == longest) + 2 * usize::from(z == longest)];
        if !(longest > 0.0 && longest < f32::INFINITY) {
            return None;
        }
        let least = LEAST * longest;
        let inverse = d.map(|d| 1.0 / d.abs().max(least).copysign(d));
        let extent = extent + o[0].abs().max(o[1].abs()).max(o[2].abs());
        let widening = WIDENING * extent;
        // Every plane is moved away from the inside of its box.
        let constant = |axis: usize, widening: f32| -(o[axis] + widening) * inverse[axis];
        let constants = |widening: f32| [constant(0, widening), constant(1, widening), constant(2, widening)];
        let over_z = inverse[axes[2]];
        Some(Self {
            line: Line::new(inverse, constants(widening), constants(-widening)),
            origin: o.map(f32x8::splat),
            ray: *ray,
            axes,
            shear: [d[axes[0]] * over_z, d[axes[1]] * over_z, over_z].map(f32x8::splat),
        })
    }
}
