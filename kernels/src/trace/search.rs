//! What eight rays at a time hit, and how they look for it.

use fogbow_processor::prefetch;
use wide::{f32x8, u32x8};

use super::Rays;
use super::cull::{Top, reached};
use super::ray::Ready;
use super::rays::{Lines, Sights, Slabs};
use super::simd::{hides, improve, no_hit};
use super::through::{Leaves, Through};
use super::triangles::Crossings;
use super::walk::DONE;
use crate::lanes::{self, LANES};
use crate::tables::geometry::{Geometry, Leaf, Tree, TriangleHit};

/// A way to look for the closest triangle. Both ways find the same bits; stages match on [`Geometry::few`] once, outside
/// their loops, and run a kernel that is generic over this.
pub trait Search {
    /// Whether it is worth it that rays which are near something wait until they are eight ([`Waiting`](super::Waiting)).
    const WAITS: bool;

    /// The closest hits of the `live` rays, with the smallest index among equals.
    fn closest(&self, rays: &Rays, live: u32) -> Hits;
}

/// What eight rays hit; as [`TriangleHit`].
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    /// Rays that hit anything, as a mask.
    pub met: f32x8,
    /// Index of the triangle.
    pub triangle: u32x8,
    /// Parameter t of the ray; its bound where nothing is hit.
    pub distance: f32x8,
    /// Weight of the second corner.
    pub second: f32x8,
    /// Weight of the third corner.
    pub third: f32x8,
}

impl Hits {
    /// None yet, of rays with these bounds.
    #[inline(always)]
    pub(super) fn none(max: f32x8) -> Self {
        let (zero, triangle) = (f32x8::ZERO, u32x8::splat(0));
        Self { met: zero, triangle, distance: max, second: zero, third: zero }
    }

    /// Takes those `crossings` of a triangle that are nearer, or as near and of a smaller index. No index is smaller
    /// than that of no hit, so that bounds are exclusive.
    #[inline(always)]
    pub(super) fn take_nearer(&mut self, crossings: &Crossings, triangle: u32) {
        let Crossings { met, distance, second, third } = *crossings;
        let triangle = u32x8::splat(triangle);
        let smaller = lanes::as_mask(triangle.simd_lt(self.triangle));
        let nearer = met & (distance.simd_lt(self.distance) | (distance.simd_eq(self.distance) & smaller));
        self.met |= nearer;
        self.triangle = lanes::as_integer_mask(nearer).select(triangle, self.triangle);
        self.distance = nearer.select(distance, self.distance);
        self.second = nearer.select(second, self.second);
        self.third = nearer.select(third, self.third);
    }
}

/// Each ray [`through`](super::through) the tree.
#[derive(Clone, Copy, Debug)]
pub struct ThroughTree<'a>(pub &'a Geometry);

impl Search for ThroughTree<'_> {
    const WAITS: bool = false;

    #[inline(always)]
    fn closest(&self, rays: &Rays, live: u32) -> Hits {
        let tree = self.0.tree();
        let reached = reached(tree, rays, live);
        if reached == 0 {
            return Hits::none(rays.max);
        }
        let slabs = Slabs::new(rays, tree.extent);
        let beams = Beams { tree, sights: Sights::new(rays, &slabs), lines: Lines::new(&slabs) };
        let mut closest = Closest { beams: &beams, best: rays.max.to_array().map(no_hit), met: 0 };
        beams.follow(reached, &mut closest);
        closest.hits()
    }
}

/// Fewest of eight rays that have to be near something for few triangles to be worth all lanes.
const TOGETHER: u32 = 3;
/// Most triangles per ray that is near something.
const TRIANGLES_PER_RAY: usize = 16;

/// Which of the `live` rays hit anything but the triangle `spared`, as bits; `u32::MAX` spares none. Those that are near
/// something go through the tree, unless they are several among few triangles.
#[inline(always)]
pub fn hidden(geometry: &Geometry, rays: &Rays, live: u32, spared: u32x8) -> u32 {
    let tree = geometry.tree();
    let reached = reached(tree, rays, live);
    if reached == 0 {
        return 0;
    }
    let slabs = Slabs::new(rays, tree.extent);
    let sights = Sights::new(rays, &slabs);
    let count = reached.count_ones();
    let is_worth = count >= TOGETHER && geometry.len() <= TRIANGLES_PER_RAY * count as usize;
    if let Some(few) = geometry.few().filter(|_| is_worth) {
        return few.hidden(&sights, reached, spared);
    }
    let beams = Beams { tree, sights, lines: Lines::new(&slabs) };
    let mut hidden = Hidden { beams: &beams, spared: spared.to_array(), hidden: 0 };
    beams.follow(reached, &mut hidden);
    hidden.hidden
}

/// Eight rays on their way through a tree.
struct Beams<'a> {
    tree: &'a Tree,
    sights: Sights<'a>,
    lines: Lines,
}

impl Beams<'_> {
    /// Leads to all `leaves` those of the rays that enter any boxes, and are among the `reached` ones.
    #[inline(always)]
    fn follow(&self, reached: u32, leaves: &mut impl Leaves) {
        let Sights { rays, slabs, views } = &self.sights;
        let nodes = self.tree.nodes.rows();
        let top = Top::new(&nodes[0], slabs, rays.max);
        let near = reached & top.any() & lanes::bits(views.directed);
        Through { nodes, top: &top, lines: &self.lines, max: rays.max }.all(near, leaves);
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Ready {
        self.sights.at(lane, self.lines.at(lane))
    }

    #[inline(always)]
    fn leaf(&self, leaf: usize) -> &Leaf {
        &self.tree.leaves.rows()[leaf]
    }
}

/// The closest hits of eight rays.
struct Closest<'a> {
    beams: &'a Beams<'a>,
    best: [TriangleHit; LANES],
    /// Rays that hit anything, as bits.
    met: u32,
}

impl Leaves for Closest<'_> {
    const ORDERED: bool = true;

    #[inline(always)]
    fn count(&self) -> usize {
        self.beams.tree.leaves.rows().len()
    }

    #[inline(always)]
    fn prefetch(&self, leaf: usize) {
        prefetch(self.beams.leaf(leaf));
    }

    #[inline(always)]
    fn look(&mut self, lane: usize, leaf: usize, _: f32) -> f32 {
        let best = &mut self.best[lane];
        self.met |= u32::from(improve(best, self.beams.leaf(leaf), &self.beams.at(lane))) << lane;
        best.distance
    }
}

impl Closest<'_> {
    fn hits(&self) -> Hits {
        let row = |of: fn(&TriangleHit) -> f32| f32x8::new(self.best.each_ref().map(of));
        Hits {
            met: lanes::mask(self.met),
            triangle: u32x8::new(self.best.each_ref().map(|hit| hit.triangle)),
            distance: row(|hit| hit.distance),
            second: row(|hit| hit.barycentric[0]),
            third: row(|hit| hit.barycentric[1]),
        }
    }
}

/// Which of eight rays are hidden.
struct Hidden<'a> {
    beams: &'a Beams<'a>,
    /// The triangles that hide nothing.
    spared: [u32; LANES],
    /// As bits.
    hidden: u32,
}

impl Leaves for Hidden<'_> {
    const ORDERED: bool = false;

    #[inline(always)]
    fn count(&self) -> usize {
        self.beams.tree.leaves.rows().len()
    }

    #[inline(always)]
    fn prefetch(&self, leaf: usize) {
        prefetch(self.beams.leaf(leaf));
    }

    #[inline(always)]
    fn look(&mut self, lane: usize, leaf: usize, bound: f32) -> f32 {
        let hides = hides(self.beams.leaf(leaf), &self.beams.at(lane), self.spared[lane]);
        self.hidden |= u32::from(hides) << lane;
        if hides { DONE } else { bound }
    }
}
