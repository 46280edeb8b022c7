//! ```text
//! stack = [root at 0]
//! while the stack has a child whose box the ray enters no later than the best hit:
//!     node: for each of its boxes that the ray enters no later than it leaves: push it, the nearest last
//!     leaf: for each of its triangles that the ray crosses before the best hit: it is the best hit
//! ```
//!
//! 1. One ray at a time, eight boxes and eight triangles ([`ray`](super::ray), [`triangles`](super::triangles)).
//! 2. The nearest box is entered at once and does not go over the stack. An entry is one number, distance before child,
//!    so that sorting compares distances: they are not negative, so their bits are in their order.
//! 3. A node leaves at most 7 of its children on the stack while the eighth is visited, and no leaf lies below more
//!    than [`DEPTH`] nodes, so `7 DEPTH` entries suffice.
//! 4. A box as far as the best hit is entered, because it may hold a triangle at the same distance with a smaller
//!    index.

use arrayvec::ArrayVec;
use wide::{f32x8, u32x8};

use super::Ray;
use super::ray::Ready;
use super::triangles::{Crossings, Pairs, cross};
use crate::lanes;
use crate::lanes::LANES;
use crate::tables::geometry::TriangleHit;
use crate::tables::geometry::{Child, DEPTH, Geometry, Leaf, Node};

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
            if let Some(Crossings { met, distance, second, third }) = cross_leaf(leaf, &ready, best.distance) {
                let triangles = leaf.triangles.to_array();
                let (distances, [u, v]) = (distance.to_array(), [second, third].map(f32x8::to_array));
                for lane in lanes::each(lanes::bits(met)) {
                    let (distance, triangle) = (distances[lane], triangles[lane]);
                    if distance < best.distance || (distance == best.distance && triangle < best.triangle) {
                        best = TriangleHit { triangle, distance, barycentric: [u[lane], v[lane]] };
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
            if let Some(Crossings { met, distance, .. }) = cross_leaf(leaf, &ready, ray.max) {
                let own = lanes::as_mask(leaf.triangles.simd_eq(u32x8::splat(spared)));
                if (!own & met & distance.simd_lt(f32x8::splat(ray.max))).any() {
                    return true;
                }
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

/// Where the ray crosses the triangles of a leaf with t in `(0, max]`; `None` where nowhere.
#[inline(always)]
fn cross_leaf(leaf: &Leaf, ray: &Ready, max: f32) -> Option<Crossings> {
    cross(&Sheaf { leaf, ray }, f32x8::splat(max), lanes::mask(lanes::ALL))
}

/// One ray and eight triangles.
struct Sheaf<'a> {
    leaf: &'a Leaf,
    ray: &'a Ready,
}

impl Pairs for Sheaf<'_> {
    #[inline(always)]
    fn relative(&self, corner: usize, axis: usize) -> f32x8 {
        let axis = self.ray.axes[axis];
        self.leaf.corners[corner][axis] - self.ray.origin[axis]
    }

    #[inline(always)]
    fn shear(&self) -> [f32x8; 3] {
        self.ray.shear
    }

    #[inline(always)]
    fn entry(&self) -> f32x8 {
        let axis = |axis: usize| {
            let [a, b, c] = self.leaf.corners.map(|corner| corner[axis]);
            let upwards = self.ray.near_planes[axis] < 3;
            let near = if upwards { a.fast_min(b).fast_min(c) } else { a.fast_max(b).fast_max(c) };
            near.mul_add(self.ray.inverse[axis], self.ray.near[axis])
        };
        axis(0).fast_max(axis(1)).fast_max(axis(2))
    }

    #[inline(always)]
    fn pair(&self, lane: usize) -> ([[f32; 3]; 3], Ray) {
        (self.leaf.at(lane), self.ray.ray)
    }
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
