//! Stages on generated tables: edge values, every tail length, permuted lanes, poisoned dead lanes.

use bumpalo::Bump;
use fogbow::frame::Frame;
use fogbow::stats::Stats;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::columns::LANES;
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::scatter;
use fogbow_testing::checked::{CHECKED, take_log};
use fogbow_testing::compare::{Save, Saved};
use fogbow_testing::frames;
use fogbow_testing::generated::{Numbers, fill};

const TABLE: usize = 3 * LANES;

/// One bounce of generated paths in the lanes `live`: every stage but generate, on tables that no walk would make.
fn check_bounce(frame: &Frame, seed: u32, live: &[usize]) -> fogbow_testing::checked::Log {
    let arena = Bump::new();
    let mut wavefront = Wavefront::new_in(&arena, frame, TABLE);
    fill(&mut wavefront, frame, seed, live);
    let Wavefront { flights, paths, vertices, rays, step, .. } = &mut wavefront;
    // Edge words reach the phase function only here: in a bounce they would be drawn anew.
    (CHECKED.scatter)(&frame.medium, *step, scatter::Columns { flights, paths, vertices, rays });
    wavefront.bounce(frame, &CHECKED, &mut Stats::new(false));
    take_log()
}

#[test]
fn kernels_agree_with_twins_on_edge_values_and_every_tail_length() {
    let (mut rows, mut decisions) = (0, 0);
    for (name, frame) in frames::variety([64, 1]) {
        for live in 0..=17 {
            for seed in 0..4 {
                let log = check_bounce(&frame, seed, &(0..live).collect::<Vec<_>>());
                let shown = log.failures.iter().take(2).map(String::as_str).collect::<Vec<_>>().join("\n");
                assert!(log.failures.is_empty(), "{name}, {live} live lanes, seed {seed}:\n{shown}");
                (rows, decisions) = (rows + log.rows, decisions + log.decisions);
            }
        }
    }
    assert!(rows > 50_000 && decisions * 2000 < rows, "{decisions} of {rows} rows were decided differently");
}

#[test]
fn kernels_agree_with_twins_for_every_pattern_of_live_lanes() {
    let frame = frames::three_lights(0.5, fogbow_kernels::tables::lights::Selection::IntensityDistance, [64, 1]);
    for bits in 0..256_usize {
        let live: Vec<_> = (0..8).filter(|lane| bits >> lane & 1 == 1).map(|lane| 8 + lane).collect();
        let log = check_bounce(&frame, bits as u32, &live);
        assert!(log.failures.is_empty(), "live lanes {live:?}: {}", log.failures[0]);
    }
}

/// What a bounce leaves of every live lane's path: radiance, vertex, ray, whether it lives on.
fn after_bounce(frame: &Frame, prepare: impl Fn(&mut Wavefront<'_>)) -> (Saved, Saved, Saved, u32) {
    let arena = Bump::new();
    let mut wavefront = Wavefront::new_in(&arena, frame, TABLE);
    prepare(&mut wavefront);
    let mut stats = Stats::new(false);
    wavefront.bounce(frame, &SIMD, &mut stats);
    assert_eq!(stats.dropped.count, 0, "something was not finite");
    let mut vertices = wavefront.vertices.save();
    // Where no light is near nothing reads it, and whole batches are filled.
    vertices.forget("light_sum");
    (wavefront.paths.save(), vertices, wavefront.rays.save(), wavefront.step.clock)
}

#[test]
fn permuted_lanes_give_permuted_results() {
    for (name, frame) in frames::variety([64, 1]) {
        let live: Vec<_> = (0..19).collect();
        let plain = after_bounce(&frame, |wavefront| fill(wavefront, &frame, 1, &live));
        let mut order: Vec<usize> = (0..TABLE).collect();
        let mut numbers = Numbers::new(5);
        (1..TABLE).rev().for_each(|i| order.swap(i, numbers.below(i as u32 + 1) as usize));
        let permuted = after_bounce(&frame, |wavefront| {
            fill(wavefront, &frame, 1, &live);
            let (paths, vertices, rays) = (wavefront.paths.save(), wavefront.vertices.save(), wavefront.rays.save());
            let trail = wavefront.trail.save();
            wavefront.trail.restore(&trail.permuted(&order));
            wavefront.paths.restore(&paths.permuted(&order));
            wavefront.vertices.restore(&vertices.permuted(&order));
            wavefront.rays.restore(&rays.permuted(&order));
        });
        for (to, from) in order.iter().enumerate().filter(|(_, from)| live.contains(from)) {
            assert_eq!(plain.0.row(0, *from), permuted.0.row(0, to), "{name}: path of lane {from}");
            let alive = plain.0.contains(0, *from);
            assert_eq!(alive, permuted.0.contains(0, to), "{name}: life of lane {from}");
            if alive {
                let slot = |saved: &Saved| plain.3 as usize % saved.tables();
                let (vertices, rays) = (slot(&plain.1), slot(&plain.2));
                assert_eq!(plain.1.row(vertices, *from), permuted.1.row(vertices, to), "{name}: vertex of {from}");
                assert_eq!(plain.2.row(rays, *from), permuted.2.row(rays, to), "{name}: ray of lane {from}");
            }
        }
    }
}

#[test]
fn what_dead_lanes_hold_does_not_matter() {
    for (name, frame) in frames::variety([64, 1]) {
        for live in [vec![], vec![3], vec![0, 2, 9, 10, 17], (0..13).collect::<Vec<_>>()] {
            let clean = after_bounce(&frame, |wavefront| fill(wavefront, &frame, 2, &live));
            let poisoned = after_bounce(&frame, |wavefront| {
                fill(wavefront, &frame, 2, &live);
                let dead = |lane: usize| !live.contains(&lane);
                let (paths, vertices, rays) =
                    (wavefront.paths.save(), wavefront.vertices.save(), wavefront.rays.save());
                let trail = wavefront.trail.save();
                wavefront.trail.restore(&trail.poisoned(dead));
                wavefront.paths.restore(&paths.poisoned(dead));
                wavefront.vertices.restore(&vertices.poisoned(dead));
                wavefront.rays.restore(&rays.poisoned(dead));
            });
            for lane in &live {
                assert_eq!(clean.0.row(0, *lane), poisoned.0.row(0, *lane), "{name}: path of lane {lane}");
                assert_eq!(clean.0.contains(0, *lane), poisoned.0.contains(0, *lane), "{name}: life of lane {lane}");
            }
        }
    }
}
