//! Eight rays against the top of the tree: which of them may meet anything. Where everything lies in few planes, these
//! are asked instead ([`reach`](super::reach)).
//!
//! ```text
//! for each box of the root:  near = max(0, over axes (b_near - o) / d),  far = min(max, over axes (b_far - o) / d)
//! a ray may meet something if near <= far for any of the boxes that it reaches
//! ```
//!
//! 1. Things in fog are few and far between: most flights and shadow segments are near none of them. Here they are full
//!    lanes, and only the others are traced one by one.
//! 2. Most batches do not even reach the boxes ([`reach`](super::reach)), and are done before they are made ready.
//! 3. Boxes are wider by the same bound as for single rays ([`ray`](super::ray)): `b r + c` with the origin moved
//!    against the box. No ray is left out that would hit.

use wide::f32x8;

use super::rays::{Rays, Slabs};
use super::reach::Reach;
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Geometry, Node, Tree};

/// The `live` rays that may meet a triangle, as bits. The others meet none.
#[inline(always)]
pub fn may_meet(geometry: &Geometry, rays: &Rays, live: u32) -> u32 {
    near(geometry, rays, live).map_or(0, |(bits, _)| bits)
}

/// The same, and what it takes to follow them; `None` if there are none.
#[inline(always)]
pub(super) fn near(geometry: &Geometry, rays: &Rays, live: u32) -> Option<(u32, Slabs)> {
    let tree = geometry.tree();
    if tree.leaves.rows().is_empty() {
        return None;
    }
    let Rays { origin, direction, max } = *rays;
    let reach = Reach::new(origin, direction, max, tree.extent);
    if !tree.facets.is_empty() {
        let crosses = |facet| reach.crosses(origin, direction, max, facet);
        let bits = live & lanes::bits(tree.facets.iter().fold(f32x8::ZERO, |any, facet| any | crosses(facet)));
        return (bits != 0).then(|| (bits, Slabs::new(rays, tree.extent)));
    }
    let reached = live & over_boxes(tree, |planes| lanes::bits(reach.overlaps(planes)));
    if reached == 0 {
        return None;
    }
    let slabs = Slabs::new(rays, tree.extent);
    let bits = reached & over_boxes(tree, |planes| entered(planes, &slabs, rays.max));
    (bits != 0).then_some((bits, slabs))
}

/// Bits that `of` finds for any of the boxes at the top of the tree.
#[inline(always)]
fn over_boxes(tree: &Tree, of: impl Fn(&[f32; 6]) -> u32) -> u32 {
    if tree.root.is_leaf() {
        let [[x, y, z], [u, v, w]] = tree.bounds;
        return of(&[x, y, z, u, v, w]);
    }
    boxes(&tree.nodes.rows()[tree.root.index()]).fold(0, |all, planes| all | of(&planes))
}

/// The rays that enter any of the boxes of a node no later than `max`, as bits.
#[inline(always)]
pub fn enter_any(node: &Node, slabs: &Slabs, max: f32x8) -> u32 {
    boxes(node).fold(0, |all, planes| all | entered(&planes, slabs, max))
}

/// The rays that enter a box no later than `max`, as bits.
#[inline(always)]
fn entered(planes: &[f32; 6], slabs: &Slabs, max: f32x8) -> u32 {
    lanes::bits(slabs.enter(planes, max).1)
}

/// The boxes of a node.
#[inline(always)]
fn boxes(node: &Node) -> impl Iterator<Item = [f32; 6]> {
    (0..LANES).map(|child| node.planes_of(child)).take_while(|planes| planes[0] != f32::INFINITY)
}
