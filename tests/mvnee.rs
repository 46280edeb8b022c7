//! Multiple-vertex next event estimation: what its kernels make against the densities of the twin.

use std::collections::BTreeSet;

use fogbow::frame::Frame;
use fogbow::wavefront::{Candidates, Source, Wavefront};
use fogbow_kernels::connect::light_sample::Scope;
use fogbow_kernels::connect::mvnee::{self, Mvnee, Offset, Seeds};
use fogbow_kernels::media::reference::{Medium as _, extinction_along};
use fogbow_kernels::pipeline::{REFERENCE, SIMD};
use fogbow_kernels::{PathLengths, random};
use fogbow_testing::frames::{self, clouds};
use fogbow_testing::recorded;
use fogbow_testing::statistics::{Moments, p_of_counts, p_of_uniformity, p_of_z};
use fogbow_testing::walks::{LANES, after_walks, vector};
use glam::DVec3;

/// Samples that a distribution is tested with.
const SAMPLES: usize = 1 << 18;
/// P-value below which a distribution is refused.
const SUSPICIOUS: f64 = 1e-4;

/// MVNEE connections of the first vertices of many walks, built by the kernels: start, inserted vertices, light point.
fn connections(frame: &Frame, samples: usize, mut visit: impl FnMut(&[DVec3])) {
    let mvnee = frame.techniques.mvnee.expect("an MVNEE frame");
    after_walks(frame, samples, 1, |wavefront| {
        recorded::build_mvnee(wavefront, &mvnee);
        let Wavefront { buckets, candidates: Candidates { bridged, .. }, chains, .. } = wavefront;
        for bucket in buckets.buckets() {
            for row in bucket.rows() {
                let inserted = chains.vertices[..bucket.inserted].iter().map(|vertex| vector(vertex.row(row)));
                let ends = [bridged.start.row(row), bridged.point.row(row)].map(vector);
                let chain: Vec<_> = [ends[0]].into_iter().chain(inserted).chain([ends[1]]).collect();
                visit(&chain);
            }
        }
    });
}

/// A frame whose connections are of moderate length and never too long.
fn mvnee_frame(g: f32, offset: Offset) -> Frame {
    let mut frame = frames::with_extinction(&frames::fog_facing(0.0, g, [64, 64]), 0.5);
    frame.lengths = PathLengths { min: 1, max: 60 };
    frame.techniques.mvnee = Some(Mvnee::new(&frame.medium, f64::INFINITY, offset));
    frame
}

#[test]
fn numbers_of_seeds_are_poisson_distributed() {
    let frame = mvnee_frame(0.9, Offset::Ggx);
    let (mut found, mut expected) = (vec![0.0; 25], vec![0.0; 25]);
    connections(&frame, SAMPLES, |chain| {
        found[(chain.len() - 2).min(24)] += 1.0;
        let mean = chain[0].distance(chain[chain.len() - 1]) * frame.medium.homogeneous_twin(0).extinction;
        let mut share = (-mean).exp();
        for (m, expected) in expected.iter_mut().enumerate() {
            *expected += share;
            share *= mean / (m + 1) as f64;
        }
    });
    let rest = found.iter().sum::<f64>() - expected.iter().take(24).sum::<f64>();
    expected[24] = rest.max(1e-3);
    let p = p_of_counts(&found, &expected);
    assert!(p > SUSPICIOUS, "p = {p}");
}

/// The twin's density of the inserted vertices of `chain`, given their number and the light point.
fn density(frame: &Frame, settings: &mvnee::reference::Settings, chain: &[DVec3]) -> f64 {
    let medium = frame.medium.twin(0);
    let mean = chain[0].distance(chain[chain.len() - 1]) * f64::from(frame.medium.largest_extinction());
    let count: f64 = (1..=chain.len() - 2).map(|m| mean / m as f64).product();
    mvnee::reference::density(settings, &medium, chain, 1.0).value() / (count * (-mean).exp())
}

#[test]
fn one_inserted_vertex_matches_its_density() {
    for (g, offset) in [(0.9, Offset::Ggx), (0.5, Offset::Gaussian), (-0.5, Offset::Ggx)] {
        let frame = mvnee_frame(g, offset);
        let settings = (&frame.techniques.mvnee.expect("an MVNEE frame")).into();
        // Position along the axis and distance from it, in units that make all chains alike: the density depends on the
        // distance between start and light only by its scale.
        let (mut found, mut total) = (vec![0.0; 20 * 10], 0.0);
        connections(&frame, 4 * SAMPLES, |chain| {
            if let [start, vertex, point] = chain {
                let (length, axis) = (start.distance(*point), (*point - *start).normalize());
                let along = (*vertex - *start).dot(axis) / length;
                let across = ((*vertex - *start) - along * length * axis).length() / length;
                let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
                found[10 * cell(along, 20) + cell(across / (across + 0.1), 10)] += 1.0;
                total += 1.0;
            }
        });
        let steps = 60;
        let mut expected = vec![0.0; found.len()];
        for i in 0..20 * steps {
            let along = (f64::from(i) + 0.5) / f64::from(20 * steps);
            for j in 0..10 * steps {
                // across / (across + 0.1) = y, uniform in y; the last cell reaches to infinity.
                let y = (f64::from(j) + 0.5) / f64::from(10 * steps);
                let across = 0.1 * y / (1.0 - y);
                let ring = core::f64::consts::TAU * across * 0.1 / (1.0 - y).powi(2) / f64::from(10 * steps);
                let chain = [DVec3::ZERO, DVec3::new(across, 0.0, along), DVec3::Z];
                let share = density(&frame, &settings, &chain) * ring / f64::from(20 * steps);
                expected[(10 * (i / steps) + j / steps) as usize] += share * total;
            }
        }
        let mass = expected.iter().sum::<f64>() / total;
        assert!((mass - 1.0).abs() < 2e-3, "g = {g}: the density integrates to {mass}");
        let p = p_of_counts(&found, &expected);
        assert!(p > SUSPICIOUS && total > 1e4, "g = {g}: p = {p} of {total} vertices");
    }
}

#[test]
fn any_density_over_the_samplers_has_mean_one() {
    // E[h / p] = 1 for every density h where the sampler's p is positive. h: MVNEE with narrower, Gaussian offsets.
    let frame = mvnee_frame(0.6, Offset::Ggx);
    let settings: mvnee::reference::Settings = (&frame.techniques.mvnee.expect("an MVNEE frame")).into();
    let other = mvnee::reference::Settings { offset: Offset::Gaussian, slope: 0.8 * settings.slope, ..settings };
    let mut quotients = vec![Moments::default(); 9];
    connections(&frame, 4 * SAMPLES, |chain| {
        if let 3..=8 = chain.len() {
            let quotient = density(&frame, &other, chain) / density(&frame, &settings, chain);
            quotients[chain.len() - 2].add(quotient);
        }
    });
    let mut p_values = Vec::new();
    for (inserted, quotient) in quotients.iter().enumerate().filter(|(_, quotient)| quotient.count > 0.0) {
        let z = (quotient.mean() - 1.0) / quotient.standard_error();
        assert!(z.abs() < 4.0, "{inserted} inserted: mean {} +- {}", quotient.mean(), quotient.standard_error());
        p_values.push(p_of_z(z));
    }
    assert!(p_values.len() == 6 && p_of_uniformity(&p_values) > SUSPICIOUS, "{p_values:?}");
}

/// Three lights in and about a cloud with holes, and vacuum around it; paths may be as long as they like.
fn cloudy_frame(mesc: f64, seeds: Seeds) -> Frame {
    let [(_, mut frame), _] = clouds::clouds([64, 64]);
    frame.lengths = PathLengths { min: 1, max: 60 };
    frame.techniques.mvnee = Some(Mvnee { seeds, ..Mvnee::new(&frame.medium, mesc, Offset::Ggx) });
    frame
}

#[test]
fn a_cloud_is_connected_through_up_to_the_depth_of_the_axis_that_mesc_says() {
    let mesc = 0.5;
    let frame = cloudy_frame(mesc, Seeds::Coarse);
    let mvnee = frame.techniques.mvnee.expect("MVNEE");
    let (mut nearer, mut deeper) = (0, 0);
    after_walks(&frame, 1 << 14, 1, |wavefront| {
        wavefront.light_sample(Scope::new(random::MVNEE_LIGHT));
        wavefront.join(&mvnee, Some(&frame.lights), frame.lengths, wavefront.step);
        let Wavefront { buckets, candidates: Candidates { connections, bridged, .. }, .. } = &*wavefront;
        let rows = buckets.buckets().iter().flat_map(|bucket| bucket.rows());
        let joined: BTreeSet<u32> = rows.map(|row| bridged.lane.rows()[row]).collect();
        for row in 0..connections.len {
            let [start, point] = [connections.start.row(row), connections.point.row(row)].map(vector);
            let depth = frame.medium.twin(0).optical_depth(start, point);
            if (depth - mesc).abs() > 1e-3 {
                let is_near = depth < mesc;
                *(if is_near { &mut nearer } else { &mut deeper }) += 1;
                assert_eq!(joined.contains(&connections.lane.rows()[row]), is_near, "an axis of depth {depth}");
            }
        }
    });
    assert!(nearer > 500 && deeper > 500, "{nearer} nearer, {deeper} deeper");
}

#[test]
fn vertices_that_are_where_their_start_is_end_a_connection() {
    let frame = mvnee_frame(0.9, Offset::Ggx);
    for pipeline in [SIMD, REFERENCE] {
        let mut dropped = 0;
        after_walks(&frame, LANES, 1, |wavefront| {
            recorded::build_mvnee(wavefront, &frame.techniques.mvnee.expect("MVNEE"));
            wavefront.pipeline = pipeline;
            for index in 0..wavefront.buckets.buckets().len() {
                let bucket = wavefront.buckets.buckets()[index];
                if bucket.inserted == 0 {
                    continue;
                }
                for row in bucket.rows().step_by(2) {
                    let start = wavefront.candidates.bridged.start.row(row);
                    wavefront.chains.vertices[0].set_row(row, start);
                }
                wavefront.sift(Source::Bridged, bucket);
                let counts = |row: usize| wavefront.worth.weight.rows()[row] != 0.0;
                let (at_start, others): (Vec<_>, Vec<_>) = bucket.rows().partition(|row| (row - bucket.start) % 2 == 0);
                assert!(!at_start.iter().any(|row| counts(*row)), "a vertex where its start is counts");
                dropped += at_start.len() * usize::from(others.iter().any(|row| counts(*row)));
            }
            wavefront.pipeline = SIMD;
        });
        assert!(dropped > 100, "{dropped}");
    }
}

#[test]
fn seeds_are_in_the_cloud_and_vertices_in_vacuum_end_a_connection() {
    for (seeds, all_in_cloud) in [(Seeds::Coarse, true), (Seeds::Fast, false)] {
        let frame = cloudy_frame(f64::INFINITY, seeds);
        let (medium, mvnee) = (frame.medium.twin(0), frame.techniques.mvnee.expect("MVNEE"));
        let [mut within, mut in_vacuum, mut beside] = [0; 3];
        after_walks(&frame, 1 << 14, 1, |wavefront| {
            recorded::build_mvnee(wavefront, &mvnee);
            for index in 0..wavefront.buckets.buckets().len() {
                let bucket = wavefront.buckets.buckets()[index];
                wavefront.sift(Source::Bridged, bucket);
                let Wavefront { candidates: Candidates { bridged, .. }, chains, worth, .. } = &*wavefront;
                for row in bucket.rows() {
                    let [start, point] = [bridged.start.row(row), bridged.point.row(row)].map(vector);
                    let (axis, strata) = ((point - start).normalize(), medium.strata(start, point));
                    let chain = || chains.vertices[..bucket.inserted].iter().map(|vertex| vector(vertex.row(row)));
                    let coarse = |vertex: DVec3| extinction_along(&strata, (vertex - start).dot(axis));
                    beside += chain().take(if all_in_cloud { 60 } else { 1 }).filter(|v| coarse(*v) == 0.0).count();
                    let is_lost = chain().any(|vertex| medium.extinction(vertex) == 0.0);
                    *(if is_lost { &mut in_vacuum } else { &mut within }) += 1;
                    // Others may arrive at the dark side of their lamp.
                    assert!(!is_lost || worth.weight.rows()[row] == 0.0, "{seeds:?}: a vertex in vacuum counts");
                }
            }
        });
        assert!(within > 500 && in_vacuum > 50 && beside == 0, "{seeds:?}: {within}, {in_vacuum}, {beside}");
    }
}
