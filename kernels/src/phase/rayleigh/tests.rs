//! The formulas by quadrature, and the kernel against its twin.

use super::{Rayleigh, RayleighX8};
use crate::phase::checks;

#[test]
fn the_twin_agrees_with_its_density() {
    checks::the_twin_agrees_with_its_density(&Rayleigh, 5e-7, "rayleigh");
    checks::the_twin_inverts_its_distribution(&Rayleigh, 5e-7, "rayleigh");
}

#[test]
fn the_kernel_is_its_twin() {
    let lanes = RayleighX8::new(Rayleigh);
    // u has steps of 1.2e-7; the cosine has five roundings of 6e-8, as has the sine of a small turn.
    checks::turns_are_those_of_the_twin(lanes, &Rayleigh, 3e-7, "rayleigh");
    // Rounding of a sum of two terms up to 1, and of the constant.
    checks::densities_are_those_of_the_twin(lanes, &Rayleigh, 6e-7, "rayleigh");
    checks::small_turns_are_those_of_the_twin(lanes, &Rayleigh, 5e-7, "rayleigh");
    checks::samples_follow_the_density(lanes, &Rayleigh, "rayleigh");
}
