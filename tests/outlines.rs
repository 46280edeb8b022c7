//! Pixels that outlines of lamps pass through: lamps there are seen by many rays per sample.

use fogbow::frame::Frame;
use fogbow_kernels::media::Medium;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::agreement::{
    assert_same, assert_same_on_all_workers, assert_stages_agree, assert_whole_paths_agree, means,
};
use fogbow_testing::frames::{self, Active, clouds};
use fogbow_testing::render::render;
use fogbow_testing::suite::{half, some};
use glam::DVec3;

const SMALL: [u32; 2] = [16, 16];

/// Lights in fog, a room, and volumes of them, in color and grey; all have outlines in view.
fn all() -> Vec<(&'static str, Frame)> {
    let several = clouds::volumes(SMALL).into_iter().chain(clouds::clouds(SMALL));
    let plain = [
        ("lights in fog", frames::three_lights(0.6, Selection::IntensityDistance, SMALL)),
        ("a room", frames::room(0.5, Selection::IntensityDistance, SMALL)),
    ];
    let outlined = |(name, frame): (&'static str, Frame)| (name, frame.with_outlines(SMALL));
    let found: Vec<_> =
        plain.into_iter().chain(several).map(outlined).filter(|(_, frame)| frame.outlines.is_some()).collect();
    assert!(found.len() >= 4, "{}", found.len());
    found
}

#[test]
fn every_stage_agrees_with_its_twin() {
    for (name, frame) in all() {
        let frames = [Active::Path, Active::Nee].map(|active| frames::with_techniques(&frame, active, 4.0));
        assert_stages_agree(name, frames.into_iter(), 32);
    }
}

#[test]
fn whole_paths_agree_with_the_scalar_integrator() {
    for (name, frame) in all() {
        let frame = frames::with_techniques(&frame, Active::Nee, 4.0);
        assert!(assert_whole_paths_agree(name, &frame) > 0.0, "{name}");
    }
}

/// Whatever the number of rays, what a lamp counts is the same; and so is all other light.
#[test]
fn more_rays_change_no_mean() {
    for (turn, (name, frame)) in all().into_iter().enumerate() {
        for (what, lengths) in some([("seen directly", 1..=1), ("all", 1..=4)], turn, 2) {
            let lengths = fogbow_kernels::PathLengths { min: *lengths.start(), max: *lengths.end() };
            let many = Frame { lengths, ..frames::with_techniques(&frame, Active::Nee, 4.0) };
            let one = Frame { outlines: None, seed: 5, ..many.clone() };
            assert_same(&format!("{name}, {what}"), means(&many, half(2000)), means(&one, half(6000)));
        }
    }
}

/// A lamp in vacuum: the edge of a disk leaves each cell of a pixel on one side but for some four of sixteen.
#[test]
fn a_lamp_has_a_fiftieth_of_the_variance() {
    let size = [32, 32];
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.9, 0.0, size);
    let lamp = Emitter::disk(DVec3::new(0.1, 0.07, 3.0), -DVec3::Z, 0.8, [5.0; 3]);
    let frame = frames::plain(camera, Medium::vacuum(), Lights::new(vec![lamp], Selection::Uniform), 4, 3);
    let variance = |frame: &Frame| render(frame, size, 0..400).0.mean().1[1].powi(2);
    let quotient = variance(&frame) / variance(&frame.clone().with_outlines(size));
    assert!((30.0..100.0).contains(&quotient), "{quotient}");
}

#[test]
fn images_do_not_depend_on_threads_or_lanes() {
    for (name, frame) in all() {
        let frame = frames::with_techniques(&frame, Active::Nee, 4.0);
        assert_same_on_all_workers(name, &frame);
    }
}
