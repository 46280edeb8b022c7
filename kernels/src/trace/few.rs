//! ```text
//! for each cluster whose box any of eight rays enters no later than its best hit:
//!     for each of its triangles whose box any of them enters no later than that:
//!         for those that cross the triangle before the best hit: it is the best hit
//! ```
//!
//! 1. Eight rays and one triangle at a time, in the same arithmetic as one ray and eight triangles
//!    ([`triangles`](super::triangles)).
//! 2. A triangle's own box costs half of what the triangle does, and says where rays enter it, which bounds t anyway.
//! 3. Every ray sees the triangle along its own axes: a corner is a row of numbers, in which lanes look up theirs.

use wide::{f32x8, u32x8};

use super::rays::{Slabs, Views};
use super::search::{Hits, Search};
use super::triangles::{Crossings, Pairs, cross};
use super::{Ray, Rays};
use crate::lanes;
use crate::tables::geometry::{Cluster, Few, Triangle};

impl Search for Few {
    #[inline(always)]
    fn closest(&self, rays: &Rays, live: u32) -> Hits {
        let ready = Ready::new(rays, self.extent);
        let live = lanes::mask(live) & ready.views.directed;
        let mut best = Hits::none(rays.max);
        for cluster in &self.clusters {
            if !ready.enter(cluster, live, best.distance) {
                continue;
            }
            for triangle in &cluster.triangles {
                if let Some(crossings) = ready.cross(triangle, live, best.distance) {
                    best.take_nearer(&crossings, triangle.index);
                }
            }
        }
        best
    }

    #[inline(always)]
    fn any_but(&self, rays: &Rays, live: u32, spared: u32x8) -> u32 {
        let ready = Ready::new(rays, self.extent);
        let live = lanes::mask(live) & ready.views.directed;
        let mut free = live;
        for cluster in &self.clusters {
            if !ready.enter(cluster, free, rays.max) {
                continue;
            }
            for triangle in &cluster.triangles {
                if let Some(crossings) = ready.cross(triangle, free, rays.max) {
                    let own = lanes::as_mask(spared.simd_eq(u32x8::splat(triangle.index)));
                    free &= own | !(crossings.met & crossings.distance.simd_lt(rays.max));
                }
            }
        }
        lanes::bits(live & !free)
    }
}

/// What the tests need of eight rays.
struct Ready<'a> {
    rays: &'a Rays,
    slabs: Slabs,
    views: Views,
}

impl<'a> Ready<'a> {
    #[inline(always)]
    fn new(rays: &'a Rays, extent: f32) -> Self {
        let slabs = Slabs::new(rays, extent);
        let views = Views::new(rays, slabs.inverse);
        Self { rays, slabs, views }
    }

    /// Whether any of the `live` rays enters the box around neighbours. One triangle is no neighbour.
    #[inline(always)]
    fn enter(&self, cluster: &Cluster, live: f32x8, max: f32x8) -> bool {
        cluster.triangles.len() == 1 || (live & self.slabs.enter(&cluster.planes, max).1).any()
    }

    /// Where the `live` rays cross a triangle with t in `(0, max]`; `None` where none does.
    #[inline(always)]
    fn cross(&self, triangle: &Triangle, live: f32x8, max: f32x8) -> Option<Crossings> {
        let (entry, entered) = self.slabs.enter(&triangle.planes, max);
        let live = live & entered;
        if !live.any() {
            return None;
        }
        cross(&Fan { triangle, ready: self, entry }, max, live)
    }
}

/// Eight rays and one triangle.
struct Fan<'a> {
    triangle: &'a Triangle,
    ready: &'a Ready<'a>,
    entry: f32x8,
}

impl Pairs for Fan<'_> {
    #[inline(always)]
    fn relative(&self, corner: usize, axis: usize) -> f32x8 {
        let views = &self.ready.views;
        lanes::reorder_f32(self.triangle.corners[corner], views.axes[axis]) - views.origin[axis]
    }

    #[inline(always)]
    fn shear(&self) -> [f32x8; 3] {
        self.ready.views.shear
    }

    #[inline(always)]
    fn entry(&self) -> f32x8 {
        self.entry
    }

    #[inline(always)]
    fn pair(&self, lane: usize) -> ([[f32; 3]; 3], Ray) {
        ([0, 1, 2].map(|i| self.triangle.corner(i)), self.ready.rays.at(lane))
    }
}
