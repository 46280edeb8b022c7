//! Extinction that differs from place to place: flights are tracked and transmittances estimated, and images are as they
//! must be.

use core::f64::consts::PI;
use core::iter;

use bumpalo::Bump;
use fogbow::film::aov::Origin;
use fogbow::frame::Frame;
use fogbow::wavefront::{Source, Wavefront};
use fogbow_kernels::PathLengths;
use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::{Technique, nee};
use fogbow_kernels::media::Medium;
use fogbow_kernels::media::field::reference::FieldTwin;
use fogbow_kernels::media::field::{Field, Interpolation, Shape, Voxels};
use fogbow_kernels::media::reference::Medium as _;
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::phase::{HenyeyGreenstein, PhaseFunction};
use fogbow_kernels::pipeline::{Pipeline, REFERENCE, SIMD};
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::agreement::{
    assert_equal_means, assert_equal_means_in, assert_same, assert_same_of, assert_same_on_all_workers,
    assert_stages_agree, assert_whole_paths_agree, means,
};
use fogbow_testing::frames::clouds::{
    IN_FIELDS, ball, centred, cloud, clouds, leaves, solid, volumes, with_field, with_volumes,
};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::quadrature::henyey_greenstein;
use fogbow_testing::recorded::wavefront;
use fogbow_testing::render::{WORKERS, render_here, render_with};
use fogbow_testing::statistics::z_of_means;
use fogbow_testing::suite::{IS_LONG, half, some};
use glam::DVec3;

/// All that varies, and a block of equal voxels, in which most of what paths come to is even.
fn all() -> impl Iterator<Item = (&'static str, Frame)> {
    let voxels = Voxels::new(&leaves(4, |_| 1.0), &centred(32, 6.0, DVec3::Z), Interpolation::Trilinear);
    let lights = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let block = with_field(&lights, Field::grid(voxels, 1.5));
    clouds(SMALL).into_iter().chain(volumes(SMALL)).chain([("block of voxels among lights", block)])
}

const SMALL: [u32; 2] = [16, 16];

#[test]
fn every_stage_agrees_with_its_twin() {
    for (name, cloud) in all() {
        assert_stages_agree(name, IN_FIELDS.map(|active| frames::with_techniques(&cloud, active, 4.0)).into_iter(), 8);
    }
}

#[test]
fn whole_paths_agree_with_the_scalar_integrator() {
    for (name, cloud) in all() {
        for active in IN_FIELDS {
            let frame = frames::with_techniques(&cloud, active, 4.0);
            assert!(assert_whole_paths_agree(&format!("{name}, {active:?}"), &frame) > 0.0, "{name}, {active:?}");
        }
    }
}

#[test]
fn a_pipeline_of_twins_renders_the_same_paths() {
    for (name, cloud) in all() {
        let frame = frames::with_techniques(&cloud, Active::Every, 4.0);
        let [kernels, twins] = [SIMD, REFERENCE].map(|pipeline| render_here(&frame, &pipeline, 64, SMALL, 1));
        let pairs = kernels.pixels().zip(twins.pixels());
        let apart = pairs.filter(|(a, b)| (a.mean[1] - b.mean[1]).abs() > 1e-6 + 2e-2 * b.mean[1]).count();
        assert!(apart <= 3, "{name}: {apart} of 256 samples are apart");
    }
}

/// A wavefront among whose weighed straight connections the first counts nothing.
fn with_weighed_connections<'q>(arena: &'q Bump, frame: &'q Frame, pipeline: Pipeline) -> (Wavefront<'q>, Bucket) {
    let mut w = wavefront(arena, frame, 256, 2);
    w.pipeline = pipeline;
    w.light_sample(nee::SCOPE);
    let bucket = w.candidates.connections.direct();
    w.mis_weight(Competing::All, Source::Connections, bucket);
    w.worth.weight.rows_mut()[0] = 0.0;
    (w, bucket)
}

#[test]
fn what_counts_nothing_is_not_estimated() {
    let [(_, cloud), _] = clouds([256, 256]);
    let frame = frames::with_techniques(&cloud, Active::Nee, 4.0);
    for pipeline in [SIMD, REFERENCE] {
        let arena = Bump::new();
        let (mut w, bucket) = with_weighed_connections(&arena, &frame, pipeline);
        (0..256).for_each(|row| w.estimates.product.set_row(row, [f32::NAN; 3]));
        let before = w.worth.factor.row(0);
        w.transmittance(Source::Connections, bucket, nee::SCOPE.purpose);
        assert_eq!(w.worth.factor.row(0), before);
        assert!(bucket.rows().all(|row| w.worth.factor.row(row)[0].is_finite()));
    }
}

#[test]
fn factors_beyond_all_numbers_are_dropped_and_counted() {
    let [(_, cloud), _] = clouds([256, 256]);
    let frame = frames::with_techniques(&cloud, Active::Nee, 4.0);
    for pipeline in [SIMD, REFERENCE] {
        let arena = Bump::new();
        let (mut w, bucket) = with_weighed_connections(&arena, &frame, pipeline);
        let weighs = |row: &usize| w.worth.weight.rows()[*row] > 0.0;
        let row = bucket.rows().find(weighs).expect("some connection counts");
        w.worth.factor.set_row(row, [1.0, f32::INFINITY, 1.0]);
        w.accumulate(Origin::Connection(Technique::Nee), Source::Connections, bucket);
        assert_eq!(w.stats.dropped.count, 1);
        assert!(w.radiance.channels().iter().all(|channel| channel.rows().iter().all(|x| x.is_finite())));
    }
}

#[test]
fn images_do_not_depend_on_threads_or_lanes() {
    for (name, cloud) in all() {
        let frame = frames::with_techniques(&cloud, Active::Every, 4.0);
        assert_same_on_all_workers(name, &frame);
    }
}

#[test]
fn all_techniques_have_the_same_means_at_short_lengths() {
    for (turn, (name, frame)) in clouds(SMALL).into_iter().chain(volumes(SMALL)).enumerate() {
        some(2..=3, turn, 2).for_each(|segments| assert_equal_means(name, &frame, segments..=segments));
    }
}

/// Majorants, means and the size of cells are our own affair. On long paths through means that are twice too large, what
/// `lis` counts has tails of which so few samples say little: it goes along as far as four segments.
#[test]
fn the_coarse_field_changes_no_mean() {
    const KINDS: [(u32, &[Active]); 2] = [(u32::MAX, &[Active::Both, Active::Bridge]), (4, &[Active::Lis])];
    let kinds =
        |(turn, base): (usize, (&'static str, Frame))| some(KINDS, turn, 2).map(move |kind| (base.clone(), kind));
    for (turn, ((name, base), (longest, techniques))) in all().enumerate().flat_map(kinds).enumerate() {
        let max = base.lengths.max.min(longest);
        let base = Frame { lengths: PathLengths { max, ..base.lengths }, ..base };
        let grid = base.medium.field().expect("a cloud").clone();
        let truth = means(&Frame { seed: 77, ..frames::with_techniques(&base, Active::Nee, 4.0) }, half(3200));
        let changes = [
            ("majorants doubled", (3, 2.0, 1.0)),
            ("means halved", (2, 1.0, 0.5)),
            ("means doubled", (3, 1.0, 2.0)),
            ("larger cells", (5, 1.0, 1.0)),
        ];
        for (change, (log_side, factor, mean)) in some(changes, turn / 2, 4) {
            let other = grid.clone().with_cells(log_side, factor, mean);
            for active in techniques.iter().copied() {
                let frame = frames::with_techniques(&with_field(&base, other.clone()), active, 4.0);
                assert_same_of(active, &format!("{name}, {change}"), means(&frame, half(1000)), truth);
            }
        }
    }
}

/// What stands for the phase functions of several media in connections and weights is our own affair, too.
#[test]
fn the_stand_in_of_phase_functions_changes_no_mean() {
    let (name, base) =
        volumes(SMALL).into_iter().find(|(_, frame)| frame.medium.phases.is_some()).expect("one of them");
    let truth = means(&Frame { seed: 77, ..frames::with_techniques(&base, Active::Path, 4.0) }, half(6000));
    let one_of_them = base.medium.all_phases()[1].clone();
    let stand_ins = [base.medium.phase.clone(), one_of_them, PhaseFunction::henyey_greenstein(-0.2)];
    for (turn, stand_in) in stand_ins.into_iter().enumerate() {
        let changed = frames::with_medium(&base, Medium { phase: stand_in.clone(), ..base.medium.clone() });
        for active in some([Active::Nee, Active::Mvnee, Active::Omnee, Active::Bridge], turn, 2) {
            let frame = frames::with_techniques(&changed, active, 4.0);
            assert_same(&format!("{name}, {stand_in:?}, {active:?}"), means(&frame, half(1500)), truth);
        }
    }
}

/// Light that is scattered once, by either of two boxes of another phase function, on its way from a small lamp beside
/// them: by quadrature.
#[test]
fn every_volume_scatters_by_its_own_phase_function() {
    let (lamp, radius, radiance) = (DVec3::new(1.7, 0.3, 1.2), 0.02, 1e4);
    let boxes = [(0.5, 1.5, 1.0, 0.8), (1.5, 2.5, 0.6, -0.5)];
    let depth = |from: DVec3, to: DVec3| {
        const STEPS: i32 = 2000;
        let within = |at: DVec3| {
            let is_in = |(near, far, ..): &&(f64, f64, f64, f64)| (*near..*far).contains(&at.z) && at.x.abs() < 1.0;
            boxes.iter().find(is_in).map_or(0.0, |found| found.2)
        };
        let at = |i: i32| from.lerp(to, (f64::from(i) + 0.5) / f64::from(STEPS));
        (0..STEPS).map(|i| within(at(i))).sum::<f64>() / f64::from(STEPS) * from.distance(to)
    };
    let [mut expected, steps] = [0.0, 400.0];
    for (near, far, extinction, g) in boxes {
        for i in 0..steps as u32 {
            let at = DVec3::Z * (near + (far - near) * (f64::from(i) + 0.5) / steps);
            let (way, through) = (lamp - at, (-depth(DVec3::ZERO, at) - depth(at, lamp)).exp());
            let covered = 2.0 * PI * (1.0 - (1.0 - radius * radius / way.length_squared()).sqrt());
            let scattered = extinction * henyey_greenstein(g, way.normalize().z) * (far - near) / steps;
            expected += radiance * covered * scattered * through;
        }
    }
    let lights = Lights::new(vec![Emitter::sphere(lamp, radius, [radiance; 3])], Selection::Uniform);
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1e-3, 0.0, SMALL);
    let volumes = boxes.map(|(near, far, extinction, _)| {
        solid(Shape::block([[-1.0, -1.0, near], [1.0, 1.0, far]]), extinction as f32)
    });
    let phases = [0.0, 0.8, -0.5].map(PhaseFunction::henyey_greenstein);
    let medium = Medium::of_field(Field::new(volumes.into(), 0.0), [1.0; 3], PhaseFunction::isotropic());
    let frame = frames::plain(camera, medium.with_phases(&phases), lights, 2, 5);
    let frame = Frame { lengths: PathLengths { min: 2, max: 2 }, ..frame };
    for active in [Active::Nee, Active::Mvnee, Active::Bridge] {
        let [(mean, error), ..] = means(&frames::with_techniques(&frame, active, 4.0), 4000);
        assert!(
            (mean - expected).abs() < 4.5 * error + 1e-3 * expected,
            "{active:?}: {mean} +- {error}, not {expected}"
        );
        assert!(error < 0.01 * expected, "{active:?}: {mean} +- {error}");
    }
}

/// Hundreds of mean free paths across: what comes out of a ball is known to the techniques, and what comes out of voxels
/// is estimated without numbers that are none.
#[test]
fn dense_volumes_have_the_same_means_and_lose_nothing() {
    // A lamp so large that path tracing, too, comes upon it.
    let lamp = Emitter::disk(DVec3::new(0.0, 0.0, -0.5), DVec3::Z, 3.0, [1.0, 2.0, 3.0]);
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, frames::UNIT_FOV, 0.1, SMALL);
    let medium = Medium::homogeneous(1.0, [0.9, 0.8, 0.7], PhaseFunction::henyey_greenstein(0.6));
    let before_a_lamp = frames::plain(camera, medium, Lights::new(vec![lamp], Selection::Uniform), 9, 1);
    let center = DVec3::new(0.1, 0.0, 1.6);
    let solid = Voxels::new(&leaves(3, |_| 1.0), &centred(24, 1.4, center), Interpolation::Trilinear);
    for (name, field) in [
        ("ball", Field::new(vec![ball(center, 0.6, 400.0)], 0.0)),
        ("ball in fog", Field::new(vec![ball(center, 0.6, 400.0)], 0.4)),
        ("block of voxels", Field::grid(solid, 300.0)),
        ("cloud", cloud(2.0, center, 600.0, Interpolation::Trilinear)),
    ] {
        let frame = with_field(&before_a_lamp, field);
        let mean =
            |active: Active, seed: u32| means(&Frame { seed, ..frames::with_techniques(&frame, active, 4.0) }, 600);
        let truth = mean(Active::Nee, 1);
        // Bridges are a matter of luck where densities fade out within a few voxels.
        let bridges = if frame.medium.field().is_some_and(Field::is_known) { &[Active::Bridge][..] } else { &[] };
        for active in [Active::Path, Active::Mvnee].iter().chain(bridges) {
            assert_same(&format!("{name}, {active:?}"), mean(*active, 2), truth);
        }
    }
}

/// A grid of one density, so large that light from beyond it does not matter, is fog; and not noisier.
#[test]
fn a_constant_grid_is_fog() {
    let fog = frames::fog_facing(0.0, 0.6, SMALL);
    let everywhere = leaves(4, |_| 0.5);
    let grid =
        Field::grid(Voxels::new(&everywhere, &centred(32, 60.0, DVec3::ZERO), Interpolation::Nearest), 2.0 * 1.7);
    let grey = with_field(&fog, grid.clone());
    // Bounds that are too large, and means that are not those of the voxels: nothing is even, and flights are tracked.
    let tracked = with_field(&fog, grid.with_cells(3, 1.5, 0.9));
    // A twentieth, and what few samples leave open.
    let (samples, off) = if IS_LONG { (8000, 0.05) } else { (2000, 0.07) };
    for active in IN_FIELDS {
        let [fog, grid] = [&fog, &grey].map(|frame| {
            let mut frame = frames::with_techniques(frame, active, 4.0);
            // In a field the companion has no limit.
            frame.techniques.lis.iter_mut().for_each(|lis| lis.near = f32::INFINITY);
            means(&frame, samples)
        });
        assert_same(&format!("{active:?}"), grid, fog);
        let variance = (grid[1].1 / fog[1].1).powi(2);
        // Vertices from the light that MVNEE joins owe most of their variance to few paths: it differs more from seed to
        // seed.
        assert!(
            active == Active::LisMvnee || (variance - 1.0).abs() < off,
            "{active:?}: {variance} of the variance of fog"
        );
        if IS_LONG || [Active::Path, Active::Nee, Active::MvneeFast, Active::Bridge].contains(&active) {
            let tracked = means(&frames::with_techniques(&tracked, active, 4.0), samples / 2);
            assert_same_of(active, &format!("{active:?}, tracked"), tracked, fog);
        }
    }
}

/// From beyond 40 mean free paths no light comes back to camera and lamps in 8 segments; what comes back from beyond 1.2
/// is missed.
#[test]
fn a_ball_that_grows_becomes_fog() {
    let extinction = 1.2;
    let medium = Medium::homogeneous(extinction, [1.0, 0.98, 0.9], PhaseFunction::henyey_greenstein(0.3));
    let lamps = vec![
        Emitter::sphere(DVec3::new(0.2, 0.1, 0.6), 0.15, [10.0, 9.0, 8.0]),
        Emitter::disk(DVec3::new(-0.3, -0.1, 0.5), DVec3::new(0.2, 0.5, 1.0), 0.2, [5.0, 6.0, 9.0]),
    ];
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, frames::UNIT_FOV, 0.1, SMALL);
    let fog = frames::plain(camera, medium, Lights::new(lamps, Selection::Uniform), 8, 3);
    let fog = Frame { lengths: PathLengths { min: 2, max: 8 }, ..fog };
    let truth = means(&Frame { seed: 99, ..frames::with_techniques(&fog, Active::Nee, 4.0) }, 3000);
    let [small, large] = [1.2, 40.0].map(|mean_free_paths| {
        let radius = mean_free_paths / f64::from(extinction);
        with_volumes(&fog, vec![ball(DVec3::ZERO, radius, extinction)], 0.0)
    });
    for active in IN_FIELDS {
        let [small, large] = [&small, &large].map(|frame| means(&frames::with_techniques(frame, active, 4.0), 1500));
        assert_same(&format!("{active:?}"), large, truth);
        for (small, truth) in small.into_iter().zip(truth) {
            let z = z_of_means(small, truth);
            assert!(z < -8.0, "{active:?}: {small:?} in a small ball, {truth:?} in fog, z = {z}");
        }
    }
}

/// A medium in two volumes, which nest or overlap, is as it is in one; borders between equal media do nothing.
#[test]
fn equal_media_are_one() {
    let lights = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let filled = |shapes: &[&Shape]| {
        let volumes = shapes.iter().map(|shape| solid((*shape).clone(), 1.6)).collect();
        let frame = with_volumes(&lights, volumes, 0.0);
        let albedos: Vec<_> = iter::once([0.1; 3]).chain(shapes.iter().map(|_| [0.9, 0.75, 0.5])).collect();
        frames::with_medium(&frame, frame.medium.clone().with_albedos(&albedos))
    };
    for (place, from) in [("outside", 0.3), ("inside", -0.9)] {
        let ball = Shape::Sphere { center: DVec3::new(0.1, 0.0, from + 1.3), radius: 1.3 };
        let within = Shape::block([[-0.4, -0.5, from + 0.8], [0.9, 0.3, from + 1.9]]);
        let block = |near: f64, far: f64| Shape::block([[-1.1, -0.7, from + near], [0.8, 0.9, from + far]]);
        let [front, back, both] = [block(0.0, 1.6), block(0.9, 2.4), block(0.0, 2.4)];
        for (name, several, one) in [
            ("a box in a ball", filled(&[&within, &ball]), filled(&[&ball])),
            ("overlapping boxes", filled(&[&front, &back]), filled(&[&both])),
        ] {
            assert_equal_means_in(&format!("{name}, {place}"), &several, &one, 2..=3);
        }
    }
}

/// A ball with some of the lights within, some in the fog around it.
#[test]
fn a_ball_of_fog_in_fog_is_fog() {
    let fog = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let in_ball = with_volumes(&fog, vec![ball(DVec3::new(0.1, 0.0, 0.6), 1.3, 1.2)], 1.2);
    assert_equal_means_in("a ball in fog", &in_ball, &fog, 1..=3);
}

/// A box with a lamp behind it has the transmittance of its thickness, without noise.
#[test]
fn lamps_behind_a_box_have_its_transmittance() {
    let lamp = Emitter::disk(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z, 2.0, [5.0; 3]);
    for (near, far) in [(0.5, 2.0), (-1.0, 2.0), (-1.0, 7.0)] {
        let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1e-3, 0.0, [4, 4]);
        let grid = Field::block([[-3.0, -2.0, near], [4.0, 2.5, far]], 0.7);
        let medium = Medium::of_field(grid, [0.0; 3], PhaseFunction::isotropic());
        let frame = frames::plain(camera, medium, Lights::new(vec![lamp], Selection::Uniform), 4, 1);
        let expected = 5.0 * (-0.7 * (far.min(3.0) - f64::max(near, 0.0))).exp();
        for pipeline in [SIMD, REFERENCE] {
            let (film, _) = render_with(&frame, &pipeline, WORKERS, [4, 4], 32, 0..8);
            let off = film.pixels().map(|pixel| (pixel.mean[0] / expected - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-5, "{near} to {far}: {off}");
        }
    }
}

/// Lights and a room with a box of fog in the middle of it, whether paths start inside or outside.
#[test]
fn all_techniques_have_the_same_means_around_a_box() {
    let lights = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let room = frames::room(0.5, Selection::IntensityDistance, SMALL);
    let inside = Field::block([[-0.7, -0.6, -0.5], [0.9, 0.5, 2.1]], 1.5);
    let outside = Field::block([[-0.5, 0.2, 0.8], [0.6, 1.6, 2.0]], 3.0);
    for (name, base) in [("inside", with_field(&lights, inside)), ("outside", with_field(&room, outside))] {
        assert_equal_means(name, &base, 2..=3);
    }
}

/// A lamp behind a cloud that only absorbs: the transmittance of the cloud, by quadrature.
#[test]
fn lamps_behind_a_cloud_have_its_transmittance() {
    let lamp = Emitter::disk(DVec3::new(0.1, 0.05, 3.0), -DVec3::Z, 0.6, [5.0; 3]);
    let camera = Camera::new(DVec3::new(0.0, 0.0, -3.0), DVec3::Z, DVec3::Y, 0.05, 0.0, [1, 1]);
    for (extinction, interpolation) in [(3.0, Interpolation::Trilinear), (8.0, Interpolation::Nearest)] {
        let grid = cloud(3.0, DVec3::ZERO, extinction, interpolation);
        let twin = FieldTwin { field: &grid, hue: 1.0, phase: &HenyeyGreenstein { g: 0.0 } };
        let through = |x: f64, y: f64| {
            let half = (0.05_f64 / 2.0).tan();
            let way = DVec3::new(-(2.0 * x - 1.0) * half, (2.0 * y - 1.0) * half, 1.0) * 6.0;
            let steps = 4000;
            let at =
                |i: i32| twin.extinction(DVec3::new(0.0, 0.0, -3.0) + (f64::from(i) + 0.5) / f64::from(steps) * way);
            (-(0..steps).map(at).sum::<f64>() / f64::from(steps) * way.length()).exp()
        };
        let points = (0..8).flat_map(|i| (0..8).map(move |j| ((f64::from(i) + 0.5) / 8.0, (f64::from(j) + 0.5) / 8.0)));
        let expected = 5.0 * points.map(|(x, y)| through(x, y)).sum::<f64>() / 64.0;
        let medium = Medium::of_field(grid.clone(), [0.0; 3], PhaseFunction::isotropic());
        let frame = frames::plain(camera, medium, Lights::new(vec![lamp], Selection::Uniform), 4, 1);
        let (film, _) = render_with(&frame, &SIMD, WORKERS, [1, 1], 32, 0..40_000);
        let (mean, error) = film.mean();
        assert!((mean[0] - expected).abs() < 4.5 * error[0] + 2e-3 * expected, "{mean:?} +- {error:?}, not {expected}");
    }
}
