//! A perforated plate between a light and the camera, over a ground.

use core::f64::consts::FRAC_1_SQRT_2;

use glam::{DVec3, IVec2};

use crate::{Material, Mesh, Model, Object};

/// Unit of the plate's pattern: all corners of plate and holes stand on a lattice of this spacing `[m]`.
pub const UNIT: f64 = 1.0 / 12.0;
/// Half the side of the plate `[UNIT]`.
pub const HALF_SIDE: i32 = 10;
/// Coordinates of the middles of the large holes in both directions of the plate `[UNIT]`.
pub const LARGE_HOLES: [i32; 3] = [-6, 0, 6];
/// Half the diagonal of a large hole `[UNIT]`.
pub const LARGE_HALF_DIAGONAL: i32 = 2;
/// Coordinates of the middles of the small holes in both directions of the plate `[UNIT]`.
pub const SMALL_HOLES: [i32; 2] = [-3, 3];
/// Half the diagonal of a small hole `[UNIT]`.
pub const SMALL_HALF_DIAGONAL: i32 = 1;
/// The plate lies in the plane y + z = `PLANE` `[m]`.
pub const PLANE: f64 = 0.6985;
/// Where the middle of the plate is on the plane's line of steepest descent `[m]`.
pub const MIDDLE: f64 = -0.66055;

/// A side of the plate: two notches between large holes, what is between them and the edge, and a corner of the plate.
/// Turned about the plate's middle, four of them make the rim around the octagons.
const RIM: [[[i32; 2]; 3]; 8] = [
    [[8, -6], [6, -2], [6, -4]],
    [[8, -6], [8, 0], [6, -2]],
    [[8, 0], [6, 4], [6, 2]],
    [[8, 0], [8, 6], [6, 4]],
    [[10, -10], [10, 10], [8, 0]],
    [[10, -10], [8, 0], [8, -6]],
    [[10, 10], [8, 6], [8, 0]],
    [[10, 10], [6, 8], [8, 6]],
];

/// A quarter of the octagon around a small hole, from the hole's middle. Turned about it, four of them make the
/// octagon; its slanted sides are those of the four large holes around it.
const OCTAGON: [[[i32; 2]; 3]; 3] = [[[1, 0], [3, -1], [3, 1]], [[1, 0], [3, 1], [1, 3]], [[1, 0], [1, 3], [0, 1]]];

/// The model.
pub fn model() -> Model {
    let ground = Mesh::parallelogram(DVec3::new(-10.0, -1.0, -10.0), 20.0 * DVec3::Z, 20.0 * DVec3::X);
    Model {
        name: "dense-plate",
        objects: vec![
            Object::new("ground", Material::new("ground", [0.3, 0.8, 0.3]), ground),
            Object::new("plate", Material::grey("plate", 0.1), plate()),
        ],
    }
}

/// The plate: a square with 13 holes and nothing between them but corners of holes, so that no corner lies within the
/// edge of a triangle. 56 corners and 13 holes leave 56 + 2 * 13 - 2 = 80 triangles.
fn plate() -> Mesh {
    let mut lattice = Lattice::default();
    for turns in 0..4 {
        lattice.add(&RIM, IVec2::ZERO, turns);
        for (x, t) in SMALL_HOLES.into_iter().flat_map(|x| SMALL_HOLES.map(|t| (x, t))) {
            lattice.add(&OCTAGON, IVec2::new(x, t), turns);
        }
    }
    lattice.into_mesh()
}

/// Triangles between points of the plate's lattice.
#[derive(Default)]
struct Lattice {
    points: Vec<IVec2>,
    triangles: Vec<[u32; 3]>,
}

impl Lattice {
    /// Adds triangles given from `middle`, turned about it by quarters.
    fn add(&mut self, pattern: &[[[i32; 2]; 3]], middle: IVec2, turns: u32) {
        for corners in pattern {
            let triangle = corners.map(|corner| {
                let turned = (0..turns).fold(IVec2::from_array(corner), |point, _| point.perp());
                self.index(middle + turned)
            });
            self.triangles.push(triangle);
        }
    }

    fn index(&mut self, point: IVec2) -> u32 {
        let found = self.points.iter().position(|&other| other == point);
        found.unwrap_or_else(|| {
            self.points.push(point);
            self.points.len() - 1
        }) as u32
    }

    fn into_mesh(self) -> Mesh {
        Mesh { positions: self.points.into_iter().map(on_plate).collect(), triangles: self.triangles }
    }
}

/// Where a point of the lattice is: x stays, the other coordinate t descends towards the viewer. The normal x cross t
/// is (0, -1, -1) / sqrt 2, away from the light.
fn on_plate(point: IVec2) -> DVec3 {
    let [x, t] = [UNIT * f64::from(point.x), MIDDLE + UNIT * f64::from(point.y)];
    DVec3::new(x, 0.5 * PLANE - FRAC_1_SQRT_2 * t, 0.5 * PLANE + FRAC_1_SQRT_2 * t)
}
