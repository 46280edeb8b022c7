//! All techniques have the same mean: per path length, per scene, and that of independent programs.

use fogbow::film::Film;
use fogbow::frame::Frame;
use fogbow_kernels::PathLengths;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::tables::lights::Selection;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::{green, render};
use fogbow_testing::statistics::{p_of_chi_square, p_of_uniformity, z_of_means};
use fogbow_testing::suite::{half, some};
use fogbow_testing::truths;
use glam::DVec3;

const SMALL: [u32; 2] = [16, 16];

/// The mean of an image and its standard error, red, green and blue.
type Mean = ([f64; 3], [f64; 3]);

/// What independent renders of the same scene, by name, say its mean is.
struct Renders {
    means: Vec<(String, Mean)>,
}

impl Renders {
    /// The mean of all in a channel, each by its certainty, and one over its variance.
    fn common(&self, channel: usize) -> (f64, f64) {
        let certainty = |error: f64| 1.0 / (error * error);
        let total: f64 = self.means.iter().map(|(_, (_, error))| certainty(error[channel])).sum();
        let sum: f64 = self.means.iter().map(|(_, (mean, error))| mean[channel] * certainty(error[channel])).sum();
        (sum / total, total)
    }

    /// Checks that none is far from the mean of all, and returns the p-values of all being equal, channel by channel.
    ///
    /// One in 40000 comparisons fails by chance. There are some 2000 in the long suite, three channels of the same paths
    /// being little more than one: one choice of seeds in 20 or so would have to be another.
    fn assert_equal(&self, name: &str) -> [f64; 3] {
        [0, 1, 2].map(|channel| {
            let (common, certainty) = self.common(channel);
            let mut chi_square = 0.0;
            for (which, (means, errors)) in &self.means {
                let (mean, error) = (means[channel], errors[channel]);
                chi_square += ((mean - common) / error).powi(2);
                // A render is part of the mean that it is compared with.
                let z = (mean - common) / (error * error - 1.0 / certainty).max(0.0).sqrt();
                let name = format!("{name}, {which}, channel {channel}");
                assert!(z.abs() < 4.2, "{name}: {mean} +- {error} where all say {common}, z = {z}");
            }
            p_of_chi_square(chi_square, self.means.len() - 1)
        })
    }
}

/// Checks that p-values of claims that hold look like it, channel by channel: those of the same paths are not
/// independent.
fn assert_uniform(name: &str, p_values: &[[f64; 3]]) {
    for channel in 0..3 {
        let p_values: Vec<_> = p_values.iter().map(|channels| channels[channel]).collect();
        let p = p_of_uniformity(&p_values);
        assert!(p > 1e-4, "{name}, channel {channel}: p-values {p_values:?} are not uniform, p = {p}");
    }
}

/// Means of all techniques, for one path length.
fn means(base: &Frame, mesc: f64, segments: u32, samples: u32) -> Renders {
    let mean = |active: Active| {
        // Other seeds, so that the walks of different techniques are independent.
        let seed = 100 * active as u32 + segments;
        let frame = frames::with_length(&Frame { seed, ..frames::with_techniques(base, active, mesc) }, segments);
        (format!("{active:?}"), render(&frame, SMALL, 0..samples).0.mean())
    };
    Renders { means: Active::ALL.into_iter().map(mean).collect() }
}

fn assert_equal_means(name: &str, base: &Frame, mesc: f64, lengths: impl Iterator<Item = u32>, samples: u32) {
    let samples = half(samples);
    let p_value =
        |segments: u32| means(base, mesc, segments, samples).assert_equal(&format!("{name}, {segments} segments"));
    assert_uniform(name, &lengths.map(p_value).collect::<Vec<_>>());
}

#[test]
fn all_techniques_have_equal_means_per_path_length_with_one_light() {
    let base = frames::fog_facing(1.0, 0.7, SMALL);
    assert_equal_means("fog-facing", &base, 4.0, some(1..=9, 0, 2), 3000);
}

#[test]
fn all_techniques_have_equal_means_per_path_length_with_two_lights() {
    for (turn, (selection, g)) in
        [(Selection::Uniform, 0.2), (Selection::Intensity, -0.4), (Selection::IntensityDistance, 0.6)]
            .into_iter()
            .enumerate()
    {
        let base = frames::two_lights(g, selection, SMALL);
        assert_equal_means(&format!("two lights, {selection:?}"), &base, 2.0, some(1..=5, turn, 2), 400);
    }
}

#[test]
fn all_techniques_have_equal_means_per_path_length_with_three_lights() {
    let cases = [
        (Selection::Uniform, -0.6, f64::INFINITY),
        (Selection::Intensity, 0.0, 2.0),
        (Selection::IntensityDistance, 0.8, 1.5),
    ];
    for (turn, (selection, g, mesc)) in cases.into_iter().enumerate() {
        let base = frames::three_lights(g, selection, SMALL);
        assert_equal_means(&format!("three lights, {selection:?}"), &base, mesc, some(1..=6, turn, 2), 1500);
    }
}

#[test]
fn all_techniques_have_equal_means_per_path_length_among_many_lights() {
    let base = frames::swarm(60, Selection::IntensityDistance, SMALL);
    assert_equal_means("many lights", &base, 2.0, 1..=4, 1000);
}

#[test]
fn all_techniques_have_equal_means_per_path_length_with_spotlights() {
    for (turn, (g, mesc)) in [(0.3, f64::INFINITY), (0.8, 2.0)].into_iter().enumerate() {
        let base = frames::three_lights(g, Selection::IntensityDistance, SMALL);
        let base = frames::focused(&base, &[12.0, 2.0, 0.0]);
        assert_equal_means(&format!("spotlights, g {g}"), &base, mesc, some(1..=6, turn, 2), 1500);
    }
}

#[test]
fn all_techniques_have_equal_means_per_path_length_with_cones() {
    let base = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let base = frames::with_cones(&frames::focused(&base, &[8.0, 2.0, 1.0]), &[[0.2, 0.7], [0.9, 0.9], [0.3, 1.5]]);
    assert_equal_means("cones", &base, 3.0, some(1..=6, 1, 2), 1500);
}

#[test]
fn all_techniques_have_equal_means_per_path_length_among_surfaces() {
    let base = frames::room(0.7, Selection::IntensityDistance, SMALL);
    assert_equal_means("room", &base, 2.0, some(1..=6, 1, 2), 1500);
}

#[test]
fn all_techniques_have_equal_means_per_path_length_among_lamps() {
    let cases = [(Selection::Intensity, 0.7), (Selection::IntensityDistance, -0.3)];
    for (turn, (selection, g)) in cases.into_iter().enumerate() {
        let base = frames::lamps(1.0, g, selection, SMALL);
        assert_equal_means(&format!("lamps, {selection:?}"), &base, 2.0, some(1..=6, turn, 2), 1000);
    }
}

#[test]
fn the_length_limit_counts_camera_and_light_segment() {
    // One segment more would be brighter by a tenth.
    let frame = frames::with_techniques(&frames::fog_facing(1.0, 0.0, SMALL), Active::Nee, 4.0);
    let (mean, error) = green(&render(&frame, SMALL, 0..40_000).0);
    assert!(error < 0.001, "error {error}");
    assert!((mean - 0.1847).abs() < 0.0002 + 3.5 * error, "{mean} +- {error}");
}

/// Compares a render with an independent image: per pixel, per block of `side` x `side` pixels, and in the mean.
fn assert_matches_by(side: usize, name: &str, film: &Film) {
    let truth = truths::image(name);
    let (green, errors) = (truth.channel("G").expect("green"), truth.channel("SE.G").expect("errors"));
    let pixels: Vec<_> = film.pixels().collect();
    assert_eq!(pixels.len(), green.len(), "{name}: sizes differ");
    let mut p_values = Vec::new();
    for block in [1, side, truth.width] {
        let (mut chi_square, mut blocks) = (0.0, 0);
        for y in (0..truth.height).step_by(block) {
            for x in (0..truth.width).step_by(block) {
                let (mut difference, mut variance) = (0.0, 0.0);
                for i in (y..y + block).flat_map(|y| (x..x + block).map(move |x| y * truth.width + x)) {
                    difference += pixels[i].mean[1] - f64::from(green[i]);
                    variance += pixels[i].standard_error[1].powi(2) + f64::from(errors[i]).powi(2);
                }
                chi_square += difference * difference / variance;
                blocks += 1;
            }
        }
        p_values.push((block, p_of_chi_square(chi_square, blocks)));
    }
    // Heavy tails make single pixels lie further out than their errors say; blocks and means must not.
    assert!(p_values[1].1 > 1e-3 && p_values[2].1 > 1e-3, "{name}: p-values per block size {p_values:?}");
}

/// The same with blocks of 4 x 4 pixels.
fn assert_matches(name: &str, film: &Film) {
    assert_matches_by(4, name, film);
}

fn size(name: &str) -> [u32; 2] {
    let image = truths::image(name);
    [image.width as u32, image.height as u32]
}

#[test]
fn fog_facing_matches_an_independent_program() {
    let name = "fog-facing-near0-g0.9";
    let film = render(&frames::fog_facing(0.0, 0.9, size(name)), size(name), 0..6000).0;
    let (mean, error) = green(&film);
    assert!((mean - 1.2838).abs() < 0.0004 + 3.5 * error && error < 0.004, "{mean} +- {error}");
    assert_matches(name, &film);
}

#[test]
fn fog_facing_seen_from_the_image_plane_matches_an_independent_program() {
    let name = "fog-facing-near1-g0.9";
    let film = render(&frames::fog_facing(1.0, 0.9, size(name)), size(name), 0..1500).0;
    let (mean, error) = green(&film);
    assert!((mean - 1.7004).abs() < 0.0005 + 3.5 * error && error < 0.006, "{mean} +- {error}");
    assert_matches(name, &film);
}

#[test]
fn isotropic_fog_matches_an_independent_program() {
    let name = "fog-facing-near1-g0.0";
    let film = render(&frames::fog_facing(1.0, 0.0, size(name)), size(name), 0..1500).0;
    let (mean, error) = green(&film);
    assert!((mean - 0.1847).abs() < 0.0002 + 3.5 * error && error < 0.001, "{mean} +- {error}");
    assert_matches(name, &film);
}

#[test]
fn light_across_the_view_matches_an_independent_program() {
    let name = "fog-perpendicular-near1-g0.6";
    let frame = frames::fog(1.0, 0.6, DVec3::Y, size(name));
    for active in [Active::Nee, Active::Mvnee] {
        let film = render(&frames::with_techniques(&frame, active, 4.0), size(name), 0..1500).0;
        let (mean, error) = green(&film);
        assert!((mean - 0.23981).abs() < 0.00026 + 3.5 * error && error < 0.002, "{active:?}: {mean} +- {error}");
        assert_matches(name, &film);
    }
}

#[test]
fn a_perforated_plate_matches_an_independent_program() {
    let name = "dense-plate";
    let film = render(&frames::shipped(name, size(name), Active::Bridge), size(name), 0..128).0;
    assert_matches(name, &film);
}

#[test]
fn fog_in_a_box_matches_an_independent_program() {
    let name = "cornell-fog-thin";
    let film = render(&frames::shipped(name, size(name), Active::Bridge), size(name), 0..128).0;
    assert_matches(name, &film);
}

#[test]
fn a_spotlight_on_a_sphere_matches_an_independent_program() {
    // The truth knows half of its pixels to a fifth or worse.
    let name = "spotlight";
    let film = render(&frames::shipped(name, size(name), Active::Lis), size(name), 0..128).0;
    let (mean, error) = green(&film);
    assert!(error < 0.0006, "{mean} +- {error}");
    assert_matches_by(16, name, &film);
}

#[test]
fn many_lights_have_equal_means_under_every_selection_rule() {
    let with = |selection: Selection, active: Active| {
        let base = frames::three_lights(0.7, selection, SMALL);
        let frame = Frame { seed: 31 * selection as u32 + active as u32, ..base };
        render(&frames::with_techniques(&frame, active, 3.0), SMALL, 0..half(4000)).0.mean()
    };
    let truth = with(Selection::Uniform, Active::Path);
    for selection in [Selection::Uniform, Selection::Intensity, Selection::IntensityDistance] {
        for active in [Active::Nee, Active::Mvnee, Active::Both] {
            let (mean, error) = with(selection, active);
            for channel in 0..3 {
                let z = z_of_means((mean[channel], error[channel]), (truth.0[channel], truth.1[channel]));
                assert!(z.abs() < 4.0, "{selection:?}, {active:?}, channel {channel}: z = {z}");
            }
        }
    }
}

/// Bridges from the first `starts` vertices of walks that survive with probability `survival`.
fn walk(base: &Frame, starts: u32, survival: f32, roulette: f32) -> Frame {
    let seed = 7919 * starts.min(9) + (100.0 * survival) as u32 + u32::from(roulette > 0.0);
    Frame { seed, roulette, ..frames::with_techniques(base, Active::Bridge, 3.0) }.with_walk(starts, survival)
}

/// The path lengths 2 to 6 one by one, and all together.
fn lengths(base: &Frame) -> impl Iterator<Item = PathLengths> {
    (2..=6).map(|n| PathLengths { min: n, max: n }).chain([base.lengths])
}

#[test]
fn where_walks_end_and_what_roulette_drops_change_no_mean() {
    let cases = [
        ("fog-facing", frames::fog_facing(1.0, 0.7, SMALL), 1.0),
        ("three lights", frames::three_lights(0.6, Selection::IntensityDistance, SMALL), 0.1),
        ("room", frames::room(0.6, Selection::IntensityDistance, SMALL), 0.1),
        ("lamps", frames::lamps(1.0, 0.6, Selection::IntensityDistance, SMALL), 0.5),
    ];
    for (turn, (name, base, threshold)) in cases.into_iter().enumerate() {
        let mut p_values = Vec::new();
        for lengths in some(lengths(&base), turn, 2) {
            let mut means = Vec::new();
            for starts in [1, 2, 4, u32::MAX] {
                for (survival, roulette) in [(1.0, 0.0), (0.6, 0.0), (1.0, threshold), (0.6, threshold)] {
                    let frame = Frame { lengths, ..walk(&base, starts, survival, roulette) };
                    let mean = render(&frame, SMALL, 0..half(500)).0.mean();
                    means.push((format!("{starts} starts, survival {survival}, roulette {roulette}"), mean));
                }
            }
            p_values.push(Renders { means }.assert_equal(&format!("{name}, {lengths:?}")));
        }
        assert_uniform(name, &p_values);
    }
}

/// Of a room, flights towards its lights meet walls on the way there and behind.
#[test]
fn first_flights_towards_lights_change_no_mean() {
    let cases = [
        ("three lights", frames::three_lights(0.6, Selection::IntensityDistance, SMALL)),
        ("room", frames::room(0.6, Selection::IntensityDistance, SMALL)),
        ("room in haze", frames::with_extinction(&frames::room(0.6, Selection::IntensityDistance, SMALL), 0.05)),
        ("lamps", frames::lamps(1.0, 0.6, Selection::IntensityDistance, SMALL)),
    ];
    for (turn, (name, base)) in cases.into_iter().enumerate() {
        let mut p_values = Vec::new();
        for lengths in some(lengths(&base), turn, 2) {
            let of = |aimed: f32| {
                let frame = Frame { lengths, aimed, seed: (100.0 * aimed) as u32, ..walk(&base, 2, 0.9, 0.0) };
                (format!("aimed {aimed}"), render(&frame, SMALL, 0..half(2000)).0.mean())
            };
            let means = [0.0, 0.05, 0.5].map(of).to_vec();
            p_values.push(Renders { means }.assert_equal(&format!("{name}, {lengths:?}")));
        }
        assert_uniform(name, &p_values);
    }
}

#[test]
fn path_tracing_finds_what_limited_bridges_leave_out() {
    let limited = |base: &Frame, mesc: f64, vertices: u32, starts: u32, survival: f32| {
        let frame = frames::with_techniques(base, Active::Bridge, f64::INFINITY);
        let bridge = Bridge::new(Roll::Aligned, &frame.medium, frame.lengths.max).with_mesc(&frame.medium, mesc);
        let bridge = Bridge { max_inserted: vertices, ..bridge };
        let techniques = Techniques { bridge: Some(bridge), ..frame.techniques };
        Frame { techniques, seed: 17 * vertices.min(9) + starts.min(9), ..frame }.with_walk(starts, survival)
    };
    for (name, base) in [
        ("fog-facing", frames::fog_facing(1.0, 0.7, SMALL)),
        ("three lights", frames::three_lights(0.6, Selection::IntensityDistance, SMALL)),
    ] {
        let mut p_values = Vec::new();
        for lengths in lengths(&base) {
            let free = Frame { lengths, ..walk(&base, u32::MAX, 1.0, 0.0) };
            let mut means = vec![("no limit".to_string(), render(&free, SMALL, 0..1000).0.mean())];
            for (mesc, vertices, starts, survival) in [
                (2.5, u32::MAX, u32::MAX, 1.0),
                (f64::INFINITY, 1, u32::MAX, 1.0),
                (f64::INFINITY, 0, 2, 1.0),
                (2.5, 2, 1, 1.0),
                (1.5, 2, 3, 0.8),
            ] {
                let frame = Frame { lengths, ..limited(&base, mesc, vertices, starts, survival) };
                let which = format!("mesc {mesc}, {vertices} vertices, {starts} starts, survival {survival}");
                means.push((which, render(&frame, SMALL, 0..2000).0.mean()));
            }
            p_values.push(Renders { means }.assert_equal(&format!("{name}, {lengths:?}")));
        }
        assert_uniform(name, &p_values);
    }
}
