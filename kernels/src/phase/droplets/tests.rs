//! The fit at its ends and in the middle.

use super::{DIAMETERS, Droplets, DropletsX8};
use crate::phase::reference::Phase;
use crate::phase::{Draine, checks};

const SOME: [f32; 4] = [5.0, 10.0, 20.0, 50.0];

#[test]
fn parameters_of_a_diameter_are_those_of_the_fit() {
    // Worked out by hand for d = 20 um.
    let Droplets { weight, first, second } = Droplets::of_diameter(20.0);
    let near =
        |found: f32, expected: f32| assert!((found - expected).abs() < 1e-3 * expected, "{found} for {expected}");
    near(first.g, 0.994_61);
    near(second.g, 0.593_80);
    near(second.alpha, 27.116);
    near(weight, 1.0 - 0.498_17);
}

#[test]
fn droplets_scatter_forward_and_the_more_the_larger_they_are() {
    let means = SOME.map(|d| Droplets::of_diameter(d).mean_cosine());
    assert!(means.is_sorted() && means[0] > 0.8 && means[3] < 0.9, "{means:?}");
    for d in [*DIAMETERS.start(), *DIAMETERS.end()] {
        assert!(Droplets::of_diameter(d).second.alpha < Draine::LARGEST_ALPHA);
    }
}

#[test]
fn the_twin_agrees_with_its_density() {
    for d in SOME {
        checks::the_twin_agrees_with_its_density(&Droplets::of_diameter(d), 1e-5, &format!("{d} um"));
    }
}

#[test]
fn the_kernel_is_its_twin() {
    for d in SOME {
        let (phase, name) = (Droplets::of_diameter(d), format!("{d} um"));
        let lanes = DropletsX8::of(&phase);
        // As of its parts.
        checks::turns_are_those_of_the_twin(lanes, &phase, 3e-7, &name);
        checks::densities_are_those_of_the_twin(lanes, &phase, 1e-5, &name);
        checks::samples_follow_the_density(lanes, &phase, &name);
    }
}
