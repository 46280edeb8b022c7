//! Lights at infinity: what closed forms say of them, and that all techniques say the same.

use core::f64::consts::{PI, TAU};
use std::sync::Arc;

use fogbow::film::Film;
use fogbow::frame::Frame;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::media::Medium;
use fogbow_kernels::media::field::{Field, Interpolation, Voxels};
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Panorama, Selection, Source};
use fogbow_kernels::tables::surfaces::Material;
use fogbow_testing::agreement::{assert_stages_agree, assert_whole_paths_agree};
use fogbow_testing::frames::clouds::{IN_FIELDS, centred, cloud, leaves};
use fogbow_testing::frames::{self, Active, skies};
use fogbow_testing::render::{green, render};
use fogbow_testing::statistics::z_of_means;
use glam::DVec3;

const SMALL: [u32; 2] = [16, 16];

fn lights(sources: &[Source]) -> Lights {
    Lights::new(Vec::new(), Selection::Uniform).with_distant(sources, Selection::Intensity)
}

fn sun(direction: DVec3, irradiance: f64, degrees: f64) -> Source {
    Source::Sun { direction, irradiance: [irradiance; 3], angular_radius: degrees.to_radians() }
}

/// An empty world that the camera sees from (0, 1, -4), with next event estimation.
fn world(sources: &[Source], longest: u32) -> Frame {
    let camera = Camera::new(DVec3::new(0.0, 1.0, -4.0), DVec3::Z, DVec3::Y, 0.6, 0.0, SMALL);
    let frame = frames::plain(camera, Medium::vacuum(), lights(sources), longest, 3);
    Frame { techniques: Techniques { nee: true, ..Techniques::default() }, ..frame }
}

/// A box from -0.5 to 0.5, 0.5 to 1.5 and -0.5 to 0.5, seen from outside.
fn closed_box(albedo: [f32; 3]) -> Vec<(Material, Vec<[[f32; 3]; 3]>)> {
    let corner = |i: usize| [(i & 1) as f32 - 0.5, (i >> 1 & 1) as f32 + 0.5, (i >> 2) as f32 - 0.5];
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let triangles = triangles.map(|triangle| triangle.map(|i| corner(*i))).collect();
    vec![(Material::plain(albedo, false), triangles)]
}

/// `frame` with a medium of this extinction and albedo in a box where the other one is.
fn with_block(frame: &Frame, extinction: f32, albedo: f32) -> Frame {
    let grid = Field::block([[-0.5, 0.5, -0.5], [0.5, 1.5, 0.5]], extinction);
    let medium = Medium::of_field(grid, [albedo; 3], PhaseFunction::henyey_greenstein(0.4));
    frames::with_medium(frame, medium)
}

/// Every pixel within 5 standard errors of `truth`, but for the one path in many thousands that finds a small sun without
/// a connection, and the mean of all within 4.
fn assert_every_pixel_is(case: &str, frame: &Frame, samples: u32, truth: f64) {
    let film = rendered(case, frame, samples);
    for pixel in film.pixels() {
        let (found, error) = (pixel.mean[1], pixel.standard_error[1]);
        assert!((found - truth).abs() <= 5.0 * error + 1e-4 * truth, "{case}: {found} +- {error} instead of {truth}");
    }
    assert_mean_is(case, &film, truth);
}

/// The mean of all pixels within 4 standard errors of `truth`, and known to a hundredth: where something rare is bright,
/// the few samples of one pixel do not know their own error.
fn assert_image_is(case: &str, frame: &Frame, samples: u32, truth: f64) {
    let film = rendered(case, frame, samples);
    assert_mean_is(case, &film, truth);
    assert!(green(&film).1 < 0.01 * truth, "{case}: {:?} says little", green(&film));
}

fn rendered(case: &str, frame: &Frame, samples: u32) -> Film {
    let (film, stats) = render(frame, SMALL, 0..samples);
    assert_eq!(stats.dropped.count, 0, "{case}: {:?}", stats.dropped.first);
    film
}

fn assert_mean_is(case: &str, film: &Film, truth: f64) {
    let (mean, error) = green(film);
    assert!((mean - truth).abs() <= 4.0 * error + 1e-4 * truth, "{case}: {mean} +- {error} instead of {truth}");
}

#[test]
fn a_white_body_is_invisible_under_an_even_sky() {
    let sky = [Source::Sky([1.0; 3])];
    for nee in [true, false] {
        let frame = world(&sky, 60);
        let techniques = Techniques { nee, ..Techniques::default() };
        let frame = Frame { surfaces: frames::surfaces(&closed_box([1.0; 3])), techniques, ..frame };
        assert_every_pixel_is(&format!("body, nee {nee}"), &frame, 64, 1.0);
    }
}

#[test]
fn a_white_cloud_is_invisible_under_an_even_sky() {
    let base = world(&[Source::Sky([1.0; 3])], 250);
    let lumpy = cloud(1.6, DVec3::new(0.0, 1.0, 0.0), 6.0, Interpolation::Trilinear);
    let medium = Medium::of_field(lumpy, [1.0; 3], PhaseFunction::henyey_greenstein(0.6));
    for (name, frame) in [("block", with_block(&base, 4.0, 1.0)), ("cloud", frames::with_medium(&base, medium))] {
        for active in IN_FIELDS {
            let frame = frames::with_techniques(&frame, active, 4.0);
            assert_image_is(&format!("{name}, {active:?}"), &frame, 64, 1.0);
            // Few starts and short walks are right, too.
            let few = frame.with_walk(1, 0.9);
            assert_image_is(&format!("{name}, {active:?}, 1 start"), &few, 64, 1.0);
        }
    }
}

/// Within a voxel, extinction goes from 0 to 30 mean free paths: what a mean of that says of optical depths is wrong by
/// many of them.
#[test]
fn light_comes_through_the_rim_of_what_is_dense() {
    let center = DVec3::new(0.0, 1.0, 0.0);
    let cube = Voxels::new(&leaves(2, |_| 1.0), &centred(16, 1.0, center), Interpolation::Trilinear);
    let medium = Medium::of_field(Field::grid(cube, 480.0), [1.0; 3], PhaseFunction::henyey_greenstein(0.4));
    let base = world(&[Source::Sky([1.0; 3])], 60);
    let camera = Camera::new(DVec3::new(0.0, 1.0, -4.0), DVec3::Z, DVec3::Y, 0.2, 0.0, SMALL);
    let connected = Frame { camera, roulette: 1.0, ..frames::with_medium(&base, medium) };
    let walked = Frame { techniques: Techniques::default(), roulette: 0.0, ..connected.clone() };
    let [connected, walked] = [connected, walked].map(|frame| green(&rendered("cube", &frame, 512)));
    let z = z_of_means(connected, walked);
    assert!(z.abs() < 4.0, "{connected:?} with connections, {walked:?} without: {z} standard errors");
    assert!(connected.1 < 0.01 * walked.0, "{connected:?} says little");
}

/// A floor that fills the view of a camera which looks down at it.
fn floor(sources: &[Source], albedo: f32) -> Frame {
    let [a, b, c, d] = [[-9.0, 0.0, -9.0], [-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, -9.0]];
    let surfaces = frames::surfaces(&[(Material::plain([albedo; 3], false), vec![[a, b, c], [a, c, d]])]);
    let camera = Camera::new(DVec3::new(0.0, 4.0, 0.0), -DVec3::Y, DVec3::Z, 0.6, 0.0, SMALL);
    Frame { surfaces, camera, ..world(sources, 4) }
}

#[test]
fn a_plane_reflects_the_irradiance_of_the_sun_and_the_radiance_of_the_sky() {
    for degrees in [0.01, 0.265, 10.0] {
        for down in [DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, -1.5, 0.3)] {
            let cosine = -down.normalize().y;
            let truth = 0.6 / PI * 5.0 * cosine;
            let (case, frame) = (format!("sun of {degrees} degrees"), floor(&[sun(down, 5.0, degrees)], 0.6));
            match degrees {
                // A wide sun is met by a walk now and then, which some pixels have not yet heard of.
                10.0 => assert_image_is(&case, &frame, 256, truth),
                _ => assert_every_pixel_is(&case, &frame, 256, truth),
            }
        }
    }
    assert_every_pixel_is("sky", &floor(&[Source::Sky([2.0; 3])], 0.6), 256, 1.2);
    let both = floor(&[Source::Sky([2.0; 3]), sun(-DVec3::Y, 5.0, 0.265)], 0.6);
    assert_every_pixel_is("sky and sun", &both, 256, 1.2 + 0.6 / PI * 5.0);
}

#[test]
fn a_plane_has_the_irradiance_of_an_image() {
    for rotation in [0.0, 1.0] {
        let panorama = Arc::new(skies::panorama([16, 8], rotation));
        // The sum over the pixels of the upper half of radiance times the integral of the cosine.
        let mut irradiance = 0.0;
        for (row, column) in (0..4).flat_map(|row| (0..16).map(move |column| (row, column))) {
            let sine = |row: u32| (PI * f64::from(row) / 8.0).sin();
            let projected = TAU / 16.0 * (sine(row + 1).powi(2) - sine(row).powi(2)) / 2.0;
            irradiance += f64::from(panorama.texel(column, row)[1] * panorama.largest()) * projected;
        }
        let frame = floor(&[Source::Panorama(panorama)], 0.5);
        assert_every_pixel_is(&format!("turned by {rotation}"), &frame, 1024, 0.5 * irradiance / PI);
    }
}

#[test]
fn the_camera_sees_the_pixels_of_an_image() {
    let panorama = Arc::new(skies::panorama([16, 8], 0.4));
    let frame = world(&[Source::Panorama(panorama.clone())], 3);
    let film = render(&frame, SMALL, 0..1).0;
    for (pixel, found) in (0..).zip(film.pixels()) {
        let (_, direction) = fogbow_kernels::generate::reference::camera_ray(&frame.camera, pixel, 0, frame.seed);
        let [column, row] = fogbow_kernels::connect::distant::reference::pixel(&panorama, direction);
        let expected = panorama.texel(column, row).map(|texel| f64::from(texel * panorama.largest()));
        for (found, expected) in found.mean.into_iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-5 * expected, "pixel {pixel}: {found}, not {expected}");
        }
    }
}

#[test]
fn what_absorbs_lets_through_what_it_should() {
    // Straight through the box, from face to face, whatever else is at infinity.
    let sources = [Source::Sky([1.0; 3]), sun(-DVec3::Z, 1.0, 40.0)];
    let radiance = 1.0 + sources[1].radiance()[1];
    for extinction in [0.1, 1.0, 8.0] {
        let frame = with_block(&world(&sources, 5), extinction, 0.0);
        let camera = Camera::new(DVec3::new(0.0, 1.0, -4.0), DVec3::Z, DVec3::Y, 1e-3, 0.0, SMALL);
        let truth = radiance * f64::from(-extinction).exp();
        assert_every_pixel_is(&format!("extinction {extinction}"), &Frame { camera, ..frame }, 4, truth);
    }
}

#[test]
fn all_techniques_have_the_same_means_by_length() {
    let sources = [Source::Sky([0.5; 3]), sun(DVec3::new(0.4, -1.0, 0.7), 2.0, 12.0)];
    let base = with_block(&world(&sources, 5), 3.0, 0.9);
    for segments in 2..=5 {
        let of = |active: Active| {
            let frame = frames::with_length(&frames::with_techniques(&base, active, 4.0), segments);
            green(&render(&frame, SMALL, 0..400).0)
        };
        let path = of(Active::Path);
        for active in &IN_FIELDS[1..] {
            let found = of(*active);
            assert!(z_of_means(found, path).abs() < 4.2, "{segments} segments, {active:?}: {found:?} and {path:?}");
            assert!(found.1 < path.1, "{segments} segments, {active:?}: {found:?} is not better than {path:?}");
        }
    }
}

#[test]
fn lamps_and_skies_add_up() {
    for (name, frame) in skies::clouds(SMALL) {
        let frame = frames::with_techniques(&frame, Active::Bridge, 4.0);
        let distant = frame.lights.first_distant() as usize;
        let (both, _) = render(&frame, SMALL, 0..200);
        let without = Lights::new(frame.lights.bodies().to_vec(), Selection::IntensityDistance);
        let lamps = (distant > 0).then(|| Frame { lights: without, ..frame.clone() });
        let lamps = lamps.map_or((0.0, 0.0), |frame| green(&render(&frame, SMALL, 0..200).0));
        // Lamps that are out still hide a little of the sky.
        let out = |lamp: &Emitter| Emitter { radiance: lamp.radiance.map(|channel| channel * 1e-20), ..*lamp };
        let bodies = frame.lights.bodies().iter().map(out).collect();
        let sky = Frame { lights: frame.lights.with_bodies(bodies), ..frame };
        let sky = green(&render(&sky, SMALL, 0..200).0);
        let sum = (lamps.0 + sky.0, lamps.1.hypot(sky.1));
        let (found, error) = green(&both);
        assert!((found - sum.0).abs() < 4.5 * error.hypot(sum.1), "{name}: {found} instead of {sum:?}");
    }
}

#[test]
fn every_stage_agrees_with_its_twin_around_clouds() {
    for (name, cloud) in skies::clouds(SMALL) {
        assert_stages_agree(&name, IN_FIELDS.map(|active| frames::with_techniques(&cloud, active, 4.0)).into_iter(), 4);
    }
}

#[test]
fn whole_paths_agree_with_the_scalar_integrator_around_clouds() {
    for (name, cloud) in skies::clouds(SMALL) {
        for active in IN_FIELDS {
            let found =
                assert_whole_paths_agree(&format!("{name}, {active:?}"), &frames::with_techniques(&cloud, active, 4.0));
            // Walks alone may miss a small sun.
            assert!(found > 0.0 || active == Active::Path, "{name}, {active:?}");
        }
    }
}

#[test]
fn the_sums_of_a_film_hold_the_brightest_suns() {
    let frame = floor(&[sun(-DVec3::Y, 1e20, 0.001), Source::Sky([1.0; 3])], 0.5);
    let truth = 0.5 * (1e20 / PI + 1.0);
    assert_every_pixel_is("a bright sun", &frame, 16, truth);
    let frame = world(&[sun(-DVec3::Z, 1e20, 30.0)], 3);
    let (mean, _) = green(&render(&frame, SMALL, 0..4).0);
    assert!(mean > 1e20 / PI && mean.is_finite(), "{mean}");
}

#[test]
fn a_black_image_makes_a_black_picture() {
    let black = Panorama::new([4, 2], vec![[0.0; 3]; 8], 0.0);
    let frame = floor(&[Source::Panorama(Arc::new(black))], 0.5);
    let (film, stats) = render(&frame, SMALL, 0..4);
    assert_eq!((green(&film).0, stats.dropped.count), (0.0, 0));
}

/// Nobody can aim at what has no place: a share of the flights would be missing.
#[test]
fn first_flights_are_not_aimed_under_the_sky_alone() {
    let fog = Frame { aimed: 0.4, ..frames::fog_facing(0.0, 0.9, [4, 4]) };
    for (name, sources) in skies::sources() {
        let both = skies::under(&fog, &sources, Selection::Uniform);
        assert!(both.aims() && !skies::only_under(&fog, &sources, Selection::Uniform).aims(), "{name}");
    }
}
