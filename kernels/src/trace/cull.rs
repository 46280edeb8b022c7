//! Eight rays against the top of the tree: which of them may meet anything. Where everything lies in few planes, these
//! are asked instead ([`reach`](super::reach)).
//!
//! ```text
//! for each box of the root:  near = max(0, over axes (b_near - o) / d),  far = min(max, over axes (b_far - o) / d)
//! a ray may meet something if near <= far for any of the boxes that it reaches
//! ```
//!
//! 1. Things in fog are few and far between: most flights and shadow segments are near none of them. Here they are full
//!    lanes, and only the others go further.
//! 2. Most batches do not even reach the boxes ([`reach`](super::reach)), and are done before they are made ready.
//! 3. Boxes are wider by the same bound as for single rays ([`ray`](super::ray)): `b r + c` with the origin moved
//!    against the box. No ray is left out that would hit.

use wide::f32x8;

use super::rays::{Rays, Slabs};
use super::reach::Reach;
use super::walk;
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Geometry, Node, Tree};

/// The `live` rays that may meet a triangle, as bits. The others meet none.
#[inline(always)]
pub fn may_meet(geometry: &Geometry, rays: &Rays, live: u32) -> u32 {
    let tree = geometry.tree();
    let reached = reached(tree, rays, live);
    if reached == 0 || !tree.facets.is_empty() {
        return reached;
    }
    reached & Top::new(&tree.nodes.rows()[0], &Slabs::new(rays, tree.extent), rays.max).any()
}

/// Those of the `live` rays that reach the planes or the boxes in which everything lies, as bits: by comparisons alone.
#[inline(always)]
pub(super) fn reached(tree: &Tree, rays: &Rays, live: u32) -> u32 {
    let Some(root) = tree.nodes.rows().first() else { return 0 };
    let Rays { origin, direction, max } = *rays;
    let reach = Reach::new(origin, direction, max, tree.extent);
    if !tree.facets.is_empty() {
        let crosses = |facet| reach.crosses(origin, direction, max, facet);
        return live & lanes::bits(tree.facets.iter().fold(f32x8::ZERO, |any, facet| any | crosses(facet)));
    }
    live & boxes(root).fold(0, |all, planes| all | lanes::bits(reach.overlaps(&planes)))
}

/// Eight rays at the boxes of a tree's root.
pub(super) struct Top {
    /// Where they enter, not before their start, by box.
    distances: [f32x8; LANES],
    /// Rays that enter no later than their bounds, as bits; by box, as bytes.
    entered: u64,
}

impl Top {
    /// Of rays with these bounds.
    #[inline(always)]
    pub fn new(root: &Node, slabs: &Slabs, max: f32x8) -> Self {
        let mut top = Self { distances: [f32x8::ZERO; LANES], entered: 0 };
        for (k, planes) in boxes(root).enumerate() {
            let (distance, entered) = slabs.enter(&planes, max);
            top.distances[k] = distance.fast_max(f32x8::ZERO);
            top.entered |= u64::from(lanes::bits(entered)) << (LANES * k);
        }
        top
    }

    /// Rays that enter any of the boxes, as bits.
    #[inline(always)]
    pub fn any(&self) -> u32 {
        self.entered.to_le_bytes().into_iter().fold(0, |all, rays| all | u32::from(rays))
    }

    /// Boxes that the ray in a lane enters, as bits: one bit of every byte, gathered by a product in which byte k goes
    /// to the place of the last one, and bit k there.
    #[inline(always)]
    pub fn boxes_of(&self, lane: usize) -> u32 {
        let bits = self.entered >> lane & 0x0101_0101_0101_0101;
        (bits.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32
    }

    /// Box `k` of the root, which the ray in a lane enters.
    #[inline(always)]
    pub fn entry(&self, k: usize, lane: usize, root: &Node) -> u64 {
        walk::entry(self.distances[k].as_array()[lane], root.children[k])
    }
}

/// The boxes of a node.
#[inline(always)]
fn boxes(node: &Node) -> impl Iterator<Item = [f32; 6]> {
    (0..LANES).map(|child| node.planes_of(child)).take_while(|planes| planes[0] != f32::INFINITY)
}
