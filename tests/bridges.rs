//! Bridges and once-more next event estimation: what their kernels make against the densities of the twins.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use fogbow::frame::Frame;
use fogbow::wavefront::{Candidates, Wavefront};
use fogbow_kernels::PathLengths;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_kernels::connect::bridge::reference::{Start, count_probability, density, roll_coefficients};
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::buckets::DROPPED;
use fogbow_kernels::connect::omnee;
use fogbow_kernels::media::reference::Homogeneous;
use fogbow_kernels::phase::reference::Phase;
use fogbow_testing::frames;
use fogbow_testing::recorded;
use fogbow_testing::statistics::{Moments, p_of_counts, p_of_uniformity, p_of_z};
use fogbow_testing::walks::{after_walks, vector};
use glam::DVec3;

/// Samples that a distribution is tested with.
const SAMPLES: usize = 1 << 18;
/// The same where every one of them costs the twin as many probabilities as there may be edges.
const COUNTED: usize = SAMPLES / 8;
/// P-value below which a distribution is refused. Some 40 are tested, with fixed seeds.
const SUSPICIOUS: f64 = 1e-4;

/// A frame whose starts see the light from all sides, at distances of some mean free paths.
fn frame(g: f32, roll: Roll) -> Frame {
    thicker(g, roll, 0.5, 60)
}

/// The same for another extinction and other lengths.
fn thicker(g: f32, roll: Roll, extinction: f32, longest: u32) -> Frame {
    let mut frame = frames::with_extinction(&frames::fog_facing(0.0, g, [64, 64]), extinction);
    frame.lengths = PathLengths { min: 1, max: longest };
    let bridge = Some(Bridge::new(roll, &frame.medium, longest));
    Frame { techniques: Techniques { bridge, ..Techniques::default() }, ..frame }
}

/// `frame` with other bridges.
fn with(frame: Frame, change: impl FnOnce(Bridge) -> Bridge) -> Frame {
    let bridge = Some(change(settings(&frame)));
    Frame { techniques: Techniques { bridge, ..Techniques::default() }, ..frame }
}

/// The medium of `frame`, as the twins ask it.
fn medium(frame: &Frame) -> Homogeneous<'_> {
    frame.medium.homogeneous_twin(0)
}

/// A start in the medium.
fn start(depth: usize, position: DVec3, arriving: DVec3) -> Start {
    Start { depth: depth as u32, position, arriving, on_surface: false }
}

/// The settings of the bridges of `frame`.
fn settings(frame: &Frame) -> Bridge {
    frame.techniques.bridge.clone().expect("a frame with bridges")
}

/// Bridges from the vertices after `events` scattering events, built by the kernels: the direction in which the path
/// arrives, the chain from the start to the light point, and its resampling weight.
fn bridges(frame: &Frame, samples: usize, events: usize, mut visit: impl FnMut(DVec3, &[DVec3], f64)) {
    after_walks(frame, samples, events, |wavefront| {
        recorded::build_bridges(wavefront, &settings(frame));
        for bucket in wavefront.buckets.buckets() {
            for row in bucket.rows() {
                let candidate = wavefront.candidates.bridged.row(row);
                let inserted =
                    wavefront.chains.vertices[..bucket.inserted].iter().map(|vertex| vector(vertex.row(row)));
                let ends = [candidate.start, candidate.point].map(vector);
                let chain: Vec<_> = [ends[0]].into_iter().chain(inserted).chain([ends[1]]).collect();
                visit(vector(candidate.arriving), &chain, f64::from(wavefront.chains.resampling.rows()[row]));
            }
        }
    });
}

/// Counts of bridges by their number of edges, dropped ones in entry 0, and what the twin expects.
fn edges(frame: &Frame, events: usize) -> (Vec<f64>, Vec<f64>) {
    let (bridge, longest) = (settings(frame), frame.lengths.max);
    let cells = longest as usize + 1;
    let (mut found, mut expected) = (vec![0.0; cells], vec![0.0; cells]);
    after_walks(frame, COUNTED, events, |wavefront| {
        recorded::build_bridges(wavefront, &bridge);
        for row in 0..wavefront.candidates.connections.len {
            let inserted = wavefront.buckets.count.rows()[row];
            found[if inserted == DROPPED { 0 } else { inserted as usize + 1 }] += 1.0;
            let connection = wavefront.candidates.connections.row(row);
            let point = vector(connection.point);
            let start = start(events, vector(connection.start), vector(connection.arriving));
            let mut rest = 1.0;
            for edges in 1..=longest - events as u32 {
                let p = count_probability(&bridge, &medium(frame), longest, &start, point, edges);
                expected[edges as usize] += p;
                rest -= p;
            }
            expected[0] += rest.max(0.0);
        }
    });
    (found, expected)
}

#[test]
fn numbers_of_edges_follow_the_defensive_mixture() {
    let fog = |extinction: f32, longest: u32| thicker(0.7, Roll::Aligned, extinction, longest);
    let mixed = |frame: Frame, defensive: f32| with(frame, |bridge| Bridge { defensive, ..bridge });
    let few = |frame: Frame, max_inserted: u32| with(frame, |bridge| Bridge { max_inserted, ..bridge });
    let poisson = |frame: Frame| {
        let counts = Arc::new(CountTable::poisson(frame.medium.phase.twin().lobe()));
        with(frame, |bridge| Bridge { defensive: 0.0, counts, ..bridge })
    };
    for (name, frame, events) in [
        ("as usual", fog(0.5, 60), 1),
        ("thin", fog(0.05, 15), 2),
        ("little room", fog(0.5, 6), 3),
        ("dense, little room", fog(20.0, 15), 2),
        ("dense, more edges than the table knows", fog(20.0, 160), 1),
        ("two vertices at most", few(fog(0.5, 60), 2), 1),
        ("dense, no vertices", few(fog(2.0, 60), 0), 1),
        ("table alone", mixed(fog(0.5, 60), 0.0), 1),
        ("Poisson", poisson(fog(0.5, 60)), 2),
        ("half and half", mixed(fog(1.0, 9), 0.5), 2),
        ("uniform", mixed(fog(0.5, 9), 1.0), 1),
    ] {
        let (found, expected) = edges(&frame, events);
        let p = p_of_counts(&found, &expected);
        assert!(p > SUSPICIOUS, "{name}: p = {p}, {found:.0?} instead of {expected:.0?}");
        assert_eq!(found.iter().sum::<f64>(), COUNTED as f64, "{name}: every start connects");
    }
}

/// Density of the inner vertices of `chain` as a free walk that sets out along the axis, with flights of mean `flight`
/// times the distance between the ends: such a walk knows nothing of where it should arrive.
fn walk_density(phase: &dyn Phase, chain: &[DVec3], flight: f64) -> f64 {
    let way = chain[chain.len() - 1] - chain[0];
    let (mean, mut direction, mut density) = (flight * way.length(), way.normalize(), 1.0);
    for ends in chain[..chain.len() - 1].windows(2) {
        let (length, next) = (ends[0].distance(ends[1]), (ends[1] - ends[0]).normalize());
        density *= phase.density(direction.dot(next)) * (-length / mean).exp() / (mean * length * length);
        direction = next;
    }
    density
}

#[test]
fn any_density_over_that_of_bridges_has_mean_one() {
    // E[w h / p] = 1 for every density h of the inner vertices, where p is the twin's density of what the kernels draw,
    // and w the resampling weight with which they choose among it.
    let mut p_values = Vec::new();
    for (roll, g) in [(Roll::Aligned, 0.5), (Roll::Uniform, 0.4), (Roll::Aligned, -0.3)] {
        // All counts from 1 to 8 alike: h / p is conditional on the count.
        let frame = with(frame(g, roll), |bridge| Bridge { defensive: 1.0, max_inserted: 7, ..bridge });
        let (bridge, phase, longest) = (settings(&frame), frame.medium.phase.twin(), frame.lengths.max);
        let (mut quotients, mut degenerate) = ([Moments::default(); 9], 0);
        bridges(&frame, 24 * SAMPLES, 2, |arriving, chain, resampling| {
            let edges = chain.len() - 1;
            let start = start(2, chain[0], arriving);
            let made = density(&bridge, &medium(&frame), longest, &start, chain, 1.0).value();
            let count = count_probability(&bridge, &medium(&frame), longest, &start, chain[edges], edges as u32);
            // A very short edge may be rounded to nothing.
            degenerate += u32::from(made == 0.0);
            let quotient = resampling * walk_density(phase, chain, 0.3) * count / made;
            quotients[edges].add(if made > 0.0 { quotient } else { 0.0 });
        });
        assert!(degenerate < 20, "{degenerate} edges without length");
        for (edges, quotient) in quotients.iter().enumerate().skip(2) {
            let (mean, error) = (quotient.mean(), quotient.standard_error());
            let z = (mean - 1.0) / error;
            assert!(z.abs() < 4.0 && error < 0.05, "{:?}, g = {g}, {edges} edges: {mean} +- {error}", bridge.roll);
            p_values.push(p_of_z(z));
        }
    }
    assert!(p_of_uniformity(&p_values) > SUSPICIOUS, "{p_values:?}");
}

/// How strongly the roll to the first edge by a lobe is concentrated, 0 .. 1, and the share of all rolls that are below
/// it.
fn roll(g: f32, arriving: DVec3, chain: &[DVec3]) -> (f64, f64) {
    let [axis, first] = [chain[chain.len() - 1], chain[1]].map(|end| (end - chain[0]).normalize());
    let [from, to] = [arriving, first].map(|v| v - v.dot(axis) * axis);
    let psi = axis.dot(from.cross(to)).atan2(from.dot(to));
    // The integral of sqrt(a^2 - b^2) / (a - b cos psi) / (2 pi).
    let (a, b) = roll_coefficients(f64::from(g), arriving, axis, first);
    (b / a, 0.5 + (((a + b) / (a - b)).sqrt() * (0.5 * psi).tan()).atan() / PI)
}

#[test]
fn rolls_follow_their_density() {
    const SHARES: usize = 32;
    let aligned = [-0.6, 0.0, 0.5, 0.9, 0.95].map(|g| (g, Roll::Aligned));
    for (g, kind) in aligned.into_iter().chain([0.9, -0.4].map(|g| (g, Roll::Uniform))) {
        let frame = frame(g, kind);
        // Weak, middling and strong concentration apart: a roll may be right on average only.
        let limits = [0.3, 0.7, 0.95];
        let mut found = vec![0.0; (limits.len() + 1) * SHARES];
        bridges(&frame, SAMPLES, 2, |arriving, chain, _| {
            if chain.len() > 2 {
                let (concentration, _) = roll(g, arriving, chain);
                // A uniform roll is the aligned one of an isotropic medium.
                let (_, share) = roll(if kind == Roll::Aligned { g } else { 0.0 }, arriving, chain);
                let class = limits.partition_point(|limit| *limit < concentration.abs());
                found[class * SHARES + ((share * SHARES as f64) as usize).min(SHARES - 1)] += 1.0;
            }
        });
        let expected: Vec<_> =
            found.chunks(SHARES).flat_map(|shares| [shares.iter().sum::<f64>() / SHARES as f64; SHARES]).collect();
        let p = p_of_counts(&found, &expected);
        let total: f64 = found.iter().sum();
        assert!(p > SUSPICIOUS && total > 1e5, "g = {g}, {kind:?}: p = {p} of {total} rolls");
    }
}

#[test]
fn one_vertex_of_a_bridge_matches_its_density() {
    const LONG: usize = 16;
    const SKEW: usize = 12;
    for g in [-0.5_f32, 0.0, 0.6, 0.9] {
        let frame = with(frame(g, Roll::Uniform), |bridge| Bridge { defensive: 1.0, max_inserted: 1, ..bridge });
        let bridge = settings(&frame);
        // With both edges l1, l2 in units of the distance: x, 1 - x^2 = 1 / (l1 + l2), and y, sin(pi (y - 1/2)) = l1 -
        // l2.
        let cell = |x: f64, y: f64| {
            let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            SKEW * at(x, LONG) + at(y, SKEW)
        };
        let (mut found, mut total) = (vec![0.0; LONG * SKEW], 0.0);
        bridges(&frame, 2 * SAMPLES, 1, |_, chain, _| {
            if let [start, vertex, point] = chain {
                let [l1, l2] = [*start, *point].map(|end| end.distance(*vertex) / start.distance(*point));
                let (x, skew) = ((1.0 - 1.0 / (l1 + l2)).max(0.0).sqrt(), (l1 - l2).clamp(-1.0, 1.0));
                found[cell(x, 0.5 + skew.asin() / PI)] += 1.0;
                total += 1.0;
            }
        });
        let steps = 40;
        let width = |n: usize| 1.0 / (n * steps) as f64;
        let mut expected = vec![0.0; found.len()];
        for i in 0..LONG * steps {
            let x = (i as f64 + 0.5) * width(LONG);
            let length = 1.0 / (1.0 - x * x);
            for j in 0..SKEW * steps {
                let y = (j as f64 + 0.5) * width(SKEW);
                let (skew, slope) = ((PI * (y - 0.5)).sin(), PI * (PI * (y - 0.5)).cos());
                let (l1, l2) = (0.5 * (length + skew), 0.5 * (length - skew));
                // dV = 2 pi l1 l2 dl1 dl2, and dl1 dl2 = d(l1 + l2) d(l1 - l2) / 2.
                let volume = PI * l1 * l2 * (2.0 * x * length * length * width(LONG)) * (slope * width(SKEW));
                let along = 0.5 * (1.0 + l1 * l1 - l2 * l2);
                let across = (l1 * l1 - along * along).max(0.0).sqrt();
                let chain = [DVec3::ZERO, DVec3::new(across, 0.0, along), DVec3::Z];
                let start = start(1, DVec3::ZERO, DVec3::Z);
                let made = density(&bridge, &medium(&frame), 60, &start, &chain, 1.0).value();
                let count = count_probability(&bridge, &medium(&frame), 60, &start, DVec3::Z, 2);
                expected[cell(x, y)] += total * made / count * volume;
            }
        }
        let mass = expected.iter().sum::<f64>() / total;
        assert!((mass - 1.0).abs() < 2e-3, "g = {g}: the density integrates to {mass}");
        let p = p_of_counts(&found, &expected);
        assert!(p > SUSPICIOUS && total > 1e5, "g = {g}: p = {p} of {total} vertices");
    }
}

/// The chains of once-more next event estimation from the first vertices of many walks.
fn omnee_chains(frame: &Frame, samples: usize, mut visit: impl FnMut(&[DVec3; 3])) {
    after_walks(frame, samples, 1, |wavefront| {
        wavefront.light_sample(omnee::scope(frame.lengths));
        wavefront.omnee_build();
        let Wavefront { candidates: Candidates { connections, .. }, chains, .. } = wavefront;
        for row in 0..connections.len {
            let connection = connections.row(row);
            visit(&[connection.start, chains.vertices[0].row(row), connection.point].map(vector));
        }
    });
}

#[test]
fn the_vertex_of_once_more_next_event_estimation_matches_its_density() {
    const ALONG: usize = 16;
    const ACROSS: usize = 10;
    for g in [-0.5_f32, 0.0, 0.5, 0.9] {
        let frame = frame(g, Roll::Aligned);
        let phase = frame.medium.phase.twin();
        // All vertices lie in the ball over the chain, where the turn is less than a right angle. Place along the axis,
        // (1 - cos(pi x)) / 2, and distance from it, a share y^2 of the widest there: finer where vertices are dense.
        let widest = |along: f64| (along * (1.0 - along)).max(0.0).sqrt();
        let cell = |x: f64, y: f64| {
            let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            ACROSS * at(x, ALONG) + at(y, ACROSS)
        };
        let (mut found, mut total, mut outside) = (vec![0.0; ALONG * ACROSS], 0.0, 0.0);
        omnee_chains(&frame, SAMPLES, |[start, vertex, point]| {
            let (length, axis) = (start.distance(*point), (*point - *start).normalize());
            let along = (*vertex - *start).dot(axis) / length;
            let across = ((*vertex - *start) - along * length * axis).length() / length;
            // Coordinates are rounded to about 1e-6 of the scene.
            outside += f64::from(across > widest(along.clamp(0.0, 1.0)) + 1e-5 / length);
            let x = (1.0 - 2.0 * along.clamp(0.0, 1.0)).acos() / PI;
            found[cell(x, (across / widest(along).max(1e-9)).sqrt())] += 1.0;
            total += 1.0;
        });
        assert!(outside == 0.0, "g = {g}: {outside} of {total} turns are larger than a right angle");
        let steps = 48;
        let width = |n: usize| 1.0 / (n * steps) as f64;
        let mut expected = vec![0.0; found.len()];
        for i in 0..ALONG * steps {
            let x = (i as f64 + 0.5) * width(ALONG);
            let along = (FRAC_PI_2 * x).sin().powi(2);
            for j in 0..ACROSS * steps {
                let y = (j as f64 + 0.5) * width(ACROSS);
                let across = widest(along) * y * y;
                let ring = TAU * across * (widest(along) * 2.0 * y * width(ACROSS));
                let volume = ring * FRAC_PI_2 * (PI * x).sin() * width(ALONG);
                let chain = [DVec3::ZERO, DVec3::new(across, 0.0, along), DVec3::Z];
                expected[cell(x, y)] += total * omnee::reference::density(phase, &chain, 1.0).value() * volume;
            }
        }
        let mass = expected.iter().sum::<f64>() / total;
        assert!((mass - 1.0).abs() < 2e-3, "g = {g}: the density integrates to {mass}");
        let p = p_of_counts(&found, &expected);
        assert!(p > SUSPICIOUS && total > 1e5, "g = {g}: p = {p} of {total} vertices");
    }
}
