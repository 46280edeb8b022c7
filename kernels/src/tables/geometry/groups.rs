//! Triangles of one box, which the builder sees as one.
//!
//! Pairs of equal boxes all look alike to it, so that it merges one after the other and takes quadratic time. Where a
//! sample shows many of them the triangles are sorted by their boxes; equal ones in a row are a group.

use core::ops::Range;
use std::collections::HashSet;

use obvhs::Boundable;
use obvhs::aabb::Aabb;

/// Triangles in the sample, about.
const SAMPLE: usize = 4096;
/// Equal boxes in the sample from which on it pays to sort. One group of some 3000 in a million may be overlooked, and
/// costs the builder a quarter of a second.
const MANY: usize = 4;

/// Triangles of one box.
pub(super) struct Group {
    /// Their place in the order.
    pub range: Range<u32>,
    /// Their box `[m]`.
    pub bounds: Aabb,
}

impl Boundable for Group {
    fn aabb(&self) -> Aabb {
        self.bounds
    }
}

/// All groups.
pub(super) struct Groups {
    /// The triangles, groups in a row.
    pub order: Vec<u32>,
    /// What is built over.
    pub groups: Vec<Group>,
}

impl Groups {
    /// Of triangles and their boxes.
    pub fn new(mut bounded: Vec<(u32, Aabb)>) -> Self {
        let mut sample = HashSet::new();
        let spread = bounded.iter().step_by(bounded.len().div_ceil(SAMPLE).max(1));
        if spread.filter(|(_, bounds)| !sample.insert(key(bounds))).count() >= MANY {
            bounded.sort_unstable_by_key(|(triangle, bounds)| (key(bounds), *triangle));
        }
        let mut groups = Vec::with_capacity(bounded.len());
        let mut start = 0;
        for group in bounded.chunk_by(|(_, a), (_, b)| a == b) {
            let end = start + group.len() as u32;
            groups.push(Group { range: start..end, bounds: group[0].1 });
            start = end;
        }
        Self { order: bounded.into_iter().map(|(triangle, _)| triangle).collect(), groups }
    }
}

/// The box, with an order.
fn key(bounds: &Aabb) -> [u32; 6] {
    let ([a, b, c], [d, e, f]) = (bounds.min.to_array(), bounds.max.to_array());
    [a, b, c, d, e, f].map(f32::to_bits)
}
