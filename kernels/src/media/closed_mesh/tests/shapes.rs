//! Closed surfaces, with normals outward.

use core::f64::consts::TAU;

use glam::{DMat3, DVec3};

pub type Triangles = Vec<[[f32; 3]; 3]>;

/// A point of a lattice and its triangles.
fn mesh(corners: &[DVec3], triangles: &[[usize; 3]]) -> Triangles {
    triangles.iter().map(|triangle| triangle.map(|corner| corners[corner].as_vec3().to_array())).collect()
}

/// The box between two corners.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Triangles {
    let ends = [low, high];
    let corner = |index: usize| DVec3::from([0, 1, 2].map(|axis| ends[index >> axis & 1][axis]));
    let corners: Vec<_> = (0..8).map(corner).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves: Vec<_> = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh(&corners, &halves)
}

/// The corner of a cube: x, y and z above 0, their sum below 1.
pub fn tetrahedron() -> Triangles {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    mesh(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

/// An octahedron whose sides are divided in two `times` times, with its corners on the unit sphere.
pub fn sphere(times: u32) -> Triangles {
    let signs = (0..8).map(|octant| [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 }));
    let mut sides: Vec<[DVec3; 3]> = signs
        .map(|[x, y, z]: [f64; 3]| {
            let [a, b, c] = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z];
            if x * y * z > 0.0 { [a, b, c] } else { [a, c, b] }
        })
        .collect();
    for _ in 0..times {
        sides = sides.into_iter().flat_map(quarters).collect();
    }
    sides.into_iter().map(|side| side.map(|corner| corner.as_vec3().to_array())).collect()
}

fn quarters([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    // The same whichever end is first.
    let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| (from + to).normalize());
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// Radii of [`torus`].
pub const TORUS: [f64; 2] = [0.7, 0.25];

/// A ring about the z axis, of `around` by `across` quadrilaterals.
pub fn torus(around: usize, across: usize) -> Triangles {
    let corner = |i: usize, j: usize| {
        let [u, v] = [i as f64 / around as f64, j as f64 / across as f64].map(|turns| (TAU * turns).sin_cos());
        let radius = TORUS[0] + TORUS[1] * v.1;
        DVec3::new(radius * u.1, radius * u.0, TORUS[1] * v.0)
    };
    let corners: Vec<_> = (0..around * across).map(|index| corner(index / across, index % across)).collect();
    let index = |i: usize, j: usize| i % around * across + j % across;
    let sides = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let halves = sides.flat_map(|(i, j)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh(&corners, &halves.collect::<Vec<_>>())
}

/// With every corner elsewhere.
pub fn moved(triangles: Triangles, by: impl Fn(DVec3) -> DVec3) -> Triangles {
    let corner = |at: [f32; 3]| by(DVec3::from(at.map(f64::from))).as_vec3().to_array();
    triangles.into_iter().map(|triangle| triangle.map(corner)).collect()
}

/// Turned about all axes, so that no edge is along one.
pub fn turned(triangles: Triangles) -> Triangles {
    let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
    moved(triangles, |at| turn * at)
}

/// With normals inward.
pub fn inverted(triangles: Triangles) -> Triangles {
    triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect()
}

/// With a surface whose corners are as high as they are irregular.
pub fn bumpy(times: u32) -> Triangles {
    let radius = |at: DVec3| 0.6 + 0.2 * (7.0 * at.x).sin() * (5.0 * at.y + 1.0).cos() + 0.15 * (9.0 * at.z).sin();
    moved(sphere(times), |at| at * radius(at))
}
