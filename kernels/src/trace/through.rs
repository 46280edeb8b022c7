//! Eight rays on their way through a tree, whatever is in its leaves.
//!
//! ```text
//! eight rays meet the eight boxes of the root together; those that enter none are done
//! a tree that stays in cache: one after the other (`walk`)
//! a larger one: they take turns
//!     each ray starts at the nearest box of the root that it enters; the others are on its stack
//!     while any ray is under way:
//!         each ray at a node:  which of its boxes does it enter?
//!         each ray at a leaf:  what is there? This may lower its bound
//!         each ray:            goes on to the nearest box that it enters, and puts the others on its stack;
//!                              where it enters none, to what is on its stack; where that is empty, it is done
//! ```
//!
//! Rays of a scattering medium are short and point everywhere. Below the root they share few nodes: lanes are boxes
//! there, not rays.
//!
//! 1. Through a large tree a ray mostly waits for memory. In turns it asks for the next box at once, and needs it only
//!    when the others have had their turns.
//! 2. A tree in cache has nothing to wait for. There a ray keeps what it needs in registers, and finds the next box a
//!    little sooner.
//! 3. A leaf may be the root's only child, so that all trees have a root of boxes.
//! 4. In a large tree even those that only want to know whether anything is in the way look at near boxes first: what
//!    they find spares them the memory of the others.

use fogbow_processor::prefetch;
use wide::f32x8;

use super::cull::Top;
use super::rays::Lines;
use super::walk::{self, Stack};
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Child, Node};

/// Leaves of a tree that stays in cache: about ten megabytes, which is 100 000 to 150 000 triangles. Rays from anywhere
/// gain from turns in a third of that; but rays of a picture keep to a part of the tree, and their neighbours go alike.
pub const IN_CACHE: usize = 30_000;

/// Eight rays at the root of a tree with leaves `L`.
///
/// What `look` makes of a leaf is the new bound of a ray, whose bound it is given: what lies beyond is not looked at
/// any more.
pub(super) struct Through<'a, L> {
    /// Of which the first is the root.
    pub nodes: &'a [Node],
    pub leaves: &'a [L],
    pub top: &'a Top,
    pub lines: &'a Lines,
    /// Bounds of the rays.
    pub max: f32x8,
}

impl<L> Through<'_, L> {
    /// Looks at all leaves whose boxes the rays in `near` lanes enter before their bounds, for each lane about from near
    /// to far if `ORDERED`. All of these rays enter boxes of the root ([`Top::any`]).
    #[inline(always)]
    pub fn all<const ORDERED: bool>(&self, near: u32, mut look: impl FnMut(usize, &L, f32) -> f32) {
        if self.leaves.len() > IN_CACHE {
            return self.in_turns(near, look);
        }
        for lane in lanes::each(near) {
            self.one::<ORDERED>(lane, |leaf, bound| look(lane, leaf, bound));
        }
    }

    /// The same for one of the rays, as [`walk::leaves`] does it.
    #[inline(always)]
    pub fn one<const ORDERED: bool>(&self, lane: usize, mut look: impl FnMut(&L, f32) -> f32) {
        let mut stack = Stack::new();
        let child = self.start::<ORDERED>(lane, &mut stack);
        let (line, max) = (self.lines.at(lane), self.max.as_array()[lane]);
        let look = |leaf: usize, bound: f32| look(&self.leaves[leaf], bound);
        walk::leaves::<ORDERED>(self.nodes, &line, &mut stack, child, max, look);
    }

    /// A box of the root that the ray in a lane enters; the others go on its stack.
    #[inline(always)]
    fn start<const ORDERED: bool>(&self, lane: usize, stack: &mut Stack) -> Child {
        walk::descend::<ORDERED>(stack, self.top.boxes_of(lane), |k| self.top.entry(k, lane, &self.nodes[0]))
    }

    #[inline(always)]
    fn in_turns(&self, near: u32, mut look: impl FnMut(usize, &L, f32) -> f32) {
        let nodes = self.nodes;
        let mut bounds = self.max.to_array();
        let mut rays = Turns::new();
        for lane in lanes::each(near) {
            let child = self.start::<true>(lane, &mut rays.stacks[lane]);
            self.go(&mut rays, lane, child);
        }
        let mut entered = [([0.0; LANES], 0); LANES];
        while rays.open != 0 {
            for lane in lanes::each(rays.open & !rays.at_leaf) {
                let node = &nodes[rays.at[lane].index()];
                let (distances, bits) = walk::enter(node, &self.lines.at(lane), bounds[lane]);
                entered[lane] = (distances.to_array(), bits);
            }
            for lane in lanes::each(rays.open & rays.at_leaf) {
                bounds[lane] = look(lane, &self.leaves[rays.at[lane].index()], bounds[lane]);
                entered[lane].1 = 0;
            }
            for lane in lanes::each(core::mem::take(&mut rays.open)) {
                let (distances, bits) = &entered[lane];
                let stack = &mut rays.stacks[lane];
                let next = if *bits != 0 {
                    let children = &nodes[rays.at[lane].index()].children;
                    Some(walk::descend::<true>(stack, *bits, |k| walk::entry(distances[k], children[k])))
                } else {
                    walk::pop(stack, bounds[lane])
                };
                if let Some(next) = next {
                    self.go(&mut rays, lane, next);
                }
            }
        }
    }

    /// The ray in a lane goes to a box, which is asked for.
    #[inline(always)]
    fn go(&self, rays: &mut Turns, lane: usize, child: Child) {
        rays.open |= 1 << lane;
        rays.at[lane] = child;
        rays.at_leaf = rays.at_leaf & !(1 << lane) | u32::from(child.is_leaf()) << lane;
        if child.is_leaf() { prefetch(&self.leaves[child.index()]) } else { prefetch(&self.nodes[child.index()]) }
    }
}

/// Where eight rays are that take turns.
struct Turns {
    /// Rays that are under way, as bits.
    open: u32,
    /// Those of them that are at leaves.
    at_leaf: u32,
    at: [Child; LANES],
    stacks: [Stack; LANES],
}

impl Turns {
    #[inline(always)]
    fn new() -> Self {
        // One by one they are left as they are in memory; an array made otherwise is copied there.
        let new = Stack::new;
        let stacks = [new(), new(), new(), new(), new(), new(), new(), new()];
        Self { open: 0, at_leaf: 0, at: [Child::node(0); LANES], stacks }
    }
}
