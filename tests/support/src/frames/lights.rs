//! Frames of several lights in fog, and lights that are focused.

use fogbow::frame::Frame;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use glam::DVec3;

use super::{Active, fog_facing, plain, with_techniques};
use crate::meshes::Random;

/// Two lights of different shapes, sizes and colours in a coloured, absorbing medium: one more than the only one, and
/// so few that the first and the last are all.
pub fn two_lights(g: f32, selection: Selection, size: [u32; 2]) -> Frame {
    let medium = Medium::homogeneous(1.1, [0.6, 0.95, 0.8], PhaseFunction::henyey_greenstein(g));
    let lights = vec![
        Emitter::sphere(DVec3::new(-0.6, 0.3, 2.2), 0.3, [1.0, 4.0, 12.0]),
        Emitter::disk(DVec3::new(0.7, -0.2, 1.7), DVec3::new(-0.8, 0.3, -0.6), 0.5, [9.0, 3.0, 0.5]),
    ];
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.2, 0.1, size);
    let frame = plain(camera, medium, Lights::new(lights, selection), 7, 13);
    with_techniques(&frame, Active::Both, 3.0)
}

/// Three coloured lights of different sizes, one of which hides part of another, in a coloured, absorbing medium.
pub fn three_lights(g: f32, selection: Selection, size: [u32; 2]) -> Frame {
    let medium = Medium::homogeneous(1.2, [0.9, 0.75, 0.5], PhaseFunction::henyey_greenstein(g));
    let lights = vec![
        Emitter::disk(DVec3::new(0.6, 0.2, 2.5), DVec3::new(-0.3, 0.1, -1.0), 0.4, [10.0, 2.0, 1.0]),
        Emitter::disk(DVec3::new(-0.8, -0.3, 2.0), DVec3::new(1.0, 0.2, -0.4), 0.25, [1.0, 20.0, 4.0]),
        Emitter::disk(DVec3::new(0.3, 0.1, 1.6), DVec3::new(0.2, 0.0, 1.0), 0.3, [0.5, 1.0, 30.0]),
    ];
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.2, 0.1, size);
    let frame = plain(camera, medium, Lights::new(lights, selection), 8, 11);
    with_techniques(&frame, Active::Both, 3.0)
}

/// The lights of [`three_lights`] and a swarm of `count` small disks and spheres around the camera, so many that they
/// are grouped.
pub fn swarm(count: u32, selection: Selection, size: [u32; 2]) -> Frame {
    let base = three_lights(0.6, selection, size);
    let mut random = Random::new(7);
    let mut body = |i: u32| {
        let at = 1.6 * random.in_cube() + DVec3::new(0.0, 0.0, 1.2);
        let radiance = [10.0 + f64::from(i % 7) * 8.0, 30.0, 60.0 - f64::from(i % 5) * 10.0];
        match i % 3 {
            0 => Emitter::sphere(at, 0.03, radiance),
            _ => Emitter::disk(at, random.in_cube(), 0.05, radiance),
        }
    };
    let swarm = (0..count).map(&mut body);
    let bodies = base.lights.bodies().iter().copied().chain(swarm).collect();
    Frame { lights: Lights::new(bodies, selection), ..base }
}

/// A wall of `side` times `side` disks in fog that nearly touch, connected with in straight lines; every other one is
/// `turned` by so much `[rad]`.
pub fn wall_of_lights(side: u32, turned: f64, size: [u32; 2]) -> Frame {
    let base = fog_facing(0.0, 0.6, size);
    let (normal, spacing) = (DVec3::new(0.3, 0.2, -1.0), 3.0 / f64::from(side));
    let (across, up) = normal.normalize().any_orthonormal_pair();
    let disk = |i: u32| {
        let [x, y] = [i % side, i / side].map(|i| (f64::from(i) - 0.5 * f64::from(side - 1)) * spacing);
        let turn = if i.is_multiple_of(2) { 0.0 } else { turned };
        let facing = normal.normalize() * turn.cos() + across * turn.sin();
        Emitter::disk(DVec3::new(0.0, 0.0, 1.5) + x * across + y * up, facing, 0.49 * spacing, [20.0; 3])
    };
    let lights = Lights::new((0..side * side).map(disk).collect(), Selection::IntensityDistance);
    with_techniques(&Frame { lights, ..base }, Active::Nee, f64::INFINITY)
}

/// `frame` with its lights, which are disks, as spotlights of these exponents.
pub fn focused(frame: &Frame, exponents: &[f64]) -> Frame {
    let disks = frame.lights.emitters().iter().zip(exponents).map(|(disk, exponent)| disk.focused(*exponent)).collect();
    Frame { lights: Lights::new(disks, frame.lights.selection()), ..frame.clone() }
}

/// `frame` with its spotlights as such with these cones `[rad]`.
pub fn with_cones(frame: &Frame, cones: &[[f64; 2]]) -> Frame {
    let cone = |(spot, cone): (&Emitter, &[f64; 2])| spot.with_cone(*cone, f64::from(spot.exponent));
    let disks = frame.lights.emitters().iter().zip(cones).map(cone).collect();
    Frame { lights: Lights::new(disks, frame.lights.selection()), ..frame.clone() }
}
