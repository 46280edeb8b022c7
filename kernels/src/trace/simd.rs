//! ```text
//! stack = [root at 0]
//! while the stack has a child whose box the ray enters no later than the best hit:
//!     node: for each of its boxes that the ray enters no later than it leaves: push it, the nearest last
//!     leaf: for each of its triangles that the ray crosses before the best hit: it is the best hit
//! ```
//!
//! 1. Eight boxes and eight triangles at a time ([`ray`](super::ray), [`triangles`](super::triangles)).
//! 2. The nearest box is entered at once and does not go over the stack. An entry is one number, distance before child,
//!    so that sorting compares distances: they are not negative, so their bits are in their order.
//! 3. A node leaves at most 7 of its children on the stack while the eighth is visited, and no leaf lies below more
//!    than [`DEPTH`] nodes, so `7 DEPTH` entries suffice.
//! 4. A box as far as the best hit is entered, because it may hold a triangle at the same distance with a smaller
//!    index.

use arrayvec::ArrayVec;
use wide::f32x8;

use super::Ray;
use super::ray::Ready;
use super::triangles::cross;
use crate::lanes;
use crate::lanes::LANES;
use crate::tables::geometry::TriangleHit;
use crate::tables::geometry::{Child, DEPTH, Geometry, Node};

/// Most entries of the stack.
const STACK: usize = (LANES - 1) * DEPTH;

/// The closest hit of the ray, with the smallest index among equals.
#[inline]
pub fn closest(geometry: &Geometry, ray: &Ray) -> Option<TriangleHit> {
    let tree = geometry.tree();
    let (nodes, leaves) = (tree.nodes.rows(), tree.leaves.rows());
    if leaves.is_empty() {
        return None;
    }
    let ready = Ready::new(ray, tree)?;
    let mut best = TriangleHit { triangle: 0, distance: ray.max, barycentric: [0.0; 2] };
    let mut found = false;
    let mut stack = ArrayVec::<u64, STACK>::new();
    let mut child = tree.root;
    loop {
        if child.is_leaf() {
            let leaf = &leaves[child.index()];
            if let Some(crossings) = cross(leaf, &ready, best.distance) {
                let triangles = leaf.triangles.to_array();
                for lane in lanes::each(crossings.bits) {
                    let (distance, triangle) = (crossings.distance[lane], triangles[lane]);
                    if distance < best.distance || (distance == best.distance && triangle < best.triangle) {
                        best = TriangleHit { triangle, distance, barycentric: [crossings.u[lane], crossings.v[lane]] };
                        found = true;
                    }
                }
            }
        } else {
            let node = &nodes[child.index()];
            let (entered, mut bits) = enter(node, &ready, best.distance);
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
            let Some(entry) = stack.pop() else { return found.then_some(best) };
            if f32::from_bits((entry >> 32) as u32) <= best.distance {
                child = Child::from_bits(entry as u32);
                break;
            }
        }
    }
}

/// Whether the ray hits anything.
#[inline]
pub fn any(geometry: &Geometry, ray: &Ray) -> bool {
    any_but(geometry, ray, u32::MAX)
}

/// Whether the ray hits anything but the triangle `spared`; `u32::MAX` for none.
#[inline]
pub fn any_but(geometry: &Geometry, ray: &Ray, spared: u32) -> bool {
    let tree = geometry.tree();
    let (nodes, leaves) = (tree.nodes.rows(), tree.leaves.rows());
    if leaves.is_empty() {
        return false;
    }
    let Some(ready) = Ready::new(ray, tree) else { return false };
    let mut stack = ArrayVec::<Child, STACK>::new();
    let mut child = tree.root;
    loop {
        if child.is_leaf() {
            let leaf = &leaves[child.index()];
            let counts = |bits: u32, distance: &[f32; LANES]| {
                lanes::each(bits).any(|lane| distance[lane] < ray.max && leaf.triangles.as_array()[lane] != spared)
            };
            if let Some(crossings) = cross(leaf, &ready, ray.max)
                && counts(crossings.bits, &crossings.distance)
            {
                return true;
            }
        } else {
            let node = &nodes[child.index()];
            let bits = enter(node, &ready, ray.max).1;
            lanes::each(bits).for_each(|lane| stack.push(Child::from_bits(node.children[lane])));
        }
        let Some(next) = stack.pop() else { return false };
        child = next;
    }
}

/// Where the ray enters the boxes of a node, not before its start, and which it enters before it leaves them and no
/// later than `max`.
#[inline(always)]
fn enter(node: &Node, ray: &Ready, max: f32) -> ([f32; LANES], u32) {
    let near = |axis: usize| node.planes[ray.near_planes[axis]].mul_add(ray.inverse[axis], ray.near[axis]);
    let far = |axis: usize| node.planes[ray.far_planes[axis]].mul_add(ray.inverse[axis], ray.far[axis]);
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
