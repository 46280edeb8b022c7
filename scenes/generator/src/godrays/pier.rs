//! Piers and shafts.

use glam::{DVec2, DVec3};

use crate::{Mesh, shapes};

/// Radius of a pier's core, and its sides `[m]`.
const CORE: (f64, u32) = (0.34, 16);
/// Radius of the shafts around it, and their sides `[m]`.
const SHAFT: (f64, u32) = (0.11, 8);
/// Height of the block under a pier, half its width `[m]`.
const PLINTH: [f64; 2] = [0.25, 0.56];
/// Height of the slab on a pier, half its width `[m]`.
const ABACUS: [f64; 2] = [0.14, 0.52];
/// How deep round parts reach into square ones, so that no light passes between them `[m]`.
const JOINT: f64 = 0.01;
/// Base: how far it stands out, height `[m]`.
const BASE: [[f64; 2]; 4] = [[0.11, 0.0], [0.12, 0.08], [0.04, 0.14], [0.0, 0.20]];
/// Capital: how far it stands out, depth below its top `[m]`. A ring, then a bell that widens.
const CAPITAL: [[f64; 2]; 5] = [[0.0, 0.42], [0.045, 0.38], [0.005, 0.34], [0.03, 0.16], [0.12, 0.0]];

/// A pier on the origin: a core with four shafts around it.
pub fn pier(height: f64) -> Mesh {
    let ends = [PLINTH[0], height - ABACUS[0]];
    let thin = shaft(ends, SHAFT);
    let around = [DVec3::X, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z].map(|side| thin.clone().moved(CORE.0 * side));
    let parts = [block([0.0, ends[0]], PLINTH[1]), block([ends[1], height], ABACUS[1]), shaft(ends, CORE)];
    Mesh::union(parts.into_iter().chain(around))
}

/// Three shafts side by side along z, with a slab on them.
pub fn cluster([foot, top]: [f64; 2]) -> Mesh {
    let neck = top - 0.12;
    let slab = shapes::cuboid(DVec3::new(-0.26, neck, -0.3), DVec3::new(0.15, top, 0.3));
    let single = shaft([foot, neck], (0.1, 8));
    Mesh::union([-0.2, 0.0, 0.2].map(|z| single.clone().moved(DVec3::Z * z)).into_iter().chain([slab]))
}

/// A round shaft on the y axis with base and capital.
fn shaft([foot, neck]: [f64; 2], (radius, sides): (f64, u32)) -> Mesh {
    let point = |outward: f64, y: f64| DVec2::new(radius + outward, y);
    let profile: Vec<DVec2> = [point(BASE[0][0], foot - JOINT)]
        .into_iter()
        .chain(BASE.map(|[outward, above]| point(outward, foot + above)))
        .chain(CAPITAL.map(|[outward, below]| point(outward, neck - below)))
        .chain([point(CAPITAL[4][0], neck + JOINT)])
        .collect();
    shapes::lathe(&profile, sides)
}

fn block([low, high]: [f64; 2], half: f64) -> Mesh {
    shapes::cuboid(DVec3::new(-half, low, -half), DVec3::new(half, high, half))
}
