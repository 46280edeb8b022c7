//! Layers beside radiance: what the camera sees first, and light by technique and by length.

use core::ops::Range;

use fogbow::film::aov::{Aov, Aovs, Origin};
use fogbow::film::{Exact, Film, Kind, RADIANCE, Region, layers};
use fogbow::frame::Frame;
use fogbow::reference;
use fogbow::render::{Monitor, Renderer, Workers};
use fogbow_kernels::PathLengths;
use fogbow_kernels::columns::parts::length_class;
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::tables::lights::{Selection, Source};
use fogbow_testing::agreement::assert_stages_agree;
use fogbow_testing::frames::{self, Active, seen_first, seen_first_in_volumes, with_all_layers};
use fogbow_testing::render::WORKERS;

const SIZE: [u32; 2] = [16, 16];

/// A film of all layers that `frame` asks for.
fn film_with(frame: &Frame, workers: Workers, tile_size: u32, samples: Range<u32>) -> Film {
    let film = Film::try_new(&layers(frame), Region::whole(SIZE[0], SIZE[1]), tile_size).expect("memory");
    let renderer = Renderer::new(workers).expect("threads start");
    let stats = renderer.render(frame, &SIMD, &film, samples, &Monitor::default());
    assert_eq!(stats.dropped.count, 0);
    film
}

fn film_of(frame: &Frame, samples: Range<u32>) -> Film {
    film_with(frame, WORKERS, 8, samples)
}

fn all() -> impl Iterator<Item = (String, Frame)> {
    seen_first(SIZE).into_iter().chain(seen_first_in_volumes(SIZE))
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)))
}

/// Index of the layer called `name`.
fn layer(film: &Film, name: &str) -> usize {
    film.layers().iter().position(|layer| layer.name == name).unwrap_or_else(|| panic!("no layer {name}"))
}

/// Mean of a channel of a layer over the image.
fn mean(film: &Film, name: &str, channel: usize) -> f64 {
    let layer = layer(film, name);
    let sum: f64 = pixels().map(|(x, y)| film.estimate(layer, channel, x, y).mean).sum();
    sum / f64::from(SIZE[0] * SIZE[1])
}

#[test]
fn every_stage_agrees_with_its_twin() {
    assert_stages_agree("seen first", seen_first(SIZE).into_iter().map(|(_, frame)| frame), 4);
    assert_stages_agree("in volumes", seen_first_in_volumes(SIZE).into_iter().map(|(_, frame)| frame), 4);
}

#[test]
fn layers_change_no_bit_of_the_radiance() {
    for (name, frame) in all() {
        let plain = film_of(&Frame { aovs: Aovs::default(), ..frame.clone() }, 0..3);
        assert!(plain.pixels().eq(film_of(&frame, 0..3).pixels()), "{name}");
    }
}

#[test]
fn threads_lanes_tiles_and_splits_leave_no_trace() {
    for (name, frame) in all() {
        let whole = film_of(&frame, 0..5);
        for (threads, lanes) in [(1, 256), (2, 24)] {
            let workers = Workers { threads, lanes: Some(lanes), ..WORKERS };
            assert!(film_with(&frame, workers, 8, 0..5).is_same(&whole), "{name}, {threads} threads");
        }
        let mut merged = film_of(&frame, 3..5);
        merged.merge(&film_of(&frame, 0..3));
        assert!(merged.is_same(&whole), "{name}");
        let other = film_with(&frame, WORKERS, 5, 0..5);
        for (layer, settings) in whole.layers().iter().enumerate() {
            for (channel, (x, y)) in (0..settings.channels).flat_map(|channel| pixels().map(move |at| (channel, at))) {
                assert_eq!(whole.exact(layer, channel, x, y), other.exact(layer, channel, x, y), "{name}");
            }
        }
    }
}

/// Units of an exact sum.
fn units(exact: &Exact) -> u128 {
    exact.sum.limbs().into_iter().rev().fold(0, |sum, limb| sum << 32 | u128::from(limb))
}

#[test]
fn techniques_add_up_to_the_radiance_exactly_and_lengths_do_too() {
    for (name, frame) in all() {
        let film = film_of(&frame, 0..7);
        let mut found = 0;
        for split in [Aov::Technique, Aov::Length] {
            let is_part = |kind| matches!(kind, Kind::Part(part) if format!("{part:?}").to_lowercase() == split.name());
            let parts: Vec<_> = (0..film.layers().len()).filter(|layer| is_part(film.layers()[*layer].kind)).collect();
            assert!(parts.len() > 1, "{name}: {parts:?}");
            for (channel, (x, y)) in (0..frame.channels()).flat_map(|channel| pixels().map(move |at| (channel, at))) {
                let whole = units(&film.exact(RADIANCE, channel, x, y));
                let sum: u128 = parts.iter().map(|layer| units(&film.exact(*layer, channel, x, y))).sum();
                assert_eq!(sum, whole, "{name}, {split:?}, pixel ({x}, {y})");
                found += whole;
                let shown = |layer| film.estimate(layer, channel, x, y).mean as f32;
                let (sum, whole) = (parts.iter().map(|layer| shown(*layer)).sum::<f32>(), shown(RADIANCE));
                assert!((sum - whole).abs() <= 1e-6 * whole, "{name}: {sum} and {whole}");
            }
        }
        assert!(found > 0, "{name}: nothing was found");
    }
}

#[test]
fn parts_are_those_of_the_scalar_integrator() {
    for (name, frame) in all() {
        let (film, origins) = (film_of(&frame, 0..1), Origin::of(&frame));
        let first = film.layers().iter().position(|layer| matches!(layer.kind, Kind::Part(_))).expect("parts");
        let mut apart = 0;
        for (pixel, (x, y)) in (0..).zip(pixels()) {
            let mut expected = vec![[0.0; 3]; film.layers().len() - first];
            for contribution in reference::contributions(&frame, pixel, 0) {
                // The walk's own finds are not told apart, but for what the camera sees.
                let origin = match contribution.technique {
                    Some(technique) => Origin::Connection(technique),
                    None if contribution.segments == 1 => Origin::View,
                    None => Origin::Path,
                };
                let place = origins.iter().position(|other| *other == origin).expect("an origin that there is");
                for part in [place, origins.len() + length_class(contribution.segments)] {
                    expected[part] = [0, 1, 2].map(|c| expected[part][c] + contribution.radiance[c]);
                }
            }
            let is_off = |(part, expected): (usize, &[f64; 3])| {
                (0..3).any(|c| {
                    let found = film.estimate(first + part, c, x, y).mean;
                    (found - expected[c]).abs() > 1e-6 + 2e-2 * expected[c]
                })
            };
            apart += u32::from(expected.iter().enumerate().any(is_off));
        }
        assert!(apart <= 3, "{name}: {apart} of 256 samples are apart");
    }
}

#[test]
fn lengths_are_renders_of_these_lengths_alone() {
    let base = frames::room(0.5, Selection::IntensityDistance, SIZE);
    for active in [Active::Path, Active::Nee] {
        let frame =
            frames::with_techniques(&Frame { lengths: PathLengths { min: 1, max: 12 }, ..base.clone() }, active, 3.0);
        let all = film_of(&with_all_layers(&frame), 0..4);
        for (name, min, max) in [
            ("length_1", 1, 1),
            ("length_2", 2, 2),
            ("length_3_to_4", 3, 4),
            ("length_5_to_8", 5, 8),
            ("length_9_up", 9, 12),
        ] {
            let alone = film_of(&Frame { lengths: PathLengths { min, max }, ..frame.clone() }, 0..4);
            let (mut sum, layer) = (0.0, layer(&all, name));
            for (channel, (x, y)) in (0..3).flat_map(|channel| pixels().map(move |at| (channel, at))) {
                let found = all.estimate(layer, channel, x, y).mean;
                let expected = alone.estimate(RADIANCE, channel, x, y).mean;
                let whole = all.estimate(RADIANCE, channel, x, y).mean;
                assert!((found - expected).abs() <= 1e-6 * whole, "{active:?}, {name}: {found} and {expected}");
                sum += expected;
            }
            assert!(sum > 0.0, "{active:?}, {name}: nothing was found");
        }
    }
}

#[test]
fn a_wall_in_vacuum_is_what_it_is() {
    let wall = frames::in_front_of_a_wall(0.0, SIZE);
    let film = film_of(&with_all_layers(&wall), 0..2);
    for (x, y) in pixels() {
        let value = |name, channel| film.estimate(layer(&film, name), channel, x, y).mean;
        assert!((value("depth", 0) - frames::WALL_DISTANCE).abs() < 1e-5, "{}", value("depth", 0));
        assert_eq!(value("depth", 1), 1.0);
        assert_eq!([0, 1, 2].map(|axis| value("normal", axis)), [0.0, 0.0, -1.0]);
        for channel in 0..3 {
            assert!((value("albedo", channel) - frames::WALL_ALBEDO[channel]).abs() < 1e-7);
            assert_eq!(value("transmittance", channel), 1.0);
        }
    }
}

/// `found` is `expected` within the noise of samples that are `deviation` apart.
fn assert_mean(case: &str, found: f64, expected: f64, deviation: f64, samples: f64) {
    let error = deviation / samples.sqrt();
    assert!((found - expected).abs() < 4.0 * error + 1e-6, "{case}: {found} +- {error}, expected {expected}");
}

#[test]
fn fog_before_a_wall_has_its_closed_forms() {
    // Aimed flights would shift the depth if their weights were left out.
    for (extinction, aimed) in [(0.4, 0.0), (0.4, 0.5), (1.5, 0.3)] {
        let fog = Frame { aimed, ..frames::in_front_of_a_wall(extinction, SIZE) };
        let (film, samples) = (film_of(&with_all_layers(&fog), 0..64), 64.0 * 256.0);
        let [t, d] = [f64::from(extinction), frames::WALL_DISTANCE];
        // The camera's field is narrow: rays and axis differ by less than the noise.
        let gone = (-t * d).exp();
        let depth = (1.0 - gone) / t;
        let square = 2.0 / (t * t) * (1.0 - gone * (1.0 + t * d));
        assert_mean("depth", mean(&film, "depth", 0), depth, (square - depth * depth).sqrt(), samples);
        assert_eq!(mean(&film, "depth", 1), 1.0);
        let deviation = (gone * (1.0 - gone)).sqrt();
        assert_mean("normal", -mean(&film, "normal", 2), gone, deviation, samples);
        for channel in 0..3 {
            let [wall, fog] = [frames::WALL_ALBEDO[channel], f64::from(fog.medium.albedo[channel])];
            let expected = gone * wall + (1.0 - gone) * fog;
            assert_mean("albedo", mean(&film, "albedo", channel), expected, deviation * (wall - fog).abs(), samples);
            let through = mean(&film, "transmittance", channel);
            assert!((through - gone).abs() < 1e-5 * gone, "transmittance {through}, expected {gone}");
        }
    }
}

#[test]
fn what_clouds_let_through_is_what_flights_get_through_and_what_the_camera_sees_of_the_sky() {
    let (_, cloud) = frames::skies::clouds(SIZE).into_iter().nth(1).expect("clouds");
    let sky = [Source::Sky([1.0; 3])];
    let cloud = frames::skies::only_under(&cloud, &sky, Selection::Uniform);
    let film = film_of(&with_all_layers(&frames::with_techniques(&cloud, Active::Path, 3.0)), 0..256);
    let [through, view, depth] = ["transmittance", "technique_view", "depth"].map(|name| layer(&film, name));
    for (case, found) in [
        ("flights", &(|x, y| 1.0 - film.estimate(depth, 1, x, y).mean) as &dyn Fn(u32, u32) -> f64),
        ("views", &|x, y| film.estimate(view, 0, x, y).mean),
    ] {
        let differences: Vec<_> = pixels().map(|(x, y)| film.estimate(through, 0, x, y).mean - found(x, y)).collect();
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        let deviation = (differences.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
        assert!(deviation > 0.0 && mean.abs() < 4.0 * deviation / count.sqrt(), "{case}: {mean} +- {deviation}");
    }
    let shown = mean(&film, "transmittance", 0);
    assert!((0.05..0.95).contains(&shown), "a cloud that says something: {shown}");
}

#[test]
fn where_nothing_is_there_is_no_depth() {
    let (_, lamps) = frames::skies::rooms(SIZE).into_iter().next().expect("lamps under a sky");
    let film = film_of(&with_all_layers(&lamps), 0..8);
    let (mut nothing, mut black) = (0, 0);
    for (x, y) in pixels() {
        let value = |name, channel| film.estimate(layer(&film, name), channel, x, y).mean;
        let [depth, hit] = [0, 1].map(|channel| value("depth", channel));
        assert!((hit == 0.0 && depth == 0.0) || (hit > 0.0 && depth > 0.0), "({x}, {y}): {depth}, {hit}");
        assert_eq!(value("transmittance", 0), 1.0, "vacuum lets everything through");
        let [albedo, normal] = ["albedo", "normal"].map(|name| [0, 1, 2].map(|channel| value(name, channel)));
        assert_eq!(hit == 0.0, normal == [0.0; 3], "({x}, {y})");
        assert!(hit > 0.0 || albedo == [0.0; 3], "({x}, {y})");
        nothing += u32::from(hit == 0.0);
        black += u32::from(hit == 1.0 && albedo == [0.0; 3]);
    }
    assert!(nothing > 0 && black > 0, "{nothing} pixels of nothing, {black} of lamps");
}
