//! Triangles of one box, which the builder sees as one.
//!
//! Pairs of equal boxes all look alike to it, so that it merges one after the other and takes quadratic time. Where a
//! sample shows many of them the triangles are sorted by their boxes, and equal ones are a group.

use core::ops::Range;
use std::collections::HashSet;

use obvhs::aabb::Aabb;

/// Triangles in the sample, about.
const SAMPLE: usize = 4096;
/// Equal boxes in the sample from which on it pays to sort. One group of some 3000 in a million may be overlooked, and
/// costs the builder a quarter of a second.
const MANY: usize = 4;

/// All groups.
pub(super) struct Groups {
    /// The triangles, groups in a row.
    pub order: Vec<u32>,
    /// The box of every group `[m]`.
    pub bounds: Vec<Aabb>,
    /// Where every group starts in the order.
    starts: Vec<u32>,
}

impl Groups {
    /// Of triangles and their boxes.
    pub fn new(mut bounded: Vec<(u32, Aabb)>) -> Self {
        let mut sample = HashSet::new();
        let spread = bounded.iter().step_by(bounded.len().div_ceil(SAMPLE).max(1));
        let many = spread.filter(|(_, bounds)| !sample.insert(key(bounds))).count() >= MANY;
        if many {
            bounded.sort_unstable_by_key(|(triangle, bounds)| (key(bounds), *triangle));
        }
        let (mut bounds, mut starts) = (Vec::with_capacity(bounded.len()), Vec::with_capacity(bounded.len()));
        let mut start = 0;
        for group in bounded.chunk_by(|(_, a), (_, b)| many && a == b) {
            bounds.push(group[0].1);
            starts.push(start);
            start += group.len() as u32;
        }
        Self { order: bounded.into_iter().map(|(triangle, _)| triangle).collect(), bounds, starts }
    }

    /// Where a group is in the order.
    pub fn range(&self, group: usize) -> Range<u32> {
        self.starts[group]..self.starts.get(group + 1).copied().unwrap_or(self.order.len() as u32)
    }
}

/// The box, with an order.
fn key(bounds: &Aabb) -> [u32; 6] {
    let ([a, b, c], [d, e, f]) = (bounds.min.to_array(), bounds.max.to_array());
    [a, b, c, d, e, f].map(f32::to_bits)
}
