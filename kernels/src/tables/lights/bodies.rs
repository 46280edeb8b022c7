//! Disks and spheres where there are many: groups of neighbours, and a tree of boxes over them.
//!
//! Connections choose among *groups* as among lights, by what all of a group shines, and then one of its bodies in
//! constant time. The *tree* has the same halves as the [groups](super::neighbours), down to a few bodies. It is a list of
//! nodes in the order in which they are visited, each of which knows the one behind all that is in its box (a threaded
//! tree; Smits, Efficiency Issues for Ray Tracing, 1998), so that eight rays go through it together and without a stack.

use core::ops::Range;

use glam::DVec3;

use super::Emitter;
use super::neighbours::{self, LEAF, half};

/// Most bodies that are lights of their own and need no tree; and most groups, a power of two.
pub const FEW: usize = 16;

/// By how much of its radius the box around a body is larger.
const MARGIN: f64 = 1e-3;

/// Boxes around bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTree {
    nodes: Vec<Node>,
    /// Size of the largest coordinate of any box `[m]`.
    pub extent: f32,
}

/// A box.
#[derive(Clone, Debug, PartialEq)]
struct Node {
    /// Its lower and upper planes `[m]`.
    planes: [f32; 6],
    /// The node to go on with behind all that is in it.
    beyond: u32,
    /// Bodies to be looked at, if it is not divided; or else none.
    bodies: Range<u32>,
}

impl BodyTree {
    /// The tree over `bodies`, which are sorted; none where they are few.
    pub fn new(bodies: &[Emitter]) -> Option<Self> {
        if bodies.len() <= FEW {
            return None;
        }
        let mut tree = Self { nodes: Vec::new(), extent: 0.0 };
        tree.add(bodies, 0..bodies.len());
        let planes = tree.nodes.iter().flat_map(|node| node.planes);
        tree.extent = planes.fold(0.0, |extent, plane| extent.max(plane.abs()));
        Some(tree)
    }

    /// Adds the node of a range of bodies, and all below it.
    fn add(&mut self, bodies: &[Emitter], range: Range<usize>) {
        let place = self.nodes.len();
        let planes = planes(&bodies[range.clone()]);
        let is_leaf = range.len() <= LEAF;
        let held = if is_leaf { range.start as u32..range.end as u32 } else { 0..0 };
        self.nodes.push(Node { planes, beyond: 0, bodies: held });
        if !is_leaf {
            let middle = range.start + half(range.len());
            self.add(bodies, range.start..middle);
            self.add(bodies, middle..range.end);
        }
        self.nodes[place].beyond = self.nodes.len() as u32;
    }

    /// Meets all bodies in boxes that are entered, in their order; both questions may look at what has been `found` so
    /// far.
    #[inline(always)]
    pub fn visit<F>(&self, found: &mut F, enters: impl Fn(&F, &[f32; 6]) -> bool, mut meet: impl FnMut(&mut F, usize)) {
        let mut place = 0;
        while let Some(node) = self.nodes.get(place) {
            if !enters(found, &node.planes) {
                place = node.beyond as usize;
                continue;
            }
            node.bodies.clone().for_each(|body| meet(found, body as usize));
            place += 1;
        }
    }
}

/// Planes of the box around some bodies.
fn planes(bodies: &[Emitter]) -> [f32; 6] {
    let balls = bodies.iter().map(Emitter::bounds);
    let (low, high) = balls.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (center, radius)| {
        let reach = radius * (1.0 + MARGIN);
        (low.min(center - reach), high.max(center + reach))
    });
    let [low, high] = [low, high].map(|corner| corner.as_vec3().to_array());
    [low[0], low[1], low[2], high[0], high[1], high[2]]
}

/// The order of `bodies` and their groups: as they are, and one each, where they are few.
pub fn grouped(bodies: &[Emitter]) -> (Vec<u32>, Vec<Vec<Emitter>>) {
    if bodies.len() <= FEW {
        return ((0..bodies.len() as u32).collect(), bodies.iter().map(|body| vec![*body]).collect());
    }
    let order = neighbours::order(bodies);
    let groups = neighbours::groups(bodies, &order, FEW);
    (order, groups)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bodies(count: u32) -> Vec<Emitter> {
        let number = |i: u32, axis: u32| crate::random::uniform(crate::random::words(i, axis, 3, 4)[0]);
        let at = |i: u32| DVec3::new(number(i, 0), 2.0 * number(i, 1), 3.0 * number(i, 2));
        (0..count).map(|i| Emitter::sphere(at(i), 0.01 + 0.05 * number(i, 3), [1.0; 3])).collect()
    }

    #[test]
    fn few_bodies_are_left_alone() {
        let all = bodies(16);
        assert_eq!(grouped(&all), ((0..16).collect(), all.iter().map(|body| vec![*body]).collect()));
        assert_eq!(BodyTree::new(&all), None);
    }

    #[test]
    fn groups_are_all_bodies_in_their_order_and_overlap_little() {
        for count in [17, 100, 1000] {
            let all = bodies(count);
            let (order, groups) = grouped(&all);
            assert_eq!(groups.len(), FEW);
            assert_eq!(groups.concat(), order.iter().map(|index| all[*index as usize]).collect::<Vec<_>>());
            let extent = |bodies: &[Emitter]| {
                let [a, b, c, x, y, z] = planes(bodies);
                (x - a) * (y - b) * (z - c)
            };
            let parts = groups.iter().map(|group| extent(group)).sum::<f32>();
            assert!(count < 1000 || parts < 2.0 * extent(&all), "{parts} of {}", extent(&all));
        }
    }

    #[test]
    fn every_body_is_in_every_box_above_it_and_visited_once() {
        let all = grouped(&bodies(333)).1.concat();
        let tree = BodyTree::new(&all).expect("many");
        for (target, body) in all.iter().enumerate() {
            let (center, radius) = body.bounds();
            let holds = |planes: &[f32; 6]| {
                (0..3).all(|axis| {
                    let (low, high) = (f64::from(planes[axis]), f64::from(planes[3 + axis]));
                    low <= center[axis] - radius && center[axis] + radius <= high
                })
            };
            let mut met = Vec::new();
            tree.visit(&mut met, |_, planes| holds(planes), |met, index| met.push(index));
            assert_eq!(met.iter().filter(|index| **index == target).count(), 1);
            assert!(met.is_sorted());
        }
        let mut count = 0;
        tree.visit(
            &mut count,
            |_, _| true,
            |count, index| {
                assert_eq!(*count, index);
                *count += 1;
            },
        );
        assert_eq!(count, all.len());
    }
}
