//! Stages on generated tables: edge values, every tail length, permuted lanes, poisoned dead lanes.

use bumpalo::Bump;
use fogbow::frame::Frame;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::lanes::LANES;
use fogbow_kernels::pipeline::SIMD;
use fogbow_testing::checked::{CHECKED, take_log};
use fogbow_testing::compare::{Row, Save, Saved};
use fogbow_testing::frames;
use fogbow_testing::generated::{Numbers, fill};

const TABLE: usize = 3 * LANES;

/// One bounce of generated paths in the lanes `live`: every stage but generate, on tables that no walk would make.
fn check_bounce(frame: &Frame, seed: u32, live: &[usize]) -> fogbow_testing::checked::Log {
    let arena = Bump::new();
    let mut wavefront = Wavefront::new_in(&arena, frame, &CHECKED, TABLE);
    fill(&mut wavefront, frame, seed, live);
    // Edge words reach the phase function only here: in a bounce they would be drawn anew.
    wavefront.scatter();
    wavefront.bounce();
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

/// Everything that a path is, by table; the rings have one table per slot.
struct Paths {
    live: Saved,
    tables: Vec<Saved>,
    vertices: Saved,
    rays: Saved,
    trail: Saved,
}

impl Paths {
    fn save(wavefront: &Wavefront<'_>) -> Self {
        let Wavefront { paths, immersion, log_posterior, last_surface, outlook, throughput, radiance, .. } = wavefront;
        Self {
            live: wavefront.live.save(),
            tables: vec![
                paths.save(),
                last_surface.save(),
                outlook.save(),
                throughput.save(),
                radiance.save(),
                immersion.save(),
                log_posterior.save(),
            ],
            vertices: wavefront.vertices.save(),
            rays: wavefront.rays.save(),
            trail: wavefront.trail.save(),
        }
    }

    fn restore(&self, wavefront: &mut Wavefront<'_>) {
        wavefront.live.restore(&self.live);
        wavefront.paths.restore(&self.tables[0]);
        wavefront.last_surface.restore(&self.tables[1]);
        wavefront.outlook.restore(&self.tables[2]);
        wavefront.throughput.restore(&self.tables[3]);
        wavefront.radiance.restore(&self.tables[4]);
        wavefront.immersion.restore(&self.tables[5]);
        wavefront.log_posterior.restore(&self.tables[6]);
        wavefront.vertices.restore(&self.vertices);
        wavefront.rays.restore(&self.rays);
        wavefront.trail.restore(&self.trail);
    }

    /// The same with every table but the set of live lanes changed by `change`.
    fn map(&self, change: impl Fn(&Saved) -> Saved) -> Self {
        Self {
            live: self.live.clone(),
            tables: self.tables.iter().map(&change).collect(),
            vertices: change(&self.vertices),
            rays: change(&self.rays),
            trail: change(&self.trail),
        }
    }

    /// What is known of the path in `lane`.
    fn of(&self, lane: usize) -> Vec<Row> {
        self.tables.iter().map(|table| table.row(0, lane)).collect()
    }
}

/// What a bounce leaves of paths, and the clock after it.
fn after_bounce(frame: &Frame, prepare: impl Fn(&mut Wavefront<'_>)) -> (Paths, u32) {
    let arena = Bump::new();
    let mut wavefront = Wavefront::new_in(&arena, frame, &SIMD, TABLE);
    prepare(&mut wavefront);
    wavefront.bounce();
    assert_eq!(wavefront.stats.dropped.count, 0, "something was not finite");
    let mut paths = Paths::save(&wavefront);
    // Light sums of vertices that may not connect are not read, and whole batches are filled.
    paths.tables.iter_mut().for_each(|table| table.forget("light_sum"));
    (paths, wavefront.step.clock)
}

#[test]
fn permuted_lanes_give_permuted_results() {
    for (name, frame) in frames::variety([64, 1]) {
        let live: Vec<_> = (0..19).collect();
        let (plain, clock) = after_bounce(&frame, |wavefront| fill(wavefront, &frame, 1, &live));
        let mut order: Vec<usize> = (0..TABLE).collect();
        let mut numbers = Numbers::new(5);
        (1..TABLE).rev().for_each(|i| order.swap(i, numbers.below(i as u32 + 1) as usize));
        let (permuted, _) = after_bounce(&frame, |wavefront| {
            fill(wavefront, &frame, 1, &live);
            let before = Paths::save(wavefront);
            let moved = before.map(|table| table.permuted(&order));
            Paths { live: before.live.permuted(&order), ..moved }.restore(wavefront);
        });
        for (to, from) in order.iter().enumerate().filter(|(_, from)| live.contains(from)) {
            assert_eq!(plain.of(*from), permuted.of(to), "{name}: path of lane {from}");
            let alive = plain.live.contains(*from);
            assert_eq!(alive, permuted.live.contains(to), "{name}: life of lane {from}");
            if alive {
                let row = |saved: &Saved, lane| saved.row(clock as usize % saved.tables(), lane);
                let [vertex, moved] = [(&plain, *from), (&permuted, to)].map(|(of, lane)| row(&of.vertices, lane));
                assert_eq!(vertex, moved, "{name}: vertex of {from}");
                let [ray, moved] = [(&plain, *from), (&permuted, to)].map(|(of, lane)| row(&of.rays, lane));
                assert_eq!(ray, moved, "{name}: ray of lane {from}");
            }
        }
    }
}

#[test]
fn what_dead_lanes_hold_does_not_matter() {
    for (name, frame) in frames::variety([64, 1]) {
        for live in [vec![], vec![3], vec![0, 2, 9, 10, 17], (0..13).collect::<Vec<_>>()] {
            let (clean, _) = after_bounce(&frame, |wavefront| fill(wavefront, &frame, 2, &live));
            let (poisoned, _) = after_bounce(&frame, |wavefront| {
                fill(wavefront, &frame, 2, &live);
                let dead = |lane: usize| !live.contains(&lane);
                Paths::save(wavefront).map(|table| table.poisoned(dead)).restore(wavefront);
            });
            for lane in &live {
                assert_eq!(clean.of(*lane), poisoned.of(*lane), "{name}: path of lane {lane}");
                assert_eq!(clean.live.contains(*lane), poisoned.live.contains(*lane), "{name}: life of lane {lane}");
            }
        }
    }
}
