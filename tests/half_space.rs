//! Fog under a shining plane: light of every number of segments against quadrature, for lobes that scatter back and
//! lights that are focused.

use fogbow::frame::Frame;
use fogbow_kernels::PathLengths;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::quadrature::{Emission, HalfSpace};
use fogbow_testing::render::render;
use fogbow_testing::tolerances::{HALF_SPACE, VIEW};
use glam::DVec3;

/// All pixels see the same.
const SIZE: [u32; 2] = [16, 16];
const ALBEDO: [f32; 3] = [0.5, 1.0, 0.75];
const RADIANCE: [f64; 3] = [4.0, 1.0, 2.0];
/// Most segments.
const LONGEST: u32 = 5;

/// The disk that stands for the plane: beyond its edge, 14 mean free paths away, is a millionth of the light.
fn plane(depth: f64, emission: Emission) -> Emitter {
    let disk = Emitter::disk(DVec3::new(0.0, 0.0, depth), -DVec3::Z, 14.0, RADIANCE);
    match emission {
        Emission::Even => disk,
        Emission::Power(exponent) => disk.focused(exponent),
        Emission::Cone(inner, outer) => disk.with_cone([inner, outer], 1.0),
    }
}

/// The fog, seen from `depth` mean free paths below the plane under the cosine `mu` to its direction.
fn frame(depth: f64, mu: f64, emission: Emission, g: f64, active: Active) -> Frame {
    let medium = Medium::homogeneous(1.0, ALBEDO, PhaseFunction::henyey_greenstein(g as f32));
    let direction = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
    let camera = Camera::new(DVec3::ZERO, direction, DVec3::Y, 1e-6, 0.0, SIZE);
    let lights = Lights::new(vec![plane(depth, emission)], Selection::Uniform);
    frames::with_techniques(&frames::plain(camera, medium, lights, LONGEST, 3), active, 4.0)
}

/// Checks both sides of the plane's fog, seen towards it and away from it, for light of every number of segments.
/// `case` tells the random numbers apart.
///
/// Channels differ by factors and share their random numbers: a threshold of 4 standard errors fails one comparison in
/// 16000, of which there are 16 here.
fn assert_is_that_of_the_quadrature(case: u32, emission: Emission, g: f64) {
    let (steps, end) = (320, 64);
    let half_space = HalfSpace::new(emission, g, 64, steps);
    for (mu, side) in [(0.6, 0), (-0.3, 1)] {
        let truth = half_space.radiance(end, mu, LONGEST as usize);
        for (active, samples) in [(Active::Path, 5000), (Active::Every, 250)] {
            for (segments, truth) in (1..).zip(&truth) {
                let base = frame(half_space.depth(end), mu, emission, g, active);
                let seed = 100 * (4 * case + 2 * side + u32::from(active == Active::Path)) + segments;
                let frame = Frame { lengths: PathLengths { min: segments, max: segments }, seed, ..base };
                let (mean, error) = render(&frame, SIZE, 0..samples).0.mean();
                for channel in 0..3 {
                    let name =
                        format!("{emission:?}, g {g}, mu {mu}, {active:?}, {segments} segments, channel {channel}");
                    let albedo = f64::from(ALBEDO[channel]).powi(segments as i32 - 1);
                    let expected = truth * albedo * RADIANCE[channel];
                    let (mean, error) = (mean[channel], error[channel]);
                    if segments == 1 {
                        assert!((mean - expected).abs() <= VIEW * expected, "{name}: {mean} instead of {expected}");
                        continue;
                    }
                    let z = (mean - expected) / error.hypot(HALF_SPACE * expected);
                    assert!(z.abs() < 4.0, "{name}: {mean} +- {error} instead of {expected}, z = {z}");
                    assert!(error < 0.04 * expected, "{name}: {mean} +- {error} says little");
                }
            }
        }
    }
}

#[test]
fn fog_that_scatters_back_and_forth_has_the_radiance_of_the_quadrature() {
    for (case, g) in [-0.9, -0.5, 0.0, 0.7].into_iter().enumerate() {
        assert_is_that_of_the_quadrature(case as u32, Emission::Even, g);
    }
}

#[test]
fn fog_under_focused_light_has_the_radiance_of_the_quadrature() {
    for (case, emission, g) in [
        (10, Emission::Power(1.0), -0.5),
        (11, Emission::Power(2.0), 0.5),
        (12, Emission::Power(3.0), -0.7),
        (13, Emission::Cone(0.4, 1.1), -0.5),
    ] {
        assert_is_that_of_the_quadrature(case, emission, g);
    }
}
