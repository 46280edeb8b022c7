//! Scenes whose radiance is known: absorption only, one scattering event, and what must hold for all.

use std::sync::Arc;

use fogbow::film::aov::Aovs;
use fogbow::frame::Frame;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{PathLengths, WalkLimits};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::quadrature::{Emission, LitFog};
use fogbow_testing::render::{green, render};
use fogbow_testing::truths;
use glam::DVec3;

/// A camera so narrow that it is one ray along +z.
fn ray_camera(near: f64) -> Camera {
    Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1e-6, near, [1, 1])
}

#[test]
fn an_absorbing_medium_dims_a_light_by_beer_lambert() {
    for (distance, absorption, near) in [(5.0, 0.3, 0.0), (5.0, 0.3, 1.0), (40.0, 0.5, 0.5), (1.0, 0.0, 0.0)] {
        let medium = Medium::homogeneous(absorption as f32, [0.0; 3], PhaseFunction::henyey_greenstein(0.3));
        let disk = Emitter::disk(DVec3::new(0.0, 0.0, distance), -DVec3::Z, 1.0, [2.0, 3.0, 4.0]);
        let base = frames::plain(ray_camera(near), medium, Lights::new(vec![disk], Selection::Uniform), 10, 3);
        for active in Active::ALL {
            let pixel = render(&frames::with_techniques(&base, active, 4.0), [1, 1], 0..4).0.pixel(0, 0);
            let expected = (-absorption * (distance - near)).exp();
            for (mean, radiance) in pixel.mean.iter().zip([2.0, 3.0, 4.0]) {
                let relative = mean / (radiance * expected);
                assert!((relative - 1.0).abs() < 2e-6, "{active:?}: {mean} is off by a factor {relative}");
            }
            // The fixed point of the sums resolves 1e-12 of the light.
            assert!(pixel.standard_error.iter().all(|error| *error < 1e-6), "{active:?}: noise where there is none");
        }
    }
}

/// The published single-scattering scene with the given camera.
fn single_scatter(camera: Camera, active: Active) -> Frame {
    let extinction = 1.1;
    let medium = Medium::homogeneous(extinction, [0.8 / 1.1; 3], PhaseFunction::henyey_greenstein(0.7));
    let disk = Emitter::disk(DVec3::new(0.8, 0.5, 4.0), DVec3::new(-0.3, 0.2, -1.0), 0.5, [10.0, 5.0, 2.5]);
    let base = frames::plain(camera, medium, Lights::new(vec![disk], Selection::Uniform), 2, 5);
    frames::with_techniques(&base, active, f64::INFINITY)
}

/// What surrounds its disk, as quadrature sees it.
const LIT_FOG: LitFog = LitFog {
    scattering: 0.8,
    extinction: 1.1,
    g: 0.7,
    center: DVec3::new(0.8, 0.5, 4.0),
    normal: DVec3::new(-0.3, 0.2, -1.0),
    radius: 0.5,
    emission: Emission::Even,
};

#[test]
fn one_scattering_event_has_the_radiance_of_the_quadrature() {
    for (near, recorded) in [(1.0, 0.033_092_55), (0.0, 0.014_787_97)] {
        let expected = 10.0 * LIT_FOG.scattered_once(near);
        assert!((expected / recorded - 1.0).abs() < 1e-3, "quadrature gives {expected} instead of {recorded}");
        for active in [Active::Nee, Active::Mvnee, Active::MvneeGaussian, Active::Both] {
            let film = render(&single_scatter(ray_camera(near), active), [1, 1], 0..2_000_000).0;
            let pixel = film.pixel(0, 0);
            let z = (pixel.mean[0] - recorded) / pixel.standard_error[0];
            assert!(z.abs() < 4.0, "near {near}, {active:?}: {} instead of {recorded}, z = {z}", pixel.mean[0]);
            assert!((pixel.mean[0] / pixel.mean[2] - 4.0).abs() < 1e-3, "channels differ by the light's colour only");
        }
    }
}

#[test]
fn the_noise_free_single_scattering_image_is_met_in_every_pixel() {
    let truth = truths::image("single-scatter-near1");
    let size = [truth.width as u32, truth.height as u32];
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, frames::UNIT_FOV, 1.0, size);
    let film = render(&single_scatter(camera, Active::Nee), size, 0..20_000).0;
    let (red, errors) = (truth.channel("R").expect("red"), truth.channel("SE.R").expect("errors"));
    let (mut chi_square, mut count) = (0.0, 0);
    for (i, pixel) in film.pixels().enumerate().filter(|(i, _)| errors[*i] < 1e8) {
        let z = (pixel.mean[0] - f64::from(red[i])) / pixel.standard_error[0].max(1e-9 * f64::from(red[i]));
        assert!(z.abs() < 5.5, "pixel {i}: {} instead of {}, z = {z}", pixel.mean[0], red[i]);
        chi_square += z * z;
        count += 1;
    }
    assert_eq!(count, 216);
    let p = fogbow_testing::statistics::p_of_chi_square(chi_square, count);
    assert!(p > 1e-4, "chi-square {chi_square} of {count} pixels, p = {p}");
}

#[test]
fn lengths_can_be_counted_in_mean_free_paths() {
    // Extinction times k and lengths over k give the same image.
    let base = frames::fog_facing(0.5, 0.7, [8, 8]);
    let (mean, error) = green(&render(&base, [8, 8], 0..4000).0);
    for scale in [1e-4, 1e4] {
        let Medium { albedo, phase, .. } = base.medium.clone();
        let medium = Medium::homogeneous((1.7 / scale) as f32, albedo, phase);
        let disk = Emitter::disk(DVec3::new(0.0, 0.0, 5.0 * scale), -DVec3::Z, 0.5 * scale, [80.0; 3]);
        let frame = Frame {
            camera: Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, frames::UNIT_FOV, 0.5 * scale, [8, 8]),
            techniques: Active::Mvnee.techniques(&medium, 5, 4.0),
            medium,
            lights: Lights::new(vec![disk], Selection::Uniform),
            surfaces: Arc::new(Surfaces::none()),
            ..base.clone()
        };
        // The random numbers are the same, so that only rounding differs.
        let scaled = green(&render(&frame, [8, 8], 0..4000).0).0;
        assert!((scaled - mean).abs() < 0.05 * error, "scale {scale}: {scaled} instead of {mean} +- {error}");
    }
}

#[test]
fn axes_can_be_exchanged() {
    let base = frames::fog(0.3, 0.8, DVec3::new(0.2, 0.7, -0.6), [12, 12]);
    let (mean, error) = green(&render(&base, [12, 12], 0..3000).0);
    let disk = Emitter::disk(DVec3::new(5.0, 0.0, 0.0), DVec3::new(-0.6, 0.2, 0.7), 0.5, [80.0; 3]);
    let permuted = Frame {
        camera: Camera::new(DVec3::ZERO, DVec3::X, DVec3::Z, frames::UNIT_FOV, 0.3, [12, 12]),
        lights: Lights::new(vec![disk], Selection::Uniform),
        surfaces: Arc::new(Surfaces::none()),
        ..base.clone()
    };
    let found = green(&render(&permuted, [12, 12], 0..3000).0);
    let z = fogbow_testing::statistics::z_of_means((mean, error), found);
    assert!(z.abs() < 4.0, "{found:?} instead of {mean} +- {error}");
}

#[test]
fn the_back_of_a_light_is_black_and_opaque() {
    let toward = |normal: DVec3| {
        let front = Emitter::disk(DVec3::new(0.0, 0.0, 2.0), normal, 1.0, [5.0; 3]);
        let behind = Emitter::disk(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z, 2.0, [7.0; 3]);
        let medium = Medium::homogeneous(0.2, [0.0; 3], PhaseFunction::henyey_greenstein(0.0));
        let frame = Frame {
            camera: ray_camera(0.0),
            techniques: Active::Both.techniques(&medium, 5, 4.0),
            medium,
            lights: Lights::new(vec![behind, front], Selection::Uniform),
            surfaces: Arc::new(Surfaces::none()),
            walk: WalkLimits::ALL,
            aimed: 0.0,
            roulette: 0.0,
            lengths: PathLengths { min: 1, max: 5 },
            seed: 1,
            outlines: None,
            aovs: Aovs::default(),
        };
        render(&frame, [1, 1], 0..1).0.pixel(0, 0).mean[0]
    };
    assert!((toward(-DVec3::Z) / (5.0 * (-0.4_f64).exp()) - 1.0).abs() < 1e-5);
    assert_eq!(toward(DVec3::Z), 0.0);
}

#[test]
fn only_paths_of_the_asked_lengths_count() {
    let base = frames::three_lights(0.4, Selection::IntensityDistance, [16, 16]);
    let with = |min: u32, max: u32| {
        let frame = Frame { lengths: PathLengths { min, max }, ..base.clone() };
        green(&render(&frame, [16, 16], 0..64).0).0
    };
    // The same random numbers make the same candidates whatever is counted, so that the parts add up exactly.
    let parts: f64 = (1..=5).map(|n| with(n, n)).sum();
    assert!((parts / with(1, 5) - 1.0).abs() < 1e-6, "{parts} instead of {}", with(1, 5));
    assert!((1..=5).all(|n| with(n, n) > 0.0));
}
