//! Disks and spheres where there are many: groups of neighbours, and a tree of boxes over them.
//!
//! Connections choose among *groups* as among lights, by what all of a group shines, and then one of its bodies in
//! constant time. The *tree* has the same halves as the [groups](super::neighbours), three of them at a time: nodes of
//! eight boxes like those over triangles, and leaves of up to eight bodies, which one ray meets together.

use core::ops::Range;

use glam::DVec3;

use super::Emitter;
use super::neighbours::{self, half};
use crate::lanes::LANES;
use crate::tables::geometry::{Child, Node};
use crate::trace::bodies::BodyLeaf;

/// Most bodies that are lights of their own and need no tree; and most groups, a power of two.
pub const FEW: usize = 16;

/// By how much of its radius the box around a body is larger on every side.
const MARGIN: f64 = 1e-3;

/// A tree over bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTree {
    /// Inner nodes, parents before their children; the first one holds them all.
    pub nodes: Vec<Node>,
    /// Leaves, in the order of their bodies.
    pub leaves: Vec<BodyLeaf>,
    /// Size of the largest coordinate of any box `[m]`.
    pub extent: f32,
}

impl BodyTree {
    /// The tree over `bodies`, which are sorted; none where they are few.
    pub fn new(bodies: &[Emitter]) -> Option<Self> {
        if bodies.len() <= FEW {
            return None;
        }
        let extent = planes(bodies).as_flattened().iter().fold(0.0_f32, |extent, plane| extent.max(plane.abs()));
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new(), extent };
        tree.add(bodies, 0..bodies.len());
        Some(tree)
    }

    /// Adds all that is in a range of bodies.
    fn add(&mut self, bodies: &[Emitter], range: Range<usize>) -> Child {
        if range.len() <= LANES {
            self.leaves.push(BodyLeaf::new(&bodies[range.clone()], range.start as u32));
            return Child::leaf(self.leaves.len() - 1);
        }
        let place = self.nodes.len();
        self.nodes.push(Node::VACANT);
        for (lane, part) in parts(range).into_iter().enumerate() {
            let planes = planes(&bodies[part.clone()]);
            let child = self.add(bodies, part);
            self.nodes[place].set(lane, planes, child);
        }
        Child::node(place)
    }
}

/// A range in up to eight parts: halves of halves of halves, as far as they do not fit a leaf.
fn parts(range: Range<usize>) -> Vec<Range<usize>> {
    let halves = |range: Range<usize>| {
        let middle = range.start + half(range.len());
        if range.len() <= LANES { vec![range] } else { vec![range.start..middle, middle..range.end] }
    };
    (0..3).fold(vec![range], |parts, _| parts.into_iter().flat_map(halves).collect())
}

/// Lower and upper corner of the box around some bodies `[m]`.
fn planes(bodies: &[Emitter]) -> [[f32; 3]; 2] {
    let (low, high) = bodies.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), body| {
        let (center, reach) = (DVec3::from(body.origin.map(f64::from)), reach(body));
        (low.min(center - reach), high.max(center + reach))
    });
    [low, high].map(|corner| corner.as_vec3().to_array())
}

/// How far the box around a body reaches from its centre along each axis `[m]`: for a disk of normal n, `R sqrt(1 - n^2)`.
fn reach(body: &Emitter) -> DVec3 {
    let normal = DVec3::from(body.normal.map(f64::from));
    let across = (1.0 - normal * normal).max(DVec3::ZERO);
    f64::from(body.radius) * (across.map(f64::sqrt) + MARGIN)
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
    use wide::{f32x8, u32x8};

    use super::*;
    use crate::trace::Rays;
    use crate::trace::bodies::{self as trace, Bodies};
    use crate::vec3::Vec3x8;

    fn bodies(count: u32) -> Vec<Emitter> {
        let number = |i: u32, axis: u32| crate::random::uniform(crate::random::words(i, axis, 3, 4)[0]);
        let at = |i: u32| DVec3::new(number(i, 0), 2.0 * number(i, 1), 3.0 * number(i, 2));
        (0..count).map(|i| Emitter::sphere(at(i), 0.01 + 0.05 * number(i, 3), [1.0; 3])).collect()
    }

    #[test]
    fn few_bodies_are_left_alone() {
        let all = bodies(16);
        assert_eq!(grouped(&all), ((0..16).collect(), all.iter().map(|body| vec![*body]).collect()));
        assert!(BodyTree::new(&all).is_none());
    }

    #[test]
    fn groups_are_all_bodies_in_their_order_and_overlap_little() {
        for count in [17, 100, 1000] {
            let all = bodies(count);
            let (order, groups) = grouped(&all);
            assert_eq!(groups.len(), FEW);
            assert_eq!(groups.concat(), order.iter().map(|index| all[*index as usize]).collect::<Vec<_>>());
            let extent = |bodies: &[Emitter]| {
                let [low, high] = planes(bodies);
                (0..3).map(|axis| high[axis] - low[axis]).product::<f32>()
            };
            let parts = groups.iter().map(|group| extent(group)).sum::<f32>();
            assert!(count < 1000 || parts < 2.0 * extent(&all), "{parts} of {}", extent(&all));
        }
    }

    /// The lower and the upper corner of a box.
    type Corners = [[f32; 3]; 2];

    /// Hands the bodies below a child, and the boxes around them, to `leaf`.
    fn visit(tree: &BodyTree, child: Child, boxes: &[Corners], leaf: &mut dyn FnMut(&BodyLeaf, &[Corners])) {
        if child.is_leaf() {
            return leaf(&tree.leaves[child.index()], boxes);
        }
        let node = &tree.nodes[child.index()];
        for lane in 0..LANES {
            let corner = |first: usize| [0, 1, 2].map(|axis| node.planes[axis][first / 3].to_array()[lane]);
            if corner(0)[0] < f32::INFINITY {
                let within = [boxes, &[[corner(0), corner(3)]]].concat();
                visit(tree, Child::from_bits(node.children[lane]), &within, leaf);
            }
        }
    }

    #[test]
    fn every_body_is_in_every_box_above_it_and_there_once() {
        for count in [17, 64, 65, 333, 1000] {
            let all = grouped(&bodies(count)).1.concat();
            let tree = BodyTree::new(&all).expect("many");
            let mut next = 0;
            visit(&tree, Child::node(0), &[], &mut |leaf, boxes| {
                let end = (next + LANES).min(all.len());
                let held = (next + 1..=end).find(|end| *leaf == BodyLeaf::new(&all[next..*end], next as u32));
                let held = next..held.expect("some bodies");
                for (center, radius) in all[held.clone()].iter().map(Emitter::bounds) {
                    for [low, high] in boxes {
                        let holds = |axis: usize| {
                            let (low, high) = (f64::from(low[axis]), f64::from(high[axis]));
                            low <= center[axis] - radius && center[axis] + radius <= high
                        };
                        assert!((0..3).all(holds));
                    }
                }
                next = held.end;
            });
            assert_eq!(next, all.len());
        }
    }

    #[test]
    fn boxes_hold_the_rims_of_disks_and_are_as_flat_as_they_are() {
        for normal in [DVec3::Z, DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.3, -2.0, 0.7), DVec3::new(1e-4, 0.0, 1.0)] {
            let disk = Emitter::disk(DVec3::new(5.0, -2.0, 0.5), normal, 0.25, [1.0; 3]);
            let [low, high] = planes(&[disk]).map(|corner| DVec3::from(corner.map(f64::from)));
            let [center, u, v] = [disk.origin, disk.tangent, disk.bitangent].map(|v| DVec3::from(v.map(f64::from)));
            let rim = (0..360).map(|degree| {
                let (sin, cos) = f64::from(degree).to_radians().sin_cos();
                center + 0.25 * (cos * u + sin * v)
            });
            let (least, most) =
                rim.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
            assert!(low.cmplt(least).all() && most.cmplt(high).all(), "{normal}");
            let margin = 2.1 * MARGIN * 0.25;
            assert!(((high - low) - (most - least)).cmplt(DVec3::splat(margin)).all(), "{normal}");
        }
    }

    #[test]
    fn a_ray_finds_in_the_tree_what_it_finds_among_all() {
        let all = grouped(&bodies(333)).1.concat();
        // Some are disks.
        let disk = |body: &Emitter| Emitter::disk(body.bounds().0, DVec3::new(1.0, 0.3, -0.5), 0.06, [1.0; 3]);
        let all: Vec<Emitter> =
            all.iter().enumerate().map(|(i, body)| if i % 3 == 0 { disk(body) } else { *body }).collect();
        let tree = BodyTree::new(&all).expect("many");
        let (mut met, mut crossed) = (0, 0);
        for i in 0..2000 {
            let ends = [0, 1].map(|end| {
                let words = crate::random::words(i, end, 5, 6);
                DVec3::from([0, 1, 2].map(|axis| crate::random::uniform(words[axis]))) * DVec3::new(1.0, 2.0, 3.0)
            });
            let [from, to] = ends.map(|end| end.as_vec3().to_array());
            let direction = (ends[1] - ends[0]).normalize().as_vec3().to_array();
            let max = if i % 2 == 0 { f32::INFINITY } else { 0.7 };
            let [origin, direction] = [from, direction].map(Vec3x8::splat);
            let rays = Rays { origin, direction, max: f32x8::splat(max) };
            let distances =
                all.iter().map(|body| Bodies::one(body).meet(body.shape, origin, direction, rays.max).to_array()[0]);
            let nearest = (0..).zip(distances).filter(|(_, distance)| *distance < max);
            let nearest = nearest.min_by(|(_, a), (_, b)| a.total_cmp(b));
            let found = trace::closest(&tree, &rays, 1 << 3);
            let (body, distance) = (found.body.to_array()[3], found.distance.to_array()[3]);
            let found = (distance < max).then_some((body, distance));
            assert_eq!(found, nearest, "ray {i}");
            let [a, b] = [from, to].map(Vec3x8::splat);
            let crosses = |body: &Emitter| Bodies::one(body).cross(body.shape, a, b).any();
            let blockers: Vec<usize> = (0..all.len()).filter(|index| crosses(&all[*index])).collect();
            let own = blockers.first().map_or(7, |index| *index as u32);
            for (own, expected) in [(u32::MAX, !blockers.is_empty()), (own, blockers.len() > 1)] {
                let found = trace::blocked(&tree, a, b, u32x8::splat(own), 1 << 5);
                assert_eq!(found, u32::from(expected) << 5, "segment {i} but {own}");
            }
            (met, crossed) = (met + usize::from(nearest.is_some()), crossed + usize::from(blockers.len() == 1));
        }
        assert!(met > 200 && crossed > 100, "{met}, {crossed}");
    }
}
