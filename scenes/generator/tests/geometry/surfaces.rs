//! Measures of surfaces.

use std::collections::HashMap;

use glam::DVec3;

/// An object as a file has it.
pub struct Surface {
    pub name: String,
    pub albedo: [f64; 3],
    pub emission: [f64; 3],
    pub double_sided: bool,
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// Corners of all triangles.
    pub fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|index| self.positions[index]))
    }

    /// Normals of all triangles, as long as their areas.
    pub fn areas(&self) -> impl Iterator<Item = DVec3> {
        self.corners().map(|[a, b, c]| 0.5 * (b - a).cross(c - a))
    }

    /// Sum of all areas.
    pub fn area(&self) -> f64 {
        self.areas().map(DVec3::length).sum()
    }

    /// Volume inside; negative where normals point inward.
    pub fn volume(&self) -> f64 {
        self.corners().map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// The smallest box around it.
    pub fn bounds(&self) -> [DVec3; 2] {
        let first = [self.positions[0]; 2];
        self.positions.iter().fold(first, |[low, high], &position| [low.min(position), high.max(position)])
    }

    /// How often every directed edge occurs.
    pub fn edges(&self) -> HashMap<[usize; 2], u32> {
        let mut edges = HashMap::new();
        for [a, b, c] in &self.triangles {
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        edges
    }

    /// Whether it is made of closed, consistently oriented solids: every edge is passed once in each direction.
    pub fn is_closed(&self) -> bool {
        let edges = self.edges();
        edges.iter().all(|(&[a, b], &count)| count == 1 && edges.get(&[b, a]) == Some(&1))
    }

    /// Whether every triangle faces `normal`.
    pub fn faces(&self, normal: DVec3) -> bool {
        self.areas().all(|area| (area.normalize() - normal).length() < 1e-6)
    }

    /// Whether it fills the box between two corners as far as f32 can tell.
    pub fn spans(&self, low: [f64; 3], high: [f64; 3]) -> bool {
        let [from, to] = self.bounds();
        let near = |a: DVec3, b: [f64; 3]| (a - DVec3::from_array(b)).abs().max_element() < 1e-5;
        near(from, low) && near(to, high)
    }
}

/// The object called `name`.
pub fn named<'a>(surfaces: &'a [Surface], name: &str) -> &'a Surface {
    surfaces.iter().find(|surface| surface.name == name).unwrap_or_else(|| panic!("no {name}"))
}

/// A triangle that a ray meets.
#[derive(Clone, Copy, Debug)]
pub struct Hit<'a> {
    pub distance: f64,
    pub name: &'a str,
    pub front: bool,
}

/// All that a ray meets, in no order.
pub fn hits(surfaces: &[Surface], origin: DVec3, direction: DVec3) -> impl Iterator<Item = Hit<'_>> {
    surfaces.iter().flat_map(move |surface| {
        surface.corners().filter_map(move |corners| {
            let (distance, front) = intersection(corners, origin, direction)?;
            Some(Hit { distance, name: &surface.name, front })
        })
    })
}

/// What a ray meets first.
pub fn first(surfaces: &[Surface], origin: DVec3, direction: DVec3) -> Option<Hit<'_>> {
    hits(surfaces, origin, direction).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Whether nothing stands between two points.
pub fn is_free(surfaces: &[Surface], from: DVec3, to: DVec3) -> bool {
    hits(surfaces, from, to - from).all(|hit| hit.distance >= 1.0)
}

/// How many solids hold a point: a ray leaves so many more than it enters.
pub fn solids_around(surfaces: &[Surface], point: DVec3) -> i32 {
    let direction = DVec3::new(0.36, 0.48, 0.8001);
    hits(surfaces, point, direction).map(|hit| if hit.front { -1 } else { 1 }).sum()
}

/// Distance in units of `direction`, and whether the triangle is seen from its front.
fn intersection([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<(f64, bool)> {
    let [ab, ac, ao] = [b - a, c - a, origin - a];
    let normal = ab.cross(ac);
    let against = -direction.dot(normal);
    let around = ao.cross(direction);
    let [u, v, distance] = [ac.dot(around), -ab.dot(around), ao.dot(normal)].map(|x| x / against);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some((distance, against > 0.0))
}
