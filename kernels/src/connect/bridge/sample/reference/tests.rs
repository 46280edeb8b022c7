//! Counts, rolls and walks of the twin follow their distributions.

use super::*;
use crate::connect::bridge::FEWEST_CHOSEN;
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
        let (mut inserted, end) = ([DVec3::ZERO; 3], End { point, normal: None });
        let from = Start { position: start, ..self::start(arriving) };
        place(&Bridge { roll, ..bridge(0.6) }, &phase, &from, &end, &draws, &mut inserted);
        let first = (inserted[0] - start).normalize();
        let across = |v: DVec3| (v - v.dot(axis) * axis).normalize();
        let (from, to) = (across(arriving), across(first));
        let found = from.cross(to).dot(axis).atan2(from.dot(to));
        let expected = psi(roll, &phase, arriving, axis, first, draws.roll());
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }
}

/// The vertices of the free walks, in the sequence of their pieces: (0, 0), (0, 1), ..
fn free_walks(phase: &dyn Phase, edges: usize, draws: &Draws) -> Vec<Vec<DVec3>> {
    let pieces = (0..MOST_ALTERNATIVES).flat_map(|i| (0..MOST_ALTERNATIVES).map(move |j| [i, j]));
    pieces.map(|pieces| [vec![DVec3::ZERO], free_walk(phase, edges, pieces, draws)].concat()).collect()
}

/// Whether the four or more vertices of `found` are those of `free`, moved, turned and scaled.
fn have_one_shape(found: &[DVec3], free: &[DVec3]) -> bool {
    let last = free.len() - 1;
    let scale = (found[last] - found[0]).length() / (free[last] - free[0]).length();
    let pairs = (0..=last).flat_map(|i| (0..i).map(move |j| (i, j)));
    let mut distances = pairs.map(|(i, j)| ((found[i] - found[j]).length() / scale, (free[i] - free[j]).length()));
    // Handedness: a mirror image has the same distances.
    let volume = |v: &[DVec3]| (v[1] - v[0]).cross(v[2] - v[1]).dot(v[3] - v[2]);
    volume(found) * volume(free) > 0.0 && distances.all(|(found, free)| (found - free).abs() < 1e-9 * free.max(1.0))
}

/// The numbers of the walks that have the shape of `chain`, each with whether it is read from its end.
fn readings(chain: &[DVec3], walks: &[Vec<DVec3>]) -> Vec<(usize, bool)> {
    let from_its_end = |walk: &[DVec3]| walk.iter().rev().map(|v| walk[walk.len() - 1] - v).collect::<Vec<_>>();
    let both = |(k, walk): (usize, &Vec<DVec3>)| [(k, false, walk.clone()), (k, true, from_its_end(walk))];
    let all = walks.iter().enumerate().flat_map(both);
    all.filter(|(_, _, walk)| have_one_shape(chain, walk)).map(|(k, turned, _)| (k, turned)).collect()
}

/// A bridge with its ends, and its resampling weight.
fn placed(
    bridge: &Bridge,
    phase: &dyn Phase,
    from: &Start,
    end: &End,
    inserted: usize,
    draws: &Draws,
) -> (Vec<DVec3>, f64) {
    let mut chain = vec![from.position; inserted + 2];
    let weight = place(bridge, phase, from, end, draws, &mut chain[1..=inserted]);
    chain[inserted + 1] = end.point;
    (chain, weight)
}

#[test]
fn bridges_keep_the_shape_of_their_walk_from_one_of_its_ends() {
    let (start, point) = (DVec3::new(0.1, -0.4, 2.0), DVec3::new(1.0, 3.0, -1.0));
    let phase = HenyeyGreenstein { g: 0.5 };
    let from = Start { position: start, ..self::start(DVec3::X) };
    for (roll, often) in [(Roll::Aligned, 20..80), (Roll::Uniform, 0..1)] {
        let (bridge, mut turned, mut chosen) =
            (Bridge { roll, ..bridge(0.5) }, 0, [0; MOST_ALTERNATIVES * MOST_ALTERNATIVES]);
        for pixel in 0..100 {
            let (chain, _) = placed(&bridge, &phase, &from, &End { point, normal: None }, 4, &draws(pixel));
            let readings = readings(&chain, &free_walks(&phase, 5, &draws(pixel)));
            let [(walk, from_its_end)] = readings[..] else {
                panic!("{pixel}: {readings:?}");
            };
            turned += u32::from(from_its_end);
            chosen[walk] += 1;
        }
        assert!(often.contains(&turned), "{roll:?}: {turned} of 100");
        let tried = if roll == Roll::Aligned { MOST_ALTERNATIVES * MOST_ALTERNATIVES } else { 1 };
        assert_eq!(chosen.iter().filter(|times| **times > 0).count(), tried, "{roll:?}: {chosen:?}");
    }
}

#[test]
fn walks_share_their_lengths_and_pieces_and_nothing_else() {
    let phase = HenyeyGreenstein { g: 0.5 };
    for (edges, half) in [(2, 1), (3, 1), (6, 3), (7, 3)] {
        let walk = |pieces: [usize; 2]| [vec![DVec3::ZERO], free_walk(&phase, edges, pieces, &draws(7))].concat();
        let [base, first, second] = [[0, 0], [1, 0], [0, 1]].map(walk);
        let lengths = |walk: &[DVec3]| walk.windows(2).map(|ends| ends[1].distance(ends[0])).collect::<Vec<_>>();
        let cosines = |walk: &[DVec3]| -> Vec<f64> {
            walk.windows(3).map(|v| (v[1] - v[0]).normalize().dot((v[2] - v[1]).normalize())).collect()
        };
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs() < 1e-12).collect::<Vec<_>>();
        assert!([&first, &second].into_iter().all(|walk| same(&lengths(&base), &lengths(walk)) == vec![true; edges]));
        // The turn between the pieces belongs to the first one, and what comes behind goes along with it.
        let of_second = (0..edges - 1).map(|turn| turn >= half).collect::<Vec<_>>();
        let of_first = (0..edges - 1).map(|turn| turn < half).collect::<Vec<_>>();
        assert_eq!(same(&cosines(&base), &cosines(&first)), of_second);
        assert_eq!(same(&cosines(&base), &cosines(&second)), of_first);
        assert_eq!(base[..=half], second[..=half]);
        if edges - half >= 3 {
            assert!(have_one_shape(&base[half..], &first[half..]));
        }
    }
}

/// Turns of a walk's two alternatives are to opposite sides of its first edge.
#[test]
fn alternatives_turn_to_opposite_sides() {
    for g in [-0.4, 0.8] {
        let phase = HenyeyGreenstein { g };
        for pixel in 0..20 {
            let [one, other] = [0, 1].map(|m| free_walk(&phase, 2, [m, 0], &draws(pixel)));
            let across = |walk: &[DVec3]| (walk[1] - walk[0]).reject_from(DVec3::Z).normalize();
            assert!((across(&one) + across(&other)).length() < 1e-9, "g = {g}, {pixel}");
        }
    }
}

/// The mean over all azimuths of the part above zero of the cosine between directions at these angles to an axis.
fn mean_cosine(end: f64, normal: f64) -> f64 {
    let steps = 1000;
    let cosine = |k: i32| {
        let azimuth = TAU * (f64::from(k) + 0.5) / f64::from(steps);
        (end.cos() * normal.cos() + end.sin() * normal.sin() * azimuth.cos()).max(0.0)
    };
    (0..steps).map(cosine).sum::<f64>() / f64::from(steps)
}

#[test]
fn walks_suit_by_about_the_mean_cosine_where_they_arrive() {
    for [end, normal] in (0..=20).flat_map(|i| (0..=20).map(move |j| [i, j].map(|k| PI * f64::from(k) / 20.0))) {
        let tilted = |angle: f64, azimuth: f64| {
            DVec3::new(angle.sin() * f64::cos(azimuth), angle.sin() * azimuth.sin(), angle.cos())
        };
        let found = facing(tilted(end, 0.7), tilted(normal, 2.0), DVec3::Z) - f64::from(LEAST_COSINE);
        let expected = mean_cosine(end, normal);
        // Farthest where the cosine along the axis is all: SHORTER_SIDE / 2 times 2 / pi.
        let across = end.sin() * normal.sin();
        assert!((found - expected).abs() < 0.131 * across + 1e-6, "{end}, {normal}: {found}, expected {expected}");
    }
}

/// p_ij, from angles in a plane where the twin has directions. The light's normal is at an angle of `theta` to the axis.
fn shares(g: f64, gamma: f64, theta: Option<f64>, walks: &[Vec<DVec3>]) -> Vec<f64> {
    let h = |angle: f64| 1.0 + g * g - 2.0 * g * angle.cos();
    let turn = |angle: f64| 1.0 / (h(angle - gamma) * (h(angle + gamma) + 1.0 - g * g));
    let arrive = |angle: f64| {
        let Some(theta) = theta else { return 1.0 };
        let (u, t) = (angle.cos() * theta.cos(), 2.0 / PI * (angle.sin() * theta.sin()).abs());
        0.5 * (u + u.abs().max(t) + f64::from(SHORTER_SIDE) * u.abs().min(t)) + f64::from(LEAST_COSINE)
    };
    let suits = walks.iter().map(|walk| {
        let (reached, last) = (walk[walk.len() - 1], walk[walk.len() - 1] - walk[walk.len() - 2]);
        let [first, last] = [walk[1], last].map(|edge| edge.angle_between(reached));
        turn(first) * arrive(last) + turn(last) * arrive(first)
    });
    let suits: Vec<_> = suits.collect();
    let (sum, count, indifferent) = (suits.iter().sum::<f64>(), suits.len() as f64, f64::from(INDIFFERENT));
    suits.iter().map(|suit| (1.0 - indifferent) * suit / sum + indifferent / count).collect()
}

#[test]
fn walks_are_chosen_by_how_well_they_suit() {
    let (samples, point, gamma) = (3000, 2.0 * DVec3::Z, 1.0_f64);
    let from = start(DVec3::new(0.0, gamma.sin(), gamma.cos()));
    for (g, inserted, theta) in [(0.8, 3, None), (-0.6, 5, None), (0.4, 4, Some(1.2_f64)), (0.8, 3, Some(2.5))] {
        let (bridge, phase) = (bridge(g), HenyeyGreenstein { g });
        let end = End { point, normal: theta.map(|theta| DVec3::new(-theta.sin(), 0.0, -theta.cos())) };
        let (mut surplus, mut variances) =
            ([0.0; MOST_ALTERNATIVES * MOST_ALTERNATIVES], [0.0; MOST_ALTERNATIVES * MOST_ALTERNATIVES]);
        for pixel in 0..samples {
            let (chain, weight) = placed(&bridge, &phase, &from, &end, inserted, &draws(pixel));
            let walks = free_walks(&phase, inserted + 1, &draws(pixel));
            let shares = shares(f64::from(g), gamma, theta, &walks);
            let (chosen, _) = readings(&chain, &walks)[0];
            let expected = 1.0 / (walks.len() as f64 * shares[chosen]);
            assert!((weight / expected - 1.0).abs() < 1e-5, "{weight}, expected {expected}");
            for (walk, share) in shares.into_iter().enumerate() {
                surplus[walk] += f64::from(u8::from(walk == chosen)) - share;
                variances[walk] += share * (1.0 - share);
            }
        }
        for (surplus, variance) in surplus.into_iter().zip(variances) {
            assert!(surplus.abs() < 4.0 * variance.sqrt(), "g = {g}: {surplus} of {samples} +- {}", variance.sqrt());
        }
    }
}

#[test]
fn the_last_walk_is_taken_before_which_the_probabilities_add_up_to_the_number_at_most() {
    let chosen = [0.0, 0.24, 0.25, 0.74, 0.75, 0.874, 0.875, 0.999].map(|u| choose(&[0.25, 0.5, 0.125, 0.125], u));
    assert_eq!(chosen, [0, 0, 1, 1, 2, 2, 3, 3]);
}

#[test]
fn resampling_weights_average_to_one_and_are_bounded() {
    let end = End { point: DVec3::new(0.0, 0.6, 0.8), normal: Some(DVec3::new(0.6, 0.0, -0.8)) };
    let (samples, from) = (20_000, start(DVec3::new(0.8, 0.0, 0.6)));
    for (g, inserted) in [(0.9, 3), (0.7, 6), (-0.5, 4)] {
        let (bridge, phase) = (bridge(g), HenyeyGreenstein { g });
        let weights = (0..samples).map(|pixel| placed(&bridge, &phase, &from, &end, inserted, &draws(pixel)).1);
        let weights: Vec<_> = weights.collect();
        let mean = weights.iter().sum::<f64>() / f64::from(samples);
        let variance = weights.iter().map(|weight| (weight - mean).powi(2)).sum::<f64>() / f64::from(samples);
        let error = (variance / f64::from(samples)).sqrt();
        let case = format!("g = {g}, {inserted} inserted: {mean} +- {error}, variance {variance}");
        assert!((mean - 1.0).abs() < 4.0 * error && variance > 0.01, "{case}");
        let bound = (1.0 + 1e-12) / f64::from(INDIFFERENT);
        assert!(weights.iter().all(|weight| *weight > 0.0 && *weight <= bound), "{case}");
    }
}

#[test]
fn bridges_that_are_not_chosen_have_a_weight_of_one() {
    let phase = HenyeyGreenstein { g: 0.8 };
    let aligned = bridge(0.8);
    let uniform = Bridge { roll: Roll::Uniform, ..aligned.clone() };
    let end = End { point: DVec3::new(0.3, 1.0, 0.2), normal: Some(DVec3::NEG_Y) };
    let as_drawn = aligned.clone().as_drawn();
    let few = (0..FEWEST_CHOSEN - 1).map(|inserted| (&aligned, inserted));
    let all = (0..8).flat_map(|inserted| [(&uniform, inserted), (&as_drawn, inserted)]);
    for (bridge, inserted) in few.chain(all) {
        for pixel in 0..50 {
            let (_, weight) = placed(bridge, &phase, &start(DVec3::X), &end, inserted, &draws(pixel));
            assert!((weight - 1.0).abs() < 1e-14, "{bridge:?}, {inserted} inserted: {weight}");
        }
    }
}

/// E[w h / p] = 1 with the resampling weight w, for a density h of the inserted vertices: each in a uniform direction
/// and at a uniform distance, up to a radius, from the one before. They stay near the start, so that it matters which
/// end comes first, and near each other, so that the ratio varies little.
#[test]
fn bridges_follow_their_density() {
    let (point, radius) = (DVec3::new(0.0, 0.6, 0.8), 0.4);
    let h = |start: DVec3, end: DVec3| {
        let squared = start.distance_squared(end);
        if squared < radius * radius { 1.0 / (2.0 * TAU * radius * squared) } else { 0.0 }
    };
    let (from, end) = (start(DVec3::new(0.8, 0.0, 0.6)), End { point, normal: Some(DVec3::new(0.0, 0.6, -0.8)) });
    for (roll, g, inserted, samples) in [
        (Roll::Uniform, 0.3, 1, 100_000),
        (Roll::Aligned, 0.5, 1, 100_000),
        (Roll::Aligned, -0.4, 1, 100_000),
        (Roll::Aligned, 0.5, 2, 300_000),
        (Roll::Aligned, 0.25, 3, 200_000),
    ] {
        let bridge = Bridge { roll, ..bridge(g) };
        let phase = HenyeyGreenstein { g };
        let medium = &Homogeneous::new(1.0, &phase);
        let (mut sum, mut squares) = (0.0, 0.0);
        // Given the number of edges, so without its probability.
        let probability = count_probability(&bridge, medium, 9, &from, point, inserted as u32 + 1);
        for pixel in 0..samples {
            let (chain, weight) = placed(&bridge, &phase, &from, &end, inserted, &draws(pixel));
            let h: f64 = chain[..=inserted].windows(2).map(|edge| h(edge[0], edge[1])).product();
            if h == 0.0 {
                continue;
            }
            let p = density(&bridge, medium, 9, &from, &chain, 1.0 / probability).value();
            let ratio = weight * h / p;
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
