//! The twin against closed forms.

use core::f64::consts::PI;

use glam::DVec3;
use wide::f32x8;

use super::Competing;
use super::reference::{Competition, CompletePath};
use crate::connect::bridge::reference::{Start, count_probability};
use crate::connect::bridge::{Bridge, Roll};
use crate::connect::mvnee::{Mvnee, Offset};
use crate::connect::{Techniques, bridge};
use crate::emission::reference::profile;
use crate::media::Medium;
use crate::phase::PhaseFunction;
use crate::survival::Survival;
use crate::tables::lights::{Emitter, Lights, Selection};
use crate::{PathLengths, WalkLimits};

fn medium(extinction: f32, g: f32) -> Medium {
    Medium::homogeneous(extinction, [1.0; 3], PhaseFunction::henyey_greenstein(g))
}

fn light(center: DVec3) -> Lights {
    Lights::new(vec![Emitter::disk(center, -DVec3::Z, 0.5, [1.0; 3])], Selection::Uniform)
}

fn both(medium: &Medium) -> Techniques {
    let mvnee = Some(Mvnee::new(medium, f64::INFINITY, Offset::Ggx));
    Techniques { nee: true, mvnee, ..Techniques::default() }
}

/// The weight of a path, with starts from `first_start` on, which is on a surface of the normal `surface`.
fn weigh(
    (medium, lights, techniques): (&Medium, &Lights, &Techniques),
    walk: &WalkLimits,
    vertices: &[DVec3],
    first_start: usize,
    surface: Option<DVec3>,
) -> f64 {
    let competition = Competition { medium, lights, techniques, walk, competing: Competing::All, lengths: LENGTHS };
    let (current, log_posterior) = (vertices.len() - 2, [0.0; 3]);
    competition.worth(&CompletePath { vertices, first_start, surface, emitter: 0, current, log_posterior }).weight
}

/// The sum of the ratios of vertex `start` of a path through open space of at most `longest` segments.
fn ratios(
    (medium, lights, techniques): (&Medium, &Lights, &Techniques),
    longest: u32,
    vertices: &[DVec3],
    start: usize,
) -> f64 {
    let lengths = PathLengths { min: 1, max: longest };
    let competition = Competition { medium, lights, techniques, walk: &FREE, competing: Competing::All, lengths };
    let (current, log_posterior) = (vertices.len() - 2, [0.0; 3]);
    let path = CompletePath { vertices, first_start: 1, surface: None, emitter: 0, current, log_posterior };
    competition.ratios(&path, start, 0)
}

const FREE: WalkLimits = WalkLimits { segments: u32::MAX, starts: u32::MAX, survival: Survival::CERTAIN };
const LENGTHS: PathLengths = PathLengths { min: 1, max: 1000 };

#[test]
fn a_straight_connection_has_the_ratios_of_the_closed_form() {
    let (medium, lights) = (medium(0.5, 0.0), light(DVec3::new(0.0, 1.0, 3.0)));
    let path = [DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0), DVec3::new(0.0, 1.0, 3.0)];
    // p_A s^2 / (p_w cos_light), with and without the probability of a flight past the light.
    let ratio = 1.0 / (0.25 * PI) * 4.0 * 4.0 * PI;
    let weight = |techniques: &Techniques| weigh((&medium, &lights, techniques), &FREE, &path, 1, None);
    assert_eq!(weight(&Techniques::default()), 1.0);
    let nee = weight(&Techniques { nee: true, ..Techniques::default() });
    assert!((nee - 1.0 / (1.0 + ratio * 1.0_f64.exp())).abs() < 1e-12, "{nee}");
    let mvnee = weight(&Techniques { nee: false, ..both(&medium) });
    assert!((mvnee - 1.0 / (1.0 + ratio)).abs() < 1e-12, "{mvnee}");
    let all = weight(&both(&medium));
    assert!((all - 1.0 / (1.0 + ratio + ratio * 1.0_f64.exp())).abs() < 1e-12, "{all}");
}

#[test]
fn backs_and_paths_without_a_last_segment_weigh_nothing() {
    let (medium, lights) = (medium(0.5, 0.3), light(DVec3::ZERO));
    let weight = |before: DVec3| {
        let path = [DVec3::X, before, DVec3::ZERO];
        weigh((&medium, &lights, &both(&medium)), &FREE, &path, 1, None)
    };
    assert!(weight(-DVec3::Z) > 0.0);
    assert_eq!([DVec3::Z, DVec3::Y, DVec3::ZERO].map(weight), [0.0; 3]);
}

#[test]
fn starts_whose_suffix_has_an_empty_segment_have_no_ratio() {
    let (medium, lights) = (medium(0.5, 0.3), light(DVec3::new(0.0, 0.0, 2.0)));
    let path = [-DVec3::Z, DVec3::X, DVec3::X, DVec3::ZERO, DVec3::new(0.0, 0.1, 2.0)];
    let weight = |first: usize| weigh((&medium, &lights, &both(&medium)), &FREE, &path, first, None);
    assert_eq!(weight(1), weight(3));
    assert!(weight(3) < 1.0);
}

#[test]
fn weights_do_not_depend_on_the_unit_of_length() {
    let zigzag = |k: usize| DVec3::new(0.1 * (k % 3) as f64, 0.2 * (k % 2) as f64, 0.5 * k as f64);
    let weights = [1e-5_f64, 1.0, 1e4].map(|mfp| {
        let mut path: Vec<_> = (0..200).map(|k| mfp * zigzag(k)).collect();
        path.push(mfp * DVec3::new(0.0, 0.0, 101.0));
        let disk = Emitter::disk(path[200], -DVec3::Z, 20.0 * mfp, [1.0; 3]);
        let lights = Lights::new(vec![disk], Selection::Uniform);
        let medium = medium((1.0 / mfp) as f32, 0.6);
        weigh((&medium, &lights, &both(&medium)), &FREE, &path, 1, None)
    });
    assert!(weights[1] > 0.0 && weights[1] < 1.0, "{weights:?}");
    assert!(weights.iter().all(|weight| (weight / weights[1] - 1.0).abs() < 1e-4), "{weights:?}");
}

/// A path of five segments through open space, and the light at its end.
fn bent() -> (Medium, Lights, [DVec3; 6]) {
    let at = |x: f64, z: f64| DVec3::new(x, 0.1 * z * z, z);
    let path = [at(0.0, 0.0), at(0.3, 0.8), at(0.1, 1.5), at(0.6, 2.1), at(0.5, 2.9), at(0.2, 4.0)];
    (medium(1.2, 0.4), light(path[5]), path)
}

/// The one-line ratios of section 5 and 6 of the derivation, which know of no full density.
#[test]
fn bridges_and_once_more_estimation_have_the_ratios_of_their_closed_forms() {
    let (medium, lights, path) = bent();
    let (twin, phase) = (medium.twin(0), medium.phase.twin());
    let extinction = f64::from(medium.largest_extinction());
    let direction = |j: usize| (path[j + 1] - path[j]).normalize();
    let area = PI * 0.25;
    let lengths = PathLengths { min: 1, max: 9 };
    let sum = |techniques: &Techniques, start: usize| ratios((&medium, &lights, techniques), lengths.max, &path, start);
    for start in 1..5 {
        let n = 5 - start as i32;
        let length: f64 = (start..5).map(|j| (path[j + 1] - path[j]).length()).sum();
        let s = (path[5] - path[start]).length();
        let cos_light = direction(4).z;
        let common = 1.0 / (area * phase.density(direction(start - 1).dot(direction(start))) * cos_light);
        let factorial: f64 = (1..n).map(f64::from).product();
        let axis = (path[5] - path[start]) / s;
        let from =
            Start { depth: start as u32, position: path[start], arriving: direction(start - 1), on_surface: false };
        let aligned = Bridge::new(Roll::Aligned, &medium, lengths.max);
        let count = count_probability(&aligned, &twin, lengths.max, &from, path[5], n as u32);
        let uniform = common * count * factorial * extinction * s.powi(3) * (extinction * length).exp()
            / (extinction * length).powi(n);
        let roll = bridge::reference::roll_density(phase, direction(start - 1), axis, direction(start));
        let ends = bridge::reference::first_share(phase, direction(start - 1), axis, direction(start), direction(4));
        for (kind, expected) in [(Roll::Uniform, uniform), (Roll::Aligned, uniform * roll * 2.0 * ends)] {
            let bridge = Bridge { roll: kind, ..aligned.clone() };
            let found = sum(&Techniques { bridge: Some(bridge), ..Techniques::default() }, start);
            assert!((found / expected - 1.0).abs() < 1e-6, "{kind:?} from {start}: {found}, expected {expected}");
        }
        let found = sum(&Techniques { omnee: true, ..Techniques::default() }, start);
        if start != 3 {
            assert_eq!(found, 0.0, "from {start}");
            continue;
        }
        let theta = direction(3).angle_between(direction(4));
        let share = phase.forward_share();
        let expected = common * s * theta.sin() / theta * (extinction * length).exp() / (share * extinction);
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, expected {expected}");
    }
}

#[test]
fn walks_that_end_stop_or_rarely_start_compete_less() {
    let (medium, lights, path) = bent();
    let bridge = Some(Bridge::new(Roll::Aligned, &medium, LENGTHS.max));
    let techniques = Techniques { nee: true, omnee: true, bridge, ..both(&medium) };
    let ratio = |start: usize| ratios((&medium, &lights, &techniques), LENGTHS.max, &path, start);
    let weight = |walk: WalkLimits, first: usize| weigh((&medium, &lights, &techniques), &walk, &path, first, None);
    let close = |found: f64, sum: f64| assert!((found * sum - 1.0).abs() < 1e-12, "{found}, expected {}", 1.0 / sum);
    close(weight(FREE, 1), 1.0 + (1..5).map(ratio).sum::<f64>());
    close(weight(FREE, 3), 1.0 + ratio(3) + ratio(4));
    close(weight(WalkLimits { starts: 2, ..FREE }, 1), 1.0 + ratio(1) + ratio(2));
    close(weight(WalkLimits { starts: 1, ..FREE }, 4), 1.0 + ratio(4));
    close(weight(WalkLimits { segments: 5, ..FREE }, 4), 1.0 + ratio(4));
    close(weight(WalkLimits { segments: 4, ..FREE }, 4), ratio(4));
    let q: f64 = 0.5;
    let survived: f64 = (1..5).map(|start| q.powi(start as i32 - 1) * ratio(start)).sum();
    close(weight(WalkLimits { survival: Survival::Constant(0.5), ..FREE }, 1), q.powi(4) + survived);
}

#[test]
fn a_path_that_nothing_makes_weighs_nothing() {
    let (medium, lights, path) = bent();
    let short = WalkLimits { segments: 4, ..FREE };
    for techniques in [Techniques::default(), Techniques { omnee: true, ..Techniques::default() }] {
        assert_eq!(weigh((&medium, &lights, &techniques), &short, &path, 4, None), 0.0);
    }
}

#[test]
fn the_depth_of_the_start_limits_what_it_can_make() {
    let (medium, lights, path) = bent();
    let sum = |techniques: &Techniques, max: u32, start: usize| {
        ratios((&medium, &lights, techniques), max, &path, start) > 0.0
    };
    let omnee = Techniques { omnee: true, ..Techniques::default() };
    assert!(sum(&omnee, 5, 3) && !sum(&omnee, 4, 3));
    let limited = Bridge { max_inserted: 2, ..Bridge::new(Roll::Uniform, &medium, 5) };
    let bridge = Techniques { bridge: Some(limited), ..Techniques::default() };
    assert!(sum(&bridge, 5, 2) && !sum(&bridge, 5, 1) && !sum(&bridge, 4, 2));
}

#[test]
fn connections_that_lead_into_a_surface_weigh_nothing() {
    let (medium, lights) = (medium(0.5, 0.3), light(DVec3::new(0.0, 0.0, 3.0)));
    let path = [DVec3::new(0.0, -1.0, 1.0), DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0)];
    let weight =
        |normal: DVec3, techniques: &Techniques| weigh((&medium, &lights, techniques), &FREE, &path, 1, Some(normal));
    for techniques in [both(&medium), Techniques::default()] {
        assert!(weight(DVec3::Z, &techniques) > 0.0 && weight(DVec3::new(0.0, 0.9, 0.1), &techniques) > 0.0);
        assert_eq!(weight(DVec3::NEG_Z, &techniques), 0.0);
    }
    // p_A s^2 pi / (cos_surface cos_light) of next event estimation, times the chance of a flight past the light.
    let nee = Techniques { nee: true, ..Techniques::default() };
    let ratio = 1.0 / (0.25 * PI) * 9.0 * PI / 0.6 * 1.5_f64.exp();
    assert!((weight(DVec3::new(0.8, 0.0, 0.6), &nee) - 1.0 / (1.0 + ratio)).abs() < 1e-12);
}

#[test]
fn spots_of_any_exponent_have_their_profile() {
    // (n + 1) / (2 pi) is 1 at n = 2 pi - 1: a spot even so.
    for exponent in [0.0, 2.0 * PI - 1.0, 50.0] {
        let spot = Emitter::disk(DVec3::ZERO, DVec3::Z, 0.5, [1.0; 3]).focused(exponent);
        let lights = Lights::new(vec![spot], Selection::Uniform);
        for cosine in [0.2_f64, 0.7, 1.0] {
            let expected = (exponent + 1.0) / (2.0 * PI) * cosine.powf(exponent);
            let direction = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine);
            let twin = profile(&spot, DVec3::ZERO, direction);
            let kernel = lights.profile(&[0; 8], f32x8::splat(cosine as f32)).to_array()[3];
            assert!((twin / expected - 1.0).abs() < 1e-5, "{exponent} at {cosine}: {twin} instead of {expected}");
            assert!(
                (f64::from(kernel) / expected - 1.0).abs() < 1e-4,
                "{exponent} at {cosine}: {kernel} in the kernel"
            );
        }
    }
}

#[test]
fn the_intensity_of_a_spot_with_a_cone_falls_between_its_angles() {
    for [inner, outer] in [[0.0, 0.5], [0.3, 0.6], [0.6, 0.6], [0.5, 0.5 * PI]] {
        let spot = Emitter::disk(DVec3::ZERO, DVec3::Z, 0.5, [1.0; 3]).with_cone([inner, outer], 3.0);
        // One without a cone beside it keeps its profile.
        let lights = Lights::new(vec![spot, Emitter { window: [0.0; 2], ..spot }], Selection::Uniform);
        for angle in [0.0, 0.1, 0.29, 0.45, 0.59, 0.61, 1.2_f64] {
            let cosine = angle.cos();
            let fall = ((cosine - outer.cos()) / (inner.cos() - outer.cos()).max(1e-4)).clamp(0.0, 1.0);
            let expected = fall * fall / cosine;
            let twin = profile(&spot, DVec3::ZERO, DVec3::new(angle.sin(), 0.0, -cosine));
            let kernel = lights.profile(&[0, 1, 0, 1, 0, 1, 0, 1], f32x8::splat(cosine as f32)).to_array();
            assert!((twin - expected).abs() < 1e-5, "{inner} to {outer} at {angle}: {twin} instead of {expected}");
            assert!((f64::from(kernel[4]) - expected).abs() < 1e-5, "{inner} to {outer} at {angle}: {}", kernel[4]);
            assert!((f64::from(kernel[5]) - cosine.powi(3)).abs() < 1e-5, "without a cone at {angle}: {}", kernel[5]);
        }
    }
}
