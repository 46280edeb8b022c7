//! Somebody in a hooded habit with a staff, who stands in the light.

use glam::{DVec2, DVec3};

use crate::{Mesh, shapes};

/// The habit from the hem to the point of the hood: radius, height `[m]`.
const HABIT: [[f64; 2]; 14] = [
    [0.34, 0.0],
    [0.33, 0.08],
    [0.28, 0.5],
    [0.235, 0.9],
    [0.22, 1.05],
    [0.25, 1.22],
    [0.265, 1.34],
    [0.24, 1.43],
    [0.165, 1.49],
    [0.145, 1.53],
    [0.155, 1.61],
    [0.14, 1.7],
    [0.08, 1.77],
    [0.0, 1.8],
];
/// Depth of the habit over its width.
const FLATNESS: f64 = 0.72;
/// The staff: radius, height, how far it stands from the middle `[m]`.
const STAFF: [f64; 3] = [0.02, 1.95, 0.39];

/// The figure on the origin.
pub fn figure() -> Mesh {
    let habit = shapes::lathe(&HABIT.map(DVec2::from_array), 24).stretched(DVec3::new(1.0, 1.0, FLATNESS));
    let [radius, height, beside] = STAFF;
    let staff = shapes::lathe(&[DVec2::new(radius, 0.0), DVec2::new(radius, height)], 8);
    Mesh::union([habit, staff.moved(beside * DVec3::X)])
}
