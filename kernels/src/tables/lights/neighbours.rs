//! Emitters in an order in which neighbours follow each other, and groups of them.
//!
//! They are halved again and again at the middle of their longest side. A group is what the first halvings leave, a leaf
//! what the last ones do; both are ranges of the order.

use glam::DVec3;

use super::Emitter;

/// Most emitters that are not halved any more.
pub const LEAF: usize = 4;

/// How many of so many are in the first half.
pub fn half(count: usize) -> usize {
    count / 2
}

/// The order of `emitters`, as their indices.
pub fn order(emitters: &[Emitter]) -> Vec<u32> {
    let centers: Vec<DVec3> = emitters.iter().map(|emitter| emitter.bounds().0).collect();
    let mut order: Vec<u32> = (0..emitters.len() as u32).collect();
    sort(&centers, &mut order);
    order
}

fn sort(centers: &[DVec3], order: &mut [u32]) {
    if order.len() <= LEAF {
        return;
    }
    let center = |index: &u32| centers[*index as usize];
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = order.iter().map(center).fold(none, |(low, high), at| (low.min(at), high.max(at)));
    let axis = (high - low).max_position();
    let middle = half(order.len());
    order.select_nth_unstable_by(middle, |a, b| center(a)[axis].total_cmp(&center(b)[axis]).then(a.cmp(b)));
    let (first, second) = order.split_at_mut(middle);
    sort(centers, first);
    sort(centers, second);
}

/// `emitters` in this `order`, in so many groups, a power of two and fewer than there are emitters.
pub fn groups(emitters: &[Emitter], order: &[u32], count: usize) -> Vec<Vec<Emitter>> {
    debug_assert!(count.is_power_of_two() && count < emitters.len(), "{count} groups of {}", emitters.len());
    let mut groups = vec![order];
    while groups.len() < count {
        groups = groups.into_iter().flat_map(|group| <[&[u32]; 2]>::from(group.split_at(half(group.len())))).collect();
    }
    groups.into_iter().map(|group| group.iter().map(|index| emitters[*index as usize]).collect()).collect()
}
