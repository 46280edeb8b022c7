//! Columns.

use glam::{DVec2, DVec3};

use super::dimensions::COLUMN_SIDES;
use crate::{Mesh, shapes};

/// Height of the square block under a column `[m]`.
const PLINTH: f64 = 0.18;
/// Height of the square slab on a column `[m]`.
const ABACUS: f64 = 0.14;
/// Half the width of that slab: carries piers of 0.8 m and walls of 0.7 m `[m]`.
const ABACUS_HALF_WIDTH: f64 = 0.45;
/// How deep round parts reach into square ones, so that no light passes between them `[m]`.
const JOINT: f64 = 0.01;

/// Base above the plinth: radius over the shaft's, height `[m]`. A torus, a hollow, the foot of the shaft.
const BASE: [[f64; 2]; 7] =
    [[1.32, 0.0], [1.42, 0.04], [1.42, 0.11], [1.30, 0.16], [1.12, 0.20], [1.12, 0.26], [1.0, 0.30]];
/// Capital: radius over the shaft's, depth below the abacus `[m]`. A ring, then a bell that widens.
const CAPITAL: [[f64; 2]; 8] =
    [[0.84, 0.62], [0.96, 0.59], [0.96, 0.54], [0.84, 0.51], [0.88, 0.34], [1.02, 0.18], [1.25, 0.06], [1.42, 0.0]];

/// A column on the origin, with the shaft's `radius` at its foot.
pub fn column(height: f64, radius: f64) -> Mesh {
    let plinth = block(1.5 * radius, 0.0, PLINTH);
    let abacus = block(ABACUS_HALF_WIDTH, height - ABACUS, height);
    Mesh::union([plinth, shapes::lathe(&profile(height, radius), COLUMN_SIDES), abacus])
}

/// The outline of base, shaft and capital. The shaft keeps its width in its lower third and narrows above.
fn profile(height: f64, radius: f64) -> Vec<DVec2> {
    let [foot, neck] = [PLINTH, height - ABACUS];
    let point = |[width, y]: [f64; 2]| DVec2::new(radius * width, y);
    let third = (2.0 * foot + neck) / 3.0;
    [point([BASE[0][0], foot - JOINT])]
        .into_iter()
        .chain(BASE.map(|[width, above]| point([width, foot + above])))
        .chain([point([1.0, third])])
        .chain(CAPITAL.map(|[width, below]| point([width, neck - below])))
        .chain([point([CAPITAL[7][0], neck + JOINT])])
        .collect()
}

fn block(half_width: f64, bottom: f64, top: f64) -> Mesh {
    shapes::cuboid(DVec3::new(-half_width, bottom, -half_width), DVec3::new(half_width, top, half_width))
}
