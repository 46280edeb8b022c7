//! One ray on its way through a tree of eight boxes per node, whatever is in its leaves.
//!
//! ```text
//! stack = [where it starts]
//! while the stack has a child whose box the ray enters no later than the bound:
//!     node: for each of its boxes that the ray enters no later than it leaves: push it, the nearest last
//!     leaf: look at it, which may lower the bound
//! ```
//!
//! 1. The nearest box is entered at once and does not go over the stack. An entry is one number, distance before child,
//!    so that sorting compares distances: they are not negative, so their bits are in their order.
//! 2. A node leaves at most 7 of its children on the stack while the eighth is visited, and no leaf lies below more
//!    than [`DEPTH`] nodes, so `7 DEPTH` entries suffice.
//! 3. Whoever only wants to know whether anything is in the way mostly finds nothing, and need not sort.
//! 4. A box as far as the bound is entered, because it may hold something at the same distance with a smaller index.

use arrayvec::ArrayVec;
use wide::f32x8;

use super::ray::Line;
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Child, DEPTH, Node};

/// A bound that no box is within: nothing more is looked for.
pub(super) const DONE: f32 = -1.0;

/// Boxes that a ray enters, and has not looked into yet.
pub(super) type Stack = ArrayVec<u64, { (LANES - 1) * DEPTH }>;

/// A box that a ray enters at a `distance`.
#[inline(always)]
pub(super) fn entry(distance: f32, child: u32) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(child)
}

/// Looks at all leaves below `child`, and below what is on the stack, whose boxes the ray enters before the bound,
/// about from near to far if `ORDERED`. The bound is `max` at first, then what `look` makes of it, which is given the
/// index of a leaf and the bound.
#[inline(always)]
pub(super) fn leaves<const ORDERED: bool>(
    nodes: &[Node],
    line: &Line,
    stack: &mut Stack,
    child: Child,
    max: f32,
    mut look: impl FnMut(usize, f32) -> f32,
) {
    let mut bound = max;
    let mut next = Some(child);
    while let Some(child) = next {
        next = None;
        if child.is_leaf() {
            bound = look(child.index(), bound);
        } else {
            let node = &nodes[child.index()];
            let (distances, bits) = enter(node, line, bound);
            if bits != 0 {
                let distances = distances.to_array();
                next = Some(descend::<ORDERED>(stack, bits, |k| entry(distances[k], node.children[k])));
            }
        }
        next = next.or_else(|| pop(stack, bound));
    }
}

/// Where the ray enters the boxes of a node, not before its start, and which it enters before it leaves them and no
/// later than `max`, as bits.
#[inline(always)]
pub(super) fn enter(node: &Node, line: &Line, max: f32) -> (f32x8, u32) {
    let t = |axis: usize, side: usize, c: f32x8| node.planes[axis][side].mul_add(line.inverse[axis], c);
    let near = |axis: usize| t(axis, line.near_side[axis] & 1, line.near[axis]);
    let far = |axis: usize| t(axis, !line.near_side[axis] & 1, line.far[axis]);
    let entered = near(0).fast_max(near(1)).fast_max(near(2).fast_max(f32x8::ZERO));
    let left = far(0).fast_min(far(1)).fast_min(far(2).fast_min(f32x8::splat(max)));
    (entered, lanes::bits(entered.simd_le(left)))
}

/// The nearest of the boxes of a node that a ray enters, `bits`, of which there are some; the others go on the stack,
/// the farthest first. `entry` is that of a box. If not `ORDERED`: the first of the boxes, and the others in any order.
#[inline(always)]
pub(super) fn descend<const ORDERED: bool>(stack: &mut Stack, mut bits: u32, entry: impl Fn(usize) -> u64) -> Child {
    let mut nearest = entry(bits.trailing_zeros() as usize % LANES);
    bits &= bits - 1;
    let bottom = stack.len();
    while bits != 0 {
        let other = entry(bits.trailing_zeros() as usize % LANES);
        bits &= bits - 1;
        if ORDERED {
            stack.push(nearest.max(other));
            nearest = nearest.min(other);
        } else {
            stack.push(other);
        }
    }
    if ORDERED {
        sort_descending(&mut stack[bottom..]);
    }
    Child::from_bits(nearest as u32)
}

/// The uppermost box on the stack that the ray enters no later than the bound.
#[inline(always)]
pub(super) fn pop(stack: &mut Stack, bound: f32) -> Option<Child> {
    while let Some(entry) = stack.pop() {
        if f32::from_bits((entry >> 32) as u32) <= bound {
            return Some(Child::from_bits(entry as u32));
        }
    }
    None
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
