//! What must agree: stages and their twins, whole paths and the scalar integrator, all techniques.

use core::ops::RangeInclusive;

use fogbow::frame::Frame;
use fogbow::reference;
use fogbow::render::Workers;
use fogbow_kernels::pipeline::SIMD;

use crate::checked::{CHECKED, Log, take_log};
use crate::frames::clouds::IN_FIELDS;
use crate::frames::{self, Active};
use crate::render::{WORKERS, render, render_here, render_with};
use crate::statistics::z_of_means;
use crate::suite::half;

const SMALL: [u32; 2] = [16, 16];

/// Share of rows that may be decided differently where cells, points, pixels and collisions are decisions.
const DIFFERENT: f64 = 2e-3;

/// Every stage of these small frames agrees with its twin, in `samples` of a pixel.
pub fn assert_stages_agree(name: &str, frames: impl Iterator<Item = Frame>, samples: u32) {
    let mut all = Log::default();
    for frame in frames {
        render_here(&frame, &CHECKED, 128, SMALL, samples);
        let log = take_log();
        assert!(log.failures.is_empty(), "{name}, {:?}: {}", frame.techniques, log.failures[0]);
        all.merge(log);
    }
    all.assert_little_is_disputed(name);
    let Log { rows, decisions, .. } = all;
    assert!(decisions as f64 <= DIFFERENT * rows as f64, "{name}: {decisions} of {rows}");
    assert!(rows > 10_000, "{name}: only {rows} rows");
}

/// A small frame has the same paths in the scalar integrator, but for a few that were decided differently. Gives the sum
/// of what they found.
pub fn assert_whole_paths_agree(case: &str, frame: &Frame) -> f64 {
    let film = render_here(frame, &SIMD, 64, SMALL, 1);
    let (mut apart, mut sum) = (0, 0.0);
    for (pixel, found) in (0..).zip(film.pixels()) {
        let twin = reference::radiance(frame, pixel, 0);
        let far = |c: usize| (found.mean[c] - twin[c]).abs() > 1e-6 + 2e-2 * twin[c];
        apart += u32::from((0..3).any(far));
        sum += twin[1];
    }
    assert!(apart <= 3, "{case}: {apart} of 256 samples are apart");
    sum
}

/// A small image is the same bits for any number of threads and lanes.
pub fn assert_same_on_all_workers(name: &str, frame: &Frame) {
    let image = |threads: usize, lanes: usize| {
        let workers = Workers { threads, lanes: Some(lanes), ..WORKERS };
        let (film, _) = render_with(frame, &SIMD, workers, SMALL, 8, 0..5);
        film.pixels().map(|pixel| pixel.mean.map(f64::to_bits)).collect::<Vec<_>>()
    };
    let one = image(1, 256);
    assert!(one == image(2, 256) && one == image(2, 24), "{name}");
}

/// Mean and standard error of a small image, per channel.
pub fn means(frame: &Frame, samples: u32) -> [(f64, f64); 3] {
    let (film, stats) = render(frame, SMALL, 0..samples);
    assert_eq!(stats.dropped.count, 0, "{:?}", stats.dropped.first);
    let (mean, error) = film.mean();
    [0, 1, 2].map(|channel| (mean[channel], error[channel]))
}

/// How well means have to be known: beyond this their agreement says little. Most are known to 4 % or better.
const KNOWN: f64 = 0.15;

/// The same of path tracing, which has to come upon the lights.
const KNOWN_OF_PATHS: f64 = 0.25;

/// Means that [`means`] gave are the same, and are known.
pub fn assert_same(case: &str, found: [(f64, f64); 3], truth: [(f64, f64); 3]) {
    assert_same_known(case, found, truth, KNOWN);
}

/// The same of means of the technique `active`.
pub fn assert_same_of(active: Active, case: &str, found: [(f64, f64); 3], truth: [(f64, f64); 3]) {
    assert_same_known(&format!("{case}, {active:?}"), found, truth, known_of(active));
}

fn known_of(active: Active) -> f64 {
    if active == Active::Path { KNOWN_OF_PATHS } else { KNOWN }
}

/// [`means`] by this many samples, or by 4, 16 or 64 times as many, until they are known.
fn means_until(is_known: impl Fn(&[(f64, f64); 3]) -> bool, frame: &Frame, samples: u32) -> [(f64, f64); 3] {
    let mut found = means(frame, samples);
    for more in [4, 16, 64] {
        if !is_known(&found) {
            found = means(frame, more * samples);
        }
    }
    found
}

/// Means to compare others with: known to half of what the difference to them has to be.
fn known_means(frame: &Frame) -> [(f64, f64); 3] {
    let is_known = |found: &[(f64, f64); 3]| found.iter().all(|(mean, error)| *error <= 0.5 * KNOWN * mean);
    means_until(is_known, frame, half(2800))
}

/// The standard error of a difference, over the truth.
fn error(found: (f64, f64), truth: (f64, f64)) -> f64 {
    found.1.hypot(truth.1) / truth.0
}

/// Whether `found` is known well enough to tell whether it is `truth`: to a share of both, since a few samples that have
/// not come upon the brightest paths find less and seem to know it well.
fn settles(found: (f64, f64), truth: (f64, f64), known: f64) -> bool {
    truth.0 == 0.0 || (error(found, truth) < known && found.1 < known * found.0)
}

/// The same where their difference has a standard error of at most `known` times the truth.
fn assert_same_known(case: &str, found: [(f64, f64); 3], truth: [(f64, f64); 3], known: f64) {
    for channel in 0..3 {
        let (found, truth) = (found[channel], truth[channel]);
        if (found, truth) == ((0.0, 0.0), (0.0, 0.0)) {
            continue;
        }
        let z = z_of_means(found, truth);
        assert!(z.abs() < 4.2, "{case}, channel {channel}: {found:?} instead of {truth:?}, z = {z}");
        let error = error(found, truth);
        assert!(error < known, "{case}, channel {channel}: {found:?} and {truth:?} are known to {error} only");
    }
}

/// In a field, every technique has the means of next event estimation, for paths of so many segments each.
pub fn assert_equal_means(name: &str, base: &Frame, segments: RangeInclusive<u32>) {
    assert_equal_means_in(name, base, base, segments);
}

/// In a field, every technique has the means that next event estimation has in `other`, for paths of so many segments
/// each.
pub fn assert_equal_means_in(name: &str, base: &Frame, other: &Frame, segments: RangeInclusive<u32>) {
    for segments in segments {
        let [base, other] = [base, other].map(|frame| frames::with_length(frame, segments));
        assert_equal_means_of(&format!("{name}, {segments} segments"), &base, &other);
    }
}

/// The same of paths of any of the lengths of `base`.
pub fn assert_equal_means_of(case: &str, base: &Frame, other: &Frame) {
    let truth = known_means(&Frame { seed: 99, ..frames::with_techniques(other, Active::Nee, 4.0) });
    for active in IN_FIELDS {
        let seed = 100 * active as u32 + base.lengths.max;
        let frame = Frame { seed, ..frames::with_techniques(base, active, 4.0) };
        let is_known = |found: &[(f64, f64); 3]| (0..3).all(|c| settles(found[c], truth[c], known_of(active)));
        let found = means_until(is_known, &frame, half(700));
        assert_same_of(active, case, found, truth);
    }
}
