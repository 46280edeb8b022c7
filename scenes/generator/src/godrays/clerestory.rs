//! The windows over the arcade at +x, and the wall around them.

use glam::{DVec2, DVec3};

use super::{
    dimensions::{ARCADE, HALF_LENGTH, SILL, TOP, UPPER_WALL},
    side::{JOINT, middles, standing},
};
use crate::{
    Mesh,
    shapes::{self, Circle, Lancet},
};

/// Half the width of a window `[m]`.
const HALF_WIDTH: f64 = 1.25;
/// Where its arcs begin `[m]`.
const SPRING: f64 = 7.1;
/// Radius of its arcs over half its width.
const SHARPNESS: f64 = 1.4;
/// Half the width of the post in the middle `[m]`.
const POST: f64 = 0.07;
/// Width of the other stones `[m]`.
const STONE: f64 = 0.07;
/// Thickness of the stones `[m]`.
const THICKNESS: f64 = 0.12;
/// Radius of the circle in the head of a window, and how far its middle is below the point `[m]`.
const CIRCLE: [f64; 2] = [0.42, 0.75];
/// Side of the iron bars `[m]`.
const IRON: f64 = 0.03;
/// Half the thickness of what fills a window without light `[m]`.
const FILLING: f64 = 0.06;

/// The opening of a window in the bay around `center`.
pub fn window(center: f64) -> Lancet {
    Lancet { center, spring: SPRING, half_width: HALF_WIDTH, sharpness: SHARPNESS }
}

/// The wall: posts between the windows, and the band over them.
pub fn walls() -> Mesh {
    let windows: Vec<Lancet> = middles().map(window).collect();
    let end = HALF_LENGTH + JOINT;
    let band = shapes::lancet_band([-end, end], TOP, &windows, UPPER_WALL);
    let sides = windows.iter().flat_map(|window| [window.center - HALF_WIDTH, window.center + HALF_WIDTH]);
    let edges: Vec<f64> = [-end].into_iter().chain(sides).chain([end]).collect();
    let posts = edges.chunks(2).map(|pair| {
        let half = 0.5 * UPPER_WALL;
        shapes::cuboid(DVec3::new(pair[0], SILL - JOINT, -half), DVec3::new(pair[1], SPRING, half))
    });
    standing(Mesh::union([band].into_iter().chain(posts)))
}

/// What stands in the windows.
pub fn tracery() -> Mesh {
    standing(Mesh::union(middles().map(|x| stones().moved(DVec3::X * x))))
}

/// The panes of all windows, sheets that face the nave.
pub fn panes() -> Mesh {
    let half = HALF_WIDTH + 0.05;
    let height = window(0.0).apex() + 0.05 - SILL;
    let pane = Mesh::parallelogram(DVec3::new(ARCADE, SILL, -half), 2.0 * half * DVec3::Z, height * DVec3::Y);
    Mesh::union(middles().map(|z| pane.clone().moved(DVec3::Z * z)))
}

/// What fills windows without light, from end to end of a part of the nave.
pub fn filling([east, west]: [f64; 2]) -> Mesh {
    let [low, high] = [ARCADE - FILLING, ARCADE + FILLING];
    shapes::cuboid(DVec3::new(low, SILL - JOINT, east), DVec3::new(high, TOP - JOINT, west))
}

/// Two lights under a circle, and two iron bars across.
fn stones() -> Mesh {
    let opening = window(0.0);
    let half_width = 0.5 * (HALF_WIDTH - POST);
    let light = |center: f64| {
        let light = Lancet { center, spring: SPRING - 0.1, half_width, sharpness: 1.6 };
        shapes::lancet_ring(light, [-STONE, 0.0], THICKNESS)
    };
    let [radius, below] = CIRCLE;
    let circle = Circle { center: DVec2::new(0.0, opening.apex() - below), radius };
    let half = 0.5 * THICKNESS;
    Mesh::union([
        shapes::cuboid(DVec3::new(-POST, SILL, -half), DVec3::new(POST, SPRING + 0.3, half)),
        shapes::lancet_ring(opening, [-STONE, 0.05], 1.5 * THICKNESS),
        light(-POST - half_width),
        light(POST + half_width),
        shapes::circle_ring(circle, STONE, THICKNESS, 20),
        iron(1.0 / 3.0),
        iron(2.0 / 3.0),
    ])
}

/// A bar across the opening, at a share of the way from the sill to the spring.
fn iron(share: f64) -> Mesh {
    let half = DVec3::new(HALF_WIDTH + 0.05, 0.5 * IRON, 0.5 * IRON);
    let middle = DVec3::Y * (SILL + share * (SPRING - SILL));
    shapes::cuboid(middle - half, middle + half)
}
