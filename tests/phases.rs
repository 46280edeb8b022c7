//! Renders with phase functions of every kind.

use fogbow::frame::Frame;
use fogbow_kernels::connect::{Technique, Techniques};
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::lights::Selection;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::{green, render};
use fogbow_testing::statistics::{p_of_chi_square, z_of_means};
use fogbow_testing::suite::{half, some};

const SIZE: [u32; 2] = [16, 16];

/// The mean of a small image and its standard error.
fn mean(frame: &Frame, active: Active, samples: u32) -> (f64, f64) {
    let frame = frames::with_techniques(frame, active, 3.0);
    green(&render(&Frame { seed: 7 + active as u32, ..frame }, SIZE, 0..samples).0)
}

#[test]
fn all_techniques_have_the_same_mean_whatever_the_phase_function() {
    for (name, phase) in frames::phase_functions() {
        let frame = frames::with_phase(&frames::two_lights(0.0, Selection::IntensityDistance, SIZE), phase);
        let means = Active::ALL.map(|active| mean(&frame, active, half(600)));
        let certainty: f64 = means.iter().map(|(_, error)| error.powi(-2)).sum();
        let common = means.iter().map(|(mean, error)| mean * error.powi(-2)).sum::<f64>() / certainty;
        let chi_square = means.iter().map(|(mean, error)| ((mean - common) / error).powi(2)).sum();
        let p = p_of_chi_square(chi_square, means.len() - 1);
        assert!(p > 1e-4, "{name}: means {means:?} are not equal, p = {p}");
    }
}

/// Checks that both phase functions make the same image, to a hundredth.
fn assert_alike(name: &str, phase: PhaseFunction, other: PhaseFunction) {
    let (frame, samples) = (frames::fog_facing(1.0, 0.0, SIZE), half(4000));
    let [a, b] = [(phase, Active::Every), (other, Active::Bridge)]
        .map(|(phase, active)| mean(&frames::with_phase(&frame, phase), active, samples));
    assert!(z_of_means(a, b).abs() < 3.5 && a.1 < 0.01 * a.0 && b.1 < 0.01 * b.0, "{name}: {a:?} and {b:?}");
}

#[test]
fn different_ways_to_the_same_phase_function_make_the_same_image() {
    let lobe = PhaseFunction::henyey_greenstein;
    let table: Vec<_> = (0..=2000)
        .map(|i| {
            // Rows are closest where the lobe is steepest.
            let cosine = 1.0 - 2.0 * (1.0 - f64::from(i) / 2000.0).powi(2);
            (cosine, lobe(0.6).twin().density(cosine))
        })
        .collect();
    let table = PhaseFunction::tabulated(&table).expect("a valid table");
    let flat = PhaseFunction::tabulated(&[(-1.0, 3.0), (1.0, 3.0)]).expect("a valid table");
    let ways = [
        ("one lobe of two", PhaseFunction::two_lobe([0.7, -0.5], 1.0), lobe(0.7)),
        ("two equal lobes", PhaseFunction::two_lobe([0.5, 0.5], 0.3), lobe(0.5)),
        ("Rayleigh as Draine", PhaseFunction::draine(0.0, 1.0), PhaseFunction::rayleigh()),
        ("alpha 0", PhaseFunction::draine(0.6, 0.0), lobe(0.6)),
        ("a table of a lobe", table, lobe(0.6)),
        ("a flat table", flat, PhaseFunction::isotropic()),
    ];
    for (name, phase, other) in some(ways, 0, 3) {
        assert_alike(name, phase, other);
    }
}

#[test]
fn every_technique_has_a_row_that_names_it() {
    let frame = frames::fog_facing(0.0, 0.5, SIZE);
    let medium = &frame.medium;
    let all =
        Techniques { lis: Active::Lis.techniques(medium, 15, 3.0).lis, ..Active::Every.techniques(medium, 15, 3.0) };
    let names: Vec<_> = all.rows().map(|(technique, _)| technique.name()).collect();
    assert_eq!(names, Technique::ALL.map(Technique::name));
}
