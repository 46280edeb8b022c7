//! ```text
//! for each start a, counted from the light (N = a edges), within reach:
//!     x = mu_t L, lambda = min(mu_t s, largest mean)
//!     r += p_A P_l mu_t s^3 / cos_light * [ (1 - eps) Poisson(N - 1; lambda) + eps / room ] (N - 1)! e^x / x^N * turn
//!     turn = 4 pi h^{3/2} / (1 - g^2)  (uniform roll),   4 pi sqrt(h h_- h_+) / (1 - g^2)  (aligned roll)
//! ```
//!
//! 1. One start costs two logarithms and two exponentials, whatever lies between it and the light. All lanes have the same
//!    N at a time, so what depends on N alone is a scalar.
//! 2. `(N - 1)! e^x / x^N = exp(N (y - 1 - ln y) + c_N)` with `y = x / N` and `c_N = N - N ln N + ln (N - 1)!`: the exponent
//!    is small where the bridge is likely, and nothing of the size of N ln N cancels.
//! 3. The Poisson term takes its factorial along: `exp(x - lambda + (N - 1) ln (lambda / x) - ln x)`.
//! 4. Sines of the angles to the axis come from what is left of a direction across it; `1 - cos^2` would lose the small
//!    angles on which a forward peak depends.

use wide::f32x8;

use super::{Bridge, LARGEST_MEAN, Roll};
use crate::mis_weight::suffix::{Arrival, Suffix};
use crate::phase::{HenyeyGreensteinX8, PlaneAngle};
use crate::transcendental::{exp, neg_ln};
use crate::vec3x8::Vec3x8;

/// Shortest length by which the axis is normalised `[m]`.
const LEAST_LENGTH: f32 = 1e-30;

/// Sum of the ratios of the starts `nearest ..= farthest`, counted from the light; `room(a)` are the most edges that a
/// bridge from start `a` may have.
#[inline(always)]
pub fn ratios(
    bridge: &Bridge,
    phase: &HenyeyGreensteinX8,
    arrival: &Arrival,
    suffix: &Suffix<'_>,
    starts: core::ops::RangeInclusive<usize>,
    room: impl Fn(usize) -> f32x8,
) -> f32x8 {
    let mut sum = f32x8::ZERO;
    let extinction = arrival.extinction;
    let reach_squared = f32x8::splat(bridge.max_distance * bridge.max_distance);
    let farthest = (*starts.end()).min(bridge.max_inserted.saturating_add(1) as usize);
    for a in *starts.start()..=farthest {
        let start = &suffix.vertices[a];
        let to_light = suffix.vertices[0].position - start.position;
        let distance_squared = to_light.length_squared();
        let possible = start.eligible & distance_squared.simd_le(reach_squared);
        let distance = distance_squared.sqrt();
        let axis = to_light * (f32x8::ONE / distance.fast_max(f32x8::splat(LEAST_LENGTH)));

        let h = phase.h(suffix.vertices[a + 1].leaving, start.leaving);
        let turn = match bridge.roll {
            Roll::Aligned => {
                let (near, far) =
                    phase.h_in_plane(angle(suffix.vertices[a + 1].leaving, axis), angle(start.leaving, axis));
                (h * near * far).sqrt()
            }
            Roll::Uniform => h * h.sqrt(),
        };
        let (mean, depth) = (extinction * distance, extinction * start.arc);
        let shape = counts(a, suffix.count_terms[a], mean, depth, room(a), bridge.defensive) * distance_squared * mean;
        let ratio = start.attempt * shape * turn;
        sum += possible.select(ratio, f32x8::ZERO);
    }
    sum * phase.inverse_scale() * arrival.inverse_area / arrival.cos_light
}

/// `P(N) (N-1)! e^x / x^N` for N = `edges`, x = `depth` = mu_t L and mu_t s = `mean`; `term` is c_N.
#[inline(always)]
fn counts(edges: usize, term: f32, mean: f32x8, depth: f32x8, room: f32x8, defensive: f32) -> f32x8 {
    let (n, one) = (edges as f32, f32x8::ONE);
    let y = depth * f32x8::splat(1.0 / n);
    let minus_ln_y = neg_ln(y);
    let spread = exp((y - one + minus_ln_y).mul_add(f32x8::splat(n), f32x8::splat(term)));
    let mean = mean.fast_min(f32x8::splat(LARGEST_MEAN as f32));
    let minus_ln_depth = minus_ln_y - f32x8::splat(n.ln());
    let poisson = exp(neg_ln(mean / depth).mul_neg_add(f32x8::splat(n - 1.0), depth - mean + minus_ln_depth));
    let share = f32x8::splat(defensive) / room;
    poisson.mul_add(f32x8::splat(1.0 - defensive), share * spread)
}

/// The angle between unit vectors.
#[inline(always)]
fn angle(direction: Vec3x8, axis: Vec3x8) -> PlaneAngle {
    let cosine = direction.dot(axis);
    PlaneAngle { cosine, sine: axis.mul_neg_add(cosine, direction).length_squared().sqrt() }
}

/// The part of the weight that depends on the number of edges alone: `N - N ln N + ln (N - 1)!`, for N >= 1.
pub fn count_term(edges: usize) -> f32 {
    let n = edges as f64;
    let log_factorial: f64 = (1..edges).map(|k| (k as f64).ln()).sum();
    (n - n * n.ln() + log_factorial) as f32
}
