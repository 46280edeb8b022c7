//! Surfaces: indexed triangles, and a tree of boxes over them, which few triangles do without.
//!
//! | what | bytes per triangle |
//! |---|---|
//! | positions | 12 per vertex: 6 in a closed mesh, 36 where nothing is shared |
//! | corners | 12 |
//! | leaves | 320 per 8 triangles and fewer: 40 where full, 60 to 110 as a rule |
//! | nodes | 256 per 8 boxes and fewer, of which 7 are taken as a rule: about 9 |
//!
//! Together about 90 to 160 bytes ([`Geometry::bytes`] says how many); up to [`FEW`] triangles are there once more,
//! without a tree, and with their normals, which take f64 to find. The corners in the leaves repeat the positions,
//! so that a ray meets eight triangles without a gather; the indexed ones serve shading.

mod build;
mod collapse;
mod facets;
mod few;
mod groups;
mod nodes;
mod pages;

pub use facets::{Facet, MOST as MOST_FACETS};
pub use few::{Cluster, FEW, Few, Triangle};
pub use nodes::{Child, DEPTH, Leaf, Node, Tree};
pub use pages::Pages;

use crate::trace::surface;

/// All triangles of the scene, by index.
#[derive(Clone, Debug)]
pub struct Geometry {
    positions: Vec<[f32; 3]>,
    corners: Vec<[u32; 3]>,
    tree: Tree,
    few: Option<Few>,
    /// Unit normals of few triangles.
    normals: Vec<[f32; 3]>,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Index of the triangle.
    pub triangle: u32,
    /// Parameter t of the ray, `(0, max)`: a distance where the direction is a unit vector.
    pub distance: f32,
    /// Weights of the second and of the third corner, `[0, 1]`; the first has the rest.
    pub barycentric: [f32; 2],
}

impl Geometry {
    /// A table of the triangles whose corners are the named `positions` `[m]`, finite and of a size below 10^12.
    ///
    /// Triangles without area are kept in the table, and no ray hits them.
    ///
    /// # Panics
    ///
    /// If a corner names no position.
    pub fn new(positions: Vec<[f32; 3]>, corners: Vec<[u32; 3]>) -> Self {
        let tree = build::tree(&positions, &corners);
        let few = Few::of(&tree);
        let normal = |corners: &[u32; 3]| surface::normal(corners.map(|corner| positions[corner as usize]));
        let normals = if few.is_some() { corners.iter().map(normal).collect() } else { Vec::new() };
        Self { positions, corners, tree, few, normals }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Indices of the corners of triangle `i`.
    #[inline(always)]
    pub fn indices(&self, i: usize) -> [u32; 3] {
        self.corners[i]
    }

    /// The corners of triangle `i` `[m]`.
    #[inline(always)]
    pub fn corners(&self, i: usize) -> [[f32; 3]; 3] {
        self.corners[i].map(|corner| self.positions[corner as usize])
    }

    /// [Unit normal](surface::normal) of triangle `i`, whose corners these are.
    #[inline(always)]
    pub fn normal(&self, i: usize, corners: [[f32; 3]; 3]) -> [f32; 3] {
        self.normals.get(i).copied().unwrap_or_else(|| surface::normal(corners))
    }

    /// Lower and upper corner of the box around all triangles that have an area `[m]`; `None` where there is none.
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        (!self.tree.leaves.rows().is_empty()).then_some(self.tree.bounds)
    }

    /// The tree that rays descend.
    #[inline(always)]
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The triangles that have an area, if they are so few that eight rays at a time need no tree.
    #[inline(always)]
    pub fn few(&self) -> Option<&Few> {
        self.few.as_ref()
    }

    /// Memory of the table in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.corners)
            + size_of_val(self.tree.nodes.rows())
            + size_of_val(self.tree.leaves.rows())
            + self.tree.facets.iter().map(Facet::bytes).sum::<usize>()
            + self.few.as_ref().map_or(0, Few::bytes)
            + size_of_val(&*self.normals)
    }
}
