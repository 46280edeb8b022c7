//! Equal means, one path at a time.

use super::*;
use std::sync::Arc;

use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::lis::{Connector, Lis};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset};
use fogbow_kernels::connect::{Technique, Techniques};
use fogbow_kernels::first_flight::Aim;
use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::survival::Survival;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{PathLengths, WalkLimits};

use crate::film::aov::Aovs;

const FREE: WalkLimits = WalkLimits { segments: u32::MAX, starts: u32::MAX, survival: Survival::CERTAIN };

fn frame(albedo: f32, lengths: PathLengths) -> Frame {
    let albedo = [albedo, 0.75 * albedo, 0.9 * albedo];
    let medium = Medium::homogeneous(0.5, albedo, PhaseFunction::henyey_greenstein(0.5));
    let disk = |z: f64, normal: DVec3, radiance| Emitter::disk(DVec3::new(0.0, 0.0, z), normal, 2.0, radiance);
    let disks = vec![disk(3.0, -DVec3::Z, [1.0, 2.0, 3.0]), disk(4.0, DVec3::Z, [4.0, 1.0, 2.0])];
    let bridge = Bridge::new(Roll::Aligned, &medium, lengths.max);
    Frame {
        camera: Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.02, 0.0, [4, 4]),
        medium: medium.clone(),
        lights: Lights::new(disks, Selection::IntensityDistance),
        surfaces: Arc::new(Surfaces::none()),
        techniques: Techniques {
            nee: true,
            mvnee: Some(Mvnee::new(&medium, 8.0, Offset::Ggx)),
            omnee: true,
            lis: Some(Lis::new(&medium, Connector::Bridge(bridge.clone()))),
            bridge: Some(bridge),
        },
        lengths,
        walk: FREE,
        aimed: 0.0,
        roulette: 0.0,
        seed: 7,
        outlines: None,
        aovs: Aovs::default(),
    }
}

#[test]
fn a_light_behind_an_absorber_is_attenuated_in_every_sample() {
    let frame = frame(0.0, PathLengths { min: 1, max: 9 });
    for sample in 0..20 {
        let [red, _, blue] = radiance(&frame, 5, sample);
        assert!((red / (-1.5_f64).exp() - 1.0).abs() < 1e-4 && (blue / red - 3.0).abs() < 1e-12, "{red} {blue}");
    }
}

#[test]
fn contributions_keep_to_the_path_lengths() {
    let frame = frame(1.0, PathLengths { min: 2, max: 5 });
    let found: Vec<_> = (0..400).flat_map(|sample| contributions(&frame, 9, sample)).collect();
    assert!(found.iter().all(|contribution| (2..=5).contains(&contribution.segments)));
    let connecting = [Technique::Nee, Technique::Mvnee, Technique::Omnee, Technique::Bridge, Technique::Lis];
    for technique in [None].into_iter().chain(connecting.map(Some)) {
        // A path of one inserted vertex has three segments or more; the companion of nee is nee.
        let shortest = if matches!(technique, Some(Technique::Omnee | Technique::Lis)) { 3 } else { 2 };
        for segments in shortest..=5 {
            let made = |c: &&Contribution| c.technique == technique && c.segments == segments;
            assert!(found.iter().filter(made).count() > 0, "{technique:?} makes no path of {segments} segments");
        }
    }
}

#[test]
fn walks_end_and_connect_where_they_are_told_to() {
    let lengths = PathLengths { min: 1, max: 6 };
    let frame =
        Frame { walk: WalkLimits { segments: 3, starts: 1, survival: Survival::CERTAIN }, ..frame(1.0, lengths) };
    let found: Vec<_> = (0..400).flat_map(|sample| contributions(&frame, 9, sample)).collect();
    let longest = |technique: Option<Technique>| {
        found.iter().filter(|c| c.technique == technique).map(|c| c.segments).max().expect("makes some path")
    };
    // From the first vertex alone: straight on, through one vertex, and as far as paths go.
    assert_eq!([None, Some(Technique::Nee), Some(Technique::Omnee)].map(longest), [3, 2, 3]);
    assert_eq!(longest(Some(Technique::Bridge)), 6);
}

#[test]
fn the_weight_of_the_first_flight_is_on_everything_but_views() {
    let free = frame(0.9, PathLengths { min: 1, max: 5 });
    let shares = [0.25, 0.5];
    let [few, many] = shares.map(|share| Frame { aimed: share as f32, ..free.clone() });
    let (mut same, mut other) = (0, 0);
    for sample in 0..600 {
        let [plain, few, many] = [&free, &few, &many].map(|frame| contributions(frame, 9, sample));
        let view = |c: &&Contribution| c.segments == 1;
        assert!(few.iter().any(|c| view(&c)), "sample {sample} sees no light");
        assert!(plain.iter().filter(view).eq(few.iter().filter(view)), "views differ in sample {sample}");
        if first_flight::reference::uniforms(9, sample, free.seed)[0] < shares[1] {
            other += u32::from(few != many);
            continue;
        }
        // The same stretched flight, weighed for either share.
        let (origin, direction) = generate::reference::camera_ray(&free.camera, 9, sample, free.seed);
        let words = medium_sample::reference::words(9, sample, 0, free.seed);
        let medium = free.medium.homogeneous_twin(0);
        let aims = shares.map(|share| Aim::in_the_open(share as f32));
        let t = medium.flight(random::uniform(words[0])) / f64::from(aims[0].thinned);
        let weight = |aim| first_flight::reference::weight(&medium, &free.lights, aim, (origin, direction), t);
        let expected = weight(aims[0]) / weight(aims[1]);
        assert_eq!(few.len(), many.len(), "sample {sample}");
        for (few, many) in few.iter().zip(&many).filter(|(few, _)| few.segments > 1) {
            let ratio = few.radiance[0] / many.radiance[0];
            assert!((ratio / expected - 1.0).abs() < 1e-12, "sample {sample}: {ratio}, expected {expected}");
            same += 1;
        }
    }
    assert!(same > 100 && other > 50, "{same} contributions weighed, {other} samples aimed elsewhere");
}

#[test]
fn absorbers_are_not_aimed_in() {
    let free = frame(0.0, PathLengths { min: 1, max: 9 });
    let aimed = Frame { aimed: 0.5, ..free.clone() };
    assert!((0..50).all(|sample| contributions(&free, 5, sample) == contributions(&aimed, 5, sample)));
}

/// Mean over pixels and samples, and its standard error, of each channel of paths of each number of segments.
fn means(frame: &Frame) -> Vec<[(f64, f64); 3]> {
    let (pixels, samples) = (16, 3000);
    let mut sums = vec![[(0.0, 0.0); 3]; frame.lengths.max as usize + 1];
    for (pixel, sample) in (0..pixels).flat_map(|pixel| (0..samples).map(move |sample| (pixel, sample))) {
        let mut values = vec![[0.0; 3]; sums.len()];
        for contribution in contributions(frame, pixel, sample) {
            let value = &mut values[contribution.segments as usize];
            *value = core::array::from_fn(|channel| value[channel] + contribution.radiance[channel]);
        }
        for ((sum, squares), value) in sums.iter_mut().flatten().zip(values.into_iter().flatten()) {
            *sum += value;
            *squares += value * value;
        }
    }
    let count = f64::from(pixels * samples);
    let estimate = |(sum, squares): (f64, f64)| {
        let mean = sum / count;
        (mean, ((squares / count - mean * mean) / count).sqrt())
    };
    // Views of a light are expectations and have no technique.
    sums.into_iter().skip(2).map(|channels| channels.map(estimate)).collect()
}

#[test]
fn techniques_walks_and_roulette_do_not_change_the_mean_of_any_path_length() {
    let all = frame(0.9, PathLengths { min: 1, max: 5 });
    let only = |techniques: Techniques| Frame { techniques, ..all.clone() };
    let shape = |roll: Roll| Bridge::new(roll, &all.medium, all.lengths.max);
    let bridge = |roll: Roll| Techniques { bridge: Some(shape(roll)), ..Techniques::default() };
    let truth = means(&only(Techniques { nee: true, ..Techniques::default() }));
    let brief = WalkLimits { segments: 2, starts: 1, survival: Survival::CERTAIN };
    let lis = |connector: Connector| {
        only(Techniques { lis: Some(Lis::new(&all.medium, connector)), ..Techniques::default() })
    };
    let limited = Bridge { max_inserted: 1, max_distance: 3.0, ..shape(Roll::Aligned) };
    for (name, frame) in [
        ("path", only(Techniques::default())),
        ("omnee", only(Techniques { omnee: true, ..Techniques::default() })),
        ("aligned bridge", only(bridge(Roll::Aligned))),
        ("uniform bridge", only(bridge(Roll::Uniform))),
        ("limited bridge", only(Techniques { bridge: Some(limited.clone()), ..Techniques::default() })),
        ("lis by bridges", lis(Connector::Bridge(shape(Roll::Aligned)))),
        ("lis by limited bridges", lis(Connector::Bridge(limited))),
        ("lis by mvnee", lis(Connector::Mvnee(Mvnee::new(&all.medium, 3.0, Offset::Ggx)))),
        ("all", all.clone()),
        ("all, first two starts", Frame { walk: WalkLimits { starts: 2, ..FREE }, ..all.clone() }),
        ("all, survival", Frame { walk: WalkLimits { survival: Survival::Constant(0.7), ..FREE }, ..all.clone() }),
        ("path, aimed", Frame { aimed: 0.5, ..only(Techniques::default()) }),
        ("all, aimed", Frame { aimed: 0.5, ..all.clone() }),
        ("all, mostly aimed, roulette", Frame { aimed: 0.9, roulette: 0.3, ..all.clone() }),
        ("all, roulette", Frame { roulette: 0.3, ..all.clone() }),
        ("bridge, one start", Frame { walk: brief, ..only(bridge(Roll::Aligned)) }),
        (
            "all, two starts, survival, roulette",
            Frame {
                walk: WalkLimits { segments: 3, starts: 2, survival: Survival::Constant(0.8) },
                roulette: 0.2,
                ..all.clone()
            },
        ),
    ] {
        for (n, (found, expected)) in means(&frame).into_iter().zip(&truth).enumerate() {
            for (channel, (found, expected)) in found.into_iter().zip(expected).enumerate() {
                let z = (found.0 - expected.0) / (found.1.powi(2) + expected.1.powi(2)).sqrt();
                let name = format!("{name}, {} segments, channel {channel}", n + 2);
                assert!(z.abs() < 4.0, "{name}: {found:?}, expected {expected:?}, z = {z}");
            }
        }
    }
}
