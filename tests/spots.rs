//! Spotlights: what is seen of them directly and after one scattering event, in closed form and by quadrature.

use fogbow::frame::Frame;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::pipeline::{REFERENCE, SIMD};
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::quadrature::{Emission, LitFog};
use fogbow_testing::render::{render, render_here};
use fogbow_testing::tolerances::{FAINTEST, SCATTERED_ONCE, VIEW};
use glam::DVec3;

/// Exponents, and cones from hard to wide.
const EMISSIONS: [Emission; 9] = [
    Emission::Even,
    Emission::Power(0.0),
    Emission::Power(1.0),
    Emission::Power(2.0),
    Emission::Power(3.0),
    Emission::Power(40.0),
    Emission::Cone(0.2, 0.7),
    Emission::Cone(0.6, 0.65),
    Emission::Cone(0.0, 1.5),
];

/// A camera so narrow that it is one ray along +z.
fn ray_camera(size: [u32; 2]) -> Camera {
    Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1e-6, 0.0, size)
}

/// `disk` that shines like this.
fn shining(disk: Emitter, emission: Emission) -> Emitter {
    match emission {
        Emission::Even => disk,
        Emission::Power(exponent) => disk.focused(exponent),
        Emission::Cone(inner, outer) => disk.with_cone([inner, outer], 2.0),
    }
}

#[test]
fn a_spot_is_as_bright_from_every_angle_as_its_emission_says() {
    let medium = Medium::homogeneous(0.3, [0.9; 3], PhaseFunction::henyey_greenstein(-0.4));
    let radiance = [2.0, 3.0, 4.0];
    for emission in EMISSIONS {
        for angle in [0.0_f64, 0.15, 0.3, 0.5, 0.62, 0.68, 0.8, 1.2, 1.45, 1.7, 3.1] {
            let normal = DVec3::new(angle.sin(), 0.0, -angle.cos());
            let disk = shining(Emitter::disk(DVec3::new(0.0, 0.0, 2.0), normal, 1.0, radiance), emission);
            // Another light, for a renderer may treat the only one apart.
            let other = Emitter::disk(DVec3::new(9.0, 0.0, 2.0), DVec3::X, 1.0, [1.0; 3]);
            for lights in [vec![disk], vec![disk, other], vec![other, disk]] {
                let lights = Lights::new(lights, Selection::Uniform);
                let base = frames::plain(ray_camera([1, 1]), medium.clone(), lights, 1, 3);
                let frame = Frame { aimed: 0.1, ..frames::with_techniques(&base, Active::Every, 4.0) };
                for (name, pipeline) in [("kernels", SIMD), ("twins", REFERENCE)] {
                    let pixel = render_here(&frame, &pipeline, 8, [1, 1], 2).pixel(0, 0);
                    for (mean, radiance) in pixel.mean.into_iter().zip(radiance) {
                        let expected = radiance * emission.radiance(angle.cos()) * (-0.6_f64).exp();
                        let close = (mean - expected).abs() <= VIEW * expected + FAINTEST;
                        assert!(close, "{name}, {emission:?} at {angle}: {mean} instead of {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_spot_lights_fog_as_the_quadrature_says() {
    let size = [16, 16];
    // Comparisons fail by chance once in 16000; there are 27, and channels differ by factors only.
    for (case, (emission, g)) in
        EMISSIONS.into_iter().zip([-0.9, -0.5, 0.6, -0.2, -0.7, 0.0, -0.3, 0.8, -0.6]).enumerate()
    {
        let (center, normal) = (DVec3::new(0.8, 0.5, 4.0), DVec3::new(-0.5, -0.3, -1.0));
        let fog = LitFog { scattering: 0.8, extinction: 1.1, g, center, normal, radius: 0.5, emission };
        let disk = shining(Emitter::disk(center, normal, fog.radius, [10.0, 5.0, 2.5]), emission);
        let medium = Medium::homogeneous(1.1, [0.8 / 1.1; 3], PhaseFunction::henyey_greenstein(g as f32));
        let base = frames::plain(ray_camera(size), medium, Lights::new(vec![disk], Selection::Uniform), 2, case as u32);
        let expected = fog.scattered_once(0.0);
        for active in [Active::Nee, Active::Mvnee, Active::Bridge] {
            let frame = frames::with_techniques(&base, active, f64::INFINITY);
            let (mean, error) = render(&frame, size, 0..4000).0.mean();
            for (channel, radiance) in [10.0, 5.0, 2.5].into_iter().enumerate() {
                let (mean, error, expected) = (mean[channel], error[channel], radiance * expected);
                let z = (mean - expected) / error.hypot(SCATTERED_ONCE * expected);
                assert!(
                    z.abs() < 4.0,
                    "{emission:?}, g {g}, {active:?}: {mean} +- {error} instead of {expected}, z = {z}"
                );
                assert!(error < 0.03 * expected, "{emission:?}, g {g}, {active:?}: {mean} +- {error} says little");
            }
        }
    }
}
