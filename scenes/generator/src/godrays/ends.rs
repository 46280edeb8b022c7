//! The walls at the ends: a plain one in the west, one with windows in the east.

use glam::DVec3;

use super::{
    dimensions::{HALF_LENGTH, OUTER, OUTER_WALL, TOP},
    rose::{ROSE, rose},
};
use crate::{
    Mesh,
    shapes::{self, Circle, Lancet},
};

/// Sill of the windows under the rose, and where their arcs begin `[m]`.
const LIGHTS: [f64; 2] = [2.2, 4.3];
/// Half the width of these windows, and the distance between their middles `[m]`.
const LIGHT: [f64; 2] = [0.5, 1.5];
/// Foot of the wall around the rose `[m]`.
const BAND: f64 = 5.5;
/// How far the walls reach sideways `[m]`.
const EDGE: f64 = OUTER + OUTER_WALL;
/// How far panes are behind the middle of the wall `[m]`.
const PANE: f64 = 0.2;
/// From the middle of the nave to the middles of the walls `[m]`.
const MIDDLE: f64 = HALF_LENGTH + 0.5 * OUTER_WALL;

/// Both walls.
pub fn walls() -> Mesh {
    Mesh::union([block([-EDGE, EDGE], [-0.1, TOP]).moved(DVec3::Z * MIDDLE), east().moved(DVec3::NEG_Z * MIDDLE)])
}

/// The stone in the windows of the east.
pub fn tracery() -> Mesh {
    let rings = lights().map(|light| shapes::lancet_ring(light, [-0.08, 0.05], 0.3));
    Mesh::union(rings.into_iter().chain([rose()])).moved(DVec3::NEG_Z * MIDDLE)
}

/// The panes of these windows, sheets that face the nave.
pub fn panes() -> Mesh {
    let pane = |center: f64, half: f64, [low, high]: [f64; 2]| {
        let corner = DVec3::new(center - half, low, -MIDDLE - PANE);
        Mesh::parallelogram(corner, 2.0 * half * DVec3::X, (high - low) * DVec3::Y)
    };
    let lights = lights().map(|light| pane(light.center, light.half_width, [LIGHTS[0], light.apex()]));
    let Circle { center, radius } = ROSE;
    Mesh::union(lights.into_iter().chain([pane(center.x, radius, [center.y - radius, center.y + radius])]))
}

/// Three windows under a rose.
fn east() -> Mesh {
    let [sill, spring] = LIGHTS;
    let sides =
        lights().into_iter().flat_map(|light| [light.center - light.half_width, light.center + light.half_width]);
    let edges: Vec<f64> = [-EDGE].into_iter().chain(sides).chain([EDGE]).collect();
    let posts = edges.chunks(2).map(|pair| block([pair[0], pair[1]], [sill - 0.01, spring]));
    let parts = [
        block([-EDGE, EDGE], [-0.1, sill]),
        shapes::lancet_band([-EDGE, EDGE], BAND, &lights(), OUTER_WALL),
        shapes::pierced_wall([-EDGE, EDGE], [BAND, TOP], ROSE, OUTER_WALL),
    ];
    Mesh::union(parts.into_iter().chain(posts))
}

fn lights() -> [Lancet; 3] {
    let [half_width, apart] = LIGHT;
    [-apart, 0.0, apart].map(|center| Lancet { center, spring: LIGHTS[1], half_width, sharpness: 1.6 })
}

/// A block of a wall.
fn block([left, right]: [f64; 2], [bottom, top]: [f64; 2]) -> Mesh {
    let half = 0.5 * OUTER_WALL;
    shapes::cuboid(DVec3::new(left, bottom, -half), DVec3::new(right, top, half))
}
