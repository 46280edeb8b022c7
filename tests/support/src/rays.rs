//! Whether rays meet what they should: kernel against twin, closed meshes, and rays that leave surfaces.

use fogbow_kernels::lanes;
use fogbow_kernels::tables::geometry::Geometry;
use fogbow_kernels::tables::geometry::TriangleHit;
use fogbow_kernels::trace::{self, Ray, Rays, reference, surface};
use fogbow_kernels::vec3::Vec3x8;
use glam::DVec3;
use wide::f32x8;

use crate::both_ways::assert_same_both_ways;
use crate::meshes::{Mesh, Random, point, ray};
use crate::tolerances::{EDGE, RAY_DISTANCE};

/// What a comparison of rays found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Agreement {
    /// Rays compared.
    pub rays: usize,
    /// Rays that hit.
    pub hits: usize,
    /// Rays that pass an edge, or end, within rounding, and that kernel and twin decided differently.
    pub decisions: usize,
}

/// Largest size of a coordinate of the geometry and of the ray's origin together: what rounding is in proportion to.
fn reach(geometry: &Geometry, ray: &Ray) -> f64 {
    let bounds = geometry.bounds().unwrap_or_default();
    let largest = |numbers: &[f32]| numbers.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
    f64::from(largest(bounds.as_flattened())) + f64::from(largest(&ray.origin))
}

/// Distance of a ray's line from an edge.
fn distance_from_edge(ray: &Ray, a: DVec3, b: DVec3) -> f64 {
    let (origin, direction) = (point(ray.origin), point(ray.direction).normalize());
    let across = |p: DVec3| (p - origin) - (p - origin).dot(direction) * direction;
    let (a, b) = (across(a), across(b));
    let along = if a == b { 0.0 } else { (-a.dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0) };
    (a + along * (b - a)).length()
}

/// Distance of a ray's line from the outline of a triangle.
fn distance_from_outline(corners: [[f32; 3]; 3], ray: &Ray) -> f64 {
    let corners = corners.map(point);
    (0..3).map(|i| distance_from_edge(ray, corners[i], corners[(i + 1) % 3])).fold(f64::INFINITY, f64::min)
}

/// How far rounding may move the distance at which a ray meets a triangle: the more, the more it grazes it.
fn distance_tolerance(corners: [[f32; 3]; 3], ray: &Ray, reach: f64) -> f64 {
    let [a, b, c] = corners.map(point);
    let direction = point(ray.direction);
    let cosine = (b - a).cross(c - a).normalize_or_zero().dot(direction.normalize()).abs();
    RAY_DISTANCE.relative * reach / cosine / direction.length()
}

/// Whether a ray, among eight alike, may meet something.
pub fn may_meet(geometry: &Geometry, ray: &Ray) -> bool {
    let [origin, direction] = [ray.origin, ray.direction].map(Vec3x8::splat);
    let bits = trace::may_meet(geometry, &Rays { origin, direction, max: f32x8::splat(ray.max) }, lanes::ALL);
    assert!(bits == 0 || bits == lanes::ALL, "{ray:?} is not itself in all lanes");
    bits != 0
}

/// Compares the closest hits of rays, and whether there are any, with the twin's: those of single rays, which are the
/// same bits as those of eight.
///
/// # Panics
///
/// Where they differ by more than rounding explains.
pub fn compare(name: &str, mesh: &Mesh, rays: &[Ray]) -> Agreement {
    let geometry = mesh.geometry();
    assert_same_both_ways(name, &geometry, rays);
    let mut agreement = Agreement::default();
    for ray in rays {
        let (found, expected) = (trace::closest(&geometry, ray), reference::closest(&geometry, ray));
        assert!(found.is_none() || may_meet(&geometry, ray), "{name}, {ray:?}: {found:?} is passed by");
        assert_eq!(trace::any(&geometry, ray), found.is_some(), "{name}: any and closest differ on {ray:?}");
        agreement.rays += 1;
        agreement.hits += usize::from(found.is_some());
        if !same(&geometry, ray, found, expected) {
            agreement.decisions += 1;
            let disputed = disputed(found, expected);
            assert!(close(&geometry, disputed, ray, found), "{name}: {found:?}, twin {expected:?} on {ray:?}");
        }
    }
    agreement
}

/// Whether two hits are the same triangle at the same place, or both none.
fn same(geometry: &Geometry, ray: &Ray, found: Option<TriangleHit>, expected: Option<reference::Hit>) -> bool {
    match (found, expected) {
        (None, None) => true,
        (Some(found), Some(expected)) => {
            let tolerance = distance_tolerance(geometry.corners(expected.triangle), ray, reach(geometry, ray));
            found.triangle as usize == expected.triangle
                && (f64::from(found.distance) - expected.distance).abs() <= tolerance
        }
        _ => false,
    }
}

/// The triangle that only one of two different hits knows of: the nearer.
fn disputed(found: Option<TriangleHit>, expected: Option<reference::Hit>) -> usize {
    let distance_found = found.map_or(f64::INFINITY, |hit| f64::from(hit.distance));
    match expected {
        Some(expected) if expected.distance < distance_found => expected.triangle,
        _ => found.map_or(usize::MAX, |hit| hit.triangle as usize),
    }
}

/// Whether rounding decides about the triangle: the ray passes its outline, or meets it at the start or at the end of
/// the ray or of the hit that was found, within tolerance.
fn close(geometry: &Geometry, triangle: usize, ray: &Ray, found: Option<TriangleHit>) -> bool {
    let (corners, reach) = (geometry.corners(triangle), reach(geometry, ray));
    if distance_from_outline(corners, ray) <= EDGE.relative * reach {
        return true;
    }
    let Some([distance, ..]) = reference::plane(corners, ray) else { return false };
    let tolerance = distance_tolerance(corners, ray, reach);
    let end = found.map_or(ray.max, |hit| hit.distance);
    [0.0, ray.max, end].iter().any(|bound| (distance - f64::from(*bound)).abs() <= 2.0 * tolerance)
}

/// How many of `count` rays leave a closed mesh, from anywhere within `radius` of the middle: a third of them anywhere,
/// a third to corners and a third to the middles of edges.
pub fn leaks(mesh: &Mesh, radius: f64, count: usize, seed: u32) -> usize {
    let geometry = mesh.geometry();
    let mut random = Random::new(seed);
    let mut leaks = 0;
    for i in 0..count {
        let origin = if i % 16 < 3 { DVec3::ZERO } else { radius * random.uniforms()[0] * random.direction() };
        let corners = geometry.corners(random.index(geometry.len())).map(point);
        let direction = match i % 3 {
            0 => random.direction(),
            1 => corners[0] - origin,
            _ => (corners[0] + corners[1]) / 2.0 - origin,
        };
        let ray = ray(origin, direction, f64::INFINITY);
        let hit = trace::closest(&geometry, &ray);
        leaks += usize::from(hit.is_none() || !trace::any(&geometry, &ray));
    }
    leaks
}

/// What became of rays that left a closed convex mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Departures {
    /// Rays to the outside that hit the mesh.
    pub returned: usize,
    /// Rays to the inside that hit nothing, or the triangle they left.
    pub lost: usize,
}

/// Sends rays from `count` random points of a closed convex mesh to both sides.
pub fn depart(mesh: &Mesh, count: usize, seed: u32) -> Departures {
    let geometry = mesh.geometry();
    let mut random = Random::new(seed);
    let mut departures = Departures::default();
    for _ in 0..count {
        let triangle = random.index(geometry.len());
        let corners = geometry.corners(triangle);
        let [u, v, ..] = random.uniforms();
        let weights = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let from = surface::points(corners.map(Vec3x8::splat), weights.map(|weight| f32x8::splat(weight as f32)));
        let normal = surface::normal(corners);
        let away = random.direction();
        // Positions of the mesh surround the origin, so that outside is where a normal points away from it.
        let middle = corners.map(point).into_iter().sum::<DVec3>();
        let outside = away.dot(point(normal)) * middle.dot(point(normal)) > 0.0;
        let direction = away.as_vec3().to_array();
        let side = (away.dot(point(normal)) as f32).signum();
        let outwards = Vec3x8::splat(normal.map(|component| side * component));
        let [x, y, z] = surface::leave(&from, outwards).to_arrays();
        let origin = [x[0], y[0], z[0]];
        let hit = trace::closest(&geometry, &Ray { origin, direction, max: f32::INFINITY });
        match (outside, hit) {
            (true, Some(_)) => departures.returned += 1,
            (false, None) => departures.lost += 1,
            (false, Some(hit)) => departures.lost += usize::from(hit.triangle as usize == triangle),
            (true, None) => {}
        }
    }
    departures
}
