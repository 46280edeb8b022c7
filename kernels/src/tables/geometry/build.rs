//! From triangles to the tree: a good binary tree by surface area (obvhs), of which the best nodes of eight are made
//! ([`collapse`](super::collapse)).
//!
//! **Depth.** Rays keep a stack of fixed size, so the tree must not be deeper than [`DEPTH`]. A pathological binary
//! tree is: below [`OPENED`] levels a subtree is cut into eight equal parts until they fit in leaves, which takes
//! `log8(2^31 / 8) < 10` levels at most, and `OPENED + 10 = DEPTH`.

use core::ops::Range;
use core::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::collapse::Collapse;
use super::facets::Facet;
use super::groups::Groups;
use super::nodes::{Child, DEPTH, Leaf, Node, Tree};
use super::pages::Pages;
use crate::lanes::LANES;

/// Levels in which nodes of the binary tree are opened.
const OPENED: usize = DEPTH - 10;

/// How to build where no boxes are equal: in the least time, with twice as many boxes moved to better places afterwards
/// as in the preset. Presets that take longer make no cheaper trees of eight. A leaf of the preset is entered half
/// again as often as one of these, and on the way to it a ray sees hardly fewer boxes.
const APART: BvhBuildParams =
    BvhBuildParams { collapse_traversal_cost: 1.5, reinsertion_batch_ratio: 0.02, ..BvhBuildParams::very_fast_build() };
/// How to build over groups of more than one triangle: each has a leaf of its own.
const ALONE: BvhBuildParams = BvhBuildParams { max_prims_per_leaf: 1, ..APART };

/// Nodes in a page of memory of 4 KiB.
const PAGE: usize = 4096 / size_of::<Node>();

/// The tree over all triangles that have an area.
pub(super) fn tree(positions: &[[f32; 3]], corners: &[[u32; 3]]) -> Tree {
    let triangle = |i: u32| corners[i as usize].map(|corner| positions[corner as usize]);
    assert!(corners.len() <= Child::MOST, "{} triangles, at most {}", corners.len(), Child::MOST);
    let bounded = (0..corners.len() as u32).into_par_iter().filter(|i| has_area(triangle(*i)));
    let groups = Groups::new(bounded.map(|i| (i, bound(triangle(i)))).collect());
    let (binary, order) = match groups.bounds.len() {
        0 | 1 => (single(&groups), groups.order),
        _ => binary(groups),
    };
    widen(&binary, order, triangle)
}

/// The binary tree, and the order of triangles of which its leaves are ranges.
fn binary(groups: Groups) -> (Vec<Bvh2Node>, Vec<u32>) {
    let apart = groups.bounds.len() == groups.order.len();
    let settings = if apart { APART } else { ALONE };
    let mut binary = build_bvh2(&groups.bounds, settings, &mut Duration::default());
    if apart {
        let order = binary.primitive_indices.iter().map(|i| groups.order[*i as usize]).collect();
        return (binary.nodes, order);
    }
    for node in binary.nodes.iter_mut().filter(|node| node.is_leaf()) {
        let range = groups.range(binary.primitive_indices[node.first_index as usize] as usize);
        (node.first_index, node.prim_count) = (range.start, range.end - range.start);
    }
    (binary.nodes, groups.order)
}

fn bound(corners: [[f32; 3]; 3]) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from_array);
    Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
}

/// Whether the corners are not in line; differences and products of f32 are exact in f64, or nearly so.
fn has_area(corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    (b - a).cross(c - a) != DVec3::ZERO
}

/// A tree of one leaf, or of none.
fn single(groups: &Groups) -> Vec<Bvh2Node> {
    groups.bounds.iter().map(|bounds| Bvh2Node::new(*bounds, groups.order.len() as u32, 0)).collect()
}

/// What a lane of a wide node is made of.
#[derive(Clone)]
enum Part {
    /// A node of the binary tree.
    Binary(u32),
    /// A range of the order of triangles: what is cut into equal parts.
    Range(Range<usize>),
}

/// A part that becomes an inner node.
struct Task {
    part: Part,
    /// Surface area of its box, in some unit: how likely a ray comes by.
    area: f32,
    /// Inner nodes above it.
    depth: usize,
    /// Node and lane that lead to it; none for the root.
    parent: Option<(usize, usize)>,
}

/// The tree of eight children per node over the binary tree `binary`, whose leaves are ranges of `order`.
fn widen(binary: &[Bvh2Node], order: Vec<u32>, triangle: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> Tree {
    let Some(root) = binary.first() else {
        let (nodes, leaves) = (Pages::new(0, |_| Node::VACANT), Pages::new(0, |_| Leaf::VACANT));
        return Tree { nodes, leaves, bounds: [[0.0; 3]; 2], extent: 0.0, facets: Vec::new() };
    };
    let collapse = Collapse::new(binary);
    let (nodes, leaves) = (Vec::with_capacity(binary.len() / 4), Vec::with_capacity(binary.len()));
    let mut widening = Widening { binary, collapse, order, triangle, nodes, leaves };
    widening.run();
    let Widening { nodes, leaves, order, triangle, .. } = widening;
    let leaves = Pages::new(leaves.len(), |i| leaf(&order[leaves[i].clone()], &triangle));
    let nodes = Pages::new(nodes.len(), |i| nodes[i]);
    let bounds = corners_of(root.aabb());
    let extent = bounds.as_flattened().iter().fold(0.0, |extent: f32, coordinate| extent.max(coordinate.abs()));
    let facets = Facet::all(leaves.rows(), extent);
    Tree { nodes, leaves, bounds, extent, facets }
}

struct Widening<'a, F> {
    binary: &'a [Bvh2Node],
    collapse: Collapse<'a>,
    order: Vec<u32>,
    triangle: F,
    nodes: Vec<Node>,
    /// Ranges of the order.
    leaves: Vec<Range<usize>>,
}

impl<F: Fn(u32) -> [[f32; 3]; 3]> Widening<'_, F> {
    /// Makes all nodes, the likeliest descendants of a node in one page with it.
    fn run(&mut self) {
        if let Some(range) = self.leaf_range(&Part::Binary(0)) {
            let mut node = Node::VACANT;
            node.set(0, corners_of(self.binary[0].aabb()), self.push_leaf(range));
            self.nodes.push(node);
            return;
        }
        let mut pages = vec![Task { part: Part::Binary(0), area: 0.0, depth: 0, parent: None }];
        let mut open = Vec::new();
        while let Some(top) = pages.pop() {
            open.push(top);
            for _ in 0..PAGE {
                let likeliest = (0..open.len()).max_by(|a, b| open[*a].area.total_cmp(&open[*b].area));
                let Some(likeliest) = likeliest else { break };
                let task = open.swap_remove(likeliest);
                self.push_node(task, &mut open);
            }
            pages.append(&mut open);
        }
    }

    /// The triangles of a part that becomes a leaf.
    fn leaf_range(&mut self, part: &Part) -> Option<Range<usize>> {
        match part {
            Part::Binary(index) => self.collapse.is_leaf(*index).then(|| self.gather(*index)),
            Part::Range(range) => (range.len() <= LANES).then(|| range.clone()),
        }
    }

    fn push_leaf(&mut self, range: Range<usize>) -> Child {
        self.leaves.push(range);
        Child::leaf(self.leaves.len() - 1)
    }

    /// A node, with its leaves; its inner children are left to do.
    fn push_node(&mut self, Task { part, depth, parent, .. }: Task, open: &mut Vec<Task>) {
        assert!(depth < DEPTH, "a tree of more than {DEPTH} levels");
        let index = self.nodes.len();
        if let Some((node, lane)) = parent {
            self.nodes[node].children[lane] = Child::node(index).bits();
        }
        let parts = match part {
            Part::Binary(root) if depth < OPENED && !self.binary[root as usize].is_leaf() => {
                self.collapse.children(root).into_iter().map(Part::Binary).collect()
            }
            Part::Binary(root) => eighths(self.gather(root)),
            Part::Range(range) => eighths(range),
        };
        let mut node = Node::VACANT;
        for (lane, part) in parts.into_iter().enumerate() {
            let bounds = self.bounds(&part);
            let mut child = Child::node(0);
            match self.leaf_range(&part) {
                Some(range) => child = self.push_leaf(range),
                None => {
                    open.push(Task { area: bounds.half_area(), part, depth: depth + 1, parent: Some((index, lane)) })
                }
            }
            node.set(lane, corners_of(&bounds), child);
        }
        self.nodes.push(node);
    }

    /// The triangles below a binary node, those of several leaves listed once more at the end of the order.
    fn gather(&mut self, root: u32) -> Range<usize> {
        let node = &self.binary[root as usize];
        if node.is_leaf() {
            let first = node.first_index as usize;
            return first..first + node.prim_count as usize;
        }
        let start = self.order.len();
        let mut open = vec![root];
        while let Some(index) = open.pop() {
            let node = &self.binary[index as usize];
            if node.is_leaf() {
                let first = node.first_index as usize;
                self.order.extend_from_within(first..first + node.prim_count as usize);
            } else {
                open.extend([node.first_index + 1, node.first_index]);
            }
        }
        start..self.order.len()
    }

    fn bounds(&self, part: &Part) -> Aabb {
        match part {
            Part::Binary(index) => *self.binary[*index as usize].aabb(),
            Part::Range(range) => {
                let bounds = self.order[range.clone()].iter().map(|i| bound((self.triangle)(*i)));
                bounds.fold(Aabb::empty(), |all, one| all.union(&one))
            }
        }
    }
}

/// The leaf that holds `triangles`, up to eight.
fn leaf(triangles: &[u32], corners: impl Fn(u32) -> [[f32; 3]; 3]) -> Leaf {
    let mut leaf = Leaf::VACANT;
    triangles.iter().enumerate().for_each(|(lane, triangle)| leaf.set(lane, corners(*triangle), *triangle));
    leaf
}

/// Up to eight parts of equal numbers of triangles, of which all but the last are multiples of eight.
fn eighths(range: Range<usize>) -> Vec<Part> {
    let size = range.len().div_ceil(LANES).next_multiple_of(LANES);
    range.clone().step_by(size).map(|start| Part::Range(start..range.end.min(start + size))).collect()
}

fn corners_of(bounds: &Aabb) -> [[f32; 3]; 2] {
    [bounds.min.to_array(), bounds.max.to_array()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A binary tree that is one long chain of `count` leaves.
    fn chain(count: u32) -> Vec<Bvh2Node> {
        let bounds = Aabb { min: Vec3A::ZERO, max: Vec3A::ONE };
        let mut nodes = vec![Bvh2Node::new(bounds, 0, 1)];
        for i in 0..count - 1 {
            let last = i == count - 2;
            nodes.push(Bvh2Node::new(bounds, 1, i));
            nodes.push(Bvh2Node::new(bounds, u32::from(last), if last { count - 1 } else { 2 * i + 3 }));
        }
        nodes
    }

    #[test]
    fn chains_become_trees_of_bounded_depth_that_hold_every_triangle_once() {
        for count in [2, 7, 8, 9, 100, 155, 1000, 100_000] {
            let nodes = chain(count);
            let tree = widen(&nodes, (0..count).collect(), |_| [[0.0; 3], [1.0; 3], [0.0, 1.0, 0.0]]);
            let mut seen = vec![0; count as usize];
            for leaf in tree.leaves.rows() {
                let triangles = leaf.triangles.to_array().into_iter().filter(|triangle| *triangle != u32::MAX);
                triangles.for_each(|triangle| seen[triangle as usize] += 1);
            }
            assert!(seen.iter().all(|times| *times == 1), "{count} triangles");
            assert!(depth(&tree, Child::node(0)) <= DEPTH);
        }
    }

    /// Inner nodes on the longest way down.
    fn depth(tree: &Tree, from: Child) -> usize {
        if from.is_leaf() {
            return 0;
        }
        let node = &tree.nodes.rows()[from.index()];
        let taken = (0..LANES).filter(|lane| node.planes[0][0].to_array()[*lane] < f32::INFINITY);
        1 + taken.map(|lane| depth(tree, Child::from_bits(node.children[lane]))).max().unwrap_or(0)
    }
}
