//! What is flat: planes in which all triangles lie, where these are few.
//!
//! Rooms, plates and boxes are made of few planes. Most segments of a path in fog lie on one side of all of them, or far
//! from what is there of them. That is found out quickly for eight rays at a time ([`trace::reach`](crate::trace::reach)).

use glam::DVec3;

use super::few::{around, ends};
use super::nodes::Leaf;

/// Most planes that are worth a look before the tree.
pub const MOST: usize = 12;
/// Fewest triangles to a plane, in the mean. Where there are fewer, the tree's boxes say as much.
const FEWEST: usize = 2;
/// Most triangles among which planes are looked for.
const SMALL: usize = 1 << 12;
/// How far corners may be from a plane that they are taken to lie in, in units of the largest coordinate.
const FLAT: f64 = 8.0 * f32::EPSILON as f64;
/// Sine of the angle by which a triangle may lean out of it.
const LEAN: f64 = 1e-3;

/// Triangles in one plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Lower x, y, z, then upper x, y, z of the box around them `[m]`.
    pub planes: [f32; 6],
    /// Unit normal n of the plane.
    pub normal: [f32; 3],
    /// Its offset: n x in the plane `[m]`.
    pub offset: f32,
    /// Bound of |n x - offset| at the triangles' corners `[m]`.
    pub margin: f32,
    /// Largest square of a triangle's longest edge over its area.
    pub aspect: f32,
    /// Whether the box is flat: whatever reaches it crosses the plane.
    pub is_upright: bool,
    /// Indices of the triangles in the table, in no order.
    pub triangles: Vec<u32>,
}

impl Facet {
    /// The planes of the triangles in leaves, whose coordinates have sizes of up to `extent`; none if they are too many
    /// to be worth it.
    pub(super) fn all(leaves: &[Leaf], extent: f32) -> Vec<Self> {
        let count: usize = leaves.iter().map(Leaf::count).sum();
        if count > SMALL {
            return Vec::new();
        }
        let triangle = |leaf: &Leaf, lane| Triangle::new(leaf.at(lane), leaf.triangles.as_array()[lane]);
        let in_leaf = |leaf: &Leaf| (0..leaf.count()).map(|lane| triangle(leaf, lane)).collect::<Vec<_>>();
        let mut triangles: Vec<_> = leaves.iter().flat_map(in_leaf).collect();
        // The plane of a large triangle is known best.
        triangles.sort_by(|a, b| b.area.total_cmp(&a.area));
        let most = MOST.min(count / FEWEST);
        let mut facets: Vec<Self> = Vec::new();
        for triangle in triangles {
            if let Some(facet) = facets.iter_mut().find(|facet| facet.holds(&triangle, extent.into())) {
                facet.add(&triangle);
            } else if facets.len() < most {
                facets.push(Self::of(&triangle));
            } else {
                return Vec::new();
            }
        }
        facets
    }

    fn of(triangle: &Triangle) -> Self {
        let through_zero = Self {
            planes: around(triangle.corners.map(single)),
            normal: triangle.normal.as_vec3().to_array(),
            offset: 0.0,
            // No less: with a subnormal number products would be slow.
            margin: f32::MIN_POSITIVE,
            aspect: 0.0,
            is_upright: false,
            triangles: Vec::new(),
        };
        let offset = through_zero.distance(triangle.corners[0]) as f32;
        let mut facet = Self { offset, ..through_zero };
        facet.add(triangle);
        facet
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&*self.triangles)
    }

    /// Signed distance of a point from the plane `[m]`.
    fn distance(&self, point: DVec3) -> f64 {
        DVec3::from(self.normal.map(f64::from)).dot(point) - f64::from(self.offset)
    }

    /// Whether a triangle lies in the plane.
    fn holds(&self, triangle: &Triangle, extent: f64) -> bool {
        let leans = DVec3::from(self.normal.map(f64::from)).cross(triangle.normal).length() > LEAN;
        !leans && triangle.corners.iter().all(|corner| self.distance(*corner).abs() <= FLAT * extent)
    }

    fn add(&mut self, triangle: &Triangle) {
        self.planes = around(ends(self.planes).into_iter().chain(triangle.corners.map(single)));
        let off = triangle.corners.into_iter().map(|corner| self.distance(corner).abs()).fold(0.0, f64::max);
        // Rounded up.
        self.margin = self.margin.max((off as f32).next_up());
        self.aspect = self.aspect.max(triangle.aspect() as f32);
        self.is_upright = (0..3).any(|axis| self.planes[axis] == self.planes[3 + axis]);
        self.triangles.push(triangle.index);
    }
}

fn single(point: DVec3) -> [f32; 3] {
    point.as_vec3().to_array()
}

/// A triangle that looks for its plane.
struct Triangle {
    corners: [DVec3; 3],
    normal: DVec3,
    area: f64,
    index: u32,
}

impl Triangle {
    fn new(corners: [[f32; 3]; 3], index: u32) -> Self {
        let corners = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        let [a, b, c] = corners;
        let across = (b - a).cross(c - a);
        Self { corners, normal: across.normalize_or_zero(), area: 0.5 * across.length(), index }
    }

    /// The square of its longest edge over its area.
    fn aspect(&self) -> f64 {
        let [a, b, c] = self.corners;
        let edges = [b - a, c - b, a - c].map(DVec3::length_squared);
        edges.into_iter().fold(0.0, f64::max) / self.area
    }
}

#[cfg(test)]
mod tests {
    use super::super::Geometry;
    use super::*;

    /// Rectangles, of a corner and two edges.
    fn rectangles(of: &[[[f32; 3]; 3]]) -> Geometry {
        let sum = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|axis| a[axis] + b[axis]);
        let corners = |[at, u, v]: [[f32; 3]; 3]| [at, sum(at, u), sum(sum(at, u), v), sum(at, v)];
        let indices = |i: u32| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]];
        Geometry::new(of.iter().copied().flat_map(corners).collect(), (0..of.len() as u32).flat_map(indices).collect())
    }

    const FLOOR: [[f32; 3]; 3] = [[-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
    const WALL: [[f32; 3]; 3] = [[-1.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    const ROOF: [[f32; 3]; 3] = [[-1.0, 2.0, 1.0], [2.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    /// In the plane of the floor, apart from it.
    const STEP: [[f32; 3]; 3] = [[3.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn triangles_of_a_plane_are_one_facet() {
        let geometry = rectangles(&[FLOOR, WALL, ROOF, STEP]);
        let facets = &geometry.tree().facets;
        assert_eq!(facets.len(), 3, "{facets:?}");
        let floor = facets.iter().find(|facet| facet.normal[1].abs() == 1.0).expect("a floor");
        assert_eq!((floor.planes, floor.offset), ([-1.0, 0.0, -1.0, 4.0, 0.0, 1.0], 0.0));
        assert!(floor.margin < 1e-30 && floor.aspect == 4.0 && floor.is_upright, "{floor:?}");
        let roof = facets.iter().find(|facet| facet.planes[4] == 3.0).expect("a roof");
        let leans = (roof.normal[1] + roof.normal[2]).abs() < 1e-6;
        assert!(leans && roof.margin < 1e-6 && !roof.is_upright, "{roof:?}");
    }

    #[test]
    fn where_planes_are_many_there_are_no_facets() {
        let stairs = |steps: usize| -> Vec<_> {
            (0..steps).map(|i| FLOOR.map(|v| if v == FLOOR[0] { [v[0], 0.1 * i as f32, v[2]] } else { v })).collect()
        };
        assert_eq!(rectangles(&stairs(MOST)).tree().facets.len(), MOST);
        assert_eq!(rectangles(&stairs(MOST + 1)).tree().facets.len(), 0);
        assert_eq!(Geometry::new(Vec::new(), Vec::new()).tree().facets.len(), 0);
        let lone = Geometry::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        assert_eq!(lone.tree().facets.len(), 0, "its box says as much");
    }
}
