//! Tables that are refused, the formulas by quadrature, and the kernel against its twin.

use wide::f32x8;

use super::{LARGEST_INVERSE_DENSITY, Tabulated, TabulatedX8};
use crate::phase::reference::Phase;
use crate::phase::{HenyeyGreenstein, PhaseX8, checks};
use crate::vec3::Vec3x8;

fn table(rows: &[(f64, f64)]) -> Tabulated {
    Tabulated::new(rows).expect("the table is valid")
}

/// A Henyey-Greenstein lobe, with rows at even roots of the angle.
fn peak(g: f32, rows: usize) -> Tabulated {
    let row = |i: usize| {
        let angle = core::f64::consts::PI * (1.0 - i as f64 / (rows - 1) as f64).powi(2);
        (angle.cos(), 17.0 * HenyeyGreenstein { g }.density(angle.cos()))
    };
    table(&(0..rows).map(row).collect::<Vec<_>>())
}

fn tables() -> [(Tabulated, &'static str); 6] {
    [
        (table(&[(-1.0, 1.0), (1.0, 1.0)]), "isotropic"),
        (table(&[(-1.0, 0.0), (1.0, 3.0)]), "a ramp"),
        (table(&[(-0.5, 2.0), (0.1, 0.3), (0.2, 0.0), (0.9, 5.0)]), "missing ends"),
        (table(&[(-0.7, 0.0), (-0.5, 30.0), (-0.4, 0.0), (0.3, 0.0), (0.37, 70.0), (0.5, 0.0)]), "gaps"),
        (peak(0.8, 100), "a lobe"),
        (peak(0.99, 1025), "a peak"),
    ]
}

#[test]
fn tables_that_are_no_phase_function_are_refused() {
    let refused = |rows: &[(f64, f64)], reason: &str| {
        let error = Tabulated::new(rows).expect_err(reason);
        assert!(error.contains(reason), "{error}");
    };
    refused(&[], "at least two rows");
    refused(&[(0.0, 1.0)], "at least two rows");
    refused(&[(-1.0, 1.0), (0.5, 1.0), (0.5, 2.0)], "row 3: a cosine of 0.5 after 0.5");
    refused(&[(1.0, 1.0), (-1.0, 1.0)], "ascend");
    refused(&[(-1.0, 1.0), (1.5, 1.0)], "row 2: a cosine of 1.5");
    refused(&[(f64::NAN, 1.0), (1.0, 1.0)], "not in [-1, 1]");
    refused(&[(-1.0, 1.0), (1.0, -2.0)], "a value of -2");
    refused(&[(-1.0, f64::INFINITY), (1.0, 1.0)], "row 1: a value of inf");
    refused(&[(-1.0, 0.0), (1.0, 0.0)], "all values are zero");
    refused(&[(-1.0, 1.0), (-0.5, 0.0)], "less than a right angle");
}

#[test]
fn values_have_no_unit() {
    let [small, large] = [1e-300, 1e300].map(|unit| table(&[(-1.0, unit), (0.3, 2.0 * unit), (1.0, unit)]));
    assert!((small.density(0.3) / large.density(0.3) - 1.0).abs() < 1e-12);
}

#[test]
fn the_twin_agrees_with_its_density() {
    for (phase, name) in tables() {
        // Kinks, on which the midpoint rule is of second order only.
        checks::the_twin_agrees_with_its_density(&phase, 2e-5, name);
        checks::the_twin_inverts_its_distribution(&phase, 2e-5, name);
    }
}

#[test]
fn a_fine_table_is_the_function_it_was_made_from() {
    let (found, expected) = (peak(0.99, 1025), HenyeyGreenstein { g: 0.99 });
    for cosine in [-0.9, 0.0, 0.9, 0.999, 1.0] {
        assert!((found.density(cosine) / expected.density(cosine) - 1.0).abs() < 1e-3, "at {cosine}");
    }
    assert!((found.mean_cosine() - expected.mean_cosine()).abs() < 1e-4);
    assert!((found.forward_share() - expected.forward_share()).abs() < 1e-4);
}

#[test]
fn sampled_turns_are_those_of_the_twin() {
    for (phase, name) in tables() {
        // u has steps of 1.2e-7, and sums of shares are rounded to 6e-8.
        checks::turns_are_those_of_the_twin(TabulatedX8::new(&phase), &phase, 5e-7, name);
    }
    // Not so next to 0, which is next to the peak.
    let phase = peak(0.99, 1025);
    checks::small_turns_are_those_of_the_twin(TabulatedX8::new(&phase), &phase, 1e-5, "a peak");
}

#[test]
fn densities_are_those_of_the_twin() {
    for (phase, name) in tables() {
        if phase.rows.iter().all(|row| row.1 > 0.0) {
            // x, up to 2, is rounded to 1e-7, and rows are a thousandth apart.
            checks::densities_are_those_of_the_twin(TabulatedX8::new(&phase), &phase, 1e-4, name);
        }
    }
}

#[test]
fn samples_follow_the_density() {
    for (phase, name) in tables() {
        checks::samples_follow_the_density(TabulatedX8::new(&phase), &phase, name);
    }
}

#[test]
fn a_turn_that_cannot_be_has_a_finite_inverse_density() {
    let phase = table(&[(-0.7, 0.0), (-0.5, 30.0), (-0.4, 0.0), (0.3, 0.0), (0.37, 70.0), (0.5, 0.0)]);
    let lanes = TabulatedX8::new(&phase);
    for (cosine, zero) in [(1.0, true), (0.8, true), (0.4, false), (0.0, true), (-0.5, false), (-1.0, true)] {
        let sine = f32::sqrt(1.0 - cosine * cosine);
        let [z, to] = [[0.0, 0.0, 1.0], [sine, 0.0, cosine]].map(Vec3x8::splat);
        let found = lanes.inverse_density(z, to).to_array()[0];
        assert_eq!(found == LARGEST_INVERSE_DENSITY, zero, "at {cosine}: {found}");
        assert_eq!(phase.density(f64::from(cosine)) == 0.0, zero, "at {cosine}");
    }
    // No sample is at the edge of a gap, with NaN or outside of [-1, 1].
    for word in (0..=u32::MAX).step_by(0x0010_0007) {
        let turn = lanes.sample(f32x8::splat(crate::random::uniform(word) as f32));
        let [cosine, sine] = [turn.cosine, turn.sine].map(|x| x.to_array()[0]);
        assert!(cosine.abs() <= 1.0 && (0.0..=1.0).contains(&sine), "cosine {cosine}, sine {sine}");
    }
}
