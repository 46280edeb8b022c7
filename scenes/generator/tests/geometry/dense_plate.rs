//! dense-plate: a square with 13 holes.

use core::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use glam::{DVec2, DVec3};

use crate::{
    glb::File,
    scene::{camera, lights},
    surfaces::{Surface, named},
};

/// Side of the plate `[m]`.
const SIDE: f64 = 5.0 / 3.0;
/// Middles of the holes on the plate (x, t), and their diagonals `[m]`.
const HOLES: [([f64; 2], f64); 13] = [
    ([-0.5, -1.1606], 1.0 / 3.0),
    ([-0.5, -0.6606], 1.0 / 3.0),
    ([-0.5, -0.1606], 1.0 / 3.0),
    ([0.0, -1.1606], 1.0 / 3.0),
    ([0.0, -0.6606], 1.0 / 3.0),
    ([0.0, -0.1606], 1.0 / 3.0),
    ([0.5, -1.1606], 1.0 / 3.0),
    ([0.5, -0.6606], 1.0 / 3.0),
    ([0.5, -0.1606], 1.0 / 3.0),
    ([-0.25, -0.9106], 1.0 / 6.0),
    ([-0.25, -0.4106], 1.0 / 6.0),
    ([0.25, -0.9106], 1.0 / 6.0),
    ([0.25, -0.4106], 1.0 / 6.0),
];
/// The numbers above are rounded to this `[m]`.
const ROUNDING: f64 = 1e-4;

fn plate() -> Surface {
    let mut surfaces = File::read("dense-plate").surfaces();
    surfaces.pop().expect("the plate is last")
}

/// Coordinates on the plate.
fn on_plate(position: DVec3) -> DVec2 {
    DVec2::new(position.x, FRAC_1_SQRT_2 * (position.z - position.y))
}

/// How far a point is outside of all holes, in the metric in which diamonds are balls; negative in a hole.
fn outside_of_holes(point: DVec2) -> f64 {
    let outside =
        |(middle, diagonal): ([f64; 2], f64)| (point - DVec2::from_array(middle)).abs().element_sum() - 0.5 * diagonal;
    HOLES.map(outside).into_iter().fold(f64::INFINITY, f64::min)
}

/// Whether a triangle of the plane holds a point.
fn holds([a, b, c]: [DVec2; 3], point: DVec2) -> bool {
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| (to - from).perp_dot(point - from) >= 0.0)
}

#[test]
fn the_ground_faces_up() {
    let surfaces = File::read("dense-plate").surfaces();
    let ground = named(&surfaces, "ground");
    assert_eq!((ground.albedo, ground.double_sided), ([0.3, 0.8, 0.3], false));
    assert!(ground.faces(DVec3::Y) && ground.spans([-10.0, -1.0, -10.0], [10.0, -1.0, 10.0]));
    assert!((ground.area() - 400.0).abs() < 1e-6);
}

#[test]
fn the_plate_turns_its_back_on_the_light() {
    let plate = plate();
    let normal = DVec3::new(0.0, -1.0, -1.0) / SQRT_2;
    assert_eq!((plate.albedo, plate.double_sided), ([0.1; 3], false));
    assert!(plate.faces(normal));
    let height = |point: DVec3| point.dot(normal) + 0.6985 / SQRT_2;
    assert!(plate.positions.iter().all(|&position| height(position).abs() < 1e-7));
    assert!(height(camera("dense-plate")[0]) > 1.0, "the camera is in front");
    assert!(lights("dense-plate")[0].points().all(|point| height(point) < -1.0), "the light is behind");
}

#[test]
fn the_plate_is_a_square_without_its_holes() {
    let plate = plate();
    let points: Vec<DVec2> = plate.positions.iter().copied().map(on_plate).collect();
    let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    assert!((low - DVec2::new(-0.8333, -1.4939)).abs().max_element() < ROUNDING, "{low}");
    assert!((high - DVec2::new(0.8333, 0.1728)).abs().max_element() < ROUNDING, "{high}");
    let holes: f64 = HOLES.iter().map(|(_, diagonal)| 0.5 * diagonal * diagonal).sum();
    assert!((plate.area() - (SIDE * SIDE - holes)).abs() < 1e-6, "{} m^2", plate.area());
    assert_eq!(plate.triangles.len(), 80, "the fewest that 56 corners and 13 holes allow");
}

#[test]
fn every_point_of_the_square_is_in_one_triangle_or_in_a_hole() {
    let plate = plate();
    let triangles: Vec<[DVec2; 3]> = plate.corners().map(|corners| corners.map(on_plate)).collect();
    for i in 0..400 {
        for j in 0..400 {
            // Not on any edge: the pattern's lines are twelfths, and diagonals between them.
            let [u, v] = [i, j].map(|k| (f64::from(k) + 0.5) / 400.0);
            let point = DVec2::new(SIDE * (u - 0.5) + 1.1e-5, -1.4939 + SIDE * v + 2.3e-5);
            let covers = triangles.iter().filter(|triangle| holds(**triangle, point)).count();
            let outside = outside_of_holes(point);
            let edge = outside.abs().min(v.min(1.0 - v)) < 2.0 * ROUNDING;
            assert!(edge || covers == usize::from(outside > 0.0), "{covers} triangles at {point}");
        }
    }
}

#[test]
fn triangles_meet_along_whole_edges() {
    let plate = plate();
    let edges = plate.edges();
    assert!(edges.values().all(|&count| count == 1));
    let length = |[a, b]: [usize; 2]| (plate.positions[a] - plate.positions[b]).length();
    let open = edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a]));
    let rim: f64 = open.map(|&edge| length(edge)).sum();
    let holes: f64 = HOLES.iter().map(|(_, diagonal)| 4.0 * diagonal / SQRT_2).sum();
    assert!((rim - (4.0 * SIDE + holes)).abs() < 1e-5, "{rim} m of open edges");
}
