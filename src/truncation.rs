//! What a limit on the length of paths leaves out.
//!
//! No error bar shows it, so it is estimated before a render begins: the image is rendered small with eight times the limit,
//! or with the longest there is, and light is summed by the length of its paths. What is beyond even that is extrapolated:
//! every further doubling of the length is taken to bring as much less than the one before as the last did. Light that is
//! absorbed falls faster; light that wanders through endless fog falls just so, with a power of the length.
//!
//! The light of long paths is the same whichever technique finds it, and bridges find it most surely; so they are used
//! wherever something scatters, with as many edges from 16 to 32 as from 8 to 16. Where even they find none, paths that
//! meet it by themselves may.

use core::fmt;
use std::sync::Arc;

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::{LONGEST_PATH, PathLengths};

use crate::film::{Film, tile_size};
use crate::frame::Frame;
use crate::render::{Monitor, Renderer};
use crate::stats::LightByLength;

/// Share of the light that may be left out without a word.
pub const TOLERATED: f64 = 0.01;

/// Longest side of the small image in pixels.
const SIDE: u32 = 32;
/// Looks whose spread tells how well the share is known.
const LOOKS: u32 = 5;
/// How to look where nothing is solid, and where something is.
const WAYS: [Way; 2] = [Way { starts: 1, survival: 1.0, samples: 12 }, Way { starts: 2, survival: 0.9, samples: 2 }];
/// How to look where bridges see nothing, as light wanders through hundreds of scatterings: by paths that meet it.
const WALKING: Way = Way { starts: 0, survival: 1.0, samples: 8 };
/// Multiple of the limit up to which paths are looked at first.
const FARTHER: u32 = 8;
/// Shortest and longest paths that are looked at first, in segments.
const FIRST: [u32; 2] = [64, 256];
/// Share of the light that the last doubling of the length may bring.
const LAST_DOUBLING: f64 = 0.01;
/// Least factor by which the next doubling is taken to bring less.
const SLOWEST: f64 = 0.9;
/// The seed of its samples.
const SEED: u32 = 0x6c07_8965;

/// How a look is taken.
#[derive(Clone, Copy)]
struct Way {
    /// Vertices that connect; with 0, light is found where paths meet it.
    starts: u32,
    /// Probability of going on from a vertex.
    survival: f32,
    /// Samples per pixel.
    samples: u32,
}

/// What is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truncation {
    /// The limit, in segments.
    pub max_segments: u32,
    /// Share of all light that longer paths would bring, [0, 1].
    pub share: f64,
    /// Its standard error.
    pub error: f64,
    /// A limit that would leave out less than [`TOLERATED`]; none if [`LONGEST_PATH`] is still too short.
    pub sufficient: Option<u32>,
}

impl Truncation {
    /// Whether it is worth a word: more than is tolerated.
    pub fn matters(&self) -> bool {
        self.share > TOLERATED
    }
}

impl fmt::Display for Truncation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { max_segments, share, .. } = self;
        let percent = (1000.0 * share).round() / 10.0;
        write!(f, "paths of more than {max_segments} segments are left out, and with them {percent} % of the light: ")?;
        match self.sufficient {
            Some(limit) => write!(f, "--max-segments {limit} would leave out about 1 % or less"),
            None => write!(f, "even {LONGEST_PATH}, the largest possible limit, would leave out more than 1 %"),
        }
    }
}

/// What `frame`, whose image has `size` pixels, leaves out. `None` where nothing is left out, as nothing turns light, or
/// where no light was found at all.
pub fn estimate(frame: &Frame, size: [u32; 2], renderer: &Renderer) -> Option<Truncation> {
    if frame.stays_straight() {
        return None;
    }
    let limit = frame.lengths.max;
    let first = (FARTHER * limit).clamp(FIRST[0], FIRST[1].max(limit));
    let way = &WAYS[usize::from(!frame.surfaces.is_empty())];
    let mut looks = look_up_to(first, way, frame, size, renderer);
    if !Beyond::of_most(&looks, limit).is_known() && first < LONGEST_PATH {
        // As much work again: longer paths cost more.
        let samples = (way.samples * first).div_ceil(LONGEST_PATH);
        looks = look_up_to(LONGEST_PATH, &Way { samples, ..*way }, frame, size, renderer);
    }
    if looks.iter().flatten().all(|light| *light == 0.0) {
        looks = look_up_to(LONGEST_PATH, &WALKING, frame, size, renderer);
    }
    let beyond = Beyond::of_most(&looks, limit);
    let shares: Vec<f64> = looks.iter().map(|look| Beyond::of(look).share(limit)).collect();
    (beyond.total > 0.0).then(|| Truncation {
        max_segments: limit,
        share: beyond.share(limit),
        error: standard_error(&shares),
        sufficient: beyond.sufficient(),
    })
}

/// Light by length, as several looks at paths of up to `longest` segments see it.
fn look_up_to(longest: u32, way: &Way, frame: &Frame, size: [u32; 2], renderer: &Renderer) -> Vec<Vec<f64>> {
    let Way { starts, survival, samples } = *way;
    let (frame, region) = frame.small(size, SIDE);
    let lengths = PathLengths { max: longest, ..frame.lengths };
    let techniques = match (frame.medium.never_scatters(), starts) {
        (true, _) => frame.techniques.clone(),
        (false, 0) => Techniques::default(),
        (false, _) => bridges(&frame, longest),
    };
    let frame = Frame { lengths, techniques, seed: SEED, roulette: 0.0, ..frame }.with_walk(starts.max(1), survival);
    let look = |number: u32| {
        let film = Film::new(&frame, region, tile_size(region));
        let samples = number * samples..(number + 1) * samples;
        let stats = renderer.render_by_length(&frame, &SIMD, &film, samples, &Monitor::default());
        stats.light_by_length.as_ref().map_or_else(Vec::new, LightByLength::values)
    };
    (0..LOOKS).map(look).collect()
}

/// Bridges with N edges in proportion to 1 / N: as many in every doubling.
fn bridges(frame: &Frame, longest: u32) -> Techniques {
    let edges = longest.saturating_sub(1).max(1) as usize;
    let weights: Vec<f64> = (1..=edges).map(|n| 1.0 / n as f64).collect();
    let counts = CountTable::from_weights(frame.medium.phase.twin().lobe(), edges, |_| weights.clone());
    Techniques { bridge: Some(Bridge::with_counts(Roll::Aligned, Arc::new(counts))), ..Techniques::default() }
}

/// The light beyond each length.
struct Beyond {
    /// All of it, extrapolated light included.
    total: f64,
    /// That of the last doubling of the length.
    last: f64,
    /// That of paths longer than so many segments.
    longer_than: Vec<f64>,
}

impl Beyond {
    /// Of all looks together but the one that sees most beyond `limit`: a single rare path may have spoilt it.
    fn of_most(looks: &[Vec<f64>], limit: u32) -> Self {
        let mut looks: Vec<_> = looks.iter().map(|look| (Self::of(look).share(limit), look)).collect();
        looks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let seen = looks.iter().filter(|(share, _)| *share > 0.0).count();
        if seen > 2 {
            looks.pop();
        }
        let lengths = 0..looks[0].1.len();
        Self::of(&lengths.map(|n| looks.iter().map(|(_, look)| look[n]).sum()).collect::<Vec<f64>>())
    }

    /// Of the light at each length; with `A` and `B` that of the last doublings, the k-th after these is taken to bring
    /// `B (B / A)^k`.
    fn of(light: &[f64]) -> Self {
        let half = light.len() / 2;
        let (before, last) = (light[half / 2..half].iter().sum::<f64>(), light[half..].iter().sum::<f64>());
        let ratio = if before > 0.0 { (last / before).min(SLOWEST) } else { SLOWEST };
        let tail = last * ratio / (1.0 - ratio);
        let light = light.iter().rev();
        let mut longer_than: Vec<f64> =
            light.scan(tail, |sum, light| Some(core::mem::replace(sum, *sum + light))).collect();
        longer_than.reverse();
        Self { total: longer_than[0], last, longer_than }
    }

    /// Whether the last doubling brought next to nothing.
    fn is_known(&self) -> bool {
        self.last <= LAST_DOUBLING * self.total
    }

    /// Share of the light of paths longer than `limit`.
    fn share(&self, limit: u32) -> f64 {
        if self.total > 0.0 { self.longer_than[limit as usize] / self.total } else { 0.0 }
    }

    /// A round limit, in eighths of a power of two, that leaves out less than is tolerated, and surely so: half of that.
    fn sufficient(&self) -> Option<u32> {
        let exact = self.longer_than.iter().position(|longer| *longer <= 0.5 * TOLERATED * self.total)? as u32;
        let step = (exact.next_power_of_two() / 16).max(1);
        Some(exact.next_multiple_of(step))
    }
}

fn standard_error(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (spread / (count - 1.0) / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light that falls with a power of the length.
    fn algebraic(power: f64, longest: u32) -> Vec<f64> {
        (0..=longest).map(|n| if n == 0 { 0.0 } else { f64::from(n).powf(-power) }).collect()
    }

    #[test]
    fn an_algebraic_tail_is_extrapolated() {
        for power in [1.5, 2.0, 3.0] {
            let truth = algebraic(power, 10_000_000);
            let all: f64 = truth.iter().sum();
            let beyond = Beyond::of(&truth[..256]);
            for limit in [15, 100, 255] {
                let share = truth[limit + 1..].iter().sum::<f64>() / all;
                let found = beyond.share(limit as u32);
                assert!((found / share - 1.0).abs() < 0.03, "{found} of {share} beyond {limit}, power {power}");
            }
        }
    }

    #[test]
    fn light_that_falls_faster_has_no_tail() {
        let light: Vec<f64> = (0..=256).map(|n| 0.9_f64.powi(n)).collect();
        let beyond = Beyond::of(&light);
        assert!(beyond.is_known() && (beyond.share(20) / 0.9_f64.powi(20) - 1.0).abs() < 1e-3);
        let limit = beyond.sufficient().expect("a limit");
        assert!((50..=56).contains(&limit), "{limit}: 51 leave out half a hundredth");
    }

    #[test]
    fn light_that_still_grows_has_no_end_in_sight() {
        let light: Vec<f64> = (0..=32).map(f64::from).collect();
        let beyond = Beyond::of(&light);
        assert!(!beyond.is_known() && beyond.share(32) > 0.5, "{} beyond the longest", beyond.share(32));
        assert_eq!(beyond.sufficient(), None);
        assert_eq!(Beyond::of(&[0.0; 33]).share(8), 0.0);
    }
}
