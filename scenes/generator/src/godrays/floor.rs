//! The floor: slabs of two kinds of stone, and steps up to an altar.

use glam::DVec3;

use super::dimensions::{HALF_LENGTH, HALF_WIDTH, OUTER};
use crate::{Mesh, shapes};

/// Side of a slab `[m]`.
const SLAB: f64 = 0.84;
/// Half the distance between two slabs, and how much lower the ground is there `[m]`.
const GAP: [f64; 2] = [0.006, 0.02];
/// Height, depth and number of the steps `[m]`.
const STEP: (f64, f64, u32) = (0.16, 0.4, 3);
/// z of the first step, from the middle of the nave `[m]`.
const CHANCEL: f64 = -7.6;
/// Half the width, the height and the depth of the altar, and its distance from the first step `[m]`.
const ALTAR: [f64; 4] = [1.1, 1.0, 0.7, 2.9];

/// The ground below the slabs.
pub fn ground() -> Mesh {
    let [x, z] = [OUTER + 0.3, HALF_LENGTH + 0.3];
    shapes::cuboid(DVec3::new(-x, -0.5, -z), DVec3::new(x, -GAP[1], z))
}

/// The slabs of one kind, like the fields of one colour of a chessboard.
pub fn slabs(kind: i32) -> Mesh {
    let [half_width, half_length] = [OUTER, HALF_LENGTH].map(|half| (half / SLAB).ceil() as i32);
    let places = (-half_width..half_width)
        .flat_map(|i| (-half_length..half_length).map(move |j| [i, j]))
        .filter(|[i, j]| (i + j).rem_euclid(2) == kind);
    Mesh::union(places.map(|[i, j]| {
        let low = DVec3::new(f64::from(i) * SLAB + GAP[0], -0.1, f64::from(j) * SLAB + GAP[0]);
        shapes::cuboid(low, low + DVec3::new(SLAB - 2.0 * GAP[0], 0.1, SLAB - 2.0 * GAP[0]))
    }))
}

/// The steps, each a block up to the east wall, and the altar on them.
pub fn chancel() -> Mesh {
    let (height, tread, count) = STEP;
    let half = HALF_WIDTH + 0.1;
    let steps = (0..count).map(|i| {
        let [top, front] = [f64::from(i + 1) * height, CHANCEL - f64::from(i) * tread];
        shapes::cuboid(DVec3::new(-half, -0.05, -HALF_LENGTH - 0.1), DVec3::new(half, top, front))
    });
    Mesh::union(steps.chain([altar(f64::from(count) * height)]))
}

/// A block and the slab on it.
fn altar(floor: f64) -> Mesh {
    let [half, height, depth, away] = ALTAR;
    let front = CHANCEL - away;
    let block = |half: f64, [low, high]: [f64; 2], over: f64| {
        let low = DVec3::new(-half, floor + low, front - depth - over);
        shapes::cuboid(low, DVec3::new(half, floor + high, front + over))
    };
    Mesh::union([block(half, [-0.05, height - 0.1], 0.0), block(half + 0.12, [height - 0.1, height], 0.1)])
}
