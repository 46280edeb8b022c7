//! Densities and weights against independent code, and the properties that every weight has.

use std::sync::Arc;

use fogbow_kernels::WalkLimits;
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_kernels::connect::bridge::{self, Bridge, Roll};
use fogbow_kernels::connect::lis::{Connector, Lis};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset, slope};
use fogbow_kernels::connect::{Techniques, mvnee, nee};
use fogbow_kernels::media::Medium;
use fogbow_kernels::media::reference::Homogeneous;
use fogbow_kernels::mis_weight::{self, Competing, reference::path_tracing_density};
use fogbow_kernels::phase::reference::Phase;
use fogbow_kernels::phase::{HenyeyGreenstein, PhaseFunction, henyey_greenstein};
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::truths::{Case, Start, density_ratios};
use fogbow_testing::weighing::{Made, Weigher};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

fn vertices(case: &Case) -> Vec<DVec3> {
    case.vertices.iter().map(|v| DVec3::from(*v)).collect()
}

fn medium(case: &Case) -> Medium {
    Medium::homogeneous(case.mu_t as f32, [1.0; 3], PhaseFunction::henyey_greenstein(case.g as f32))
}

/// The phase function of a case, whose mean cosine single precision does not hold.
struct Exact(f64);

impl Phase for Exact {
    fn density(&self, cosine: f64) -> f64 {
        henyey_greenstein::reference::density(self.0, cosine)
    }

    fn sample_cosine(&self, u: f64) -> f64 {
        henyey_greenstein::reference::sample_cosine(self.0, u)
    }

    fn forward_share(&self) -> f64 {
        henyey_greenstein::reference::forward_share(self.0)
    }

    fn mean_cosine(&self) -> f64 {
        self.0
    }

    fn roll_lobes(&self) -> Vec<(f64, f64)> {
        vec![(1.0, self.0)]
    }
}

#[test]
fn full_densities_of_the_twins_match_recorded_ratios() {
    let mut checked = 0;
    for (index, case) in density_ratios().iter().enumerate() {
        let path = vertices(case);
        let normal = DVec3::from(case.light_normal);
        let settings = mvnee::reference::Settings {
            max_distance: f64::INFINITY,
            max_depth: f64::INFINITY,
            max_inserted: u32::MAX,
            offset: Offset::Ggx,
            seeds: mvnee::Seeds::Coarse,
            slope: slope::of(case.g),
        };
        for start in &case.starts {
            let phase = Exact(case.g);
            let medium = &Homogeneous::new(case.mu_t, &phase);
            let traced = path_tracing_density(medium, &path, start.start, None, normal).expect("has a density");
            let chain = &path[start.start..];
            let light = 1.0 / case.light_area;
            let arriving = (path[start.start] - path[start.start - 1]).normalize();
            let (depth, position) = (start.start as u32, path[start.start]);
            let from = bridge::reference::Start { depth, position, arriving, on_surface: false };
            let bridge = |roll: Roll| {
                let density =
                    bridge::reference::density(&poisson_bridge(case, roll), medium, 1000, &from, chain, light);
                density.times(1.0 / count_quotient(case, start.start))
            };
            let chosen = end_factor(case, start.start);
            let nee = nee::reference::density(chain, normal, light).over(traced);
            let mvnee = mvnee::reference::density(&settings, medium, chain, light).over(traced);
            let [uniform, aligned] = [Roll::Uniform, Roll::Aligned].map(|roll| bridge(roll).over(traced));
            for (name, quotient, tolerance) in [
                ("path tracing", traced.value() / start.path_tracing_density, 1e-9),
                ("nee", quotient(nee, start.nee), 1e-9),
                ("mvnee", quotient(mvnee, start.mvnee), 1e-9),
                ("bridge", quotient(uniform, start.bridge), 1e-9),
                ("aligned bridge", quotient(aligned, start.aligned_bridge * chosen), 1e-9),
            ] {
                let place = format!("case {index}, start {}: {name}", start.start);
                assert!((quotient - 1.0).abs() < tolerance, "{place} is off by a factor {quotient}");
            }
            checked += 1;
        }
    }
    assert!(checked > 300, "only {checked} starts");
}

/// Quotient of a found and a recorded ratio; 1 if both are zero.
fn quotient(found: f64, recorded: f64) -> f64 {
    if found == recorded { 1.0 } else { found / recorded }
}

/// Bridges with about the counts that were recorded: nothing but Poisson, from a table.
fn poisson_bridge(case: &Case, roll: Roll) -> Bridge {
    let lobe = HenyeyGreenstein { g: case.g as f32 };
    Bridge { defensive: 0.0, ..Bridge::with_counts(roll, Arc::new(CountTable::poisson(lobe))) }
}

/// The probability that the table gives to the number of edges from vertex `start` on, over the Poisson probability
/// that was recorded.
fn count_quotient(case: &Case, start: usize) -> f64 {
    let path = vertices(case);
    let arriving = (path[start] - path[start - 1]).normalize();
    let (point, edges) = (path[path.len() - 1], path.len() - 1 - start);
    let from = bridge::reference::Start { depth: start as u32, position: path[start], arriving, on_surface: false };
    let (bridge, phase) = (poisson_bridge(case, Roll::Uniform), Exact(case.g));
    let medium = &Homogeneous::new(case.mu_t, &phase);
    let tabled = bridge::reference::count_probability(&bridge, medium, 1000, &from, point, edges as u32);
    let mean = case.mu_t * path[start].distance(point);
    let poisson = (1..edges).fold((-mean).exp(), |p, k| p * mean / k as f64);
    tabled / poisson
}

/// 2 P(first): by how much likelier the choice of an end makes the bridge from vertex `start` on, which was recorded
/// without it.
fn end_factor(case: &Case, start: usize) -> f64 {
    let path = vertices(case);
    let edge = |k: usize| path[k + 1] - path[k];
    let g = f64::from(case.g as f32);
    let axis = path[path.len() - 1] - path[start];
    let gamma = edge(start - 1).angle_between(axis);
    let h = |angle: f64| 1.0 + g * g - 2.0 * g * angle.cos();
    let [first, last] = [edge(start), edge(path.len() - 2)].map(|end| {
        let angle = end.angle_between(axis);
        1.0 / (h(angle - gamma) * h(angle + gamma).sqrt())
    });
    2.0 * first / (first + last)
}

/// The techniques whose ratios were recorded, and their sum over the starts from `first` on.
fn recorded(case: &Case, first: usize) -> [(Techniques, f64); 6] {
    let mvnee = Some(Mvnee::new(&medium(case), f64::INFINITY, Offset::Ggx));
    let bridge = |roll: Roll| Techniques { bridge: Some(poisson_bridge(case, roll)), ..Techniques::default() };
    let aligned =
        |start: &Start| start.aligned_bridge * count_quotient(case, start.start) * end_factor(case, start.start);
    let sum = |ratio: &dyn Fn(&Start) -> f64| case.starts.iter().filter(|start| start.start >= first).map(ratio).sum();
    [
        (Techniques { nee: true, ..Techniques::default() }, sum(&|start| start.nee)),
        (Techniques { mvnee, ..Techniques::default() }, sum(&|start| start.mvnee)),
        (Techniques { nee: true, mvnee, ..Techniques::default() }, sum(&|start| start.nee + start.mvnee)),
        (bridge(Roll::Uniform), sum(&|start| start.bridge * count_quotient(case, start.start))),
        (bridge(Roll::Aligned), sum(&aligned)),
        (
            Techniques { nee: true, mvnee, ..bridge(Roll::Aligned) },
            sum(&|start| start.nee + start.mvnee + aligned(start)),
        ),
    ]
}

#[test]
fn weights_of_kernel_and_twin_match_recorded_ratios_however_a_path_was_made() {
    let (mut checked, mut worst) = (0, 0.0_f64);
    for (index, case) in density_ratios().iter().enumerate() {
        let path = vertices(case);
        let n = path.len() - 1;
        let radius = (case.light_area / core::f64::consts::PI).sqrt();
        // The recorded path ends on the light, wherever its centre is.
        let disk = Emitter::disk(path[n], DVec3::from(case.light_normal), radius, [1.0; 3]);
        let (medium, lights) = (medium(case), Lights::new(vec![disk], Selection::Uniform));
        let shortest = path.windows(2).map(|ends| ends[0].distance(ends[1])).fold(f64::INFINITY, f64::min);
        let distance = path.iter().map(|v| v.length()).fold(0.0, f64::max);
        // Recorded in f64, stored in f32.
        let cos_light = -(path[n] - path[n - 1]).normalize().dot(DVec3::from(case.light_normal));
        let rounding = fogbow_testing::tolerances::weight_conditioning(case.g, distance, shortest, cos_light);
        for inserted in 0..n - 1 {
            for first_start in 1..=n - 1 - inserted {
                for (techniques, expected) in recorded(case, first_start) {
                    let made = Made { vertices: &path, inserted, first_start, emitter: 0 };
                    for kernel in [mis_weight::simd::run as mis_weight::Kernel, mis_weight::reference::run] {
                        let weigher = Weigher::new(kernel, &medium, &lights, &techniques);
                        let weight = weigher.weight(&made, (index + inserted) % 16);
                        let error = (weight * (1.0 + expected) - 1.0).abs();
                        worst = worst.max(error / (1e-5 + rounding));
                        assert!(
                            error < 1e-5 + rounding,
                            "case {index}, {inserted} inserted, starts from {first_start}: weight {weight:e}, expected {:e}",
                            1.0 / (1.0 + expected)
                        );
                        checked += 1;
                    }
                }
            }
        }
    }
    println!("{checked} weights, worst at {worst:.2} of its tolerance");
    assert!(checked > 1000, "only {checked} weights");
}

/// A random path in front of a light, as a walk that mostly goes forward.
fn any_path() -> impl Strategy<Value = Vec<DVec3>> {
    let step = (-1.0..1.0_f64, -1.0..1.0_f64, 0.3..1.5_f64).prop_map(|(x, y, z)| DVec3::new(0.6 * x, 0.6 * y, z));
    proptest::collection::vec(step, 2..10).prop_map(|steps| {
        let mut path = vec![DVec3::new(0.1, -0.2, 0.05)];
        steps.iter().for_each(|step| path.push(path[path.len() - 1] + *step));
        path
    })
}

/// Lights of which the first is met by the path's end.
fn lights_around(path: &[DVec3], turn: DQuat, scale: f64, selection: Selection) -> Lights {
    let end = path[path.len() - 1];
    let place = |offset: DVec3| end + scale * (turn * offset);
    let disk = |offset: DVec3, normal: DVec3, radius: f64, radiance: f64| {
        Emitter::disk(place(offset), turn * normal, scale * radius, [radiance; 3])
    };
    let lights = vec![
        disk(DVec3::new(0.05, 0.1, 0.0), -DVec3::Z, 0.4, 3.0),
        disk(DVec3::new(2.0, -1.0, 0.5), -DVec3::X, 0.7, 8.0),
        disk(DVec3::new(-1.0, 2.0, -1.5), -DVec3::Y, 0.2, 20.0),
    ];
    Lights::new(lights, selection)
}

fn any_selection() -> impl Strategy<Value = Selection> {
    prop_oneof![Just(Selection::Uniform), Just(Selection::Intensity), Just(Selection::IntensityDistance)]
}

fn any_g() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), Just(0.9), -0.9..0.95_f32]
}

fn any_turn() -> impl Strategy<Value = DQuat> {
    (any::<[i16; 3]>(), 0.0..6.0_f64).prop_map(|(axis, angle)| {
        let axis = DVec3::from(axis.map(f64::from)) + DVec3::new(0.5, 0.25, 0.125);
        DQuat::from_axis_angle(axis.normalize(), angle)
    })
}

/// All techniques, or those whose bit is set; light importance sampling without its companion, which nee replaces.
fn techniques(medium: &Medium, bits: u32, mesc: f64) -> Techniques {
    let has = |bit: u32| bits >> bit & 1 == 1;
    // The counts of the paper are the quickest to tabulate.
    let bridge = Bridge::with_counts(Roll::Aligned, Arc::new(CountTable::poisson(medium.phase.twin().lobe())));
    let lis = Connector::Bridge(bridge.clone());
    Techniques {
        nee: has(0),
        mvnee: has(1).then(|| Mvnee::new(medium, mesc, Offset::Ggx)),
        omnee: has(2),
        bridge: has(3).then_some(bridge),
        lis: (has(4) || has(5)).then(|| Lis {
            near: 0.0,
            ..Lis::new(medium, if has(4) { lis } else { Connector::Mvnee(Mvnee::new(medium, mesc, Offset::Ggx)) })
        }),
    }
}

/// Every technique, with light importance sampling joined by bridges and by MVNEE.
const EVERY: [u32; 2] = [0b01_1111, 0b10_1111];

const KERNELS: [mis_weight::Kernel; 2] = [mis_weight::simd::run, mis_weight::reference::run];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn weights_sum_to_one_over_techniques(
        path in any_path(), g in any_g(), selection in any_selection(), mesc in 2.0..30.0_f64, lane in 0..16_usize,
    ) {
        // A technique's share of a path is its density over the sum of all; the weight is path tracing's share, and
        // each of the others has `weight * ratio`. That these add up to one is what makes ratios additive.
        let medium = Medium::homogeneous(1.3, [1.0; 3], PhaseFunction::henyey_greenstein(g));
        let lights = lights_around(&path, DQuat::IDENTITY, 1.0, selection);
        for (kernel, bits) in KERNELS.into_iter().flat_map(|kernel| EVERY.map(|bits| (kernel, bits))) {
            let made = Made { vertices: &path, inserted: 0, first_start: 1, emitter: 0 };
            let with = |bits: u32| {
                let techniques = techniques(&medium, bits, mesc);
                Weigher::new(kernel, &medium, &lights, &techniques).weight(&made, lane)
            };
            prop_assert_eq!(with(0), 1.0);
            let every = with(bits);
            prop_assert!(every > 0.0);
            let mut shares = every;
            for bit in (0..6).filter(|bit| bits >> bit & 1 == 1) {
                let alone = with(1 << bit);
                prop_assert!(alone > 0.0 && alone <= 1.0, "technique {}: {}", bit, alone);
                shares += every * (1.0 / alone - 1.0);
            }
            prop_assert!((shares - 1.0).abs() < 1e-5, "shares add up to {}", shares);
        }
    }

    #[test]
    fn a_connection_weighs_no_more_than_its_own_start_leaves(
        path in any_path(), g in any_g(), selection in any_selection(), mesc in 2.0..30.0_f64, lane in 0..16_usize,
    ) {
        // What a weight is one over is a sum over starts, and over the walk, which here ends before: every start alone has
        // its term, in a sum of kernels that is never less than one of its terms, to the last bit.
        let medium = Medium::homogeneous(1.3, [1.0; 3], PhaseFunction::henyey_greenstein(g));
        let lights = lights_around(&path, DQuat::IDENTITY, 1.0, selection);
        let walk = WalkLimits { segments: 1, ..WalkLimits::ALL };
        for (kernel, bits) in KERNELS.into_iter().flat_map(|kernel| EVERY.map(|bits| (kernel, bits))) {
            let techniques = techniques(&medium, bits, mesc);
            let weight = |competing, inserted| {
                let weigher = Weigher { walk, competing, ..Weigher::new(kernel, &medium, &lights, &techniques) };
                weigher.weight(&Made { vertices: &path, inserted, first_start: 1, emitter: 0 }, lane)
            };
            let weigh = |inserted| [Competing::All, Competing::Own].map(|competing| weight(competing, inserted));
            let weights: Vec<_> = (0..path.len() - 2).map(weigh).collect();
            for (inserted, [all, own]) in weights.iter().enumerate() {
                prop_assert!(own >= all && *own > 0.0, "{} inserted: {} and {}", inserted, all, own);
            }
            let sum: f64 = weights.iter().map(|[_, own]| 1.0 / own).sum();
            prop_assert!((sum * weights[0][0] - 1.0).abs() < 1e-3, "{} of a sum of {}", sum, 1.0 / weights[0][0]);
        }
    }

    #[test]
    fn weights_do_not_depend_on_how_a_path_was_made(
        path in any_path(), g in any_g(), selection in any_selection(), mesc in 2.0..30.0_f64,
    ) {
        let medium = Medium::homogeneous(1.3, [1.0; 3], PhaseFunction::henyey_greenstein(g));
        let lights = lights_around(&path, DQuat::IDENTITY, 1.0, selection);
        for bits in EVERY {
            let techniques = techniques(&medium, bits, mesc);
            let weigher = Weigher::new(mis_weight::simd::run, &medium, &lights, &techniques);
            let weight = |inserted| weigher.weight(&Made { vertices: &path, inserted, first_start: 1, emitter: 0 }, 5);
            for inserted in 1..path.len() - 2 {
                prop_assert!((weight(inserted) / weight(0) - 1.0).abs() < 1e-4, "{} inserted", inserted);
            }
        }
    }

    #[test]
    fn weights_are_invariant_under_scaling_and_rotation(
        path in any_path(), g in any_g(), selection in any_selection(), mesc in 2.0..30.0_f64,
        turn in any_turn(), log_scale in -9.0..9.0_f64,
    ) {
        let scale = log_scale.exp();
        let moved: Vec<_> = path.iter().map(|v| scale * (turn * *v)).collect();
        for (kernel, bits) in KERNELS.into_iter().flat_map(|kernel| EVERY.map(|bits| (kernel, bits))) {
            let weight = |path: &[DVec3], turn: DQuat, scale: f64| {
                let extinction = (1.3 / scale) as f32;
                let medium = Medium::homogeneous(extinction, [1.0; 3], PhaseFunction::henyey_greenstein(g));
                let lights = lights_around(path, turn, scale, selection);
                let techniques = techniques(&medium, bits, mesc);
                let weigher = Weigher::new(kernel, &medium, &lights, &techniques);
                weigher.weight(&Made { vertices: path, inserted: path.len() / 2 - 1, first_start: 1, emitter: 0 }, 2)
            };
            let (here, there) = (weight(&path, DQuat::IDENTITY, 1.0), weight(&moved, turn, scale));
            // A start right at the limit of reach, or a turn of the projections, may fall to either side.
            prop_assert!((there / here - 1.0).abs() < 1e-3, "{} and {}", here, there);
        }
    }
}
