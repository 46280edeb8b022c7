//! The kernel against its twin, for every kind of lobe.

use wide::f32x8;

use super::{HenyeyGreenstein, HenyeyGreensteinX8, reference};
use crate::phase::reference::Phase;
use crate::phase::{PhaseX8, checks};
use crate::vec3::Vec3x8;

const ASYMMETRIES: [f32; 12] = [-0.99, -0.9, -0.3, -1e-3, -1e-6, 0.0, 1e-6, 1e-3, 0.5, 0.9, 0.97, 0.999];

fn lane(batch: f32x8) -> f64 {
    f64::from(batch.to_array()[0])
}

#[test]
fn sampled_turns_are_those_of_the_twin() {
    for g in ASYMMETRIES {
        let phase = HenyeyGreensteinX8::new(HenyeyGreenstein { g });
        for word in (0..=u32::MAX).step_by(0x0100_3007) {
            let u = crate::random::uniform(word);
            let found = phase.sample(f32x8::splat(u as f32));
            let cosine = reference::sample_cosine(f64::from(g), u);
            // Five roundings of a number up to 2.
            assert!((lane(found.cosine) - cosine).abs() < 6e-7, "g {g}, u {u}: {} {cosine}", lane(found.cosine));
            let sine = (1.0 - cosine * cosine).sqrt();
            assert!((lane(found.sine) - sine).abs() < 1e-6, "g {g}, u {u}: {} {sine}", lane(found.sine));
        }
    }
}

#[test]
fn densities_between_directions_keep_small_angles() {
    for g in ASYMMETRIES {
        let phase = HenyeyGreensteinX8::new(HenyeyGreenstein { g });
        for angle in [0.0_f64, 1e-5, 1e-3, 0.1, 1.0, 2.0, 3.1, core::f64::consts::PI - 1e-4] {
            let (sin, cos) = (angle as f32).sin_cos();
            let (from, to) = (Vec3x8::splat([0.0, 0.0, 1.0]), Vec3x8::splat([sin, 0.0, cos]));
            let found = lane(phase.inverse_density(from, to));
            let expected = 1.0 / reference::density(f64::from(g), f64::from(angle as f32).cos());
            // A forward lobe resolves an angle of 1 - g; a backward one the distance to pi, which cos stores to 1e-7.
            assert!((found / expected - 1.0).abs() < 3e-5, "g {g}, angle {angle}: {found} {expected}");
        }
    }
}

#[test]
fn a_lobe_passes_what_every_phase_function_has_to_pass() {
    for g in ASYMMETRIES {
        let (phase, name) = (HenyeyGreenstein { g }, format!("g {g}"));
        let lanes = HenyeyGreensteinX8::new(phase);
        checks::the_twin_agrees_with_its_density(&phase, 1e-5, &name);
        checks::the_twin_inverts_its_distribution(&phase, 1e-5, &name);
        checks::samples_follow_the_density(lanes, &phase, &name);
        let [share, mirrored] = [g, -g].map(|g| HenyeyGreenstein { g }.forward_share());
        assert!((share + mirrored - 1.0).abs() < 1e-12, "{name}");
    }
}
