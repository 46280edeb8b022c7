//! What eight rays at a time hit, and how they look for it.

use wide::{f32x8, u32x8};

use super::Rays;
use super::cull::near;
use super::rays::Sights;
use super::simd::{any_but_along, closest_along};
use super::triangles::Crossings;
use crate::lanes;
use crate::tables::geometry::Geometry;

/// A way to look for the closest triangle. Both ways find the same bits; stages match on [`Geometry::few`] once, outside
/// their loops, and run a kernel that is generic over this.
pub trait Search {
    /// Whether it is worth it that rays which are near something wait until they are eight ([`Waiting`](super::Waiting)).
    const WAITS: bool;

    /// The closest hits of the `live` rays, with the smallest index among equals.
    fn closest(&self, rays: &Rays, live: u32) -> Hits;
}

/// What eight rays hit; as [`TriangleHit`](crate::tables::geometry::TriangleHit).
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

/// Through the tree, one ray after the other.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne<'a>(pub &'a Geometry);

impl Search for OneByOne<'_> {
    const WAITS: bool = false;

    #[inline(always)]
    fn closest(&self, rays: &Rays, live: u32) -> Hits {
        let mut hits = Hits::none(rays.max);
        let Some((near, slabs)) = near(self.0, rays, live) else { return hits };
        let sights = Sights::new(rays, slabs);
        let mut met = 0;
        for lane in lanes::each(near & lanes::bits(sights.views.directed)) {
            let Some(hit) = closest_along(self.0.tree(), &sights.at(lane)) else { continue };
            met |= 1 << lane;
            hits.triangle.as_mut_array()[lane] = hit.triangle;
            hits.distance.as_mut_array()[lane] = hit.distance;
            [hits.second.as_mut_array()[lane], hits.third.as_mut_array()[lane]] = hit.barycentric;
        }
        Hits { met: lanes::mask(met), ..hits }
    }
}

/// Fewest of eight rays that have to be near something for few triangles to be worth all lanes.
const TOGETHER: u32 = 3;
/// Most triangles per ray that is near something.
const TRIANGLES_PER_RAY: usize = 16;

/// Which of the `live` rays hit anything but the triangle `spared`, as bits; `u32::MAX` spares none. Those that are near
/// something go through the tree, one after the other, unless they are several among few triangles.
#[inline(always)]
pub fn hidden(geometry: &Geometry, rays: &Rays, live: u32, spared: u32x8) -> u32 {
    let Some((near, slabs)) = near(geometry, rays, live) else { return 0 };
    let sights = Sights::new(rays, slabs);
    let count = near.count_ones();
    let is_worth = count >= TOGETHER && geometry.len() <= TRIANGLES_PER_RAY * count as usize;
    if let Some(few) = geometry.few().filter(|_| is_worth) {
        return few.hidden(&sights, near, spared);
    }
    let spared = spared.to_array();
    let met = |lane: usize| any_but_along(geometry.tree(), &sights.at(lane), spared[lane]);
    let lanes = lanes::each(near & lanes::bits(sights.views.directed));
    lanes.fold(0, |all, lane| all | u32::from(met(lane)) << lane)
}
