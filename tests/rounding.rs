//! Weights where single precision does not tell what a connection was like: which of two vertices came first, whether one
//! went on or back, how far it is from an axis; and where densities are beyond all numbers, or lengths short next to others.

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::lis::{Connector, Lis};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset};
use fogbow_kernels::media::Medium;
use fogbow_kernels::mis_weight;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::agreement::means;
use fogbow_testing::frames;
use fogbow_testing::frames::clouds::{IN_FIELDS, ball, with_volumes};
use fogbow_testing::weighing::{Made, Weigher};
use glam::DVec3;

/// Weights, by the kernel and by its twin, of a path that `techniques` made through `medium`, by these inserted
/// vertices between its start at 0 and a lamp somewhere that faces somewhere.
fn weights_of(medium: &Medium, [lamp, facing]: [DVec3; 2], techniques: &Techniques, inserted: &[DVec3]) -> [f64; 2] {
    let lights = Lights::new(vec![Emitter::disk(lamp, facing, 0.5, [1.0; 3])], Selection::Uniform);
    let path = [&[-10.0 * DVec3::Z, DVec3::ZERO], inserted, &[lamp]].concat();
    let made = Made { vertices: &path, inserted: inserted.len(), first_start: 1, emitter: 0 };
    [mis_weight::simd::run, mis_weight::reference::run]
        .map(|kernel| Weigher::new(kernel, medium, &lights, techniques).weight(&made, 3))
}

/// The same of a lamp 200 m away.
fn weights_far_away(extinction: f32, facing: DVec3, techniques: &Techniques, inserted: &[DVec3]) -> [f64; 2] {
    weights_of(&thin_fog(extinction), [200.0 * DVec3::Z, facing], techniques, inserted)
}

fn thin_fog(extinction: f32) -> Medium {
    Medium::homogeneous(extinction, [1.0; 3], PhaseFunction::henyey_greenstein(0.4))
}

/// The same by MVNEE alone.
fn weights_by_mvnee(extinction: f32, offset: Offset, inserted: &[DVec3]) -> [f64; 2] {
    let medium = thin_fog(extinction);
    let mvnee = Some(Mvnee::new(&medium, f64::INFINITY, offset));
    weights_far_away(extinction, DVec3::NEG_Z, &Techniques { mvnee, ..Techniques::default() }, inserted)
}

/// Detours by long edges, of which densities of offsets and of walks are beyond the range of f32, and quotients are not.
#[test]
fn detours_of_mvnee_are_weighed_however_long_they_are() {
    for (extinction, offset, across) in [
        (0.02, Offset::Ggx, [60.0, 120.0, 180.0]),
        (0.02, Offset::Gaussian, [60.0, 150.0, 300.0]),
        (0.05, Offset::Gaussian, [60.0, 150.0, 300.0]),
        (0.1, Offset::Gaussian, [60.0, 90.0, 210.0]),
    ] {
        for across in across {
            let around =
                |i: u32| DVec3::new(across * f64::from(i).cos(), across * f64::from(i).sin(), 25.0 * f64::from(i));
            let inserted: Vec<DVec3> = (1..8).map(around).collect();
            let [kernel, twin] = weights_by_mvnee(extinction, offset, &inserted);
            let name = format!("{offset:?}, extinction {extinction}, {across} m off the axis");
            assert!((1e-35..0.1).contains(&twin), "{name}: {twin:e}");
            assert!((kernel / twin - 1.0).abs() < 2e-4, "{name}: {kernel:e}, should be {twin:e}");
        }
    }
}

/// Positions are rounded: which of two seeds at a distance of 100 m comes first is not known to 1e-5 m.
#[test]
fn seeds_that_are_too_close_for_their_order_to_be_known_count_as_in_order() {
    let weights = |step: f64| {
        let at = |i: u32| DVec3::new(20.0 * f64::from(i).cos(), 20.0 * f64::from(i).sin(), 25.0 * f64::from(i));
        let mut inserted: Vec<DVec3> = (1..8).map(at).collect();
        inserted[4].z = inserted[3].z + step;
        weights_by_mvnee(0.05, Offset::Ggx, &inserted)
    };
    let [expected, _] = weights(1e-3);
    assert!(expected < 1e-5, "{expected:e}");
    for step in [-4e-5, -1e-5, 0.0, 1e-5, 4e-5] {
        for weight in weights(step) {
            assert!((weight / expected - 1.0).abs() < 1e-3, "{step} m: {weight:e}, should be {expected:e}");
        }
    }
    // Chains that turn back are made from vertices behind that alone.
    let [back, back_twin] = weights(-0.1);
    assert!(back > 3.0 * expected && (back / back_twin - 1.0).abs() < 1e-3, "{back:e} and {back_twin:e}");
}

/// The last seed may be nearer to the light than rounding tells: its offset from the axis is that of rounding, however
/// small its width.
#[test]
fn seeds_that_are_too_close_to_the_light_are_weighed_like_those_that_are_a_little_further() {
    for offset in [Offset::Ggx, Offset::Gaussian] {
        let weights = |along: f64, across: f64| {
            let at = |i: u32| DVec3::new(20.0 * f64::from(i).cos(), 20.0 * f64::from(i).sin(), 25.0 * f64::from(i));
            let inserted: Vec<DVec3> = (1..8).map(at).chain([DVec3::new(across, 0.0, 200.0 - along)]).collect();
            weights_by_mvnee(0.05, offset, &inserted)
        };
        let [little, _] = weights(1e-3, 4e-4);
        assert!(little < 1e-5, "{offset:?}: {little:e}");
        for (along, across) in [-4e-5, -1e-5, 0.0, 1e-5, 4e-5].into_iter().flat_map(|z| [(z, 6e-6), (z, 2e-5)]) {
            for weight in weights(along, across) {
                assert!(weight < 1e-3, "{offset:?}, {along} and {across} m away: {weight:e}, about {little:e}");
            }
        }
    }
}

/// The same of a vertex next to the light: rounding decides where from the light arrives.
#[test]
fn a_vertex_that_is_too_close_to_the_light_for_its_turn_to_be_known_counts_as_turning_forward() {
    let omnee = Techniques { omnee: true, ..Techniques::default() };
    let weights = |away: DVec3| weights_far_away(0.15, DVec3::X, &omnee, &[200.0 * DVec3::Z + away]);
    let [expected, _] = weights(DVec3::new(3e-5, 0.0, -2e-5));
    assert!(expected < 1e-6, "{expected:e}");
    for along in [0.0, 2e-5, 4e-5] {
        for weight in weights(DVec3::new(3e-5, 0.0, along)) {
            assert!((0.1..10.0).contains(&(weight / expected)), "{along} m: {weight:e}, about {expected:e}");
        }
    }
    assert!(weights(DVec3::new(3.0, 0.0, 0.1)).into_iter().all(|weight| weight == 1.0), "OMNEE does not turn back");
}

/// What is short next to the way to the lamp is not lost: lengths between vertices are added up without it.
#[test]
fn connections_to_a_vertex_made_from_the_light_are_weighed_however_far_away_that_is() {
    let medium = thin_fog(1e-6);
    let lis = Some(Lis::new(&medium, Connector::Bridge(Bridge::new(Roll::Aligned, &medium, 32))));
    let techniques = Techniques { lis, ..Techniques::default() };
    let inserted = [DVec3::new(0.1, 0.0, 0.2), DVec3::new(0.2, 0.1, 0.45), DVec3::new(0.1, 0.2, 0.7)];
    for away in [1e2, 1e4, 1e5, 1e6] {
        let [kernel, twin] = weights_of(&medium, [away * DVec3::Z, DVec3::NEG_Z], &techniques, &inserted);
        assert!(twin > 0.0 && twin < 0.5, "{away} m: {twin:e}");
        assert!((kernel / twin - 1.0).abs() < 1e-3, "{away} m: {kernel:e}, should be {twin:e}");
    }
}

/// Whatever is small in one unit is large in another: extinctions per micron or so, lamps of next to no area. Walks end, so
/// that batches hold paths of all lengths: what one has no vertices for must not matter however large it is.
#[test]
fn no_unit_of_length_matters_among_volumes() {
    let in_unit = |unit: f64| {
        let room = frames::lamps(unit, 0.6, Selection::IntensityDistance, [16, 16]);
        let dense = |x: f64, radius: f64| ball(unit * DVec3::new(x, 0.9, 1.0), unit * radius, (3.0 / unit) as f32);
        with_volumes(&room, vec![dense(-0.4, 0.4), dense(0.3, 0.3)], (0.3 / unit) as f32).with_walk(u32::MAX, 0.9)
    };
    let [metre, micron] = [1.0, (-20_f64).exp2()].map(in_unit);
    for active in IN_FIELDS {
        let [truth, found] = [&metre, &micron].map(|frame| means(&frames::with_techniques(frame, active, 4.0), 200));
        for ((truth, _), (found, _)) in truth.into_iter().zip(found) {
            assert!((found / truth - 1.0).abs() < 1e-3, "{active:?}: {found} in microns, {truth} in metres");
        }
    }
}
