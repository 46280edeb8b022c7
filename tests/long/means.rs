//! Means that independent programs, or all techniques together, say are right.

use fogbow::film::Film;
use fogbow::frame::Frame;
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::tables::lights::Selection;
use fogbow_testing::frames::Active;
use fogbow_testing::render::{WORKERS, green, render, render_with};
use fogbow_testing::statistics::{p_of_uniformity, p_of_z, z_of_means};
use fogbow_testing::{frames, truths};
use glam::DVec3;

/// Mean of a scene to a standard error of `goal`, against a published one of error `known`.
fn assert_mean(name: &str, frame: &Frame, expected: f64, known: f64, goal: f64) {
    let size = [64, 64];
    let mut samples = 1000;
    loop {
        let (mean, error) = green(&render(frame, size, 0..samples).0);
        if error <= goal {
            let z = (mean - expected) / error.hypot(known);
            println!("{name}: {mean:.5} +- {error:.5}, expected {expected} +- {known}, z = {z:.2}");
            assert!(z.abs() < 3.5, "{name}: {mean} +- {error}");
            return;
        }
        samples = (f64::from(samples) * (error / goal).powi(2) * 1.1) as u32;
    }
}

/// Mean and standard error of each channel of a block of `side * side` pixels from (x, y) on.
fn block(film: &Film, [x, y]: [u32; 2], side: u32) -> [(f64, f64); 3] {
    let pixels: Vec<_> = (y..y + side).flat_map(|y| (x..x + side).map(move |x| film.pixel(x, y))).collect();
    let count = pixels.len() as f64;
    [0, 1, 2].map(|channel| {
        let sum: f64 = pixels.iter().map(|pixel| pixel.mean[channel]).sum();
        let variance: f64 = pixels.iter().map(|pixel| pixel.standard_error[channel].powi(2)).sum();
        (sum / count, variance.sqrt() / count)
    })
}

/// The same of all blocks of an image of `size`, row by row.
fn blocks(film: &Film, size: [u32; 2], side: u32) -> Vec<[(f64, f64); 3]> {
    let starts = |length: u32| (0..length).step_by(side as usize);
    let corners = starts(size[1]).flat_map(|y| starts(size[0]).map(move |x| [x, y]));
    corners.map(|corner| block(film, corner, side)).collect()
}

#[test]
fn means_of_fog_facing_are_those_of_independent_programs() {
    let size = [64, 64];
    for active in Active::ALL {
        let with = |near: f64, g: f32| frames::with_techniques(&frames::fog_facing(near, g, size), active, 4.0);
        assert_mean(&format!("near 1, g .9, {active:?}"), &with(1.0, 0.9), 1.7004, 0.0005, 0.001);
        assert_mean(&format!("near 0, g .9, {active:?}"), &with(0.0, 0.9), 1.2838, 0.0004, 0.001);
        assert_mean(&format!("near 1, g 0, {active:?}"), &with(1.0, 0.0), 0.1847, 0.0002, 0.0005);
    }
    let tight = |name: &str, frame: &Frame, expected: f64, known: f64| {
        assert_mean(&format!("{name}, tight"), frame, expected, known, 0.0004);
    };
    let mvnee = |near: f64| frames::fog_facing(near, 0.9, size);
    tight("near 1, g .9, Mvnee", &mvnee(1.0), 1.7004, 0.0005);
    tight("near 0, g .9, Mvnee", &mvnee(0.0), 1.2838, 0.0004);
    for starts in [1, 4, u32::MAX] {
        let bridge = |near: f64| frames::with_techniques(&mvnee(near), Active::Bridge, 4.0).with_walk(starts, 1.0);
        tight(&format!("near 1, g .9, Bridge, {starts} starts"), &bridge(1.0), 1.7004, 0.0005);
        tight(&format!("near 0, g .9, Bridge, {starts} starts"), &bridge(0.0), 1.2838, 0.0004);
    }
}

#[test]
fn light_across_the_view_has_the_mean_of_an_independent_program() {
    for active in Active::ALL {
        let frame = frames::with_techniques(&frames::fog(1.0, 0.6, DVec3::Y, [64, 64]), active, 4.0);
        assert_mean(&format!("fog-perpendicular, {active:?}"), &frame, 0.23981, 0.00026, 0.0006);
    }
    let bridge = frames::with_techniques(&frames::fog(1.0, 0.6, DVec3::Y, [64, 64]), Active::Bridge, 4.0);
    assert_mean("fog-perpendicular, Bridge, tight", &bridge, 0.23981, 0.00026, 0.0002);
}

#[test]
fn techniques_agree_tile_by_tile_and_their_p_values_are_uniform() {
    let size = [32, 32];
    for (name, base, mesc) in [
        ("fog-facing", frames::fog_facing(1.0, 0.8, size), 4.0),
        ("three lights", frames::three_lights(0.6, Selection::IntensityDistance, size), 2.5),
    ] {
        for segments in [2, 3, 5, 8] {
            let with = |active: Active| {
                let frame = Frame { seed: 7 + active as u32, ..frames::with_techniques(&base, active, mesc) };
                let film = render(&frames::with_length(&frame, segments), size, 0..4000).0;
                blocks(&film, size, 8).into_iter().map(|channels| channels[1]).collect::<Vec<_>>()
            };
            let nee = with(Active::Nee);
            for active in Active::ALL.into_iter().filter(|active| ![Active::Path, Active::Nee].contains(active)) {
                let p_values: Vec<_> = with(active).iter().zip(&nee).map(|(a, b)| p_of_z(z_of_means(*a, *b))).collect();
                let p = p_of_uniformity(&p_values);
                println!("{name}, {segments} segments, {active:?}: p-values uniform with p = {p:.3}");
                assert!(p > 1e-4, "{name}, {segments} segments, {active:?}: {p_values:?}");
            }
        }
    }
}

#[test]
fn all_techniques_have_equal_means_for_every_lobe() {
    let size = [16, 16];
    for g in [-0.9, -0.5, 0.3, 0.9, 0.97] {
        let base = frames::three_lights(g, Selection::IntensityDistance, size);
        let with = |active: Active| {
            let frame = Frame { seed: 1000 + active as u32, ..frames::with_techniques(&base, active, 3.0) };
            render(&frame, size, 0..40_000).0.mean()
        };
        let truth = with(Active::Path);
        for active in Active::ALL.into_iter().filter(|active| *active != Active::Path) {
            let (mean, error) = with(active);
            let z = [0, 1, 2].map(|i| z_of_means((mean[i], error[i]), (truth.0[i], truth.1[i])));
            println!("g {g}, {active:?}: z = {z:.2?}");
            assert!(z.iter().all(|z| z.abs() < 4.0), "g {g}, {active:?}: z = {z:?}");
        }
    }
}

#[test]
fn every_technique_has_the_mean_that_every_scene_promises_among_surfaces() {
    for (name, size, expected, known, certainty) in [
        ("dense-plate", [64, 64], 0.1864, 0.0002, 0.12),
        ("cornell-fog", [64, 64], 0.2233, 0.0003, 0.12),
        ("cornell-fog-thin", [64, 64], 0.14504, 0.00009, 0.06),
        ("spotlight", [64, 64], 0.0897, 0.00035, 0.3),
        ("colonnade", [80, 36], 0.808, 0.004, 0.05),
    ] {
        for active in Active::ALL {
            let (mean, error) = green(&render(&frames::shipped(name, size, active), size, 0..600).0);
            let z = (mean - expected) / error.hypot(known);
            assert!(z.abs() < 4.0, "{name}, {active:?}: {mean} +- {error}, expected {expected}, z = {z}");
            assert!(error < certainty * expected, "{name}, {active:?}: {mean} +- {error} says little");
        }
    }
}

#[test]
fn every_technique_has_the_mean_of_an_independent_program_in_a_cloud() {
    let (name, size) = ("cloud-box", [64, 64]);
    // Mitsuba 3.9 with the same numbers in its grid: scenes/cloud-box/in_mitsuba.py.
    let (expected, known) = ([0.81802, 0.81846, 0.77027], [0.00035, 0.00034, 0.00034]);
    for active in frames::clouds::IN_FIELDS {
        let (mean, error) = render(&frames::shipped(name, size, active), size, 0..1500).0.mean();
        let z = [0, 1, 2].map(|i| (mean[i] - expected[i]) / error[i].hypot(known[i]));
        assert!(z.iter().all(|z| z.abs() < 4.0), "{active:?}: {mean:?} +- {error:?}, z = {z:?}");
        assert!(error[1] < 0.001, "{active:?}: {error:?} is too uncertain");
    }
}

#[test]
fn every_technique_has_the_mean_of_an_independent_program_behind_a_perforated_plate() {
    let (name, size) = ("dense-plate", [64, 64]);
    let (expected, known) = truths::mean(name);
    assert!((expected[1] - 0.1864).abs() < 0.000_05 && known[1] < 0.000_065, "{name}: {expected:?} +- {known:?}");
    let shipped = |active: Active| frames::shipped(name, size, active);
    // Most connections are blocked by the plate: roulette before they are traced pays with many starts.
    let all_starts = Frame { roulette: 0.1, ..shipped(Active::Bridge) };
    let one_start = Frame { seed: 20, ..shipped(Active::Bridge) }.with_walk(1, 1.0);
    for (technique, frame, samples, goal) in [
        ("path", shipped(Active::Path), 18_000, 0.0006),
        ("mvnee", shipped(Active::Mvnee), 8000, 0.0004),
        ("bridge, one start", one_start, 9000, 0.00012),
        ("bridge, all starts", all_starts, 3000, 0.00012),
        ("lis", shipped(Active::Lis), 1600, 0.0005),
        ("omnee and nee", shipped(Active::Omnee), 5000, 0.0006),
        ("nee", shipped(Active::Nee), 9000, 0.0007),
    ] {
        let (mean, error) = render(&frame, size, 0..samples).0.mean();
        let z = [0, 1, 2].map(|i| (mean[i] - expected[i]) / error[i].hypot(known[i]));
        println!("{name}, {technique}: {mean:.5?} +- {error:.5?}, z = {z:.2?}");
        assert!(z.iter().all(|z| z.abs() < 3.5), "{name}, {technique}: {mean:?} +- {error:?}, z = {z:?}");
        assert!(error[1] < goal, "{name}, {technique}: {error:?} is too uncertain");
    }
}

/// Relative deviation of means from recorded ones, and its standard error. Those that are recorded best count most.
fn deviation(pairs: &[[(f64, f64); 2]]) -> (f64, f64) {
    let (mut sum, mut variance, mut weights) = (0.0, 0.0, 0.0);
    for [(mean, error), (expected, known)] in pairs {
        let weight = (expected / known).powi(2);
        sum += weight * (mean / expected - 1.0);
        variance += (weight * error.hypot(*known) / expected).powi(2);
        weights += weight;
    }
    (sum / weights, variance.sqrt() / weights)
}

#[test]
fn wax_has_the_means_of_an_independent_program_block_by_block() {
    let truth = truths::blocks("wax");
    let size = [truth.size; 2];
    let changes = [
        format!("film.size={size:?}"),
        format!("camera.look_at={:?}", truth.look_at),
        format!("camera.vertical_fov_deg={:?}", truth.vertical_fov_deg),
        // Roulette changes no mean; without it as small an error takes several times as long.
        "render.survival=0.98".into(),
        "render.roulette=0.02".into(),
    ];
    let frame = frames::shipped_with("wax", &changes, Active::Nee);
    // Small tiles give every thread some.
    let film = render_with(&frame, &SIMD, WORKERS, size, truth.block, 0..11_000).0;
    let found = blocks(&film, size, truth.block);
    assert_eq!([found.len(), found.len()], [truth.mean.len(), truth.standard_error.len()]);
    for (channel, goal) in [0.006, 0.005, 0.004].into_iter().enumerate() {
        let known = truth.mean.iter().zip(&truth.standard_error).map(|(mean, error)| (mean[channel], error[channel]));
        let pairs: Vec<_> = found.iter().zip(known).map(|(block, known)| [block[channel], known]).collect();
        let z: Vec<_> = pairs.iter().map(|[found, known]| z_of_means(*found, *known)).collect();
        let (all, error) = deviation(&pairs);
        println!("wax, channel {channel}: off by {all:.5} +- {error:.5} in all; z of blocks = {z:.2?}");
        assert!(z.iter().all(|z| z.abs() < 4.0), "wax, channel {channel}: z of blocks = {z:?}");
        assert!(all.abs() < 3.5 * error, "wax, channel {channel}: off by {all} +- {error}");
        assert!(error < goal, "wax, channel {channel}: {error} is too uncertain");
    }
}
