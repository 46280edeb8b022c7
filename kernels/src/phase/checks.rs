//! What every phase function has to pass, kernel and twin.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use wide::{f32x8, u32x8};

use super::reference::{Phase, turn};
use super::{Deflection, PhaseX8};
use crate::random::{uniform, uniform_f32, words};
use crate::vec3::Vec3x8;

/// Steps of the midpoint rule.
const STEPS: i32 = 4000;

/// `2 pi` times the integral of `weight(c) density(c)` over the cosines in `from..to`, by the midpoint rule in z: the
/// angle is `pi/2 z^3` from the nearer pole, so that peaks of a thousandth of a radian are wide.
pub fn integral(phase: &dyn Phase, [from, to]: [f64; 2], weight: impl Fn(f64) -> f64) -> f64 {
    let end = |cosine: f64| {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        let z = (angle.min(PI - angle) / FRAC_PI_2).cbrt();
        if angle < FRAC_PI_2 { 1.0 - z } else { z - 1.0 }
    };
    let (start, width) = (end(from), (end(to) - end(from)) / f64::from(STEPS));
    let step = |i: i32| {
        let z = start + (f64::from(i) + 0.5) * width;
        let from_pole = 1.0 - z.abs();
        let angle = FRAC_PI_2 * from_pole.powi(3);
        let cosine = angle.cos().copysign(z);
        let per_z = 3.0 * FRAC_PI_2 * from_pole * from_pole * angle.sin();
        TAU * phase.density(cosine) * weight(cosine) * per_z * width
    };
    (0..STEPS).map(step).sum()
}

/// Share of all events with a cosine in `from..to`.
fn share(phase: &dyn Phase, ends: [f64; 2]) -> f64 {
    integral(phase, ends, |_| 1.0)
}

/// Density, shares and mean of a twin belong together: by quadrature, within `tolerance`.
pub fn the_twin_agrees_with_its_density(phase: &dyn Phase, tolerance: f64, name: &str) {
    let near = |found: f64, expected: f64, what: &str| {
        assert!((found - expected).abs() < tolerance, "{name}: {what} is {found}, by quadrature {expected}");
    };
    near(1.0, share(phase, [-1.0, 1.0]), "the whole");
    near(phase.forward_share(), share(phase, [0.0, 1.0]), "the forward share");
    near(phase.mean_cosine(), integral(phase, [-1.0, 1.0], |cosine| cosine), "the mean cosine");
}

/// A share u of the density lies below the cosine of u, and below that of the forward hemisphere alone.
pub fn the_twin_inverts_its_distribution(phase: &dyn Phase, tolerance: f64, name: &str) {
    for u in [1e-4, 0.01, 0.2, 0.45, 0.5, 0.55, 0.8, 0.99, 0.9999] {
        let below = share(phase, [-1.0, phase.sample_cosine(u)]);
        assert!((below - u).abs() < tolerance, "{name}: {below} lies below the cosine of {u}");
        let below = share(phase, [0.0, phase.sample_forward_cosine(u)]) / phase.forward_share();
        assert!((below - u).abs() < tolerance, "{name}, forward: {below} lies below the cosine of {u}");
    }
}

fn lane(batch: f32x8) -> f64 {
    f64::from(batch.to_array()[0])
}

/// The smaller of cosine and sine is the one that knows the angle.
fn precise_cosine(cosine: f64, sine: f64) -> f64 {
    if sine < cosine.abs() { ((1.0 - sine) * (1.0 + sine)).sqrt().copysign(cosine) } else { cosine }
}

/// Uniform numbers: next to the ends, and 256 across.
fn uniforms() -> impl Iterator<Item = f64> {
    let ends = (0..32).flat_map(|i| [1 << i, u32::MAX - (1 << i)]);
    ends.chain((0..=u32::MAX).step_by(0x0100_3007)).map(uniform)
}

/// Sampled turns are those of the twin for a uniform number within `tolerance` of u, but for an angle of `tolerance`:
/// where hardly anything scatters, and next to the poles, angles are that sensitive to u.
pub fn turns_are_those_of_the_twin(lanes: impl PhaseX8, twin: &dyn Phase, tolerance: f64, name: &str) {
    let check = |found: Deflection, expected: &dyn Fn(f64) -> f64, u: f64| {
        let (c, s) = (lane(found.cosine), lane(found.sine));
        // A cosine that is computed as the distance from the opposite pole is rounded as a number up to 2.
        assert!((c * c + s * s - 1.0).abs() < 1.5e-6 && s >= 0.0, "{name}, u {u}: cosine {c}, sine {s}");
        let found = precise_cosine(c, s).acos();
        let [a, b] = [-tolerance, tolerance].map(|d| expected((u + d).clamp(1e-15, 1.0 - 1e-15)).acos());
        let inside = found > a.min(b) - tolerance && found < a.max(b) + tolerance;
        assert!(inside, "{name}, u {u}: an angle of {found} for {}", expected(u).acos());
    };
    for u in uniforms() {
        let batch = f32x8::splat(u as f32);
        check(lanes.sample(batch), &|u| twin.sample_cosine(u), u);
        let forward = lanes.sample_forward(batch);
        assert!(lane(forward.cosine) >= 0.0, "{name}, u {u}: {} is not forward", lane(forward.cosine));
        check(forward, &|u| twin.sample_forward_cosine(u), u);
    }
    let (found, expected) = (lane(lanes.forward_share()), twin.forward_share());
    assert!((found / expected - 1.0).abs() < 1e-6, "{name}: forward share {found} for {expected}");
    // Both ask for the same row of the table of counts.
    let [h, expected] = [lanes.lobe(), super::HenyeyGreensteinX8::new(twin.lobe())]
        .map(|lobe| lane(lobe.inverse_density(Vec3x8::splat([0.0, 0.0, 1.0]), Vec3x8::splat([0.6, 0.0, 0.8]))));
    assert_eq!(h, expected, "{name}: lobe");
}

/// Inverse densities between directions are those of the twin, relative to themselves, at every angle and next to both
/// poles. Directions are compared as stored: what they lose in f32 is not the phase function's.
pub fn densities_are_those_of_the_twin(lanes: impl PhaseX8, twin: &dyn Phase, tolerance: f64, name: &str) {
    let steps = (0..200).map(|i| PI * (f64::from(i) + 0.5) / 200.0);
    let angles = steps.chain((0..14).flat_map(|i| [0.1_f64, 0.03].map(|a| a * 0.5_f64.powi(i))));
    for (i, angle) in angles.enumerate() {
        let [a, b, c, _] = words(i as u32, 1, 2, 3).map(uniform);
        let from = turn(DVec3::Z, 2.0 * a - 1.0, b);
        for angle in [angle, PI - angle] {
            let (from, to) = (from.as_vec3(), turn(from, angle.cos(), c).as_vec3());
            let [f, t] = [from, to].map(|d| d.as_dvec3().normalize());
            // Half the squared chord, without the cancellation of a dot product.
            let cosine = if f.dot(t) > 0.0 { 1.0 - 0.5 * (t - f).length_squared() } else { f.dot(t) };
            let (from, to) = (Vec3x8::splat(from.to_array()), Vec3x8::splat(to.to_array()));
            let (found, expected) = (lane(lanes.inverse_density(from, to)), twin.density(cosine).recip());
            assert!((found / expected - 1.0).abs() < tolerance, "{name}, angle {angle}: {found} for {expected}");
            let shape = lane(lanes.scale() * lanes.inverse_shape(from, to));
            assert!((shape / found - 1.0).abs() < 1e-6, "{name}, angle {angle}: {shape} and {found}");
        }
    }
}

/// Turns by small angles are those of the twin relative to themselves, down to 1e-4: its cosines end there.
pub fn small_turns_are_those_of_the_twin(lanes: impl PhaseX8, twin: &dyn Phase, tolerance: f64, name: &str) {
    for word in (2..18).map(|i| u32::MAX >> i) {
        let u = 1.0 - uniform(word);
        let cosine = twin.sample_cosine(u);
        let expected = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        if !(1e-4..0.3).contains(&expected) {
            continue;
        }
        let found = lane(lanes.sample(f32x8::splat(u as f32)).sine);
        assert!((found / expected - 1.0).abs() < tolerance, "{name}, u {u}: sine {found} for {expected}");
    }
}

/// Sampled cosines, of all turns and of the forward ones, fill bins as the density says: chi-square of up to 128 bins.
pub fn samples_follow_the_density(lanes: impl PhaseX8, twin: &dyn Phase, name: &str) {
    const BINS: usize = 128;
    const SAMPLES: u32 = 1 << 18;
    for from in [-1.0, 0.0] {
        // Bins are narrow towards the poles.
        let angle = |i: usize| {
            let pole = 2.0 * (i as f64 / BINS as f64) - 1.0;
            FRAC_PI_2 * (1.0 + pole.signum() * (1.0 - (1.0 - pole.abs()).powi(3)))
        };
        let ends: Vec<f64> = (0..=BINS).rev().map(|i| angle(i).cos()).map(|c| f64::max(c, from)).collect();
        let mut counts = [0_u32; BINS];
        for batch in 0..SAMPLES / 8 {
            let word = core::array::from_fn(|i| words(batch, i as u32, 7, 11)[0]);
            let u = uniform_f32(u32x8::new(word));
            let turn = if from < 0.0 { lanes.sample(u) } else { lanes.sample_forward(u) };
            for (cosine, sine) in turn.cosine.to_array().into_iter().zip(turn.sine.to_array()) {
                let cosine = precise_cosine(f64::from(cosine), f64::from(sine));
                counts[ends[1..BINS].partition_point(|end| *end < cosine)] += 1;
            }
        }
        let scale = f64::from(SAMPLES) / share(twin, [from, 1.0]);
        let (mut expected, mut found) = (0.0, 0.0);
        let (mut chi_square, mut freedom) = (0.0, -1.0_f64);
        for (i, count) in counts.into_iter().enumerate() {
            expected += scale * share(twin, [ends[i], ends[i + 1]]);
            found += f64::from(count);
            // Bins that hardly anything falls in count with the next.
            if expected > 40.0 {
                chi_square += (found - expected).powi(2) / expected;
                freedom += 1.0;
                (expected, found) = (0.0, 0.0);
            }
        }
        assert!(freedom >= 4.0 && found < 100.0, "{name}, from {from}: {freedom} bins are no test");
        // The mean plus five standard deviations.
        let limit = freedom + 5.0 * (2.0 * freedom).sqrt();
        assert!(chi_square < limit, "{name}, from {from}: chi-square {chi_square} of {freedom} degrees of freedom");
    }
}
