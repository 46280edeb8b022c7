//! Few triangles, as eight rays at a time meet them: one after the other, with a box around each and around neighbours.

use wide::f32x8;

use super::facets::Facet;
use super::nodes::{Leaf, Tree};

/// Most triangles for which full lanes do without a tree. With more of them it is as fast (BENCHMARKS.md, *Few
/// triangles*).
pub const FEW: usize = 96;

/// The triangles of a tree without its inner nodes.
#[derive(Clone, Debug)]
pub struct Few {
    /// Neighbours: what was a leaf.
    pub clusters: Vec<Cluster>,
    /// Size of the largest coordinate `[m]`.
    pub extent: f32,
    /// The triangles of each [facet](super::Facet) by themselves; none where there are no facets, and in the parts.
    pub parts: Vec<Self>,
}

/// Up to eight neighbours.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// Lower x, y, z, then upper x, y, z of the box around them `[m]`.
    pub planes: [f32; 6],
    /// The neighbours.
    pub triangles: Vec<Triangle>,
}

/// A triangle.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Lower x, y, z, then upper x, y, z of its box `[m]`.
    pub planes: [f32; 6],
    /// Index of the triangle in the table.
    pub index: u32,
    /// By corner: x, y, z `[m]`, and five numbers that nobody asks for. Lanes look up the axis that each needs.
    pub corners: [f32x8; 3],
}

impl Few {
    /// The triangles of a tree, however many.
    pub fn new(tree: &Tree) -> Self {
        let whole = Self::among(tree, |_| true);
        let part = |facet: &Facet| Self::among(tree, |index| facet.triangles.contains(&index));
        Self { parts: tree.facets.iter().map(part).collect(), ..whole }
    }

    /// Those of the triangles of a tree that are `kept`, by index.
    fn among(tree: &Tree, kept: impl Fn(u32) -> bool) -> Self {
        let clusters = tree.leaves.rows().iter().filter_map(|leaf| Cluster::new(leaf, &kept)).collect();
        Self { clusters, extent: tree.extent, parts: Vec::new() }
    }

    /// The triangles of a tree if they are few.
    pub(super) fn of(tree: &Tree) -> Option<Self> {
        let is_small = tree.leaves.rows().len() <= FEW;
        (is_small && tree.leaves.rows().iter().map(Leaf::count).sum::<usize>() <= FEW).then(|| Self::new(tree))
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        let triangles: usize = self.clusters.iter().map(|cluster| size_of_val(&*cluster.triangles)).sum();
        let parts: usize = self.parts.iter().map(|part| size_of_val(part) + part.bytes()).sum();
        size_of_val(&*self.clusters) + triangles + parts
    }
}

impl Cluster {
    /// Those of a leaf that are `kept`, if there are any.
    fn new(leaf: &Leaf, kept: impl Fn(u32) -> bool) -> Option<Self> {
        let index = |lane: &usize| leaf.triangles.as_array()[*lane];
        let lanes = (0..leaf.count()).filter(|lane| kept(index(lane)));
        let triangles: Vec<_> = lanes.map(|lane| Triangle::new(leaf.at(lane), index(&lane))).collect();
        let planes = around(triangles.iter().flat_map(|triangle| ends(triangle.planes)));
        (!triangles.is_empty()).then_some(Self { planes, triangles })
    }
}

impl Triangle {
    fn new(corners: [[f32; 3]; 3], index: u32) -> Self {
        let row = |[x, y, z]: [f32; 3]| f32x8::new([x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0]);
        Self { planes: around(corners), index, corners: corners.map(row) }
    }

    /// A corner `[m]`.
    pub fn corner(&self, i: usize) -> [f32; 3] {
        let [x, y, z, ..] = self.corners[i].to_array();
        [x, y, z]
    }
}

/// Lower and upper corner of a box.
pub(super) fn ends([x, y, z, u, v, w]: [f32; 6]) -> [[f32; 3]; 2] {
    [[x, y, z], [u, v, w]]
}

/// Planes of the box around points.
pub(super) fn around(points: impl IntoIterator<Item = [f32; 3]>) -> [f32; 6] {
    let (mut lower, mut upper) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            lower[axis] = lower[axis].min(point[axis]);
            upper[axis] = upper[axis].max(point[axis]);
        }
    }
    let ([x, y, z], [u, v, w]) = (lower, upper);
    [x, y, z, u, v, w]
}
