//! How far walks should go, where no number of segments ends them.
//!
//! A walk that goes on finds more, and costs more. If a share q_k of all walks gets to the k-th octave of depth, with
//! M_k the mean square of what is found there by walks that all go on and A_k the mean number of their vertices there,
//!
//! ```text
//! variance = sum of M_k / q_k,     cost = c_0 + c sum of A_k q_k
//! variance * cost is least where   q_k = min(1, sqrt(M_k / (c A_k) cost / variance)),    non-increasing
//! ```
//!
//! (contributions at different depths taken as independent). All walks get to the first octave: c_0 is spent on those
//! that do not, too. Octaves that would have more walks than the ones before are joined with them. No octave has less
//! than a quarter of the walks of the one before: what a look has not found may be there, and with q falling as the
//! square of the depth it is still found, while the cost of going there is no more than that of what comes before.
//! Behind the last octave where more than a few contributions were found nothing is known of M_k, and half of the walks
//! go on from one octave to the next.
//!
//! Variance is that of the brightest parts of an image: a lamp on a table would have no walk go on in the dark wax beside
//! it, of which the noise is seen all the same. So all walks get to the third octave, and no fewer than half of those of
//! an octave to the next one.
//!
//! The first look does not know the scene. Its walks end so that both sums converge where light falls with the power
//! -3/2 of the depth, as it does in endless white fog: with the power -3/4. What the looks found is put together, since
//! a few bright samples have most of the square of what a single one finds.

use fogbow_kernels::pipeline::WIDEST;
use fogbow_kernels::survival::{FIRST_FADING, OCTAVES, Survival};

use super::{Pilot, Setting, cost};
use crate::film::Film;
use crate::stats::{ByDepth, Stats};

/// Looks, each with what those before found.
const LOOKS: u32 = 3;
/// Side of a tile: few blocks, as each takes as long as its longest walk.
const TILE: u32 = 16;
/// Samples of a look, at least.
const SAMPLES: u32 = 1 << 12;
/// Segments after which the walks of looks end: the last ones of a block are alone.
const FARTHEST: u32 = 1 << 13;
/// The octave from which on walks may end at all.
const DARK: usize = 2;
/// Least share of the walks of an octave that gets to the next one.
const STEEPEST: f64 = 0.25;
/// That share where little is known.
const HALF: f64 = 0.5;
/// Contributions of which an octave's light must at least seem to consist, were they all alike, to be known.
const LEAST_CONTRIBUTIONS: f64 = 8.0;
/// Work of a further look in about nanoseconds of one core.
const MOST_WORK: f64 = 3e9;
/// Steps towards the best shares.
const STEPS: usize = 100;

/// Survival by depth that suits the pilot's frame with `setting`, and the cost of a sample then; none if it was stopped.
pub(super) fn survival(pilot: &Pilot<'_>, setting: Setting) -> Option<(Survival, f64)> {
    let (mut best, mut found) = ((Survival::fading(FIRST_FADING), 0.0), None);
    for look in 0..LOOKS {
        let new = take(pilot, Setting { survival: best.0, ..setting }, look)?;
        let all = found.map_or(new, |before: Found| before.and(&new));
        let (reach, cost) = all.best_reach();
        best = (Survival::from_reach(reach), cost);
        if cost * f64::from(samples_per_pixel(pilot)) * pilot.region.pixels() as f64 > MOST_WORK {
            break;
        }
        found = Some(all);
    }
    Some(best)
}

/// Samples per pixel of a look.
fn samples_per_pixel(pilot: &Pilot<'_>) -> u32 {
    SAMPLES.div_ceil(pilot.region.pixels() as u32)
}

/// What looks say of a sample whose walks all go on.
#[derive(Clone, Copy)]
struct Found {
    /// M: mean square of contributions, by octave.
    squares: [f64; OCTAVES],
    /// Mean of contributions, by octave.
    means: [f64; OCTAVES],
    /// A: mean number of vertices, by octave.
    vertices: [f64; OCTAVES],
    /// Walks that got to the middle of each octave, or would have if none were absorbed or had left.
    walks: [f64; OCTAVES],
    /// Work per vertex, and beside that.
    cost: [f64; 2],
}

fn take(pilot: &Pilot<'_>, setting: Setting, look: u32) -> Option<Found> {
    let mut frame = setting.apply(&pilot.frame);
    frame.lengths.max = frame.lengths.max.min(FARTHEST);
    let film = Film::new(&frame, pilot.region, TILE);
    let empty = Stats { by_depth: Some(ByDepth::new()), ..Stats::new(false).with_work() };
    let count = samples_per_pixel(pilot);
    let samples = look * count..(look + 1) * count;
    let stats = pilot.renderer.render_counting(empty, &frame, &WIDEST, &film, samples, pilot.monitor);
    if pilot.monitor.stops() {
        return None;
    }
    let by_depth = stats.by_depth.as_ref()?;
    let per_sample = |sum: f64| sum / stats.samples as f64;
    let seen = by_depth.vertices.map(|count| per_sample(count as f64));
    let whole = per_sample(cost(&stats, &frame));
    let fixed = per_sample(cost(
        &Stats { samples: stats.samples, segments: stats.samples, ..Stats::new(false).with_work() },
        &frame,
    ));
    let per_vertex = (whole - fixed) / seen.iter().sum::<f64>().max(1.0);
    let sums = by_depth.sums();
    let share: [f64; OCTAVES] = core::array::from_fn(|k| setting.survival.reach(middle(k)));
    Some(Found {
        squares: core::array::from_fn(|k| per_sample(sums[k][1]) * share[k]),
        means: sums.map(|[sum, _]| per_sample(sum)),
        vertices: core::array::from_fn(|k| seen[k] / share[k]),
        walks: share.map(|share| share * stats.samples as f64),
        cost: [per_vertex, fixed],
    })
}

/// Octaves that get the same share of all walks.
struct Part {
    /// M: the mean square of what is found there by walks that all go on.
    squares: f64,
    /// A: the mean number of their vertices there.
    vertices: f64,
    octaves: usize,
    /// q: the share of all walks that gets there.
    share: f64,
    /// q over that of the part before, where the squares do not say it.
    falls: Option<f64>,
}

impl Found {
    /// What both looks say: each as much as it has walks.
    fn and(&self, other: &Self) -> Self {
        let mean = |a: &[f64; OCTAVES], b: &[f64; OCTAVES]| {
            core::array::from_fn(|k| {
                let [before, new] = [self.walks[k], other.walks[k]];
                (a[k] * before + b[k] * new) / (before + new)
            })
        };
        Self {
            squares: mean(&self.squares, &other.squares),
            means: mean(&self.means, &other.means),
            vertices: mean(&self.vertices, &other.vertices),
            walks: core::array::from_fn(|k| self.walks[k] + other.walks[k]),
            cost: other.cost,
        }
    }

    /// How many contributions there seem to be in an octave, were they all alike.
    fn contributions(&self, octave: usize) -> f64 {
        let squares = self.squares[octave];
        if squares > 0.0 { self.walks[octave] * self.means[octave].powi(2) / squares } else { 0.0 }
    }

    /// The shares of walks that should get to the beginning of each octave, and the cost of a sample then.
    fn best_reach(&self) -> ([f64; OCTAVES], f64) {
        let parts = self.best_parts();
        (at_beginnings(&parts), self.cost_of(&parts))
    }

    /// Octaves with their best shares.
    fn best_parts(&self) -> Vec<Part> {
        let mut parts = self.parts();
        for _ in 0..STEPS {
            let variance: f64 = parts.iter().map(|part| part.squares / part.share).sum();
            let ratio = self.cost_of(&parts) / (self.cost[0] * variance);
            let mut before = 1.0;
            let mut octave = parts[0].octaves;
            for part in &mut parts[1..] {
                octave += part.octaves;
                let least = HALF.powi(octave.saturating_sub(1 + DARK) as i32);
                let best = (part.squares / part.vertices * ratio).sqrt();
                let best = part.falls.map_or(best, |falls| falls * before);
                part.share = best.clamp(STEEPEST * before, before).max(least.min(before));
                before = part.share;
            }
        }
        parts
    }

    /// Octaves, joined where later ones would have more walks.
    fn parts(&self) -> Vec<Part> {
        let is_known = |octave: &usize| self.contributions(*octave) >= LEAST_CONTRIBUTIONS;
        let known = (0..OCTAVES).rev().find(is_known).map_or(1, |last| last + 1);
        let mut parts: Vec<Part> = Vec::new();
        for k in 0..OCTAVES {
            // Of a few large ones there may be fewer than it seems.
            let sure = (self.contributions(k) / LEAST_CONTRIBUTIONS).min(1.0);
            let (squares, vertices) = (self.squares[k] * sure, self.vertices[k]);
            let nothing = squares == 0.0 && vertices > 0.0;
            let found = if nothing { STEEPEST } else { HALF };
            let falls = (k >= known).then_some(found);
            parts.push(Part { squares, vertices, octaves: 1, share: 1.0, falls });
            while let [.., before, last] = &parts[..]
                && last.falls.is_none()
                && last.squares * before.vertices > before.squares * last.vertices
            {
                let (squares, vertices) = (before.squares + last.squares, before.vertices + last.vertices);
                let octaves = before.octaves + last.octaves;
                parts.truncate(parts.len() - 2);
                parts.push(Part { squares, vertices, octaves, share: 1.0, falls });
            }
        }
        parts
    }

    /// Cost of a sample.
    fn cost_of(&self, parts: &[Part]) -> f64 {
        let [per_vertex, fixed] = self.cost;
        fixed + per_vertex * parts.iter().map(|part| part.vertices * part.share).sum::<f64>()
    }
}

/// From shares in the middle of octaves to those at their beginnings; depth 1 is reached by all.
fn at_beginnings(parts: &[Part]) -> [f64; OCTAVES] {
    let mut middles = parts.iter().flat_map(|part| core::iter::repeat_n(part.share, part.octaves));
    let mut before = 1.0;
    core::array::from_fn(|k| {
        let middle = middles.next().unwrap_or(before);
        let between = if k == 0 { 1.0 } else { f64::sqrt(before * middle) };
        before = middle;
        between
    })
}

/// A depth in the middle of an octave.
fn middle(octave: usize) -> u32 {
    (core::f64::consts::SQRT_2 * f64::from(1_u32 << octave)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found where squares and vertices are these in all octaves, `fall` times less from one to the next, if
    /// walks cost as much as `fixed` vertices before their first one.
    fn found(fall: f64, fixed: f64) -> Found {
        let squares = core::array::from_fn(|k| fall.powi(-(k as i32)));
        Found { squares, means: [1.0; OCTAVES], vertices: [1.0; OCTAVES], walks: [1e6; OCTAVES], cost: [1.0, fixed] }
    }

    /// Variance times cost, if this is the share of walks in each part.
    fn product(found: &Found, parts: &[Part], share: impl Fn(usize) -> f64) -> f64 {
        let variance: f64 = parts.iter().enumerate().map(|(k, part)| part.squares / share(k)).sum();
        let cost: f64 = parts.iter().enumerate().map(|(k, part)| part.vertices * share(k)).sum();
        variance * (found.cost[1] + found.cost[0] * cost)
    }

    #[test]
    fn shares_are_best_however_little_a_sample_costs() {
        for fixed in [0.001, 0.1, 10.0] {
            let found = found(1.5, fixed);
            let parts = found.best_parts();
            assert_eq!(parts[0].share.to_bits(), 1.0_f64.to_bits(), "fixed cost {fixed}");
            let least = product(&found, &parts, |k| parts[k].share);
            for factor in [0.8, 0.9, 1.1, 1.25] {
                let all = product(&found, &parts, |k| (parts[k].share * factor).min(1.0));
                assert!(all >= least, "fixed cost {fixed}: {all} instead of {least}, all of them {factor} times");
                let may_be = |k: &usize| parts[*k].share * factor >= HALF.powi(k.saturating_sub(DARK) as i32);
                for changed in (1..parts.len()).filter(may_be) {
                    let share =
                        |k: usize| if k == changed { (parts[k].share * factor).min(1.0) } else { parts[k].share };
                    let other = product(&found, &parts, share);
                    assert!(other >= least, "fixed cost {fixed}: {other} instead of {least}, part {changed}, {factor}");
                }
            }
        }
    }

    #[test]
    fn looks_count_as_much_as_they_have_walks() {
        let [few, many] = [
            Found { walks: [1.0; OCTAVES], ..found(1.0, 1.0) },
            Found { walks: [3.0; OCTAVES], squares: [5.0; OCTAVES], ..found(1.0, 1.0) },
        ];
        let both = few.and(&many);
        assert_eq!((both.squares[0], both.walks[0], both.vertices[0]), (4.0, 4.0, 1.0));
        // Four walks with a mean of 1 and a mean square of 4: as one contribution of 4.
        assert_eq!(both.contributions(0), 1.0);
    }
}
