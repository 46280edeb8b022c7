//! Kernels and twins agree, stage by stage on the queues of real frames, and path by path.

use bumpalo::Bump;
use fogbow::film::{Film, Region};
use fogbow::frame::Frame;
use fogbow::reference;
use fogbow::stats::Stats;
use fogbow::wavefront::{Candidates, Wavefront};
use fogbow_kernels::extend;
use fogbow_kernels::pipeline::{Pipeline, REFERENCE, SIMD, Stage, WIDEST};
use fogbow_kernels::tables::lights::Selection;
use fogbow_processor::Avx512;
use fogbow_testing::agreement::assert_whole_paths_agree;
use fogbow_testing::checked::{CHECKED, Log, take_log};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::not_run::not_run;
use fogbow_testing::render::{render, render_here};
use fogbow_testing::tolerances;

/// Runs a frame through the checked pipeline and returns what it found.
fn check(frame: &Frame, lanes: usize, size: [u32; 2], samples: u32) -> Log {
    render_here(frame, &CHECKED, lanes, size, samples);
    take_log()
}

fn assert_clean(name: &str, log: &Log) {
    let shown: Vec<_> = log.failures.iter().take(3).map(String::as_str).collect();
    assert!(
        log.failures.is_empty(),
        "{name}: {} of {} rows are apart, among them\n{}",
        log.failures.len(),
        log.rows,
        shown.join("\n")
    );
}

#[test]
fn every_stage_agrees_with_its_twin_on_the_queues_of_real_frames() {
    let mut all = Log::default();
    for (name, frame) in frames::variety([16, 16]) {
        let log = check(&frame, 128, [16, 16], 4);
        assert_clean(&name, &log);
        assert!(log.rows > 1000, "{name}: only {} rows were compared", log.rows);
        all.merge(log);
    }
    let Log { rows, decisions, .. } = all;
    let share = decisions as f64 / rows as f64;
    assert!(share <= tolerances::DIFFERENT_DECISIONS, "{decisions} of {rows} rows were decided differently");
    all.assert_little_is_disputed("variety");
}

/// What connections weigh at most is what their twins say, too.
#[test]
fn every_stage_agrees_with_its_twin_where_roulette_comes_before_weights() {
    let mut all = Log::default();
    for (name, frame) in variety_and_clouds([16, 16]) {
        let frame = Frame { roulette: 0.2, ..frame };
        if frame.plays_before_weights() {
            let log = check(&frame, 128, [16, 16], 1);
            assert_clean(&name, &log);
            all.merge(log);
        }
    }
    assert!(all.rows > 100_000, "only {} rows were compared", all.rows);
    all.assert_little_is_disputed("roulette before weights");
}

#[test]
fn every_stage_agrees_with_its_twin_for_every_tail_length() {
    let mut all = Log::default();
    for paths in 1..=17 {
        for (name, frame) in frames::variety([paths, 1]) {
            let log = check(&frame, 24, [paths, 1], 1);
            assert_clean(&format!("{name}, {paths} paths"), &log);
            all.merge(log);
        }
    }
    let Log { rows, decisions, .. } = all;
    assert!(decisions <= 5, "{decisions} of {rows} rows were decided differently");
    all.assert_little_is_disputed("tails");
}

#[test]
fn paths_without_room_for_what_a_technique_inserts_do_without() {
    for segments in 1..=3 {
        for active in Active::ALL {
            let frame = frames::with_length(&frames::fog_facing(0.0, 0.6, [8, 8]), segments);
            let log = check(&frames::with_techniques(&frame, active, 4.0), 24, [8, 8], 4);
            assert_clean(&format!("{active:?} in paths of {segments} segments"), &log);
        }
    }
}

/// The radiance of every pixel's first sample, by the wavefront.
fn first_samples(frame: &Frame, pipeline: &Pipeline, lanes: usize, size: [u32; 2]) -> Vec<[f64; 3]> {
    render_here(frame, pipeline, lanes, size, 1).pixels().map(|pixel| pixel.mean).collect()
}

#[test]
fn whole_paths_agree_with_the_scalar_integrator_pixel_by_pixel() {
    let size = [48, 48];
    for (name, frame) in frames::variety(size) {
        let found = first_samples(&frame, &SIMD, 512, size);
        let mut apart = Vec::new();
        let (mut sum, mut sum_twin) = (0.0, 0.0);
        for (pixel, kernel) in (0..).zip(found) {
            let twin = reference::radiance(&frame, pixel, 0);
            (sum, sum_twin) = (sum + kernel[1], sum_twin + twin[1]);
            let allowed = |x: f64| tolerances::RADIANCE.absolute + tolerances::RADIANCE.relative * x;
            if (0..3).any(|c| (kernel[c] - twin[c]).abs() > allowed(kernel[c].max(twin[c]))) {
                apart.push((pixel, kernel, twin));
            }
        }
        let share = apart.len() as f64 / f64::from(size[0] * size[1]);
        assert!(
            share <= tolerances::DIFFERENT_PATHS,
            "{name}: {} pixels are apart, among them {:?}",
            apart.len(),
            &apart[..3]
        );
        assert!(sum > 0.0 && sum_twin > 0.0, "{name}: nothing was found");
    }
}

/// Also where the last stretch of rows is a single batch, and where there is nothing but that.
#[test]
fn the_widest_registers_change_no_bit() {
    if Avx512::detect().is_none() {
        not_run("this processor has no AVX-512: there is nothing wider than eight rows");
    }
    let size = [24, 24];
    for (name, frame) in frames::variety(size) {
        for lanes in [8, 136] {
            let (eight, widest) =
                (first_samples(&frame, &SIMD, lanes, size), first_samples(&frame, &WIDEST, lanes, size));
            assert!(eight == widest, "{name}, {lanes} lanes: another image");
        }
    }
}

/// Where triangles lie in few planes, rays look for these row by row, and wait by the plane.
#[test]
fn rays_among_few_planes_meet_what_they_meet_eight_at_a_time() {
    let size = [24, 24];
    let by_eight = Pipeline { extend: extend::simd::run_by_eight, ..SIMD };
    let mut flat = 0;
    for (name, frame) in frames::variety(size) {
        flat += usize::from(!frame.surfaces.geometry().tree().facets.is_empty());
        for lanes in [8, 136] {
            let [eight, rows] = [&by_eight, &SIMD].map(|pipeline| first_samples(&frame, pipeline, lanes, size));
            assert!(eight == rows, "{name}, {lanes} lanes: another image");
        }
    }
    assert!(flat > 1, "{flat} scenes have few planes");
}

/// Nobody asks whether the disks of a wall hide each other, but the scalar integrator does.
#[test]
fn lights_that_hide_nothing_are_never_hidden() {
    for (side, turned) in [(3, 0.0), (3, 1.0), (12, 0.0), (12, 1.0)] {
        let frame = frames::wall_of_lights(side, turned, [16, 16]);
        assert_eq!(frame.lights.are_clear(), turned == 0.0, "{side}, {turned}");
        let found = assert_whole_paths_agree(&format!("{side} x {side} disks, turned by {turned}"), &frame);
        assert!(found > 0.0, "{side}, {turned}");
    }
}

/// Who counts what connections cost has them made through queues.
#[test]
fn connections_in_place_bring_what_they_bring_through_queues() {
    let size = [24, 24];
    for (name, frame) in frames::connected_in_place(size) {
        let found = |stats: Stats| {
            let film = Film::new(&frame, Region::whole(size[0], size[1]), 32);
            let arena = Bump::new();
            let mut wavefront = Wavefront::new_in(&arena, &frame, &SIMD, 128);
            wavefront.stats = stats;
            wavefront.render(0..8, &mut film.tile(0));
            let rows = [Stage::Nee, Stage::LightSample].map(|stage| wavefront.stats.stages[stage as usize].rows);
            let means: Vec<_> = film.pixels().map(|pixel| pixel.mean).collect();
            (means, wavefront.stats.connections, rows)
        };
        let (means, connections, [in_place, queued]) = found(Stats::new(true));
        assert!(in_place > 1000 && queued == 0, "{name}: {in_place} rows in place, {queued} in queues");
        let (expected, expected_connections, [in_place, queued]) = found(Stats::new(true).with_work());
        assert!(in_place == 0 && queued > 1000, "{name}: {in_place} rows in place, {queued} in queues");
        assert!(means == expected, "{name}: another image");
        assert_eq!(connections, expected_connections, "{name}");
    }
}

#[test]
fn media_of_any_density_leave_the_range_of_numbers_nowhere() {
    let size = [48, 48];
    for extinction in [1e-9, 1e-6, 1e6, 1e9] {
        let base = frames::three_lights(0.6, Selection::IntensityDistance, size);
        let base = frames::with_extinction(&base, extinction);
        for active in frames::Active::ALL {
            let techniques = active.techniques(&base.medium, base.lengths.max, f64::INFINITY);
            let frame = Frame { techniques, ..base.clone() };
            let (film, stats) = render(&frame, size, 0..1);
            assert_eq!(stats.dropped.count, 0, "extinction {extinction}, {active:?}: {:?}", stats.dropped.first);
            for (pixel, found) in (0..).zip(film.pixels()) {
                let twin = reference::radiance(&frame, pixel, 0)[1];
                let apart = (found.mean[1] - twin).abs();
                assert!(apart <= 1e-6 + 1e-2 * twin, "extinction {extinction}, {active:?}, pixel {pixel}: {twin}");
            }
        }
    }
}

#[test]
fn a_pipeline_of_twins_alone_renders_the_same_paths() {
    let size = [16, 16];
    for (name, frame) in frames::variety(size).into_iter().step_by(3) {
        let (kernels, twins) = (first_samples(&frame, &SIMD, 64, size), first_samples(&frame, &REFERENCE, 64, size));
        let apart = |(a, b): &(&[f64; 3], &[f64; 3])| (a[1] - b[1]).abs() > 1e-9 + 5e-3 * a[1].max(b[1]);
        let count = kernels.iter().zip(&twins).filter(apart).count();
        assert!(count <= 2, "{name}: {count} of 256 samples differ");
    }
}

#[test]
fn many_lights_are_met_and_chosen_as_one_by_one() {
    let size = [24, 24];
    for (count, selection) in [(60, Selection::IntensityDistance), (700, Selection::Uniform)] {
        let frame = frames::swarm(count, selection, size);
        assert!(frame.lights.tree().is_some());
        let (kernels, twins) = (first_samples(&frame, &SIMD, 64, size), first_samples(&frame, &REFERENCE, 64, size));
        let apart = |(a, b): &(&[f64; 3], &[f64; 3])| (a[1] - b[1]).abs() > 1e-9 + 5e-3 * a[1].max(b[1]);
        let count = kernels.iter().zip(&twins).filter(apart).count();
        assert!(count <= 4, "{selection:?}: {count} of 576 samples differ");
    }
}

#[test]
fn any_single_stage_can_be_replaced_by_its_twin() {
    let size = [16, 16];
    let frame = frames::three_lights(0.6, Selection::IntensityDistance, size);
    let kernels = first_samples(&frame, &SIMD, 64, size);
    for stage in Stage::ALL {
        let mixed = first_samples(&frame, &SIMD.with_reference(*stage), 64, size);
        let apart = |(a, b): &(&[f64; 3], &[f64; 3])| (a[1] - b[1]).abs() > 1e-9 + 5e-3 * a[1].max(b[1]);
        let count = kernels.iter().zip(&mixed).filter(apart).count();
        assert!(count <= 2, "{}: {count} of 256 samples differ", stage.name());
    }
}

/// Fills every real column with NaN, and every index column with indices that are valid but senseless.
fn poison(wavefront: &mut Wavefront<'_>, lanes: u32) {
    use fogbow_kernels::columns::{ColumnMut, ColumnSet};
    let mut fill = |_: &'static str, column: ColumnMut<'_>| match column {
        ColumnMut::F32(values) => values.fill(f32::NAN),
        ColumnMut::U32(values) => values.iter_mut().enumerate().for_each(|(i, v)| *v = (i as u32 * 7) % lanes),
    };
    let w = wavefront;
    let tables: [&mut dyn ColumnSet; 12] = [
        &mut w.paths,
        &mut w.immersion,
        &mut w.log_posterior,
        &mut w.last_surface,
        &mut w.outlook,
        &mut w.throughput,
        &mut w.radiance,
        &mut w.flights,
        &mut w.flight_density,
        &mut w.hits,
        &mut w.worth,
        &mut w.estimates,
    ];
    tables.into_iter().for_each(|table| table.visit_mut(&mut fill));
    w.passages.iter_mut().for_each(|passage| passage.visit_mut(&mut fill));
    w.flight_weight.rows_mut().fill(f32::NAN);
    (0..w.vertices.slots() as u32).for_each(|slot| w.vertices.at_mut(slot).visit_mut(&mut fill));
    (0..w.rays.slots() as u32).for_each(|slot| w.rays.at_mut(slot).visit_mut(&mut fill));
    let (rows, slots) = (w.trail.lanes(), w.trail.slots() as u32);
    for (lane, slot) in (0..rows).flat_map(|lane| (0..slots).map(move |slot| (lane, slot))) {
        w.trail.set_numbers(lane, slot, [f32::NAN; 8]);
    }
    for (lane, slot) in (0..rows).flat_map(|lane| (0..slots).map(move |slot| (lane, slot))) {
        w.passage_trails.iter_mut().for_each(|trail| trail.set_row(lane, slot, [f32::NAN; 2]));
    }
    let Candidates { views, light_hits, connections, bridged } = &mut w.candidates;
    for queue in [views, light_hits, connections, bridged] {
        queue.visit_mut(&mut fill);
        // One light is all that every frame has.
        queue.emitter.rows_mut().fill(0);
    }
    w.hits.emitter.rows_mut().fill(0);
    for vertex in w.chains.vertices.iter_mut() {
        vertex.channels_mut().into_iter().for_each(|channel| channel.rows_mut().fill(f32::NAN));
    }
}

/// Frames that visit every branch, those of grids included.
fn variety_and_clouds(size: [u32; 2]) -> Vec<(String, Frame)> {
    let clouds = frames::clouds::clouds(size).into_iter().flat_map(|(name, cloud)| {
        frames::clouds::IN_FIELDS
            .map(|active| (format!("{name}, {active:?}"), frames::with_techniques(&cloud, active, 4.0)))
    });
    let under_skies = frames::skies::clouds(size).into_iter().zip(frames::clouds::IN_FIELDS.into_iter().cycle());
    let under_skies = under_skies
        .map(|((name, cloud), active)| (format!("{name}, {active:?}"), frames::with_techniques(&cloud, active, 4.0)));
    let coloured = frames::clouds::colours(size).into_iter().flat_map(|colours| {
        let of =
            |active| (format!("{}, {active:?}", colours.name), frames::with_techniques(&colours.frame, active, 4.0));
        [Active::Path, Active::Both, Active::Bridge, Active::Lis, Active::Omnee].map(of)
    });
    frames::variety(size).into_iter().chain(clouds).chain(under_skies).chain(coloured).collect()
}

#[test]
fn dead_lanes_are_silent() {
    for paths in [1, 5, 8, 13, 17] {
        let size = [paths, 1];
        for (name, frame) in variety_and_clouds(size) {
            let clean = first_samples(&frame, &SIMD, 40, size);
            let arena = Bump::new();
            let mut wavefront = Wavefront::new_in(&arena, &frame, &SIMD, 40);
            poison(&mut wavefront, 40);
            let film = Film::new(&frame, Region::whole(paths, 1), 32);
            wavefront.stats = Stats::new(true);
            wavefront.render(0..1, &mut film.tile(0));
            let poisoned: Vec<_> = film.pixels().map(|pixel| pixel.mean).collect();
            assert_eq!(clean, poisoned, "{name}, {paths} paths");
            assert_eq!(wavefront.stats.dropped.count, 0, "{name}: NaN was counted");
        }
    }
}

#[test]
fn a_sample_does_not_depend_on_its_lane() {
    for (name, frame) in variety_and_clouds([23, 3]) {
        let alone = first_samples(&frame, &SIMD, 8, [23, 3]);
        for lanes in [16, 64, 200] {
            assert_eq!(alone, first_samples(&frame, &SIMD, lanes, [23, 3]), "{name}, {lanes} lanes");
        }
    }
}
