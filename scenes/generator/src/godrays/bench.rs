//! Benches in rows on both sides of the nave.

use glam::DVec3;

use crate::{Mesh, shapes};

/// Half the length of a bench, and how far its legs stand from its ends `[m]`.
const HALF: [f64; 2] = [1.05, 0.18];
/// Height of a bench and thickness of its boards `[m]`.
const HEIGHT: [f64; 2] = [0.46, 0.05];
/// Half the depth of a seat and of a leg `[m]`.
const DEPTH: [f64; 2] = [0.17, 0.14];
/// From the axis to the middle of a bench `[m]`.
const AISLE: f64 = 2.2;

/// Two benches at every place, from the middle of the nave.
pub fn rows(places: impl Iterator<Item = f64>) -> Mesh {
    let bench = bench();
    Mesh::union(places.flat_map(|z| [-AISLE, AISLE].map(|x| bench.clone().moved(DVec3::new(x, 0.0, z)))))
}

/// A seat on two legs and the board between these, on the origin.
fn bench() -> Mesh {
    let [half, inset] = HALF;
    let [height, board] = HEIGHT;
    let [seat, leg] = DEPTH;
    let block = |[left, right]: [f64; 2], [low, high]: [f64; 2], depth: f64| {
        shapes::cuboid(DVec3::new(left, low, -depth), DVec3::new(right, high, depth))
    };
    let under = height - board;
    let foot = half - inset;
    Mesh::union([
        block([-half, half], [under, height], seat),
        block([-foot, board - foot], [0.0, under + 0.01], leg),
        block([foot - board, foot], [0.0, under + 0.01], leg),
        block([-foot, foot], [under - 0.12, under + 0.01], 0.5 * board),
    ])
}
