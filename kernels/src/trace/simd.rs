//! One ray at a time, eight boxes ([`walk`]) and eight triangles ([`ray`](super::ray), [`triangles`](super::triangles)).
//!
//! ```text
//! for each leaf on the way, from near to far:
//!     for each of its triangles that the ray crosses before the best hit: it is the best hit
//! ```

use wide::{f32x8, u32x8};

use super::ray::Ready;
use super::triangles::{Crossings, Pairs, cross};
use super::{Ray, walk};
use crate::lanes;
use crate::tables::geometry::{Geometry, Leaf, Tree, TriangleHit};

/// The closest hit of the ray, with the smallest index among equals.
#[inline]
pub fn closest(geometry: &Geometry, ray: &Ray) -> Option<TriangleHit> {
    let tree = geometry.tree();
    if tree.leaves.rows().is_empty() {
        return None;
    }
    closest_along(tree, &Ready::new(ray, tree.extent)?)
}

/// The closest hit of a ray among the triangles of a tree that has any.
#[inline(always)]
pub(super) fn closest_along(tree: &Tree, ray: &Ready) -> Option<TriangleHit> {
    let (nodes, leaves, max) = (tree.nodes.rows(), tree.leaves.rows(), ray.ray.max);
    let mut best = TriangleHit { triangle: 0, distance: max, barycentric: [0.0; 2] };
    let mut found = false;
    walk::nearest(nodes, tree.root, &ray.line, max, |leaf, bound| {
        let leaf = &leaves[leaf];
        if let Some(Crossings { met, distance, second, third }) = cross_leaf(leaf, ray, bound) {
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
        best.distance
    });
    found.then_some(best)
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
    !tree.leaves.rows().is_empty()
        && Ready::new(ray, tree.extent).is_some_and(|ready| any_but_along(tree, &ready, spared))
}

/// Whether a ray hits anything but the triangle `spared` in a tree that has any.
#[inline(always)]
pub(super) fn any_but_along(tree: &Tree, ray: &Ready, spared: u32) -> bool {
    let (nodes, leaves, max) = (tree.nodes.rows(), tree.leaves.rows(), ray.ray.max);
    walk::any(nodes, tree.root, &ray.line, max, |leaf| {
        let leaf = &leaves[leaf];
        let Some(Crossings { met, distance, .. }) = cross_leaf(leaf, ray, max) else { return false };
        let own = lanes::as_mask(leaf.triangles.simd_eq(u32x8::splat(spared)));
        (!own & met & distance.simd_lt(f32x8::splat(max))).any()
    })
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
            let upwards = self.ray.line.near_planes[axis] < 3;
            let near = if upwards { a.fast_min(b).fast_min(c) } else { a.fast_max(b).fast_max(c) };
            near.mul_add(self.ray.line.inverse[axis], self.ray.line.near[axis])
        };
        axis(0).fast_max(axis(1)).fast_max(axis(2))
    }

    #[inline(always)]
    fn pair(&self, lane: usize) -> ([[f32; 3]; 3], Ray) {
        (self.leaf.at(lane), self.ray.ray)
    }
}
