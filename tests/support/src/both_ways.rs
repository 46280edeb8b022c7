//! Eight rays at a time, with a tree and without: hits must be the same bits as one ray's through the tree.

use fogbow_kernels::lanes::{self, LANES};
use fogbow_kernels::tables::geometry::{Few, Geometry, TriangleHit};
use fogbow_kernels::trace::reach::Reach;
use fogbow_kernels::trace::{self, Hits, Ray, Rays, Search, ThroughTree};
use fogbow_kernels::vec3::Vec3x8;
use wide::{f32x8, u32x8};

/// Lanes in which rays are, in turn.
type Order = [usize; LANES];

/// What is in dead lanes, in turn: nothing of it may show.
const POISON: [f32; 3] = [f32::NAN, f32::INFINITY, -3e38];

/// Rays by eight, poison in the lanes that are left.
pub fn batches(rays: &[Ray]) -> Vec<(Rays, u32)> {
    rays.chunks(LANES).map(|rays| batch(rays, [0, 1, 2, 3, 4, 5, 6, 7], f32::NAN)).collect()
}

/// Up to eight rays in the lanes `order[0]`, `order[1]` .., and poison in the others; and which lanes are live.
fn batch(rays: &[Ray], order: Order, poison: f32) -> (Rays, u32) {
    let dead = Ray { origin: [poison; 3], direction: [poison; 3], max: poison };
    let mut lane_rays = [dead; LANES];
    let places = order.iter().take(rays.len());
    places.clone().zip(rays).for_each(|(lane, ray)| lane_rays[*lane] = *ray);
    let row = |of: fn(&Ray) -> f32| f32x8::new(lane_rays.each_ref().map(of));
    let origin = Vec3x8::new(row(|ray| ray.origin[0]), row(|ray| ray.origin[1]), row(|ray| ray.origin[2]));
    let direction = Vec3x8::new(row(|ray| ray.direction[0]), row(|ray| ray.direction[1]), row(|ray| ray.direction[2]));
    (Rays { origin, direction, max: row(|ray| ray.max) }, places.fold(0, |live, lane| live | 1 << lane))
}

/// The hit of one lane.
fn hit(hits: &Hits, lane: usize) -> Option<TriangleHit> {
    let at = |row: f32x8| row.to_array()[lane];
    let (triangle, barycentric) = (hits.triangle.to_array()[lane], [at(hits.second), at(hits.third)]);
    (lanes::bits(hits.met) >> lane & 1 == 1).then(|| TriangleHit { triangle, distance: at(hits.distance), barycentric })
}

/// Everything in bits, so that zeros of different signs differ, too.
fn bits(hit: Option<TriangleHit>) -> Option<[u32; 4]> {
    let TriangleHit { triangle, distance, barycentric: [u, v] } = hit?;
    Some([triangle, distance.to_bits(), u.to_bits(), v.to_bits()])
}

/// Asserts that both ways find what single rays find: the closest hits, whether there are any, and whether there are
/// any but the closest; with every number of live lanes, in several orders.
///
/// # Panics
///
/// Where any bit differs.
pub fn assert_same_both_ways(name: &str, geometry: &Geometry, rays: &[Ray]) {
    let few = Few::new(geometry.tree());
    for (i, rays) in rays.chunks(LANES).enumerate() {
        let rays = &rays[..if i % 4 == 0 { rays.len() } else { rays.len().min(1 + i % LANES) }];
        let order = core::array::from_fn(|place| (place * [1, 3, 5, 7][i % 4] + i / 4) % LANES);
        let (batch, live) = batch(rays, order, POISON[i % POISON.len()]);
        assert_same(&format!("{name}, without a tree"), geometry, &few, rays, (&batch, live, order));
        assert_same(
            &format!("{name}, through the tree"),
            geometry,
            &ThroughTree(geometry),
            rays,
            (&batch, live, order),
        );
        assert_same_by_facet(name, geometry, &few, rays, (&batch, live, order));
        assert_same_hidden(name, geometry, rays, (&batch, live, order));
    }
}

fn assert_same(
    name: &str,
    geometry: &Geometry,
    search: &impl Search,
    rays: &[Ray],
    (batch, live, order): (&Rays, u32, Order),
) {
    let hits = search.closest(batch, live);
    let closest: Vec<_> = rays.iter().map(|ray| trace::closest(geometry, ray)).collect();
    for (place, expected) in closest.iter().enumerate() {
        let found = hit(&hits, order[place]);
        assert_eq!(bits(found), bits(*expected), "{name}: {found:?} for {expected:?} on {:?}", rays[place]);
    }
    assert_eq!(lanes::bits(hits.met) & !live, 0, "{name}: dead lanes hit something");
    let near = trace::may_meet(geometry, batch, live);
    assert_eq!(near & !live, 0, "{name}: dead lanes are near something");
    assert_eq!(lanes::bits(hits.met) & !near, 0, "{name}: near {near:08b}, but {hits:?}, of {rays:?}");
}

/// Asserts that rays which are near one facet alone hit there what they hit anywhere.
fn assert_same_by_facet(
    name: &str,
    geometry: &Geometry,
    few: &Few,
    rays: &[Ray],
    (batch, live, order): (&Rays, u32, Order),
) {
    let (facets, Rays { origin, direction, max }) = (&geometry.tree().facets, *batch);
    assert_eq!(few.parts.len(), facets.len(), "{name}");
    let reach = Reach::new(origin, direction, max, few.extent);
    let near: Vec<_> =
        facets.iter().map(|facet| live & lanes::bits(reach.crosses(origin, direction, max, facet))).collect();
    for (k, part) in few.parts.iter().enumerate() {
        let others = (0..near.len()).filter(|other| *other != k).fold(0, |all, other| all | near[other]);
        let alone = near[k] & !others;
        let hits = part.closest(batch, alone);
        for (place, ray) in rays.iter().enumerate().filter(|(place, _)| alone >> order[*place] & 1 == 1) {
            let (found, expected) = (hit(&hits, order[place]), trace::closest(geometry, ray));
            assert_eq!(bits(found), bits(expected), "{name}: {found:?} in facet {k} for {expected:?} on {ray:?}");
        }
    }
}

/// Asserts that of eight rays those hit anything, and anything but the closest, that do so alone.
fn assert_same_hidden(name: &str, geometry: &Geometry, rays: &[Ray], (batch, live, order): (&Rays, u32, Order)) {
    let mut closest = [u32::MAX; LANES];
    for (place, ray) in rays.iter().enumerate() {
        closest[order[place]] = trace::closest(geometry, ray).map_or(u32::MAX, |hit| hit.triangle);
    }
    for spared in [[u32::MAX; LANES], closest] {
        let hidden = trace::hidden(geometry, batch, live, u32x8::new(spared));
        let one = |place: usize| trace::any_but(geometry, &rays[place], spared[order[place]]);
        let expected = (0..rays.len()).fold(0, |all, place| all | u32::from(one(place)) << order[place]);
        assert_eq!(hidden, expected, "{name}: {hidden:08b} for {expected:08b}, sparing {spared:?}, of {rays:?}");
    }
}
