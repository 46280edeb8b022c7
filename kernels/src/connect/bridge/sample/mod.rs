//! Making bridges: first how many edges each has, then, bucket by bucket, where their vertices are.

pub mod reference;
pub mod simd;

use super::Bridge;
use crate::Step;
pub use crate::connect::buckets::{BuildColumns, CountColumns};

/// Draws the number of edges N of every bridge.
///
/// With u, v, w the first, second and fourth uniform of block `BRIDGE_COUNT` at the depth of the start, and `room` as
/// in [`bridge`](super): if `u < defensive`, `N = 1 + floor(v room)`. Else the [table's](super::counts) farther knot in
/// mu_t s is chosen if w is less than the place between the knots, the farther one in gamma if `(u - defensive) / (1 -
/// defensive)` is, and N is the smallest number whose cumulative probability there exceeds v. A bridge of more than
/// `room` edges is marked as dropped.
pub type CountKernel = fn(Step, CountColumns<'_, '_, Bridge>);

/// Places the inserted vertices of every bridge.
///
/// The free walk starts at its own origin along z. Edge `k` (0 .. N) takes block k of `BRIDGE_WALK` at the depth of the
/// start: its length is `-ln(1 - u)` of the first word; unless it is the last, the next two words are cosine (the
/// inverse of the [phase function](crate::phase)'s distribution) and azimuth of the turn at its end, the latter counted
/// in a frame that is that of the axes in the beginning and is [carried](crate::phase::Deflection::carry) along.
///
/// Where the roll is aligned, the walk's first edge stays the first with the probability [P(first)](super::ends), for the
/// fourth word of the last edge's block; otherwise the edges follow each other in the opposite sequence, each in its own
/// direction: vertex y_k becomes y_N - y_{N-k}.
///
/// With e the unit vector to the end of the walk, p the unit part of its first edge's direction perpendicular to e, and
/// q = e x p, a walk vertex v becomes `start + s / |end| * ((v.e) w + (v.p) a + (v.q) b)` where w is the axis, and a
/// and b = w x a are unit vectors across it: a has the azimuth `phi + psi` in the frame of the axis, phi being the
/// azimuth of the arriving direction (0 if that lies on the axis), and psi the roll of [`bridge`](super) for u, the
/// third word of block `BRIDGE_COUNT`.
pub type BuildKernel = fn(Step, BuildColumns<'_, '_, Bridge>);
