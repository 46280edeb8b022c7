//! A closed surface of triangles, which is asked whether points are inside.
//!
//! A point is inside if the surface winds around it: if the signed number of its crossings with a ray from the point
//! on is not 0. All rays go along one axis, so that which triangles they may meet is a matter of the point's place on a
//! plane. That plane is a lattice of *columns*, and each column knows its triangles.
//!
//! ```text
//! in the view along the axis, (x, y) the place on the plane and z along the axis:
//!     column = that of (x, y);   from the highest of its layers down:
//!         z above the layer:   the number is the one between the layers, the same in all of the column
//!         z within the layer:  the number above it, and every crossing of its triangles above z
//!     inside if the number is not 0
//! ```
//!
//! **Layers.** Triangles of a column whose extents along z overlap are a layer. Neighbours share an edge, so that a
//! layer ends only outside of the column, and the number between layers does not depend on where in the column a point
//! is. Most points are between layers and ask no triangle at all.
//!
//! **Watertight.** A triangle's crossings are those of its edges with a second ray, on the plane. Two triangles along
//! an edge ask the same question of the same numbers and take opposite signs (`facet`): over a closed surface they
//! cancel, whatever rounding does and however many corners lie above the point. Only points within rounding of the
//! surface may be on either side.
//!
//! **Any closed surface will do.** It may have several parts, within each other or across: their union is inside. A
//! part within another whose triangles face the other way is a hollow. Outsides may be insides: -1 is not 0 either.

mod columns;
mod edges;
mod facet;
mod fill;
mod overlap;
pub mod reference;
mod simd;

use self::columns::Columns;
use self::facet::{Facet, View};
pub use edges::{OpenEdge, OpenMesh};
pub use fill::Fill;

/// A closed surface of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    /// The smallest box around it `[m]`.
    bounds: [[f32; 3]; 2],
    /// Along which axis rays go.
    view: View,
    /// The triangles, in the view.
    facets: Vec<Facet>,
    columns: Columns,
}

impl ClosedMesh {
    /// The surface of `triangles`, three corners each, `[m]`, all finite. Corners are the same if they are equal.
    ///
    /// # Errors
    /// If there is no triangle, or edges are open.
    ///
    /// # Panics
    /// If there are 2^32 triangles or more.
    pub fn new(triangles: &[[[f32; 3]; 3]]) -> Result<Self, OpenMesh> {
        let triangles = edges::closed(triangles)?;
        let corners = || triangles.as_flattened().iter().copied();
        let bound = |pick: fn(f32, f32) -> f32| {
            let extreme = corners().reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis])));
            extreme.expect("a closed mesh has triangles")
        };
        let bounds = [bound(f32::min), bound(f32::max)];
        let view = View::of(&triangles);
        let facets: Vec<_> = triangles.iter().map(|corners| Facet::new(corners.map(|at| view.place(at)))).collect();
        let columns = Columns::new(&facets, bounds.map(|corner| view.place(corner)));
        Ok(Self { bounds, view, facets, columns })
    }

    /// Whether `triangles` are a closed surface.
    ///
    /// # Errors
    /// If there is no triangle, or edges are open.
    pub fn check(triangles: &[[[f32; 3]; 3]]) -> Result<(), OpenMesh> {
        edges::closed(triangles).map(|_| ())
    }

    /// The smallest box around it, from its low corner to its high one `[m]`.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        self.bounds
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.facets.as_slice()) + self.columns.bytes()
    }

    /// Hands everything that its inside depends on to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        for triangle in self.triangles() {
            digest(bytemuck::cast_slice(triangle.as_flattened()));
        }
    }

    /// Corners of its triangles `[m]`.
    fn triangles(&self) -> impl Iterator<Item = [[f32; 3]; 3]> {
        self.facets.iter().map(|facet| facet.triangle().map(|corner| self.view.undo(corner)))
    }
}

#[cfg(test)]
mod tests;
