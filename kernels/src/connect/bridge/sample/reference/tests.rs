//! Counts, rolls and walks of the twin follow their distributions.

use super::*;
use crate::connect::bridge::reference::{count_probability, density, roll_density};
use crate::media::Medium;
use crate::media::reference::Homogeneous;
use crate::phase::HenyeyGreenstein;
use crate::phase::PhaseFunction;
use crate::phase::henyey_greenstein::reference as lobe;

fn bridge(g: f32) -> Bridge {
    let phase = PhaseFunction::henyey_greenstein(g);
    Bridge::new(Roll::Aligned, &Medium::homogeneous(1.0, [1.0; 3], phase), 30)
}

fn start(arriving: DVec3) -> Start {
    Start { depth: 2, position: DVec3::ZERO, arriving, on_surface: false }
}

fn draws(pixel: u32) -> Draws {
    Draws { pixel, sample: 3, depth: 2, seed: 1 }
}

#[test]
fn counts_follow_their_probabilities() {
    let samples = 40_000;
    let limited = Bridge { max_inserted: 2, ..bridge(0.6) };
    let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.6 });
    for (bridge, way, max) in [(bridge(0.6), 2.4, 30), (bridge(0.6), 13.5, 8), (limited, 2.4, 30)] {
        let (lengths, way) = (PathLengths { min: 1, max }, way * DVec3::X);
        for start in [start(DVec3::Y), Start { on_surface: true, ..start(DVec3::Y) }] {
            let mut made = [0; 31];
            for pixel in 0..samples {
                let inserted = count_edges(&bridge, medium, lengths, &start, way, &draws(pixel));
                inserted.into_iter().for_each(|inserted| made[inserted as usize + 1] += 1);
            }
            for (edges, made) in made.into_iter().enumerate() {
                let p = count_probability(&bridge, medium, max, &start, way, edges as u32);
                let (expected, deviation) = (p * f64::from(samples), (p * f64::from(samples)).sqrt());
                let case = format!("{edges} edges: {made}, not {expected}");
                assert!((f64::from(made) - expected).abs() <= 4.5 * deviation, "{case}");
            }
        }
    }
}

#[test]
fn without_room_bridges_are_dropped() {
    let count = |max: u32| {
        let lengths = PathLengths { min: 1, max };
        let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.5 });
        count_edges(&bridge(0.5), medium, lengths, &start(DVec3::X), DVec3::ZERO, &draws(0))
    };
    assert_eq!([1, 2, 3].map(count), [None, None, Some(0)]);
}

/// A phase function that rolls by three lobes.
struct Mixture;

impl Phase for Mixture {
    fn density(&self, cosine: f64) -> f64 {
        self.roll_lobes().into_iter().map(|(share, g)| share * lobe::density(g, cosine)).sum()
    }

    fn sample_cosine(&self, _: f64) -> f64 {
        unreachable!("only rolls are drawn")
    }

    fn forward_share(&self) -> f64 {
        self.roll_lobes().into_iter().map(|(share, g)| share * lobe::forward_share(g)).sum()
    }

    fn mean_cosine(&self) -> f64 {
        self.roll_lobes().into_iter().map(|(share, g)| share * g).sum()
    }

    fn roll_lobes(&self) -> Vec<(f64, f64)> {
        vec![(0.5, 0.9), (0.2, -0.7), (0.3, 0.0)]
    }
}

/// The share of rolls below an angle, drawn by an even spread of numbers, against the integral of the density.
#[test]
fn rolls_by_several_lobes_follow_their_density() {
    let (arriving, axis) = (DVec3::new(0.6, 0.0, 0.8), DVec3::Z);
    let first = |psi: f64| DVec3::new(0.9_f64.sin() * psi.cos(), 0.9_f64.sin() * psi.sin(), 0.9_f64.cos());
    let (numbers, steps) = (100_000, 8192);
    let roll = |u: f64| psi(Roll::Aligned, &Mixture, arriving, axis, first(0.0), u);
    let mut rolls: Vec<_> = (0..numbers).map(|k| roll((f64::from(k) + 0.5) / f64::from(numbers))).collect();
    rolls.sort_by(f64::total_cmp);
    let (width, mut share) = (TAU / f64::from(steps), 0.0);
    for k in 0..steps {
        let angle = -PI + (f64::from(k) + 0.5) * width;
        share += roll_density(&Mixture, arriving, axis, first(angle)) / f64::from(steps);
        let below = rolls.partition_point(|roll| *roll < angle + 0.5 * width);
        let found = below as f64 / f64::from(numbers);
        assert!((found - share).abs() < 5e-5, "{found} of all rolls are below {angle}, not {share}");
    }
}

/// What a share u of all rolls does not exceed, against the integral of the density.
#[test]
fn rolls_follow_their_density() {
    let (phase, arriving, axis) = (HenyeyGreenstein { g: 0.8 }, DVec3::new(0.6, 0.0, 0.8), DVec3::Z);
    let first = |psi: f64| DVec3::new(0.9_f64.sin() * psi.cos(), 0.9_f64.sin() * psi.sin(), 0.9_f64.cos());
    let width = TAU / 8192.0;
    let mut share = 0.0;
    for k in 0..8191 {
        let angle = -PI + (f64::from(k) + 0.5) * width;
        share += roll_density(&phase, arriving, axis, first(angle)) * width / TAU;
        if k % 512 == 511 {
            let found = psi(Roll::Aligned, &phase, arriving, axis, first(0.0), share);
            assert!((found - (angle + 0.5 * width)).abs() < 1e-4, "{found} at {angle}");
        }
    }
}

#[test]
fn the_first_edge_is_rolled_away_from_the_direction_of_arrival() {
    let (start, point) = (DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.1, 0.5, -0.7));
    let phase = HenyeyGreenstein { g: 0.6 };
    let (axis, arriving) = ((point - start).normalize(), DVec3::new(0.4, 0.5, -0.6).normalize());
    for (pixel, roll) in (0..50).flat_map(|pixel| [(pixel, Roll::Aligned), (pixel, Roll::Uniform)]) {
        let draws = draws(pixel);
        let mut inserted = [DVec3::ZERO; 3];
        let from = Start { position: start, ..self::start(arriving) };
        place(&Bridge { roll, ..bridge(0.6) }, &phase, &from, point, &draws, &mut inserted);
        let first = (inserted[0] - start).normalize();
        let across = |v: DVec3| (v - v.dot(axis) * axis).normalize();
        let (from, to) = (across(arriving), across(first));
        let found = from.cross(to).dot(axis).atan2(from.dot(to));
        let expected = psi(roll, &phase, arriving, axis, first, draws.roll());
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }
}

#[test]
fn bridges_keep_the_shape_of_their_walk_from_one_of_its_ends() {
    let (start, point) = (DVec3::new(0.1, -0.4, 2.0), DVec3::new(1.0, 3.0, -1.0));
    let (bridge, phase) = (bridge(0.5), HenyeyGreenstein { g: 0.5 });
    let from = Start { position: start, ..self::start(DVec3::X) };
    let mut turned = 0;
    for pixel in 0..50 {
        let mut chain = [start; 6];
        place(&bridge, &phase, &from, point, &draws(pixel), &mut chain[1..5]);
        chain[5] = point;
        let walk = [vec![DVec3::ZERO], free_walk(&phase, 5, &draws(pixel))].concat();
        let scale = (point - start).length() / walk[5].length();
        let keeps = |at: &dyn Fn(usize) -> DVec3| {
            let pairs = (0..6).flat_map(|i| (0..i).map(move |j| (i, j)));
            let distances = pairs.map(|(i, j)| ((chain[i] - chain[j]).length(), (at(i) - at(j)).length()));
            // Handedness: a mirror image has the same distances.
            let volume = |at: &dyn Fn(usize) -> DVec3| (at(1) - at(0)).cross(at(2) - at(1)).dot(at(3) - at(2));
            let same_hand = volume(&|k| chain[k]) * volume(at) > 0.0;
            let mut far = distances.map(|(found, free)| (found - scale * free).abs() / (scale * free.max(1.0)));
            same_hand && far.all(|error| error < 1e-9)
        };
        let [as_drawn, from_its_end] = [keeps(&|k| walk[k]), keeps(&|k| walk[5] - walk[5 - k])];
        assert!(as_drawn != from_its_end, "{pixel}");
        turned += u32::from(from_its_end);
    }
    assert!((10..40).contains(&turned), "{turned} of 50");
}

/// E[h / p] = 1 for a density h of the inserted vertices: each uniform in a ball between the ends, small enough for
/// the ratio to vary little, and nearer to one of them, which walks from the other end are not.
#[test]
fn bridges_follow_their_density() {
    let (start, point) = (DVec3::ZERO, DVec3::new(0.0, 0.6, 0.8));
    let arriving = DVec3::new(0.8, 0.0, 0.6);
    let (center, radius) = (start.lerp(point, 0.3), 0.5_f64);
    let h = 1.0 / (4.0 / 3.0 * PI * radius.powi(3));
    for (roll, g, inserted) in
        [(Roll::Uniform, 0.3, 1), (Roll::Aligned, 0.5, 1), (Roll::Aligned, -0.4, 1), (Roll::Aligned, 0.25, 2)]
    {
        let (bridge, from) = (Bridge { roll, ..bridge(g) }, self::start(arriving));
        let phase = HenyeyGreenstein { g };
        let medium = &Homogeneous::new(1.0, &phase);
        // Pairs of vertices are rarely both in the ball.
        let samples = if inserted == 1 { 100_000 } else { 1_000_000 };
        let (mut sum, mut squares) = (0.0, 0.0);
        // Given the number of edges, so without its probability.
        let probability = count_probability(&bridge, medium, 9, &from, point, inserted as u32 + 1);
        for pixel in 0..samples {
            let mut chain = vec![start; inserted + 2];
            place(&bridge, &phase, &from, point, &draws(pixel), &mut chain[1..=inserted]);
            chain[inserted + 1] = point;
            if chain[1..=inserted].iter().any(|vertex| (*vertex - center).length() > radius) {
                continue;
            }
            let p = density(&bridge, medium, 9, &from, &chain, 1.0 / probability).value();
            let ratio = h.powi(inserted as i32) / p;
            sum += ratio;
            squares += ratio * ratio;
        }
        let samples = f64::from(samples);
        let mean = sum / samples;
        let error = ((squares / samples - mean * mean) / samples).sqrt();
        let case = format!("{roll:?}, g = {g}, {inserted} inserted: {mean} +- {error}");
        assert!((mean - 1.0).abs() < 4.0 * error && error < 0.03, "{case}");
    }
}
