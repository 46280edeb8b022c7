//! One ray on its way through a tree of eight boxes per node, whatever is in its leaves.
//!
//! ```text
//! stack = [root at 0]
//! while the stack has a child whose box the ray enters no later than the bound:
//!     node: for each of its boxes that the ray enters no later than it leaves: push it, the nearest last
//!     leaf: look at it, which may lower the bound
//! ```
//!
//! 1. The nearest box is entered at once and does not go over the stack. An entry is one number, distance before child,
//!    so that sorting compares distances: they are not negative, so their bits are in their order.
//! 2. A node leaves at most 7 of its children on the stack while the eighth is visited, and no leaf lies below more
//!    than [`DEPTH`] nodes, so `7 DEPTH` entries suffice.
//! 3. A box as far as the bound is entered, because it may hold something at the same distance with a smaller index.

use arrayvec::ArrayVec;
use wide::f32x8;

use super::ray::Line;
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Child, DEPTH, Node};

/// Most entries of the stack.
const STACK: usize = (LANES - 1) * DEPTH;

/// Looks at all leaves whose boxes the ray enters before the bound, about from near to far: at first `max`, then what
/// `look`, which is given the index of a leaf and the bound, makes of it.
#[inline(always)]
pub fn nearest(nodes: &[Node], root: Child, line: &Line, max: f32, mut look: impl FnMut(usize, f32) -> f32) {
    let mut bound = max;
    let mut stack = ArrayVec::<u64, STACK>::new();
    let mut child = root;
    loop {
        if child.is_leaf() {
            bound = look(child.index(), bound);
        } else {
            let node = &nodes[child.index()];
            let (entered, mut bits) = enter(node, line, bound);
            let entry = |lane: usize| u64::from(entered[lane].to_bits()) << 32 | u64::from(node.children[lane]);
            if bits != 0 {
                let mut nearest = entry(bits.trailing_zeros() as usize);
                bits &= bits - 1;
                let bottom = stack.len();
                while bits != 0 {
                    let other = entry(bits.trailing_zeros() as usize);
                    bits &= bits - 1;
                    stack.push(nearest.max(other));
                    nearest = nearest.min(other);
                }
                sort_descending(&mut stack[bottom..]);
                child = Child::from_bits(nearest as u32);
                continue;
            }
        }
        loop {
            let Some(entry) = stack.pop() else { return };
            if f32::from_bits((entry >> 32) as u32) <= bound {
                child = Child::from_bits(entry as u32);
                break;
            }
        }
    }
}

/// Whether `meets` is true of any leaf, given by its index, whose box the ray enters before `max`.
#[inline(always)]
pub fn any(nodes: &[Node], root: Child, line: &Line, max: f32, mut meets: impl FnMut(usize) -> bool) -> bool {
    let mut stack = ArrayVec::<Child, STACK>::new();
    let mut child = root;
    loop {
        if child.is_leaf() {
            if meets(child.index()) {
                return true;
            }
        } else {
            let node = &nodes[child.index()];
            let bits = enter(node, line, max).1;
            lanes::each(bits).for_each(|lane| stack.push(Child::from_bits(node.children[lane])));
        }
        let Some(next) = stack.pop() else { return false };
        child = next;
    }
}

/// Where the ray enters the boxes of a node, not before its start, and which it enters before it leaves them and no
/// later than `max`.
#[inline(always)]
fn enter(node: &Node, line: &Line, max: f32) -> ([f32; LANES], u32) {
    let near = |axis: usize| node.planes[line.near_planes[axis]].mul_add(line.inverse[axis], line.near[axis]);
    let far = |axis: usize| node.planes[line.far_planes[axis]].mul_add(line.inverse[axis], line.far[axis]);
    let entered = near(0).fast_max(near(1)).fast_max(near(2).fast_max(f32x8::ZERO));
    let left = far(0).fast_min(far(1)).fast_min(far(2).fast_min(f32x8::splat(max)));
    (entered.to_array(), lanes::bits(entered.simd_le(left)))
}

/// Sorts a handful of entries.
#[inline(always)]
fn sort_descending(entries: &mut [u64]) {
    for i in 1..entries.len() {
        let entry = entries[i];
        let mut at = i;
        while at > 0 && entries[at - 1] < entry {
            entries[at] = entries[at - 1];
            at -= 1;
        }
        entries[at] = entry;
    }
}
