//! ```text
//! for each cluster whose box any of eight rays reaches:
//!     for each of its triangles whose box any of them reaches, and enters no later than its best hit:
//!         for those that cross the triangle before the best hit: it is the best hit
//! ```
//!
//! 1. Eight rays and one triangle at a time, in the same arithmetic as one ray and eight triangles
//!    ([`triangles`](super::triangles)).
//! 2. What rays do not reach is left out by comparisons ([`reach`](super::reach)).
//! 3. A triangle's own box costs half of what the triangle does, and says where rays enter it, which bounds t anyway.
//! 4. Every ray sees the triangle along its own axes: a corner is a row of numbers, in which lanes look up theirs.

use wide::{f32x8, u32x8};

use super::rays::{Sights, Slabs};
use super::reach::Reach;
use super::search::{Hits, Search};
use super::triangles::{Crossings, Pairs, cross};
use super::{Ray, Rays};
use crate::lanes;
use crate::tables::geometry::{Cluster, Few, Triangle};

impl Search for Few {
    const WAITS: bool = true;

    #[inline(always)]
    fn closest(&self, rays: &Rays, live: u32) -> Hits {
        let slabs = Slabs::new(rays, self.extent);
        let sights = Sights::new(rays, &slabs);
        let among = Among::new(self, &sights, live);
        let mut best = Hits::none(rays.max);
        for cluster in &self.clusters {
            if !among.reaches(cluster) {
                continue;
            }
            for triangle in &cluster.triangles {
                if let Some(crossings) = among.cross(triangle, best.distance) {
                    best.take_nearer(&crossings, triangle.index);
                }
            }
        }
        best
    }
}

impl Few {
    /// Which of the `live` rays hit anything but the triangle `spared`, as bits; `u32::MAX` spares none.
    #[inline(always)]
    pub(super) fn hidden(&self, sights: &Sights<'_>, live: u32, spared: u32x8) -> u32 {
        let mut among = Among::new(self, sights, live);
        let mut hidden = f32x8::ZERO;
        for cluster in &self.clusters {
            if !among.reaches(cluster) {
                continue;
            }
            for triangle in &cluster.triangles {
                if let Some(crossings) = among.cross(triangle, sights.rays.max) {
                    let own = lanes::as_mask(spared.simd_eq(u32x8::splat(triangle.index)));
                    hidden |= !own & crossings.met & crossings.distance.simd_lt(sights.rays.max);
                    among.live &= !hidden;
                }
            }
        }
        lanes::bits(hidden)
    }
}

/// Eight rays among few triangles.
struct Among<'a> {
    sights: &'a Sights<'a>,
    /// Those that look for anything, as a mask.
    live: f32x8,
    reach: Reach<f32x8>,
}

impl<'a> Among<'a> {
    #[inline(always)]
    fn new(few: &Few, sights: &'a Sights<'a>, live: u32) -> Self {
        let live = lanes::mask(live) & sights.views.directed;
        let Rays { origin, direction, max } = *sights.rays;
        Self { sights, live, reach: Reach::new(origin, direction, max, few.extent) }
    }

    /// Whether any ray reaches the box around neighbours. One triangle is no neighbour.
    #[inline(always)]
    fn reaches(&self, cluster: &Cluster) -> bool {
        cluster.triangles.len() == 1 || (self.live & self.reach.overlaps(&cluster.planes)).any()
    }

    /// Where rays cross a triangle with t in `(0, max]`; `None` where none does.
    #[inline(always)]
    fn cross(&self, triangle: &Triangle, max: f32x8) -> Option<Crossings> {
        let reached = self.live & self.reach.overlaps(&triangle.planes);
        if !reached.any() {
            return None;
        }
        let (entry, entered) = self.sights.slabs.enter(&triangle.planes, max);
        let live = reached & entered;
        if !live.any() {
            return None;
        }
        cross(&Fan { triangle, sights: self.sights, entry }, max, live)
    }
}

/// Eight rays and one triangle.
struct Fan<'a> {
    triangle: &'a Triangle,
    sights: &'a Sights<'a>,
    entry: f32x8,
}

impl Pairs for Fan<'_> {
    #[inline(always)]
    fn relative(&self, corner: usize, axis: usize) -> f32x8 {
        let views = &self.sights.views;
        lanes::reorder_f32(self.triangle.corners[corner], views.axes[axis]) - views.origin[axis]
    }

    #[inline(always)]
    fn shear(&self) -> [f32x8; 3] {
        self.sights.views.shear
    }

    #[inline(always)]
    fn entry(&self) -> f32x8 {
        self.entry
    }

    #[inline(always)]
    fn pair(&self, lane: usize) -> ([[f32; 3]; 3], Ray) {
        ([0, 1, 2].map(|i| self.triangle.corner(i)), self.sights.rays.at(lane))
    }
}
