//! Rays against triangles: the closest hit, and whether there is any.
//!
//! Stages ask for eight rays at once. Most flights and shadow segments in fog are near nothing. Comparisons tell this for
//! all eight at once ([`reach`]): with the planes in which everything lies, where these are few
//! ([`Facet`](crate::tables::geometry::Facet)), otherwise with boxes, which rays then have to enter, too ([`cull`]). The
//! closest hits of those that are left are looked for in one of two ways, which is chosen once, outside the loop
//! ([`Search`]):
//!
//! - **Few triangles** meet eight rays each ([`few`]), which wait until they are eight ([`waiting`]), in a pile for each
//!   plane where everything lies in few: lanes are full, and nothing has to be found.
//! - **Many triangles** are in a tree. Rays of a scattering medium are short and point everywhere, so neighbours in a
//!   batch would share few nodes: each goes its own way, eight boxes or eight triangles at a time. In a large tree they
//!   take turns, so that while one waits for memory the others go on ([`through`]).
//!
//! Shadow segments are done at the first hit, and go through the tree unless several of eight are near few triangles
//! ([`hidden`]).
//!
//! What is promised:
//!
//! - **Closed meshes do not leak.** Two triangles that share an edge decide about it in the same arithmetic, so that no
//!   ray passes between them, and boxes are as much wider as triangles may be misplaced by rounding ([`ray`]).
//! - **The tree does not show.** A hit is a function of ray and triangle alone, on equal distances the smaller index
//!   wins, and no box that contains a winner is passed by. With or without a tree, hits are the same bits. `any` is
//!   `closest(..).is_some()`.
//! - **No length is built in.** There is no epsilon: rays start beyond the surface they leave by the bound of the
//!   position's rounding ([`surface`]).
//!
//! Both sides of a triangle are hit.

pub mod bodies;
pub mod cull;
pub mod few;
pub mod ray;
pub mod rays;
pub mod reach;
pub mod reference;
pub mod search;
pub mod simd;
pub mod surface;
pub mod through;
pub mod triangles;
pub mod waiting;
pub mod walk;

pub use cull::may_meet;
pub use rays::{Rays, Slabs};
pub use search::{Hits, Search, ThroughTree, hidden};
pub use simd::{any, any_but, closest};
pub use waiting::{Waited, Waiting};

/// A ray: the points `origin + t direction` for t in `(0, max)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts `[m]`, within 10^12 of zero.
    pub origin: [f32; 3],
    /// Where it goes, of any length from 10^-12 to 10^12 `[m]`; t counts in it. A ray of no direction meets nothing.
    pub direction: [f32; 3],
    /// Bound of t, exclusive, > 0; may be infinite.
    pub max: f32,
}
