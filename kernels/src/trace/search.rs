//! What eight rays at a time hit, and how they look for it.

use wide::{f32x8, u32x8};

use super::Rays;
use super::cull::{Top, reached};
use super::ray::Ready;
use super::rays::{Lines, Sights, Slabs};
use super::simd::{hides, improve, no_hit};
use super::through::Through;
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

    /// The best hits of the rays in `met` lanes.
    #[inline(always)]
    fn new(met: u32, best: &[TriangleHit; LANES]) -> Self {
        let row = |of: fn(&TriangleHit) -> f32| f32x8::new(best.each_ref().map(of));
        Self {
            met: lanes::mask(met),
            triangle: u32x8::new(best.each_ref().map(|hit| hit.triangle)),
            distance: row(|hit| hit.distance),
            second: row(|hit| hit.barycentric[0]),
            third: row(|hit| hit.barycentric[1]),
        }
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
        let (mut best, mut met) = (rays.max.to_array().map(no_hit), 0);
        beams.follow::<true>(reached, |lane, leaf, ray, _| {
            met |= u32::from(improve(&mut best[lane], leaf, ray)) << lane;
            best[lane].distance
        });
        Hits::new(met, &best)
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
    let (spared, mut hidden) = (spared.to_array(), 0);
    beams.follow::<false>(reached, |lane, leaf, ray, bound| {
        let hides = hides(leaf, ray, spared[lane]);
        hidden |= u32::from(hides) << lane;
        if hides { DONE } else { bound }
    });
    hidden
}

/// Eight rays on their way through a tree.
struct Beams<'a> {
    tree: &'a Tree,
    sights: Sights<'a>,
    lines: Lines,
}

impl Beams<'_> {
    /// Shows those of the `reached` rays that enter any boxes all leaves on their way, as [`Through::all`] does: lane,
    /// leaf, ray and bound.
    #[inline(always)]
    fn follow<const ORDERED: bool>(&self, reached: u32, mut look: impl FnMut(usize, &Leaf, &Ready, f32) -> f32) {
        let Sights { rays, slabs, views } = &self.sights;
        let (nodes, leaves, lines) = (self.tree.nodes.rows(), self.tree.leaves.rows(), &self.lines);
        let top = Top::new(&nodes[0], slabs, rays.max);
        let near = reached & top.any() & lanes::bits(views.directed);
        Through { nodes, leaves, top: &top, lines, max: rays.max }
            .all::<ORDERED>(near, |lane, leaf, bound| look(lane, leaf, &self.sights.at(lane, lines.at(lane)), bound));
    }
}
