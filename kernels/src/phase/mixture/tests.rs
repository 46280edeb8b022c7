//! The formulas by quadrature, the kernel against its twin, and its roll against the density of its roll.

use core::f64::consts::TAU;

use wide::f32x8;

use super::{Mixture, MixtureX8, TwoLobeX8};
use crate::phase::reference::Phase;
use crate::phase::{Draine, DraineX8, HenyeyGreenstein, PhaseX8, PlaneAngle, checks};
use crate::vec3::Vec3x8;

type TwoLobe = Mixture<HenyeyGreenstein, HenyeyGreenstein>;

fn two_lobe([first, second]: [f32; 2], weight: f32) -> TwoLobe {
    Mixture { weight, first: HenyeyGreenstein { g: first }, second: HenyeyGreenstein { g: second } }
}

fn two_lobes() -> impl Iterator<Item = (TwoLobe, String)> {
    let lobes = [([0.9, -0.3], 0.8), ([0.99, 0.0], 0.1), ([-0.95, 0.6], 0.3), ([0.5, 0.7], 0.0), ([0.5, 0.7], 1.0)];
    lobes.into_iter().map(|(g, weight)| (two_lobe(g, weight), format!("g {g:?}, weight {weight}")))
}

#[test]
fn the_twin_agrees_with_its_density() {
    for (phase, name) in two_lobes() {
        checks::the_twin_agrees_with_its_density(&phase, 5e-6, &name);
        let lobes = phase.roll_lobes();
        assert!((lobes.iter().map(|(share, _)| share).sum::<f64>() - 1.0).abs() < 1e-12, "{name}");
        let mean: f64 = lobes.iter().map(|(share, g)| share * g).sum();
        assert!((mean - phase.mean_cosine()).abs() < 1e-7, "{name}");
    }
}

#[test]
fn sampled_turns_are_those_of_the_twin() {
    for (phase, name) in two_lobes() {
        // u has steps of 1.2e-7, and what remains of it is rounded twice.
        checks::turns_are_those_of_the_twin(TwoLobeX8::of(&phase), &phase, 3e-7, &name);
    }
}

#[test]
fn densities_are_those_of_the_twin() {
    // h of a peak, as that of Henyey-Greenstein.
    for (phase, name) in two_lobes() {
        checks::densities_are_those_of_the_twin(TwoLobeX8::of(&phase), &phase, 1e-5, &name);
    }
}

#[test]
fn samples_follow_the_density() {
    for (phase, name) in two_lobes() {
        checks::samples_follow_the_density(TwoLobeX8::of(&phase), &phase, &name);
    }
    let phase = Mixture { weight: 0.6, first: two_lobe([0.8, -0.5], 0.7), second: Draine { g: 0.4, alpha: 9.0 } };
    let lanes = MixtureX8::new(&phase, TwoLobeX8::of(&phase.first), DraineX8::new(phase.second));
    checks::samples_follow_the_density(lanes, &phase, "a mixture within a mixture");
}

fn angle(cosine: f64) -> PlaneAngle {
    let splat = |x: f64| f32x8::splat(x as f32);
    PlaneAngle { cosine: splat(cosine), sine: splat((1.0 - cosine * cosine).sqrt()) }
}

#[test]
fn rolls_follow_their_density() {
    const BINS: usize = 32;
    const SAMPLES: u32 = 1 << 15;
    for (phase, name) in two_lobes() {
        let lanes = TwoLobeX8::of(&phase);
        let angles = [0.8, 0.5].map(angle);
        let [arriving, leaving] = angles;
        let zero = f32x8::ZERO;
        // 2 pi p(psi) of the kernel, with the azimuths of both directions psi apart.
        let density = |psi: f64| {
            let (s, c) = psi.sin_cos();
            let incoming = Vec3x8::new(arriving.sine, zero, arriving.cosine);
            let outgoing = Vec3x8::new(
                leaving.sine * f32x8::splat(c as f32),
                leaving.sine * f32x8::splat(s as f32),
                leaving.cosine,
            );
            f64::from(lanes.roll_density([incoming, outgoing], angles).to_array()[0])
        };
        let expected = |bin: usize| -> f64 {
            let steps = 64_usize;
            let per_bin = (steps * BINS) as f64;
            (0..steps).map(|i| density(TAU * ((bin * steps + i) as f64 + 0.5) / per_bin) / per_bin).sum()
        };
        let mut found = [0.0; BINS];
        for i in 0..SAMPLES {
            let u = (f64::from(i) + 0.5) / f64::from(SAMPLES);
            let (sin, cos) = lanes.roll(arriving, leaving, f32x8::splat(u as f32));
            let psi = f64::from(sin.to_array()[0]).atan2(f64::from(cos.to_array()[0])).rem_euclid(TAU);
            found[((psi / TAU * BINS as f64) as usize).min(BINS - 1)] += 1.0 / f64::from(SAMPLES);
        }
        for (bin, found) in found.into_iter().enumerate() {
            // Uniform numbers are evenly spaced: a bin is off by a sample of each lobe at either end.
            let limit = 4.0 / f64::from(SAMPLES) + 1e-5;
            assert!((found - expected(bin)).abs() < limit, "{name}, bin {bin}: {found} and {}", expected(bin));
        }
    }
}
