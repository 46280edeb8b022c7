//! Eight rays against the top of the tree: which of them may meet anything.
//!
//! ```text
//! for each box of the root:  near = max(0, over axes (b_near - o) / d),  far = min(max, over axes (b_far - o) / d)
//! a ray may meet something if near <= far for any of the boxes
//! ```
//!
//! 1. Things in fog are few and far between: most flights and shadow segments are near none of them. Here they are full
//!    lanes, and only the others are traced one by one.
//! 2. Boxes are wider by the same bound as for single rays ([`ray`](super::ray)): `b r + c` with the origin moved
//!    against the box. No ray is left out that would hit.

use wide::f32x8;

use super::ray::{LEAST, WIDENING};
use crate::lanes;
use crate::lanes::LANES;
use crate::tables::geometry::{Geometry, Tree};
use crate::vec3x8::Vec3x8;

/// The rays `origin + t direction`, t in `(0, max)`, that may meet a triangle, as bits. The others meet none.
#[inline(always)]
pub fn may_meet(geometry: &Geometry, origin: Vec3x8, direction: Vec3x8, max: f32x8) -> u32 {
    let tree = geometry.tree();
    if tree.leaves.rows().is_empty() {
        return 0;
    }
    let rays = Rays::new(tree, origin, direction, max);
    if tree.root.is_leaf() {
        let [[x, y, z], [u, v, w]] = tree.bounds;
        return rays.enter([x, y, z, u, v, w]);
    }
    let planes = &tree.nodes.rows()[tree.root.index()].planes;
    let mut bits = 0;
    for child in 0..LANES {
        bits |= rays.enter(core::array::from_fn(|plane| planes[plane].as_array()[child]));
    }
    bits
}

/// Eight rays made ready for boxes, by axis.
struct Rays {
    /// One over the direction.
    inverse: [f32x8; 3],
    /// Rays that run towards smaller coordinates.
    backwards: [f32x8; 3],
    /// What near and far planes are moved by.
    near: [f32x8; 3],
    /// See `near`.
    far: [f32x8; 3],
    max: f32x8,
}

impl Rays {
    #[inline(always)]
    fn new(tree: &Tree, origin: Vec3x8, direction: Vec3x8, max: f32x8) -> Self {
        let largest = |v: Vec3x8| v.x.abs().fast_max(v.y.abs()).fast_max(v.z.abs());
        let least = f32x8::splat(LEAST) * largest(direction);
        let widening = f32x8::splat(WIDENING) * (f32x8::splat(tree.extent) + largest(origin));
        let (origin, direction) = ([origin.x, origin.y, origin.z], [direction.x, direction.y, direction.z]);
        let backwards = direction.map(|d| d.simd_lt(f32x8::ZERO));
        let inverse: [f32x8; 3] = core::array::from_fn(|axis| {
            let size = f32x8::ONE / direction[axis].abs().fast_max(least);
            backwards[axis].select(-size, size)
        });
        // Against the box: every plane is moved away from its inside, which is the same sign in t on both sides.
        let moved = |axis: usize, sign: f32| {
            let towards = backwards[axis].select(-widening, widening) * f32x8::splat(sign);
            -(origin[axis] + towards) * inverse[axis]
        };
        Self {
            inverse,
            backwards,
            near: core::array::from_fn(|axis| moved(axis, 1.0)),
            far: core::array::from_fn(|axis| moved(axis, -1.0)),
            max,
        }
    }

    /// The rays that enter the box with these lower and upper planes, as bits.
    #[inline(always)]
    fn enter(&self, planes: [f32; 6]) -> u32 {
        let (mut entered, mut left) = (f32x8::ZERO, self.max);
        for axis in 0..3 {
            let (lower, upper) = (f32x8::splat(planes[axis]), f32x8::splat(planes[3 + axis]));
            let near = self.backwards[axis].select(upper, lower).mul_add(self.inverse[axis], self.near[axis]);
            let far = self.backwards[axis].select(lower, upper).mul_add(self.inverse[axis], self.far[axis]);
            entered = entered.fast_max(near);
            left = left.fast_min(far);
        }
        lanes::bits(entered.simd_le(left))
    }
}
