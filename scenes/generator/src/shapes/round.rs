//! Round openings in walls along x.

use core::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::wall::wall;
use crate::Mesh;

/// A circle in the plane of a wall.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// Along the wall and up `[m]`.
    pub center: DVec2,
    /// Radius `[m]`.
    pub radius: f64,
}

/// Flat pieces that stand for half a circle.
const HALF_SEGMENTS: u32 = 24;

/// The ring between a circle and one that is `width` larger, of `sides` pieces.
pub fn circle_ring(circle: Circle, width: f64, thickness: f64, sides: u32) -> Mesh {
    let half = 0.5 * thickness;
    let corners = [(0.0, half), (width, half), (width, -half), (0.0, -half)];
    let at = |side: u32, (outward, z): (f64, f64)| {
        let direction = DVec2::from_angle(TAU * f64::from(side) / f64::from(sides));
        (circle.center + (circle.radius + outward) * direction).extend(z)
    };
    let positions: Vec<DVec3> = (0..sides).flat_map(|side| corners.map(|corner| at(side, corner))).collect();
    let mut mesh = Mesh { positions, triangles: vec![] };
    for side in 0..sides {
        let [here, next] = [4 * side, 4 * ((side + 1) % sides)];
        for corner in 0..4 {
            let other = (corner + 1) % 4;
            mesh.quad([here + corner, here + other, next + other, next + corner]);
        }
    }
    mesh
}

/// The part of a wall from `left` to `right` and from `bottom` to `top` around a round opening.
pub fn pierced_wall([left, right]: [f64; 2], [bottom, top]: [f64; 2], hole: Circle, thickness: f64) -> Mesh {
    let chain = |sign: f64| -> Vec<DVec2> {
        let arc = (0..=HALF_SEGMENTS).map(|i| {
            let (sin, cos) = (PI * f64::from(i) / f64::from(HALF_SEGMENTS)).sin_cos();
            let rise = if i % HALF_SEGMENTS == 0 { 0.0 } else { sign * hole.radius * sin };
            hole.center + DVec2::new(-hole.radius * cos, rise)
        });
        let end = |x: f64| [DVec2::new(x, hole.center.y)];
        end(left).into_iter().chain(arc).chain(end(right)).collect()
    };
    let level = |chain: &[DVec2], y: f64| chain.iter().map(|point| DVec2::new(point.x, y)).collect::<Vec<DVec2>>();
    let [below, above] = [chain(-1.0), chain(1.0)];
    Mesh::union([wall(&level(&below, bottom), &below, thickness), wall(&above, &level(&above, top), thickness)])
}
