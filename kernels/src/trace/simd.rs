//! One ray at a time, eight boxes ([`walk`]) and eight triangles ([`ray`](super::ray), [`triangles`](super::triangles)).
//!
//! ```text
//! for each leaf on the way, from near to far:
//!     for each of its triangles that the ray crosses before the best hit: it is the best hit
//! ```

use wide::{f32x8, u32x8};

use super::Ray;
use super::ray::{Line, Ready};
use super::triangles::{Crossings, Pairs, cross};
use super::walk::{self, DONE, Stack};
use crate::lanes;
use crate::tables::geometry::{Child, Geometry, Leaf, Tree, TriangleHit};

/// The closest hit of the ray, with the smallest index among equals.
#[inline]
pub fn closest(geometry: &Geometry, ray: &Ray) -> Option<TriangleHit> {
    let tree = geometry.tree();
    if tree.leaves.rows().is_empty() {
        return None;
    }
    closest_along(tree, &Ready::new(ray, tree.extent)?)
}

/// The closest hit of a ray among the triangles of a tree.
#[inline(always)]
fn closest_along(tree: &Tree, ray: &Ready) -> Option<TriangleHit> {
    let leaves = tree.leaves.rows();
    let mut best = no_hit(ray.ray.max);
    let mut found = false;
    each_leaf::<true>(tree, ray, |leaf, _| {
        found |= improve(&mut best, &leaves[leaf], ray);
        best.distance
    });
    found.then_some(best)
}

/// The best hit of a ray that has none yet. No index is smaller than its own, so that bounds are exclusive.
#[inline(always)]
pub(super) fn no_hit(max: f32) -> TriangleHit {
    TriangleHit { triangle: 0, distance: max, barycentric: [0.0; 2] }
}

/// Takes a hit on a triangle of the leaf that is nearer than the best one, or as near and of a smaller index; whether
/// there is any.
#[inline(always)]
pub(super) fn improve(best: &mut TriangleHit, leaf: &Leaf, ray: &Ready) -> bool {
    let Some(Crossings { met, distance, second, third }) = cross_leaf(leaf, ray, best.distance) else { return false };
    let triangles = leaf.triangles.to_array();
    let (distances, [u, v]) = (distance.to_array(), [second, third].map(f32x8::to_array));
    let mut found = false;
    for lane in lanes::each(lanes::bits(met)) {
        let (distance, triangle) = (distances[lane], triangles[lane]);
        if distance < best.distance || (distance == best.distance && triangle < best.triangle) {
            *best = TriangleHit { triangle, distance, barycentric: [u[lane], v[lane]] };
            found = true;
        }
    }
    found
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

/// Whether a ray hits anything but the triangle `spared` in a tree.
#[inline(always)]
fn any_but_along(tree: &Tree, ray: &Ready, spared: u32) -> bool {
    let leaves = tree.leaves.rows();
    let mut met = false;
    each_leaf::<false>(tree, ray, |leaf, bound| {
        met = hides(&leaves[leaf], ray, spared);
        if met { DONE } else { bound }
    });
    met
}

/// Looks at the leaves whose boxes a ray enters, as [`walk::leaves`] does.
#[inline(always)]
fn each_leaf<const ORDERED: bool>(tree: &Tree, ray: &Ready, look: impl FnMut(usize, f32) -> f32) {
    walk::leaves::<ORDERED>(tree.nodes.rows(), &ray.line, &mut Stack::new(), Child::node(0), ray.ray.max, look);
}

/// Whether a ray hits any triangle of the leaf but `spared`.
#[inline(always)]
pub(super) fn hides(leaf: &Leaf, ray: &Ready, spared: u32) -> bool {
    let max = ray.ray.max;
    let Some(Crossings { met, distance, .. }) = cross_leaf(leaf, ray, max) else { return false };
    let own = lanes::as_mask(leaf.triangles.simd_eq(u32x8::splat(spared)));
    (!own & met & distance.simd_lt(f32x8::splat(max))).any()
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
            let Line { inverse, near, .. } = &self.ray.line;
            let [a, b, c] = self.leaf.corners.map(|corner| corner[axis].mul_add(inverse[axis], near[axis]));
            a.fast_min(b).fast_min(c)
        };
        axis(0).fast_max(axis(1)).fast_max(axis(2))
    }

    #[inline(always)]
    fn pair(&self, lane: usize) -> ([[f32; 3]; 3], Ray) {
        (self.leaf.at(lane), self.ray.ray)
    }
}
