//! Few triangles, as eight rays at a time meet them: one after the other, with a box around each and around neighbours.

use wide::f32x8;

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
        Self { clusters: tree.leaves.rows().iter().map(Cluster::new).collect(), extent: tree.extent }
    }

    /// The triangles of a tree if they are few.
    pub(super) fn of(tree: &Tree) -> Option<Self> {
        let is_small = tree.leaves.rows().len() <= FEW;
        (is_small && tree.leaves.rows().iter().map(Leaf::count).sum::<usize>() <= FEW).then(|| Self::new(tree))
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.clusters) + self.clusters.iter().map(|c| size_of_val(&*c.triangles)).sum::<usize>()
    }
}

impl Cluster {
    fn new(leaf: &Leaf) -> Self {
        let triangle = |lane: usize| Triangle::new(leaf.at(lane), leaf.triangles.to_array()[lane]);
        let triangles: Vec<_> = (0..leaf.count()).map(triangle).collect();
        Self { planes: around(triangles.iter().flat_map(|triangle| ends(triangle.planes))), triangles }
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
