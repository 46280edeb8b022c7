//! Lights that are more than a disk: rooms that shine evenly, meshes however they are cut, any unit of length.

use fogbow::frame::Frame;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Lights, Selection};
use fogbow_kernels::tables::surfaces::Material;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::{green, render};
use fogbow_testing::suite::half;
use glam::DVec3;

const SIZE: [u32; 2] = [8, 8];

type Face = [[f32; 3]; 3];

/// A room without openings.
fn closed_room() -> Vec<Face> {
    let front = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [-1.0, 2.0, 0.0]];
    let front = [[front[0], front[1], front[2]], [front[0], front[2], front[3]]];
    frames::walls().into_iter().flatten().chain(front).collect()
}

/// Nothing, and media that absorb nothing.
fn media() -> [Medium; 3] {
    let medium =
        |extinction: f32, g: f32| Medium::homogeneous(extinction, [1.0; 3], PhaseFunction::henyey_greenstein(g));
    let vacuum = Medium::vacuum();
    [vacuum, medium(0.7, 0.8), medium(1.5, -0.4)]
}

/// Checks that the radiance is 1 everywhere in a room of these faces, of which those from `first_shining` on shine.
fn assert_even(name: &str, groups: &[(Material, Vec<Face>)], first_shining: u32, radiance: f32, longest: u32) {
    let surfaces = frames::surfaces(groups);
    let mesh = frames::shining(&surfaces, first_shining..surfaces.geometry().len() as u32, [radiance; 3]);
    for medium in media() {
        for active in Active::ALL {
            let camera = Camera::new(DVec3::new(0.2, 0.9, 0.3), DVec3::new(0.1, 0.1, 1.0), DVec3::Y, 1.5, 0.0, SIZE);
            let lights = Lights::with_meshes(Vec::new(), vec![mesh.clone()], Selection::Uniform);
            let base =
                Frame { surfaces: surfaces.clone(), ..frames::plain(camera, medium.clone(), lights, longest, 7) };
            let mut frame = frames::with_techniques(&base, active, 3.0).with_walk(u32::MAX, 1.0);
            if medium.never_scatters() {
                frame.techniques = frame.techniques.without_vertices();
            }
            let (mean, error) = green(&render(&frame, SIZE, 0..half(64)).0);
            let name = format!("{name}, extinction {}, {active:?}", medium.largest_extinction());
            assert!((mean - 1.0).abs() < 1e-6 + 4.2 * error && error < 0.02, "{name}: {mean} +- {error}");
        }
    }
}

#[test]
fn a_room_of_walls_that_reflect_and_emit_one_half_is_even() {
    // After n walls 2^-n is missing.
    assert_even("half", &[(Material::plain([0.5; 3], true), closed_room())], 0, 0.5, 100);
}

#[test]
fn a_white_room_around_a_lamp_is_as_bright_as_the_lamp() {
    let panel = [[-0.5, 0.6, 1.6], [0.6, 0.4, 2.0], [0.4, 1.6, 2.4], [-0.6, 1.5, 2.0]];
    let panel = vec![[panel[0], panel[1], panel[2]], [panel[0], panel[2], panel[3]]];
    let (white, lamp) = (Material::plain([1.0; 3], false), Material::plain([0.0; 3], true));
    assert_even("white", &[(white, closed_room()), (lamp, panel)], 12, 1.0, 500);
}

#[test]
fn a_lamp_shines_alike_however_finely_it_is_cut() {
    let render_cut = |n: u32, active: Active| {
        let base = Frame { seed: n, ..frames::panel(n, SIZE) };
        green(&render(&frames::with_techniques(&base, active, 3.0), SIZE, 0..2000).0)
    };
    for active in [Active::Nee, Active::Bridge] {
        let renders = [1, 9, 100].map(|n| render_cut(n, active));
        for (mean, error) in &renders[1..] {
            let z = (mean - renders[0].0) / error.hypot(renders[0].1);
            assert!(z.abs() < 4.0 && *error < 0.01 * mean, "{active:?}: {renders:?}");
        }
    }
}

#[test]
fn the_unit_of_length_does_not_show() {
    let image = |unit: f64| {
        let film = render(&frames::lamps(unit, 0.6, Selection::IntensityDistance, SIZE), SIZE, 0..64).0;
        film.pixels().map(|pixel| pixel.mean).collect::<Vec<_>>()
    };
    let metres = image(1.0);
    for unit in [1e-4, 1e4] {
        // The same random numbers: pixels differ by rounding, and where that decides between hit and miss.
        let close = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|c| (a[c] - b[c]).abs() <= 1e-3 * b[c]);
        let same = image(unit).iter().zip(&metres).filter(|(a, b)| close((a, b))).count();
        assert!(same >= 60, "{same} of 64 pixels are the same where a metre is {unit}");
    }
}
