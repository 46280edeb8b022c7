//! Surfaces: how they reflect, what their backs do, and a plane under a disk in closed form.

use std::sync::Arc;

use fogbow::frame::Frame;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_kernels::tables::surfaces::{Material, Surfaces};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::render;
use fogbow_testing::statistics::p_of_counts;
use fogbow_testing::walks::{LANES, after_walks, vector};
use glam::DVec3;

const VACUUM: Medium = Medium::homogeneous(0.0, [0.0; 3], PhaseFunction::henyey_greenstein(0.0));

/// A square of half side 50 around the origin, whose front is at z > 0.
fn plane(albedo: [f32; 3], double_sided: bool) -> Arc<Surfaces> {
    let [a, b, c, d] = [[-50.0, -50.0, 0.0], [50.0, -50.0, 0.0], [50.0, 50.0, 0.0], [-50.0, 50.0, 0.0]];
    frames::surfaces(&[(Material::plain(albedo, double_sided), vec![[a, b, c], [a, c, d]])])
}

/// A view of the origin from `eye`, so narrow that it is one ray, in a vacuum with a disk above the plane, on `side`.
fn under_a_disk(eye: DVec3, surfaces: Arc<Surfaces>, side: f64, active: Active) -> Frame {
    let camera = Camera::new(eye, -eye.normalize(), DVec3::Y, 1e-6, 0.0, [1, 1]);
    let disk = Emitter::disk(2.0 * side * DVec3::Z, -side * DVec3::Z, 1.5, [3.0; 3]);
    let lights = Lights::new(vec![disk], Selection::Uniform);
    let frame = Frame { surfaces, ..frames::plain(camera, VACUUM, lights, 6, 3) };
    let techniques = active.techniques(&VACUUM, frame.lengths.max, f64::INFINITY).without_vertices();
    Frame { techniques, ..frame }
}

/// A disk of radius R at the height h shines `pi L R^2 / (R^2 + h^2)` onto the point below its centre.
#[test]
fn a_plane_under_a_disk_is_as_bright_as_the_closed_form() {
    let albedo = [0.8, 0.5, 0.1];
    for active in [Active::Path, Active::Nee] {
        let frame = under_a_disk(DVec3::new(6.0, 0.0, 2.0), plane(albedo, false), 1.0, active);
        let pixel = render(&frame, [1, 1], 0..40_000).0.pixel(0, 0);
        for ((albedo, mean), error) in albedo.into_iter().zip(pixel.mean).zip(pixel.standard_error) {
            let expected = f64::from(albedo) * 3.0 * 2.25 / 6.25;
            let z = (mean - expected) / error;
            assert!(z.abs() < 4.0 && error < 0.02 * expected, "{active:?}: {mean} +- {error}, expected {expected}");
        }
    }
}

#[test]
fn backs_are_black_unless_the_material_says_otherwise() {
    for active in [Active::Path, Active::Nee] {
        let behind = |double_sided: bool| {
            let surfaces = plane([0.5; 3], double_sided);
            let frame = under_a_disk(DVec3::new(6.0, 0.0, -2.0), surfaces, -1.0, active);
            render(&frame, [1, 1], 0..20_000).0.pixel(0, 0).mean[1]
        };
        assert_eq!(behind(false), 0.0, "{active:?}");
        let expected = 0.5 * 3.0 * 2.25 / 6.25;
        assert!((behind(true) / expected - 1.0).abs() < 0.05, "{active:?}: {}", behind(true));
    }
}

#[test]
fn backs_are_opaque() {
    for (active, double_sided) in [(Active::Path, false), (Active::Nee, true), (Active::Nee, false)] {
        // The disk is on the other side of the plane.
        let surfaces = plane([0.5; 3], double_sided);
        let frame = under_a_disk(DVec3::new(6.0, 0.0, 2.0), surfaces, -1.0, active);
        assert_eq!(render(&frame, [1, 1], 0..5_000).0.pixel(0, 0).mean, [0.0; 3], "{active:?}, {double_sided}");
    }
}

#[test]
fn flights_are_stretched_the_less_the_less_fog_there_is_among_surfaces() {
    let thinned = |frame: &Frame| frame.aim().thinned;
    let room = frames::room(0.5, Selection::Intensity, [4, 4]);
    let [dense, thin] = [40.0, 0.05].map(|extinction| thinned(&frames::with_extinction(&room, extinction)));
    let open = thinned(&frames::fog_facing(0.0, 0.9, [4, 4]));
    assert!(open == 0.75 && (0.75..0.76).contains(&dense) && (0.95..1.0).contains(&thin), "{open}, {dense}, {thin}");
}

#[test]
fn reflected_directions_follow_the_cosine() {
    let camera = Camera::new(3.0 * DVec3::Z + DVec3::X, DVec3::NEG_Z, DVec3::Y, 0.5, 0.0, [64, 64]);
    let lights = Lights::new(vec![Emitter::disk(9.0 * DVec3::Z, DVec3::Z, 0.1, [1.0; 3])], Selection::Uniform);
    let frame = Frame { surfaces: plane([0.5; 3], false), ..frames::plain(camera, VACUUM, lights, 8, 5) };
    let mut cells = vec![0.0; 64];
    let samples = 1 << 16;
    after_walks(&frame, samples, 0, |wavefront| {
        wavefront.bounce();
        for lane in 0..LANES {
            let direction = vector(wavefront.rays.at(wavefront.step.clock).direction.row(lane));
            let azimuth = direction.y.atan2(direction.x).rem_euclid(core::f64::consts::TAU) / core::f64::consts::TAU;
            assert!(direction.z > 0.0, "{direction} leads into the plane");
            let cell = [1.0 - direction.z * direction.z, azimuth].map(|x| ((x * 8.0) as usize).min(7));
            cells[8 * cell[0] + cell[1]] += 1.0;
        }
    });
    let p = p_of_counts(&cells, &[samples as f64 / 64.0; 64]);
    assert!(p > 1e-4, "p = {p}");
}
