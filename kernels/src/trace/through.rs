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

/// What is in the leaves of a tree, and what rays have found there.
pub(super) trait Leaves {
    /// Whether near leaves are to be looked at before far ones.
    const ORDERED: bool;

    /// How many there are.
    fn count(&self) -> usize;

    /// Asks for a leaf that will be looked at in the next turn.
    fn prefetch(&self, leaf: usize);

    /// What the ray in a lane finds in a leaf. Gives its bound, which was `bound` before: what lies beyond is not looked
    /// at any more.
    fn look(&mut self, lane: usize, leaf: usize, bound: f32) -> f32;
}

/// Eight rays at the root of a tree.
pub(super) struct Through<'a> {
    /// Of which the first is the root.
    pub nodes: &'a [Node],
    pub top: &'a Top,
    pub lines: &'a Lines,
    /// Bounds of the rays.
    pub max: f32x8,
}

impl Through<'_> {
    /// Looks at all leaves whose boxes the rays in `near` lanes enter before their bounds. All of them enter boxes of the
    /// root ([`Top::any`]).
    #[inline(always)]
    pub fn all<L: Leaves>(&self, near: u32, leaves: &mut L) {
        if leaves.count() > IN_CACHE {
            return self.in_turns(near, leaves);
        }
        for lane in lanes::each(near) {
            let look = |leaf: usize, bound: f32| leaves.look(lane, leaf, bound);
            match L::ORDERED {
                true => self.one::<true>(lane, look),
                false => self.one::<false>(lane, look),
            }
        }
    }

    /// The same for one of the rays, as [`walk::leaves`] does it.
    #[inline(always)]
    pub fn one<const ORDERED: bool>(&self, lane: usize, look: impl FnMut(usize, f32) -> f32) {
        let mut stack = Stack::new();
        let child = self.start::<ORDERED>(lane, &mut stack);
        walk::leaves::<ORDERED>(self.nodes, &self.lines.at(lane), &mut stack, child, self.max.as_array()[lane], look);
    }

    /// A box of the root that the ray in a lane enters; the others go on its stack.
    #[inline(always)]
    fn start<const ORDERED: bool>(&self, lane: usize, stack: &mut Stack) -> Child {
        walk::descend::<ORDERED>(stack, self.top.boxes_of(lane), |k| self.top.entry(k, lane, &self.nodes[0]))
    }

    #[inline(always)]
    fn in_turns(&self, near: u32, leaves: &mut impl Leaves) {
        let nodes = self.nodes;
        let mut bounds = self.max.to_array();
        let mut rays = Turns::new();
        for lane in lanes::each(near) {
            let child = self.start::<true>(lane, &mut rays.stacks[lane]);
            rays.go(lane, child, nodes, leaves);
        }
        let mut entered = [([0.0; LANES], 0); LANES];
        while rays.open != 0 {
            for lane in lanes::each(rays.open & !rays.at_leaf) {
                let node = &nodes[rays.at[lane].index()];
                let (distances, bits) = walk::enter(node, &self.lines.at(lane), bounds[lane]);
                entered[lane] = (distances.to_array(), bits);
            }
            for lane in lanes::each(rays.open & rays.at_leaf) {
                bounds[lane] = leaves.look(lane, rays.at[lane].index(), bounds[lane]);
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
                    rays.go(lane, next, nodes, leaves);
                }
            }
        }
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

    /// The ray in a lane goes to a box.
    #[inline(always)]
    fn go(&mut self, lane: usize, child: Child, nodes: &[Node], leaves: &impl Leaves) {
        self.open |= 1 << lane;
        self.at[lane] = child;
        self.at_leaf = self.at_leaf & !(1 << lane) | u32::from(child.is_leaf()) << lane;
        if child.is_leaf() { leaves.prefetch(child.index()) } else { prefetch(&nodes[child.index()]) }
    }
}
