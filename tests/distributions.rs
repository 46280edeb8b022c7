//! Samplers against their densities, and moments of the random walk.

use core::f64::consts::{PI, TAU};

use bumpalo::Bump;
use fogbow::frame::Frame;
use fogbow::wavefront::{Source, Wavefront};
use fogbow_kernels::accumulate::reference::contribution;
use fogbow_kernels::columns::queues::Candidate;
use fogbow_kernels::connect::distant;
use fogbow_kernels::connect::light_sample::Scope;
use fogbow_kernels::connect::light_sample::reference::{light_density, selection_probability};
use fogbow_kernels::connect::nee;
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::roulette::reference::{self as roulette_reference, largest};
use fogbow_kernels::tables::lights::{Distant, Emitter, Panorama, Selection, Shape};
use fogbow_kernels::{WalkLimits, random};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::recorded;
use fogbow_testing::statistics::{Moments, p_of_counts};
use fogbow_testing::walks::{LANES, after_walks, start, vector, walk};
use glam::DVec3;
use rayon::prelude::*;

/// Samples that a distribution is tested with.
const SAMPLES: usize = 1 << 18;
/// P-value below which a distribution is refused. Some 40 are tested, with fixed seeds.
const SUSPICIOUS: f64 = 1e-4;

fn frame(g: f32) -> Frame {
    frames::three_lights(g, Selection::IntensityDistance, [64, 64])
}

#[test]
fn pixels_are_sampled_uniformly() {
    let mut cells = vec![0.0; 64];
    let frame = frame(0.0);
    let camera = &frame.camera;
    after_walks(&frame, SAMPLES, 0, |wavefront| {
        for lane in 0..LANES {
            let direction = vector(wavefront.rays.at(wavefront.step.clock).direction.row(lane));
            let film = direction / direction.dot(vector(camera.forward)) - vector(camera.corner);
            let coordinate = |step: [f32; 3]| film.dot(vector(step)) / vector(step).length_squared();
            let cell = |x: f64| ((x.rem_euclid(1.0) * 8.0) as usize).min(7);
            cells[8 * cell(coordinate(camera.pixel_y)) + cell(coordinate(camera.pixel_x))] += 1.0;
        }
    });
    let p = p_of_counts(&cells, &[SAMPLES as f64 / 64.0; 64]);
    assert!(p > SUSPICIOUS, "p = {p}");
}

#[test]
fn free_flights_are_exponential() {
    let frame = frame(0.0);
    let mut cells = vec![0.0; 60];
    after_walks(&frame, SAMPLES, 1, |wavefront| {
        for lane in 0..LANES {
            let depth = f64::from(wavefront.flights.flight.rows()[lane]) * frame.medium.homogeneous_twin(0).extinction;
            cells[((depth / 0.2) as usize).min(59)] += 1.0;
        }
    });
    let expected: Vec<_> = (0..60)
        .map(|i| (-0.2 * f64::from(i)).exp() - if i < 59 { (-0.2 * f64::from(i + 1)).exp() } else { 0.0 })
        .map(|share| share * SAMPLES as f64)
        .collect();
    let p = p_of_counts(&cells, &expected);
    assert!(p > SUSPICIOUS, "p = {p}");
}

#[test]
fn scattered_directions_match_the_phase_function() {
    for g in [-0.95, -0.3, 0.0, 1e-4, 0.5, 0.9, 0.99] {
        let frame = frame(g);
        // Cells of equal probability in the cosine, from the twin's inversion, and of equal azimuth.
        let edges: Vec<_> = (1..32).map(|i| frame.medium.phase.twin().sample_cosine(f64::from(i) / 32.0)).collect();
        let mut cells = vec![0.0; 32 * 8];
        after_walks(&frame, SAMPLES, 1, |wavefront| {
            let clock = wavefront.step.clock;
            for lane in 0..LANES {
                let old = vector(wavefront.rays.at(clock - 1).direction.row(lane));
                let new = vector(wavefront.rays.at(clock).direction.row(lane));
                let (tangent, bitangent) = old.normalize().any_orthonormal_pair();
                let azimuth = new.dot(bitangent).atan2(new.dot(tangent)).rem_euclid(core::f64::consts::TAU);
                let cosine = edges.partition_point(|edge| *edge < new.dot(old));
                cells[8 * cosine + ((azimuth / core::f64::consts::TAU * 8.0) as usize).min(7)] += 1.0;
            }
        });
        let p = p_of_counts(&cells, &vec![SAMPLES as f64 / 256.0; 256]);
        assert!(p > SUSPICIOUS, "g = {g}: p = {p}");
    }
}

#[test]
fn random_walks_have_the_moments_of_the_phase_function() {
    const EVENTS: i32 = 12;
    for g in [-0.5_f32, 0.0, 0.6, 0.9] {
        let frame = frame(g);
        let (mut along, mut squared) = (Moments::default(), Moments::default());
        let arena = Bump::new();
        let mut wavefront = Wavefront::new_in(&arena, &frame, &SIMD, LANES);
        for round in 0..2 * SAMPLES / LANES {
            start(&mut wavefront, round);
            let first = wavefront.step.clock;
            let camera = |wavefront: &Wavefront<'_>, lane: usize| {
                let start = vector(wavefront.vertices.at(first).position.row(lane));
                (start, vector(wavefront.rays.at(first).direction.row(lane)))
            };
            let starts: Vec<_> = (0..LANES).map(|lane| camera(&wavefront, lane)).collect();
            (0..EVENTS).for_each(|_| walk(&mut wavefront));
            for (lane, (start, direction)) in starts.into_iter().enumerate() {
                let way = vector(wavefront.vertices.at(wavefront.step.clock).position.row(lane)) - start;
                along.add(way.dot(direction));
                squared.add(way.length_squared());
            }
        }
        let (g, mu_t, n) = (f64::from(g), frame.medium.homogeneous_twin(0).extinction, f64::from(EVENTS));
        let power = g.powi(EVENTS);
        let mean = (1.0 - power) / (mu_t * (1.0 - g));
        let mean_square = 2.0 / (mu_t * mu_t) * (n / (1.0 - g) - g * (1.0 - power) / ((1.0 - g) * (1.0 - g)));
        for (name, found, expected) in [("r.w", along, mean), ("r^2", squared, mean_square)] {
            let z = (found.mean() - expected) / found.standard_error();
            assert!(z.abs() < 4.0, "g = {g}: <{name}> is {} instead of {expected}, z = {z}", found.mean());
        }
    }
}

/// Light points for the first vertices of many walks.
fn light_points(frame: &Frame, scope: Scope, mut visit: impl FnMut(DVec3, usize, DVec3)) {
    after_walks(frame, SAMPLES, 1, |wavefront| {
        wavefront.light_sample(scope);
        let connections = &wavefront.candidates.connections;
        for row in 0..connections.len {
            let connection = connections.row(row);
            visit(vector(connection.start), connection.emitter as usize, vector(connection.point));
        }
    });
}

/// The numbers in the unit square that a point of an emitter stands for.
fn coordinates(emitter: &Emitter, point: DVec3) -> [f64; 2] {
    let offset = point - vector(emitter.origin);
    let (tangent, bitangent) = (vector(emitter.tangent), vector(emitter.bitangent));
    let (x, y, radius) = (offset.dot(tangent), offset.dot(bitangent), f64::from(emitter.radius));
    let azimuth = y.atan2(x).rem_euclid(core::f64::consts::TAU) / core::f64::consts::TAU;
    match emitter.shape {
        Shape::Disk => [(x * x + y * y) / (radius * radius), azimuth],
        Shape::Sphere => [(1.0 - offset.z / radius) / 2.0, azimuth],
        Shape::Triangle => {
            // Cramer's rule in the triangle's plane.
            let normal = tangent.cross(bitangent);
            let weight = |edge: DVec3, other: DVec3| offset.cross(other).dot(normal) / edge.cross(other).dot(normal);
            let (p, q) = (weight(tangent, bitangent), weight(bitangent, tangent));
            [(p + q).powi(2), q / (p + q)]
        }
        Shape::Distant => unreachable!("directions have a test of their own"),
    }
}

#[test]
fn light_points_are_uniform_on_disks_spheres_and_triangles() {
    // Everything is accepted, so that what is tested is the sampler alone.
    let scope = Scope { facing: false, ..nee::SCOPE };
    let lamps = frames::lamps(1.0, 0.3, Selection::Uniform, [64, 64]);
    for frame in [frame(0.3), lamps] {
        let mut cells = vec![vec![0.0; 64]; frame.lights.emitters().len()];
        light_points(&frame, scope, |_, light, point| {
            let cell = coordinates(&frame.lights.emitters()[light], point).map(|x| ((x * 8.0) as usize).min(7));
            cells[light][8 * cell[0] + cell[1]] += 1.0;
        });
        for (light, cells) in cells.iter().enumerate() {
            let count: f64 = cells.iter().sum();
            let p = p_of_counts(cells, &[count / 64.0; 64]);
            assert!(p > SUSPICIOUS && count > 1000.0, "emitter {light}: p = {p} of {count} points");
        }
    }
}

/// The numbers in the unit square that a direction to a cap of the sphere stands for.
fn in_cap(light: &Distant, direction: DVec3) -> [f64; 2] {
    let [axis, tangent, bitangent] = [light.axis, light.tangent, light.bitangent].map(vector);
    let azimuth = direction.dot(bitangent).atan2(direction.dot(tangent)) / TAU;
    [(direction - axis).length_squared() / 4.0 / f64::from(light.cap), azimuth.rem_euclid(1.0)]
}

/// What is expected of `count` directions in each pixel of an image, and where this one is.
fn in_pixels(panorama: &Panorama, count: f64) -> (Vec<f64>, impl Fn(DVec3) -> usize) {
    let [width, height] = panorama.size();
    let solid_angle = |row: u32| {
        let cosine = |row: u32| (PI * f64::from(row) / f64::from(height)).cos();
        TAU / f64::from(width) * (cosine(row) - cosine(row + 1))
    };
    let pixels = (0..height).flat_map(move |row| (0..width).map(move |column| [column, row]));
    let share = |[column, row]: [u32; 2]| {
        let radiance: f64 = panorama.texel(column, row).iter().map(|x| f64::from(*x)).sum();
        radiance / 3.0 * f64::from(panorama.largest()) * solid_angle(row) / panorama.flux()
    };
    let place = move |direction: DVec3| {
        let [column, row] = distant::reference::pixel(panorama, direction);
        (row * width + column) as usize
    };
    (pixels.map(|pixel| count * share(pixel)).collect(), place)
}

#[test]
fn directions_to_lights_at_infinity_have_their_density() {
    let lamps = frames::lamps(1.0, 0.3, Selection::Uniform, [64, 64]);
    for selection in [Selection::Uniform, Selection::Intensity] {
        for (name, sources) in frames::skies::sources() {
            let frame = frames::skies::under(&lamps, &sources, selection);
            let mut found = vec![Vec::new(); sources.len()];
            light_points(&frame, distant::SCOPE, |start, emitter, point| {
                found[emitter - frame.lights.first_distant() as usize].push((point - start).normalize());
            });
            let total = found.iter().map(Vec::len).sum::<usize>() as f64;
            let counts: Vec<f64> = found.iter().map(|directions| directions.len() as f64).collect();
            let expected: Vec<f64> = frame.lights.distant().iter().map(|x| total * f64::from(x.share)).collect();
            let p = p_of_counts(&counts, &expected);
            assert!(p > SUSPICIOUS && total > 1000.0, "{name}, {selection:?}: p = {p}, {counts:?} of {expected:?}");
            for (light, directions) in frame.lights.distant().iter().zip(&found) {
                let count = directions.len() as f64;
                let p = if let Some(panorama) = &light.panorama {
                    let (expected, place) = in_pixels(panorama, count);
                    let mut cells = vec![0.0; expected.len()];
                    directions.iter().for_each(|direction| cells[place(*direction)] += 1.0);
                    p_of_counts(&cells, &expected)
                } else {
                    let mut cells = vec![0.0; 64];
                    for direction in directions {
                        let cell = in_cap(light, *direction).map(|x| ((x * 8.0) as usize).min(7));
                        cells[8 * cell[0] + cell[1]] += 1.0;
                    }
                    p_of_counts(&cells, &[count / 64.0; 64])
                };
                assert!(p > SUSPICIOUS, "{name}, {selection:?}: p = {p} of {count} directions");
            }
        }
    }
}

/// Checks how often each emitter of a frame is chosen against the density of its points.
fn assert_emitters_are_chosen_by_density(name: &str, frame: &Frame) {
    let emitters = frame.lights.emitters();
    let (mut found, mut expected) = (vec![0.0; emitters.len()], vec![0.0; emitters.len()]);
    light_points(frame, Scope { facing: false, ..nee::SCOPE }, |start, light, _| {
        found[light] += 1.0;
        for (light, emitter) in emitters.iter().enumerate() {
            expected[light] += light_density(&frame.lights, light, start) * emitter.area();
        }
    });
    let p = p_of_counts(&found, &expected);
    assert!(p > SUSPICIOUS, "{name}: p = {p}, {found:?} instead of {expected:?}");
}

#[test]
fn triangles_of_a_mesh_are_chosen_by_area() {
    let frame = frames::lamps(1.0, 0.3, Selection::IntensityDistance, [64, 64]);
    assert_emitters_are_chosen_by_density("lamps", &frame);
}

#[test]
fn lights_of_groups_are_chosen_by_their_density() {
    [Selection::Uniform, Selection::Intensity, Selection::IntensityDistance].into_par_iter().for_each(|selection| {
        let frame = frames::swarm(60, selection, [64, 64]);
        assert!(frame.lights.lights().len() < frame.lights.emitters().len(), "groups");
        assert_emitters_are_chosen_by_density(&format!("{selection:?}"), &frame);
    });
}

#[test]
fn lights_are_selected_with_their_probability() {
    for selection in [Selection::Uniform, Selection::Intensity, Selection::IntensityDistance] {
        let frame = frames::three_lights(0.3, selection, [64, 64]);
        let scope = Scope { facing: false, ..nee::SCOPE };
        let (mut found, mut expected) = ([0.0; 3], [0.0; 3]);
        light_points(&frame, scope, |start, light, _| {
            found[light] += 1.0;
            (0..3).for_each(|light| expected[light] += selection_probability(&frame.lights, light, start));
        });
        let p = p_of_counts(&found, &expected);
        assert!(p > SUSPICIOUS, "{selection:?}: p = {p}, {found:?} instead of {expected:?}");
    }
}

#[test]
fn isotropic_media_forget_where_light_came_from() {
    let frame = frames::with_phase(&frame(0.0), PhaseFunction::henyey_greenstein(0.0));
    let mut cosines = Moments::default();
    after_walks(&frame, SAMPLES, 2, |wavefront| {
        let clock = wavefront.step.clock;
        for lane in 0..LANES {
            let [old, new] = [clock - 1, clock].map(|clock| vector(wavefront.rays.at(clock).direction.row(lane)));
            cosines.add(old.dot(new));
        }
    });
    assert!((cosines.mean() / cosines.standard_error()).abs() < 4.0, "{}", cosines.mean());
    assert!((cosines.variance() * 3.0 - 1.0).abs() < 0.01, "{}", cosines.variance());
}

#[test]
fn walks_survive_as_often_as_they_should_and_survivors_are_like_all() {
    for survival in [0.3_f32, 0.75, 1.0] {
        let frame = Frame { walk: WalkLimits { survival: survival.into(), ..WalkLimits::ALL }, ..frame(0.5) };
        for vertices in 0..6 {
            // The camera is no vertex that a walk has to survive.
            let (mut alive, mut flights) = (0.0, Moments::default());
            after_walks(&frame, SAMPLES, vertices + 1, |wavefront| {
                for lane in (0..LANES).filter(|lane| wavefront.live.contains(*lane)) {
                    alive += 1.0;
                    flights.add(f64::from(wavefront.flights.flight.rows()[lane]));
                }
            });
            let share = f64::from(survival).powi(vertices as i32);
            let counts = [alive, SAMPLES as f64 - alive];
            let expected = [share, 1.0 - share].map(|share| share * SAMPLES as f64);
            let p = p_of_counts(&counts, &expected);
            assert!(p > SUSPICIOUS, "{alive} instead of {} walks survive {vertices} vertices, p = {p}", expected[0]);
            let z = (flights.mean() * frame.medium.homogeneous_twin(0).extinction - 1.0)
                / (flights.standard_error() * frame.medium.homogeneous_twin(0).extinction);
            assert!(z.abs() < 4.0, "flights of survivors of {vertices} vertices have a mean of {}", flights.mean());
        }
    }
}

/// The weights of bridges from the second vertices of many walks before and after the roulette, with the probability
/// that the twin gives them.
fn roulette_of_bridges(frame: &Frame, mut visit: impl FnMut(f64, f64, f64)) {
    let bridge = frame.techniques.bridge.clone().expect("a frame with bridges");
    after_walks(frame, SAMPLES, 2, |wavefront| {
        recorded::build_bridges(wavefront, &bridge);
        for bucket in wavefront.buckets.buckets().to_vec() {
            wavefront.mis_weight(Competing::All, Source::Bridged, bucket);
            let weights = wavefront.worth.weight.rows()[bucket.rows()].to_vec();
            wavefront.roulette(Source::Bridged, bucket, random::BRIDGE_LIGHT);
            for (row, before) in bucket.rows().zip(weights).filter(|(_, before)| *before > 0.0) {
                let Candidate { lane, emitter, .. } = wavefront.candidates.bridged.row(row);
                let channels = contribution(
                    f64::from(before),
                    wavefront.worth.factor.row(row).map(f64::from),
                    frame.lights.emitters()[emitter as usize].radiance.map(f64::from),
                    wavefront.throughput.row(lane as usize).map(f64::from),
                );
                let survival = roulette_reference::survival(f64::from(frame.roulette), largest(&channels));
                visit(f64::from(before), f64::from(wavefront.worth.weight.rows()[row]), survival);
            }
        }
    });
}

#[test]
fn roulette_drops_its_share_and_keeps_the_mean() {
    for threshold in [0.003_f32, 0.1, 1.0] {
        let frame = Frame { roulette: threshold, ..frames::with_techniques(&frame(0.6), Active::Bridge, 3.0) };
        // Kept and dropped connections by their probability of being kept; only certain ones have one of 1.
        let (mut found, mut expected) = (vec![0.0; 2 * 11], vec![0.0; 2 * 11]);
        let (mut change, mut certain) = (Moments::default(), 0.0);
        roulette_of_bridges(&frame, |before, after, survival| {
            let kept = (after > 0.0).then_some(after * survival / before);
            assert!(kept.is_none_or(|kept| (kept - 1.0).abs() < 1e-5), "{before} became {after}, survival {survival}");
            if survival == 1.0 {
                certain += after.signum();
                return;
            }
            let class = 2 * ((survival * 11.0) as usize).min(10);
            found[class + usize::from(after == 0.0)] += 1.0;
            expected[class] += survival;
            expected[class + 1] += 1.0 - survival;
            // In units of the threshold, so that no weight is too rare to be seen.
            change.add(survival * (after / before - 1.0));
        });
        let p = p_of_counts(&found, &expected);
        assert!(p > SUSPICIOUS && change.count > 1e4, "threshold {threshold}: p = {p}, {found:?}, {expected:?}");
        let (z, error) = (change.mean() / change.standard_error(), change.standard_error());
        assert!(
            z.abs() < 4.0 && error < 5e-3,
            "threshold {threshold}: the mean changes by {} +- {error}",
            change.mean()
        );
        assert!(certain > 20.0, "threshold {threshold}: only {certain} connections are bright");
    }
}
