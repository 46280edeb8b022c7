//! Whether a closed mesh has an inside: sheets without thickness have none.

use std::collections::BTreeMap;

use glam::DVec3;

use super::Corners;
use super::open::place;

/// Distance from a plane, relative to the largest coordinate, below which single precision does not tell a corner from
/// one on it.
const FLAT: f64 = 1e-6;

/// Whether a closed surface of `triangles` has an inside: not if each of them lies on another that faces the other way,
/// nor if all are in a plane.
pub fn has_inside(triangles: &[Corners]) -> bool {
    let left = uncovered(triangles);
    !left.is_empty() && !is_flat(&left)
}

/// The triangles without those that lie on another that faces the other way.
fn uncovered(triangles: &[Corners]) -> Vec<Corners> {
    let mut counts: BTreeMap<_, i64> = BTreeMap::new();
    let side = |corners: &Corners| {
        let places = corners.map(place);
        let mut key = places;
        key.sort_unstable();
        let is_even = (0..3).any(|turn| core::array::from_fn(|i| places[(i + turn) % 3]) == key);
        (key, if is_even { 1 } else { -1 })
    };
    for corners in triangles {
        let (key, sign) = side(corners);
        *counts.entry(key).or_default() += sign;
    }
    triangles.iter().filter(|corners| counts[&side(corners).0] != 0).copied().collect()
}

fn is_flat(triangles: &[Corners]) -> bool {
    let corners = |triangle: &Corners| triangle.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = |triangle: &Corners| {
        let [a, b, c] = corners(triangle);
        (b - a).cross(c - a)
    };
    let by_area = |a: &&Corners, b: &&Corners| normal(a).length_squared().total_cmp(&normal(b).length_squared());
    let Some(largest) = triangles.iter().max_by(by_area) else { return true };
    let (base, normal) = (corners(largest)[0], normal(largest).normalize_or_zero());
    let all = || triangles.iter().flat_map(corners);
    let scale = all().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    all().all(|corner| (corner - base).dot(normal).abs() <= FLAT * scale)
}
