//! Which edges are open.
//!
//! A surface is closed if each of its edges is passed as often from a to b as from b to a.

use std::collections::BTreeMap;

use core::cmp::Ordering;

/// Why triangles bound nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum OpenMesh {
    /// There is no triangle, but for those that are edges or points.
    Empty,
    /// These edges, all that there are, do not have a triangle on either side.
    Edges(Vec<OpenEdge>),
}

/// An edge that is passed more often one way than the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenEdge {
    /// Its ends `[m]`.
    pub ends: [[f32; 3]; 2],
    /// How many triangles pass it from the first end to the second.
    pub there: u32,
    /// How many triangles pass it from the second end to the first.
    pub back: u32,
}

/// The triangles of three different corners, if they are closed.
pub(super) fn closed(triangles: &[[[f32; 3]; 3]]) -> Result<Vec<[[f32; 3]; 3]>, OpenMesh> {
    // -0 becomes 0, so that equal corners have the same bits.
    let triangles = triangles.iter().map(|corners| corners.map(|at| at.map(|x| x + 0.0)));
    let triangles: Vec<_> = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    if triangles.is_empty() {
        return Err(OpenMesh::Empty);
    }
    let open = open_edges(&triangles);
    if open.is_empty() { Ok(triangles) } else { Err(OpenMesh::Edges(open)) }
}

fn open_edges(triangles: &[[[f32; 3]; 3]]) -> Vec<OpenEdge> {
    let mut passed: BTreeMap<[Place; 2], [u32; 2]> = BTreeMap::new();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let [from, to] = [Place(*from), Place(*to)];
            let back = usize::from(to < from);
            passed.entry([from.min(to), from.max(to)]).or_default()[back] += 1;
        }
    }
    let open = passed.into_iter().filter(|(_, [there, back])| there != back);
    open.map(|(ends, [there, back])| OpenEdge { ends: ends.map(|end| end.0), there, back }).collect()
}

/// A position, in the order of its components.
#[derive(Clone, Copy, PartialEq)]
struct Place([f32; 3]);

impl Eq for Place {}

impl Ord for Place {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_axis = self.0.iter().zip(&other.0).map(|(a, b)| a.total_cmp(b));
        by_axis.fold(Ordering::Equal, Ordering::then)
    }
}

impl PartialOrd for Place {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
