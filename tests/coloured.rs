//! Extinction that differs between channels: every channel is as if all had its extinction.

use std::path::Path;

use fogbow::frame::Frame;
use fogbow::scene::{self, document::Override};
use fogbow_kernels::media::Medium;
use fogbow_kernels::media::field::{Field, Shape};
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::pipeline::{REFERENCE, SIMD};
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::agreement::{assert_same, assert_same_of, means};
use fogbow_testing::frames::clouds::{IN_FIELDS, colours, solid};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::{WORKERS, render, render_with};
use fogbow_testing::suite::{half, some};
use glam::DVec3;

const SMALL: [u32; 2] = [16, 16];

/// `frame` in grey extinction: that of one channel.
fn grey(frame: &Frame, channel: usize) -> Frame {
    frames::with_extinction(frame, frame.medium.extinctions()[channel])
}

/// Means in the grey extinction of every channel, of which each has its own render.
fn grey_means(grey: impl Fn(usize) -> Frame, active: Active, samples: u32) -> [(f64, f64); 3] {
    [0, 1, 2].map(|channel| {
        let frame = frames::with_techniques(&grey(channel), active, 4.0);
        means(&Frame { seed: 1000 + channel as u32, ..frame }, samples)[channel]
    })
}

/// One comparison in 40000 fails by chance; there are some 400 in the long suite. Others look at the lengths whose `turn`
/// it is.
fn assert_that_of_grey_extinction(name: &str, base: &Frame, turn: usize, samples: u32) {
    for segments in some(1..=5, turn, 2) {
        let frame = frames::with_length(base, segments);
        let truth = grey_means(|channel| grey(&frame, channel), Active::Every, half(2 * samples));
        for active in Active::ALL {
            let seed = 100 * active as u32 + segments;
            let found = means(&Frame { seed, ..frames::with_techniques(&frame, active, 4.0) }, half(samples));
            assert_same_of(active, &format!("{name}, {segments} segments"), found, truth);
        }
    }
}

#[test]
fn every_technique_has_the_means_of_grey_fog_in_every_channel() {
    let [(name, lights), _] = frames::coloured(SMALL);
    assert_that_of_grey_extinction(name, &lights, 0, 800);
}

#[test]
fn every_technique_has_the_means_of_grey_fog_among_surfaces() {
    let [_, (name, room)] = frames::coloured(SMALL);
    assert_that_of_grey_extinction(name, &room, 1, 800);
}

/// Volumes and haze that differ in colour: no channel follows from another.
#[test]
fn volumes_of_several_colours_have_the_means_of_grey_ones_in_every_channel() {
    for (turn, colours) in colours(SMALL).iter().enumerate() {
        for segments in some(1..=4, turn, 2) {
            let of_length = |frame: &Frame| frames::with_length(frame, segments);
            let truth = grey_means(|channel| of_length(&colours.grey(channel)), Active::Nee, half(2000));
            for active in IN_FIELDS {
                let frame = frames::with_techniques(&of_length(&colours.frame), active, 4.0);
                let found = means(&Frame { seed: 100 * active as u32 + segments, ..frame }, half(1000));
                assert_same_of(active, &format!("{}, {segments} segments", colours.name), found, truth);
            }
        }
    }
}

#[test]
fn few_starts_survival_aimed_flights_and_roulette_keep_the_means() {
    for (turn, (name, base)) in frames::coloured(SMALL).into_iter().enumerate() {
        let base = Frame { aimed: 0.0, ..base };
        let truth = grey_means(|channel| grey(&base, channel), Active::Every, half(3000));
        let few = frames::with_techniques(&base, Active::Bridge, 4.0).with_walk(2, 0.8);
        let kinds = [
            ("few starts", few.clone()),
            ("aimed", Frame { aimed: 0.4, ..few.clone() }),
            ("roulette", Frame { roulette: 0.2, ..few }),
        ];
        for (kind, frame) in some(kinds, turn + 1, 2) {
            assert_same(&format!("{name}, {kind}"), means(&frame, half(4000)), truth);
        }
    }
}

/// A narrow look at a lamp two metres away.
fn at_a_lamp(medium: Medium) -> Frame {
    let lamp = Emitter::disk(DVec3::new(0.0, 0.0, 2.0), -DVec3::Z, 1.0, [5.0; 3]);
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1e-3, 0.0, SMALL);
    frames::plain(camera, medium, Lights::new(vec![lamp], Selection::Uniform), 4, 1)
}

/// A lamp seen through a medium that only absorbs: e^{-mu_c d} in every channel, without noise.
#[test]
fn lamps_seen_through_ink_have_its_transmittance() {
    // The densest leaves nothing that a number could hold.
    for extinction in [[0.1, 0.7, 3.0], [500.0, 0.7, 0.1], [0.7, 60.0, 0.1], [0.01, 0.1, 500.0]] {
        let medium = Medium::coloured(extinction, [0.0; 3], PhaseFunction::isotropic());
        let frame = at_a_lamp(medium);
        for pipeline in [SIMD, REFERENCE] {
            let (film, stats) = render_with(&frame, &pipeline, WORKERS, SMALL, 32, 0..4);
            assert_eq!(stats.dropped.count, 0, "{extinction:?}");
            for (found, extinction) in film.mean().0.into_iter().zip(extinction) {
                let expected = 5.0 * (-2.0 * f64::from(extinction)).exp();
                assert!((found - expected).abs() < 2e-6 * expected + 1e-12, "{found}, expected {expected}");
            }
        }
    }
}

/// The same through half a metre of a block in haze, each of a colour of its own: what flights of one channel do not say
/// of another is estimated, or known.
#[test]
fn lamps_seen_through_a_block_in_haze_have_the_transmittance_of_both() {
    let block = || vec![solid(Shape::block([[-1.0, -1.0, 0.5], [1.0, 1.0, 1.0]]), 2.0)];
    for (inside, haze) in
        [([0.1, 1.0, 0.4], [0.3, 0.1, 0.5]), ([1.0, 0.0, 1.0], [0.0, 0.2, 0.2]), ([1.0; 3], [0.0, 0.1, 1.0])]
    {
        let field = Field::of_colours(block(), &[inside], haze);
        let frame = at_a_lamp(Medium::of_field(field, [0.0; 3], PhaseFunction::isotropic()));
        for pipeline in [SIMD, REFERENCE] {
            let (film, stats) = render_with(&frame, &pipeline, WORKERS, SMALL, 32, 0..64);
            assert_eq!(stats.dropped.count, 0);
            let (mean, error) = film.mean();
            for c in 0..3 {
                let expected = 5.0 * (-2.0 * 0.5 * f64::from(inside[c]) - 1.5 * f64::from(haze[c])).exp();
                let off = (mean[c] - expected).abs();
                assert!(
                    off < 4.2 * error[c] + 1e-5 * expected,
                    "{inside:?} in {haze:?}, channel {c}: {} +- {}, expected {expected}",
                    mean[c],
                    error[c]
                );
                assert!(error[c] < 0.02 * expected, "{} +- {} says little", mean[c], error[c]);
            }
        }
    }
}

/// A channel without extinction is given a millionth of the densest one's, which nobody sees.
#[test]
fn a_clear_channel_stays_clear() {
    let base = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let medium = Medium::coloured([0.0, 0.8, 1.6], [0.0, 0.9, 0.5], PhaseFunction::henyey_greenstein(0.6));
    let clear = frames::with_medium(&base, medium);
    let vacuum = Frame { techniques: Default::default(), ..frames::with_medium(&base, Medium::vacuum()) };
    let grey = grey_means(|channel| grey(&clear, channel), Active::Every, half(3000));
    let truth = [means(&vacuum, half(3000))[0], grey[1], grey[2]];
    for active in Active::ALL {
        let found = means(&Frame { seed: 7, ..frames::with_techniques(&clear, active, 4.0) }, half(800));
        assert_same(&format!("{active:?}"), found, truth);
    }
}

/// Variance of a sample, mean over the pixels, per channel.
fn variances(frame: &Frame, size: [u32; 2], samples: u32) -> [f64; 3] {
    let (film, _) = render(frame, size, 0..samples);
    let mut sums = [0.0; 3];
    for pixel in film.pixels() {
        for (sum, error) in sums.iter_mut().zip(pixel.standard_error) {
            *sum += error * error;
        }
    }
    sums
}

/// Checks that no channel pays for the others: how much more variance each has than a grey render of it.
fn assert_variances(name: &str, coloured: &Frame, size: [u32; 2], samples: u32, limit: f64) {
    for (channel, found) in variances(coloured, size, samples).into_iter().enumerate() {
        let quotient = found / variances(&grey(coloured, channel), size, samples)[channel];
        assert!(quotient < limit, "{name}, channel {channel}: {quotient} x the variance of grey fog");
    }
}

/// Techniques, samples that tell their variance, and what colour may cost them.
const COSTS: [(&str, u32, f64); 4] =
    [("path", 2000, 3.0), ("nee", 1000, 3.0), ("mvnee", 400, 3.0), ("bridge", 100, 2.0)];

#[test]
fn colour_costs_little_variance() {
    let size = [32, 32];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog-coloured");
    for (technique, samples, limit) in COSTS {
        let settings = [
            format!("film.size={size:?}"),
            format!("render.technique={technique}"),
            "render.starts=all".into(),
            "render.survival=1".into(),
        ];
        let settings = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
        let frame = scene::load(&folder, settings).unwrap_or_else(|error| panic!("{error}")).frame;
        assert_variances(technique, &frame, size, samples, limit);
    }
}

/// A lamp four mean free paths away in each of the media.
#[test]
fn presets_cost_little_variance() {
    let size = [16, 16];
    for preset in some(["milk", "skim_milk", "sea_water", "skin", "wax"], 0, 2) {
        let parse = |distance: f64, technique: &str| {
            let text = format!(
                "camera = {{ position = [0, 0, 0], look_at = [0, 0, 1], vertical_fov_deg = 50 }}\nfilm.size = {size:?}\n\
                 medium.preset = \"{preset}\"\nrender = {{ technique = \"{technique}\", max_segments = 24, \
                 starts = \"all\", survival = 1 }}\n[[light]]\ntype = \"disk\"\ncenter = [0, 0, {distance:?}]\n\
                 normal = [0, 0, -1]\nradius = {:?}\nradiance = 10\n",
                0.2 * distance
            );
            scene::parse("scene.toml", &text).unwrap_or_else(|error| panic!("{error}")).frame
        };
        let extinction = parse(1.0, "path").medium.extinctions();
        let distance = 12.0 / f64::from(extinction.into_iter().sum::<f32>());
        for (technique, samples, limit) in COSTS {
            let name = format!("{preset}, {technique}");
            assert_variances(&name, &parse(distance, technique), size, samples, limit);
        }
    }
}
