//! ```text
//! for each start a, counted from the light, near enough:
//!     w, s: axis and distance to the light point
//!     project the vertices between on the axis: t, d = t - t_previous, rho; refuse unless every d > -blur
//!     width_v^2 = c^2 max(slope^2 L_v R_v / (L_v + R_v), grain^2)
//!     r += p_A P_l l_{n-1}^2 / cos_light * seeds / (prod_v mu exp(-tau(Lambda_a)) p_w(a))
//!          * prod_v pi offset_density(width_v, rho_v) * spread_v
//! ```
//!
//! 1. `spread_v = l^2 / (pi phase)` is the same for all starts and is computed once per vertex.
//! 2. Two passes: from the start to the light for projections and L, back again for R and the product. L + R is known
//!    only after the first; R as a difference would cancel, and sums of outer products of the edges, which give R
//!    without a pass, cost more loads and cancel too when edges stand across the axis.
//! 3. rho comes from the component across the axis, not from a difference of squares.
//! 4. `seeds` over the rest of path tracing's density is one exponential; in a homogeneous medium all mu_t^m cancel, and
//!    `tau(Lambda_a) - tau(s)` is left. Detours that long edges make are as large as offsets that far out are rare, more
//!    than f32 holds either way. So every edge gets its share of the exponential, the a-th root: a running product of
//!    factors of order one neither overflows nor vanishes. Where detours are of more than 88 mean free paths per edge it
//!    overflows all the same, and rightly: such paths have no weight.
//! 5. Areas are divided by areas before they are multiplied: a scene in kilometres must not overflow.
//! 6. Starts that are near enough in no lane cost only the test; starts that every lane refuses, the projections up to
//!    there.

use wide::f32x8;

use super::{GGX_WIDTH, Mvnee, Offset, Seeds};
use crate::connect::BLUR;
use crate::connect::suffix::{Arrival, Projection, Suffix};
use crate::media::spectral::Hues;
use crate::media::{AxisX8, MediumX8};
use crate::transcendental::{exp, neg_ln};
use crate::vec3::Vec3x8;

/// Sum of the ratios of all `starts`, counted from the light.
#[inline(always)]
pub fn ratios<M: MediumX8>(
    mvnee: &Mvnee,
    arrival: &Arrival<'_, M>,
    suffix: &mut Suffix<'_>,
    starts: core::ops::RangeInclusive<usize>,
) -> f32x8 {
    match mvnee.offset {
        Offset::Ggx => sum(mvnee, arrival, suffix, starts, GGX_WIDTH as f32, |width, offset, spread, share| {
            let inverse = f32x8::ONE / (width + offset);
            (width * inverse) * (spread * inverse) * share.exp
        }),
        Offset::Gaussian => sum(mvnee, arrival, suffix, starts, 1.0, |width, offset, spread, share| {
            let inverse = f32x8::ONE / (width + width);
            exp(share.log - offset * inverse) * (spread * inverse)
        }),
    }
}

/// The ratios of all starts. Widths are `c` standard deviations; `factor` is what an inserted vertex contributes, pi times the density of its offset times
/// its spread and its share of the exponential, as a function of squared width, squared offset, spread and share:
/// quotients of areas, which no scale of the scene can make overflow.
#[inline(always)]
fn sum<M: MediumX8>(
    mvnee: &Mvnee,
    arrival: &Arrival<'_, M>,
    suffix: &mut Suffix<'_>,
    starts: core::ops::RangeInclusive<usize>,
    c: f32,
    factor: impl Fn(f32x8, f32x8, f32x8, Share) -> f32x8,
) -> f32x8 {
    let longest_squared = f32x8::splat(mvnee.max_distance * mvnee.max_distance);
    let slope_squared = f32x8::splat((c * mvnee.slope) * (c * mvnee.slope));
    let scale = arrival.inverse_area * arrival.last_squared / arrival.cos_light;
    let mut sum = f32x8::ZERO;
    for a in starts {
        let start = suffix.vertices[a];
        let to_light = suffix.vertices[0].position - start.position;
        let distance_squared = to_light.length_squared();
        let possible = start.eligible & distance_squared.simd_le(longest_squared);
        if !possible.any() {
            continue;
        }
        let distance = distance_squared.sqrt();
        let axis = to_light * (f32x8::ONE / distance);
        let line = arrival.medium.axis(start.position, suffix.vertices[0].position, distance);
        let most = f32x8::splat(mvnee.max_depth) * arrival.medium.over_clearest();
        let mut possible = possible;
        if M::VARIES {
            let (even, extinction) = line.even();
            possible &= !even | (extinction * distance).simd_le(most);
            if !possible.any() {
                continue;
            }
        }
        let size = suffix.vertices[0].position.length_squared().sqrt() + distance;
        let Some(axial) = project(suffix, a, axis, [distance, size * BLUR], possible) else { continue };
        let [depth, whole] = flights(mvnee.seeds, &line, &suffix.projections[1..a], distance, most);
        let mut possible = axial.possible;
        if M::VARIES {
            possible &= whole.simd_le(most);
            if !possible.any() {
                continue;
            }
        }

        let way = arrival.way(&start);
        let mut log = way.depth - depth;
        if M::VARIES {
            log += log_extinctions(mvnee.seeds, &line, &suffix.projections[1..a]);
            log -= arrival.medium.log_extinction_along(a - 1, way.log_extinction);
        }
        let share = Share::new(log * f32x8::splat(1.0 / a as f32));
        let mut product = start.inverse_density * share.exp;
        let grain = size * (c * mvnee.offset.grain());
        let (grain_squared, mut after) = (grain * grain, axial.last_squared);
        let widening = slope_squared / axial.total;
        for (vertex, projection) in suffix.vertices[1..a].iter().zip(&suffix.projections[1..a]) {
            let width_squared = (projection.before * (after * widening)).fast_max(grain_squared);
            product *= factor(width_squared, projection.offset_squared, vertex.spread, share);
            after += projection.segment_squared;
        }
        // Beyond all numbers, and perhaps none at all since it met a segment without length. It stands for something huge:
        // on such a detour little else could have been made up for.
        let overflowed = !product.is_finite() & log.is_finite();
        product = overflowed.select(f32x8::splat(f32::MAX), product);
        let mut ratio = scale * start.attempt * product;
        if let Some(hues) = arrival.hues {
            ratio *= seeds(hues, suffix, a, depth);
        }
        sum += possible.select(ratio, f32x8::ZERO);
    }
    sum
}

/// What an edge gets of the exponential.
#[derive(Clone, Copy)]
struct Share {
    log: f32x8,
    exp: f32x8,
}

impl Share {
    #[inline(always)]
    fn new(log: f32x8) -> Self {
        Self { log, exp: exp(log) }
    }
}

/// Least logarithm of an extinction: there are no seeds in vacuum.
const NOWHERE: f32 = -1e4;

/// ln of the extinction at a seed `along` the axis `[m]`.
#[inline(always)]
fn log_extinction(line: &impl AxisX8, along: f32x8) -> f32x8 {
    let extinction = line.extinction(along);
    extinction.simd_gt(f32x8::ZERO).select(-neg_ln(extinction), f32x8::splat(NOWHERE))
}

/// ln of the product of the extinctions that `seeds` were drawn with, which are counted from the light.
#[inline(always)]
fn log_extinctions(how: Seeds, line: &impl AxisX8, seeds: &[Projection]) -> f32x8 {
    let [.., first] = seeds else { return f32x8::ZERO };
    let (even, _) = line.even();
    if how == Seeds::Fast || even.all() {
        return log_extinction(line, first.along) * f32x8::splat(seeds.len() as f32);
    }
    let sum = seeds.iter().fold(f32x8::ZERO, |sum, seed| sum + log_extinction(line, seed.along));
    even.select(log_extinction(line, first.along) * f32x8::splat(seeds.len() as f32), sum)
}

/// The optical depth that the flights between `seeds` pass up to the end of the axis, at `distance` `[m]`, and that of
/// the axis, which is above `most` where it is more: then the first has no meaning.
#[inline(always)]
fn flights<A: AxisX8>(how: Seeds, line: &A, seeds: &[Projection], distance: f32x8, most: f32x8) -> [f32x8; 2] {
    match (how, seeds) {
        (Seeds::Fast, [.., first]) if A::VARIES => {
            let [until, whole] = line.depths(first.along, most);
            [line.extinction(first.along).mul_add(distance - first.along, until), whole]
        }
        _ => [line.depth(most); 2],
    }
}

/// Density of the seeds between start `a` and the light, whose flights pass `depth`, over that of the row's own channel:
/// the mean over the channels for which they may have been drawn.
#[inline(always)]
fn seeds(hues: &Hues, suffix: &Suffix<'_>, a: usize, depth: f32x8) -> f32x8 {
    hues.mean(suffix.shares[a], hues.quotients(f32x8::splat((a - 1) as f32), depth))
}

/// A suffix seen along the axis from its start to its light point.
struct Axial {
    /// Rows that go forward only, and so may have been made by a connection.
    possible: f32x8,
    /// Squared length of the last projected segment [m^2].
    last_squared: f32x8,
    /// Sum of squares of all projected segments, L + R [m^2].
    total: f32x8,
}

/// Fills the projections of the vertices between start `a` and the light, at `distance`, which may be off by `blur`;
/// `None` if every row refuses.
#[inline(always)]
fn project(
    suffix: &mut Suffix<'_>,
    a: usize,
    axis: Vec3x8,
    [distance, blur]: [f32x8; 2],
    possible: f32x8,
) -> Option<Axial> {
    let start = suffix.vertices[a].position;
    let (mut possible, mut along, mut before) = (possible, f32x8::ZERO, f32x8::ZERO);
    for (vertex, projection) in suffix.vertices[1..a].iter().zip(&mut suffix.projections[1..a]).rev() {
        let from_start = vertex.position - start;
        let reached = from_start.dot(axis);
        let segment = reached - along;
        possible &= segment.simd_gt(-blur);
        if !possible.any() {
            return None;
        }
        let segment_squared = segment * segment;
        before += segment_squared;
        *projection = Projection {
            segment_squared,
            before,
            offset_squared: axis.mul_neg_add(reached, from_start).length_squared(),
            along: reached,
        };
        along = reached;
    }
    let last = distance - along;
    possible &= last.simd_gt(-blur);
    let last_squared = last * last;
    possible.any().then(|| Axial { possible, last_squared, total: before + last_squared })
}
