//! Rays and segments against disks and spheres.
//!
//! ```text
//! ray o + t d, |d| = 1:
//!     disk:    t = ((c - o) . n) / (d . n);  met if 0 < t < bound and |o + t d - c| <= R
//!     sphere:  t = b -+ sqrt(R^2 - |c - o - b d|^2),  b = (c - o) . d;  the smaller one that is positive
//! segment a .. b:
//!     disk:    fa, fb = signed distances of a, b from its plane
//!              crossed if fa fb < 0 and the crossing a + (b - a) fa / (fa - fb) lies within the radius
//!     sphere:  crossed if the point of the segment that is closest to the centre is within the radius
//! ```
//!
//! 1. Lanes are rays against one body, or bodies against one ray: the arithmetic is the same.
//! 2. Where bodies are many, rays go through their tree as through one of triangles: each its own way
//!    ([`through`](super::through)).
//! 3. A ray in the disk's plane gives t = +-inf or NaN, and every comparison with it fails.

use wide::{f32x8, u32x8};

use super::cull::Top;
use super::rays::Lines;
use super::through::Through;
use super::walk::DONE;
use super::{Rays, Slabs};
use crate::lanes::{self, LANES};
use crate::real::{Mask, Real};
use crate::tables::lights::{BodyTree, Emitter, Shape};
use crate::vec3::{Vec3, Vec3x8};

/// Eight disks or spheres; or one, for as many rows as there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bodies<F = f32x8> {
    center: Vec3<F>,
    normal: Vec3<F>,
    radius_squared: F,
}

impl<F: Real> Bodies<F> {
    /// One body in all rows.
    #[inline(always)]
    pub fn one(body: &Emitter) -> Self {
        Self {
            center: Vec3::splat(body.origin),
            normal: Vec3::splat(body.normal),
            radius_squared: F::splat(body.radius * body.radius),
        }
    }

    /// Distance at which rays meet bodies of one shape before `bound`; infinite where they do not.
    #[inline(always)]
    pub fn meet(&self, shape: Shape, origin: Vec3<F>, direction: Vec3<F>, bound: F) -> F {
        let from_center = origin - self.center;
        let (distance, inside) = if shape == Shape::Sphere {
            let closest = -from_center.dot(direction);
            let half_squared = self.radius_squared - direction.mul_add(closest, from_center).length_squared();
            let half = half_squared.fast_max(F::ZERO).sqrt();
            let near = closest - half;
            (near.simd_gt(F::ZERO).select(near, closest + half), half_squared.simd_gt(F::ZERO))
        } else {
            let distance = -from_center.dot(self.normal) / direction.dot(self.normal);
            let across = direction.mul_add(distance, from_center).length_squared();
            (distance, across.simd_le(self.radius_squared))
        };
        let hit = distance.simd_gt(F::ZERO) & distance.simd_lt(bound) & inside;
        hit.select(distance, F::splat(f32::INFINITY))
    }
}

impl Bodies {
    /// Those of eight lanes. A vacant lane is never met.
    pub fn new(bodies: &[Emitter]) -> Self {
        let number = |of: &dyn Fn(&Emitter) -> f32, vacant: f32| {
            f32x8::new(core::array::from_fn(|lane| bodies.get(lane).map_or(vacant, of)))
        };
        let vector = |of: fn(&Emitter) -> [f32; 3]| {
            let [x, y, z] = [0, 1, 2].map(|axis: usize| number(&|body| of(body)[axis], 0.0));
            Vec3x8::new(x, y, z)
        };
        Self {
            center: vector(|body| body.origin),
            normal: vector(|body| body.normal),
            radius_squared: number(&|body| body.radius * body.radius, -1.0),
        }
    }

    /// Which segments from `a` to `b` cross bodies of one shape.
    #[inline(always)]
    pub fn cross(&self, shape: Shape, a: Vec3x8, b: Vec3x8) -> f32x8 {
        let (a, b) = (a - self.center, b - self.center);
        if shape == Shape::Sphere {
            let edge = b - a;
            let closest = -a.dot(edge) / edge.length_squared().fast_max(f32x8::splat(f32::MIN_POSITIVE));
            let closest = closest.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
            return edge.mul_add(closest, a).length_squared().simd_lt(self.radius_squared);
        }
        let (fa, fb) = (a.dot(self.normal), b.dot(self.normal));
        let across = (b - a).mul_add(fa / (fa - fb), a).length_squared();
        (fa * fb).simd_lt(f32x8::ZERO) & across.simd_le(self.radius_squared)
    }
}

/// Some bodies of a tree, of both shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyLeaf {
    bodies: Bodies,
    /// Which are spheres, as bits.
    spheres: u32,
    /// Index of the first.
    first: u32,
}

impl BodyLeaf {
    /// Of at most eight bodies that follow each other from number `first` on.
    pub fn new(bodies: &[Emitter], first: u32) -> Self {
        debug_assert!((1..=LANES).contains(&bodies.len()), "{} bodies", bodies.len());
        // What a vacant lane is does not matter: here, what its neighbour is.
        let is_sphere = |lane: &usize| bodies[(*lane).min(bodies.len() - 1)].shape == Shape::Sphere;
        let spheres = (0..LANES).filter(is_sphere).fold(0, |bits, lane| bits | 1 << lane);
        Self { bodies: Bodies::new(bodies), spheres, first }
    }

    /// What `of` says of bodies, each asked for its own shape.
    #[inline(always)]
    fn by_shape(&self, of: impl Fn(&Bodies, Shape) -> f32x8) -> f32x8 {
        let of = |shape: Shape| of(&self.bodies, shape);
        match self.spheres {
            0 => of(Shape::Disk),
            lanes::ALL => of(Shape::Sphere),
            spheres => lanes::mask(spheres).select(of(Shape::Sphere), of(Shape::Disk)),
        }
    }

    /// Takes the body that a ray meets first, if that is nearer than the `best` one, or as near and of a smaller index;
    /// gives the new bound.
    #[inline(always)]
    fn improve(&self, best: &mut Option<(u32, f32)>, bound: f32, origin: Vec3x8, direction: Vec3x8) -> f32 {
        let met = self.by_shape(|bodies, shape| bodies.meet(shape, origin, direction, f32x8::splat(f32::INFINITY)));
        let (distances, mut bound) = (met.to_array(), bound);
        for lane in lanes::each(lanes::bits(met.simd_le(f32x8::splat(bound)))) {
            let (distance, index) = (distances[lane], self.first + lane as u32);
            let wins_draw = best.is_some_and(|(other, at)| distance == at && index < other);
            if distance < bound || wins_draw {
                (*best, bound) = (Some((index, distance)), distance);
            }
        }
        bound
    }

    /// Whether a segment crosses any of the bodies but number `own` of all.
    #[inline(always)]
    fn blocks(&self, from: Vec3x8, to: Vec3x8, own: u32) -> bool {
        let crossed = lanes::bits(self.by_shape(|bodies, shape| bodies.cross(shape, from, to)));
        let own = own.wrapping_sub(self.first);
        crossed & !(if own < LANES as u32 { 1 << own } else { 0 }) != 0
    }
}

/// The nearest bodies on rays of unit direction.
pub struct Nearest {
    /// Their indices; on equal distances the smaller one, and 0 where there is none.
    pub body: u32x8,
    /// How far away they are; bounds, which none of them reaches, where there is none `[m]`.
    pub distance: f32x8,
}

/// The nearest of some bodies on eight rays of unit direction.
#[inline(always)]
pub fn closest_among(bodies: &[Emitter], rays: &Rays) -> Nearest {
    let mut found = Nearest { body: u32x8::splat(0), distance: rays.max };
    for (index, body) in (0..).zip(bodies) {
        let distance = Bodies::one(body).meet(body.shape, rays.origin, rays.direction, found.distance);
        let nearer = distance.simd_lt(found.distance);
        found.distance = nearer.select(distance, found.distance);
        found.body = lanes::as_integer_mask(nearer).select(u32x8::splat(index), found.body);
    }
    found
}

/// The nearest bodies of a tree on the `live` ones of eight rays of unit direction.
#[inline(always)]
pub fn closest(tree: &BodyTree, rays: &Rays, live: u32) -> Nearest {
    let mut found = Nearest { body: u32x8::splat(0), distance: rays.max };
    each_near(tree, rays, live, |lane, through| {
        let [origin, direction] = [rays.origin, rays.direction].map(|v| splat(v, lane));
        let mut best = None;
        through.one::<true>(lane, |leaf, bound| leaf.improve(&mut best, bound, origin, direction));
        let Some((body, distance)) = best else { return };
        (found.body.as_mut_array()[lane], found.distance.as_mut_array()[lane]) = (body, distance);
    });
    found
}

/// Which of the `free` ones of eight segments cross any body of a tree but their `own` one, as bits; `u32::MAX` for none.
#[inline(always)]
pub fn blocked(tree: &BodyTree, from: Vec3x8, to: Vec3x8, own: u32x8, free: u32) -> u32 {
    let rays = Rays { origin: from, direction: to - from, max: f32x8::ONE };
    let own = own.to_array();
    let mut blocked = 0;
    each_near(tree, &rays, free, |lane, through| {
        let ([from, to], own) = ([from, to].map(|v| splat(v, lane)), own[lane]);
        through.one::<false>(lane, |leaf, bound| {
            let blocks = leaf.blocks(from, to, own);
            blocked |= u32::from(blocks) << lane;
            if blocks { DONE } else { bound }
        });
    });
    blocked
}

/// Hands those of the `live` rays that enter any box at the top of a tree to `of`, by lane.
#[inline(always)]
fn each_near(tree: &BodyTree, rays: &Rays, live: u32, mut of: impl FnMut(usize, &Through<'_, BodyLeaf>)) {
    let slabs = Slabs::new(rays, tree.extent);
    let top = Top::new(&tree.nodes[0], &slabs, rays.max);
    let near = live & top.any();
    if near != 0 {
        let (nodes, leaves, lines) = (&tree.nodes, &tree.leaves, &Lines::new(&slabs));
        let through = Through { nodes, leaves, top: &top, lines, max: rays.max };
        lanes::each(near).for_each(|lane| of(lane, &through));
    }
}

/// The vector of one lane, in all lanes.
#[inline(always)]
fn splat(v: Vec3x8, lane: usize) -> Vec3x8 {
    let [x, y, z] = [v.x, v.y, v.z].map(|component| f32x8::splat(component.as_array()[lane % LANES]));
    Vec3x8::new(x, y, z)
}
