//! The values of bricks with an apron.
//!
//! A brick has 9^3 values, those of its own voxels and the first ones of its neighbours behind, so that all eight
//! corners of an interpolation are in one brick.

use std::collections::HashMap;

use super::bricks::{Leaf, SIDE};

/// Values along the edge of a brick.
pub const STRIDE: usize = SIDE as usize + 1;
/// Values of a brick.
pub const VALUES: usize = STRIDE * STRIDE * STRIDE;

/// Leaves by the places of their bricks.
pub struct Leaves<'a>(HashMap<[i32; 3], &'a Leaf>);

impl<'a> Leaves<'a> {
    /// Those of a grid, no two of which have the same origin.
    pub fn new(leaves: &'a [Leaf]) -> Self {
        let brick_of = |leaf: &Leaf| leaf.origin.map(|component| component.div_euclid(SIDE as i32));
        Self(leaves.iter().map(|leaf| (brick_of(leaf), leaf)).collect())
    }

    /// The bricks that leaves reach into, x first: theirs, and those before, whose aprons have first layers of leaves.
    pub fn bricks(&self) -> Vec<[i32; 3]> {
        let before = |brick: [i32; 3], corner: i32| [0, 1, 2].map(|axis| brick[axis] - (corner >> axis & 1));
        let mut touched: Vec<_> =
            self.0.keys().flat_map(|brick| (0..8).map(move |corner| before(*brick, corner))).collect();
        touched.sort_unstable_by_key(|[x, y, z]| [*z, *y, *x]);
        touched.dedup();
        touched
    }

    /// The values of a brick, x first.
    pub fn values(&self, brick: [i32; 3]) -> [f32; VALUES] {
        let mut values = [0.0; VALUES];
        for corner in 0..8 {
            let offset = [0, 1, 2].map(|axis| corner >> axis & 1);
            let Some(leaf) = self.0.get(&[0, 1, 2].map(|axis| brick[axis] + offset[axis])) else {
                continue;
            };
            // Of a neighbour behind, the first layer alone.
            let side = SIDE as usize;
            let layers = offset.map(|behind| if behind == 1 { side..side + 1 } else { 0..side });
            for (z, y) in layers[2].clone().flat_map(|z| layers[1].clone().map(move |y| (z, y))) {
                for x in layers[0].clone() {
                    values[(z * STRIDE + y) * STRIDE + x] = leaf.values[(z % side * side + y % side) * side + x % side];
                }
            }
        }
        values
    }
}
