//! Making bridges: first how many edges each has, then, bucket by bucket, where their vertices are.

pub mod reference;
pub mod simd;
pub mod walk;

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

/// Places the inserted vertices of every bridge, and says by what weight it was resampled.
///
/// Nothing is drawn for bridges of one edge; their weight is 1.
///
/// **Pieces.** The free walk of N >= 2 edges is one of M^2: each of M alternatives i of its first `N / 2` edges
/// (rounded down), continued by each of M alternatives j of the others. M is [`Bridge::alternatives_of`] N. A piece
/// starts at its own origin along z. Edge `k` (0 .. N, counted along the whole walk) takes block k of `BRIDGE_WALK` at
/// the depth of the start. Its length is `-ln(1 - u)` of the first word, in all alternatives. Unless it is the walk's
/// last, the words from the third on are the cosines of the turn at its end in one alternative each (the inverse of the
/// [phase function](crate::phase)'s distribution); the second is the azimuth of the turn in alternative 0, and those of
/// the others are spread evenly: one more turn / `MOST_ALTERNATIVES` each. Azimuths count in a frame that is that of the
/// axes where the piece begins and is [carried](crate::phase::Deflection::carry) along. The second piece goes on where
/// the first one ends, behind the turn there, the frame carried so far in the place of its axes.
///
/// **Choice.** With S for how well walk (i, j) [suits](super::suit), it is chosen with probability
///
/// ```text
/// p_ij = (1 - e) S_ij / sum of all S + e / M^2,      e = INDIFFERENT;      resampling weight = 1 / (M^2 p_ij)
/// ```
///
/// by the third word u of block N - 1: of the sequence (0, 0), (0, 1), .. (1, 0), (1, 1), .. , the last walk is taken
/// before which the probabilities add up to u at most.
///
/// **Ends.** Where the roll is aligned, the walk's first edge stays the first with the probability
/// [P(first)](super::ends), for the fourth word of block N - 1; otherwise the edges follow each other in the opposite
/// sequence, each in its own direction: vertex y_k becomes y_N - y_{N-k}. At starts on surfaces it stays.
///
/// **Place.** With e the unit vector to the end of the walk, p the unit part of its first edge's direction
/// perpendicular to e, and q = e x p, a walk vertex v becomes `start + s / |end| * ((v.e) w + (v.p) a + (v.q) b)` where
/// w is the axis, and a and b = w x a are unit vectors across it: a has the azimuth `phi + psi` in the frame of the
/// axis, phi being the azimuth of the arriving direction (0 if that lies on the axis), and psi the roll of
/// [`bridge`](super) for u, the third word of block `BRIDGE_COUNT`.
pub type BuildKernel = fn(Step, BuildColumns<'_, '_, Bridge>);
