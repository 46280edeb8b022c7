//! How far rays reach, and which boxes that is far from.
//!
//! ```text
//! a ray is between o and e = o + max d along every axis, so that it is in no box with
//!     b_upper < min(o, e)   or   b_lower > max(o, e)        along any of them
//! ```
//!
//! A flight in fog is short, and most of what there is lies upright or flat: where boxes are that thin, this leaves out
//! nearly all that the planes of [`rays`](super::rays) do, by comparisons alone, and rays that are near nothing need not
//! be made ready.
//!
//! With u and L as in [`ray`](super::ray): those planes are moved by 12 u L, and the parameters at which they are met
//! are off by what 4 u L makes of them; e, and the sums that widen it, are off by another 3 u L where e is within L,
//! which it is wherever a box could be between the two. So reaches are wider by 24 u L: what no ray reaches, none
//! enters.
//!
//! **Planes.** A ray whose ends are on one side of a plane crosses nothing in it. How far from a triangle's plane may the
//! point at t be, where [`triangles`](super::triangles) finds a crossing? There t is a mean of the corners' with weights
//! U, V and W, which are exact for coordinates as they were rounded, by 7 u L: that makes 10 u L along the normal. Products
//! are off by what makes another 26 u L S^2 / A, with the triangle's longest edge S and its area A. We allow 32 u L (1 +
//! S^2 / A). A triangle of a facet may be off its plane by the margin, and lean out of it by as much over its height: we
//! allow 2 margin (1 + S^2 / A).

use super::rays::{by_axis, largest};
use crate::real::{Mask, Real};
use crate::tables::geometry::Facet;
use crate::vec3::Vec3;

/// How much wider reaches are than what is between the ends of rays, in units of the largest coordinates.
const WIDENING: f32 = 12.0 * f32::EPSILON;
/// How far from its plane a triangle may meet rays, in units of L (1 + S^2 / A): 32 u.
const SLACK: f32 = 16.0 * f32::EPSILON;

/// The boxes around a ray, or around eight, up to their bounds.
#[derive(Clone, Copy, Debug)]
pub struct Reach<F> {
    /// Lower x, y and z `[m]`.
    pub lower: [F; 3],
    /// Upper x, y and z `[m]`.
    pub upper: [F; 3],
    /// L: how large coordinates are `[m]`.
    pub scale: F,
}

impl<F: Real> Reach<F> {
    /// Of the points `origin + t direction`, t up to `max`, among boxes whose coordinates have sizes of up to `extent`.
    #[inline(always)]
    pub fn new(origin: Vec3<F>, direction: Vec3<F>, max: F, extent: f32) -> Self {
        let scale = F::splat(extent) + largest(origin);
        let widening = F::splat(WIDENING) * scale;
        let (origin, direction) = (by_axis(origin), by_axis(direction));
        let ends = |axis: usize| {
            let (o, d) = (origin[axis], direction[axis]);
            // Across an axis even an endless ray gets nowhere.
            let e = d.abs().simd_le(F::ZERO).select(o, max.mul_add(d, o));
            [o.fast_min(e) - widening, o.fast_max(e) + widening]
        };
        let [x, y, z] = [ends(0), ends(1), ends(2)];
        Self { lower: [x[0], y[0], z[0]], upper: [x[1], y[1], z[1]], scale }
    }

    /// The rays that reach the box with these lower and upper planes.
    #[inline(always)]
    pub fn overlaps(&self, planes: &[f32; 6]) -> F::Mask {
        let begins = |axis: usize| self.lower[axis].simd_le(F::splat(planes[3 + axis]));
        let ends = |axis: usize| F::splat(planes[axis]).simd_le(self.upper[axis]);
        begins(0) & ends(0) & begins(1) & ends(1) & begins(2) & ends(2)
    }

    /// The rays that reach a facet, and do not stay on one side of its plane; they are those of [`Self::new`].
    #[inline(always)]
    pub fn crosses(&self, origin: Vec3<F>, direction: Vec3<F>, max: F, facet: &Facet) -> F::Mask {
        let overlaps = self.overlaps(&facet.planes);
        if facet.is_upright {
            return overlaps;
        }
        let normal = Vec3::splat(facet.normal);
        let from = normal.dot(origin) - F::splat(facet.offset);
        let to = max.mul_add(normal.dot(direction), from);
        let wide = 1.0 + facet.aspect;
        let slack = F::splat(SLACK * wide).mul_add(self.scale, F::splat(2.0 * wide * facet.margin));
        let above = slack.simd_lt(from) & slack.simd_lt(to);
        let below = from.simd_lt(-slack) & to.simd_lt(-slack);
        overlaps & !(above | below)
    }
}
