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

use super::rays::{Rays, Slabs};
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Geometry, Node};

/// The rays that may meet a triangle, as bits. The others meet none.
#[inline(always)]
pub fn may_meet(geometry: &Geometry, rays: &Rays) -> u32 {
    let tree = geometry.tree();
    if tree.leaves.rows().is_empty() {
        return 0;
    }
    let slabs = Slabs::new(rays, tree.extent);
    if tree.root.is_leaf() {
        let [[x, y, z], [u, v, w]] = tree.bounds;
        return lanes::bits(slabs.enter(&[x, y, z, u, v, w], rays.max).1);
    }
    enter_any(&tree.nodes.rows()[tree.root.index()], &slabs, rays.max)
}

/// The rays that enter any of the boxes of a node no later than `max`, as bits.
#[inline(always)]
pub fn enter_any(node: &Node, slabs: &Slabs, max: f32x8) -> u32 {
    let rows = node.planes.each_ref().map(|row| row.as_array());
    let mut entered = 0;
    for child in 0..LANES {
        let planes = rows.map(|row| row[child]);
        if planes[0] == f32::INFINITY {
            break;
        }
        entered |= lanes::bits(slabs.enter(&planes, max).1);
    }
    entered
}
