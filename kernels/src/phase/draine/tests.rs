//! The formulas by quadrature, and the kernel against its twin, over the range that is promised.

use core::f64::consts::PI;

use super::{Draine, DraineX8};
use crate::phase::reference::Phase;
use crate::phase::{HenyeyGreenstein, Rayleigh, checks};

const ASYMMETRIES: [f32; 11] = [-0.97, -0.5, -0.1999, -1e-4, 0.0, 1e-4, 0.2001, 0.6, 0.9, 0.99, 0.999];
const ALPHAS: [f32; 6] = [0.0, 0.3, 1.0, 30.0, 200.0, Draine::LARGEST_ALPHA];

fn each(mut check: impl FnMut(Draine, &str)) {
    for g in ASYMMETRIES {
        for alpha in ALPHAS {
            check(Draine { g, alpha }, &format!("g {g}, alpha {alpha}"));
        }
    }
}

#[test]
fn the_twin_agrees_with_its_density() {
    each(|phase, name| {
        checks::the_twin_agrees_with_its_density(&phase, 5e-6, name);
        checks::the_twin_inverts_its_distribution(&phase, 5e-6, name);
    });
}

#[test]
fn special_cases_are_those_of_their_names() {
    for cosine in [-1.0, -0.3, 0.0, 0.8, 1.0] {
        for (g, c) in [(0.4, 0.4_f32), (-0.9, -0.9)].map(|(g, f): (f32, f32)| (g, f64::from(f))) {
            let [found, expected] =
                [&Draine { g, alpha: 0.0 } as &dyn Phase, &HenyeyGreenstein { g }].map(|phase| phase.density(cosine));
            assert!((found / expected - 1.0).abs() < 1e-12);
            // Cornette and Shanks, Physically Reasonable Analytic Expression for the Single-Scattering Phase Function,
            // 1992.
            let expected = 3.0 / (8.0 * PI) * (1.0 - c * c) * (1.0 + cosine * cosine)
                / ((2.0 + c * c) * (1.0 + c * c - 2.0 * c * cosine).powf(1.5));
            assert!((Draine { g, alpha: 1.0 }.density(cosine) / expected - 1.0).abs() < 1e-12);
        }
        let rayleigh = Draine { g: 0.0, alpha: 1.0 }.density(cosine);
        assert!((rayleigh / Rayleigh.density(cosine) - 1.0).abs() < 1e-12);
    }
    for u in [0.001, 0.3, 0.5, 0.9] {
        assert!((Draine { g: 0.0, alpha: 1.0 }.sample_cosine(u) - Rayleigh.sample_cosine(u)).abs() < 1e-9);
        let [draine, lobe] = [&Draine { g: 0.7, alpha: 0.0 } as &dyn Phase, &HenyeyGreenstein { g: 0.7 }];
        assert!((draine.sample_cosine(u) - lobe.sample_cosine(u)).abs() < 1e-12);
    }
}

#[test]
fn sampled_turns_are_those_of_the_twin() {
    // u has steps of 1.2e-7; shares are computed to a few roundings of 6e-8, and the sine of a small turn to ten.
    each(|phase, name| {
        let lanes = DraineX8::new(phase);
        checks::turns_are_those_of_the_twin(lanes, &phase, 3e-7, name);
        checks::small_turns_are_those_of_the_twin(lanes, &phase, 1e-6, name);
    });
}

#[test]
fn densities_are_those_of_the_twin() {
    // The larger of 1e-5, h of a peak as that of Henyey-Greenstein, and what c^2 loses next to a right angle:
    // sqrt(alpha) roundings.
    each(|phase, name| checks::densities_are_those_of_the_twin(DraineX8::new(phase), &phase, 1e-5, name));
}

#[test]
fn samples_follow_the_density() {
    for (g, alpha) in [(0.0, 1.0), (-0.6, 5.0), (0.6, 27.0), (0.9, 1.0), (0.99, 1000.0)] {
        let phase = Draine { g, alpha };
        checks::samples_follow_the_density(DraineX8::new(phase), &phase, &format!("g {g}, alpha {alpha}"));
    }
}
