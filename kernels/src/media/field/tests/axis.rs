//! Places and depths along axes and rays.

use wide::f32x8;

use super::{grids, point, real, twin};
use crate::media::field::FieldX8;
use crate::media::reference::{Medium as _, depth_until, extinction_along, reach};
use crate::media::{AxisX8 as _, MediumX8 as _};
use crate::vec3::Vec3x8;

#[test]
fn places_on_an_axis_have_the_depth_that_leads_there() {
    let (mut apart, mut tried) = (0, 0);
    for field in grids() {
        for seed in 0..200 {
            let [from, to] = [point(seed), point(seed + 1000)];
            let length = real(from).distance(real(to));
            let direction = (real(to) - real(from)) / length;
            let eight = Vec3x8::splat;
            // Every other one is a ray, of which nothing has to be known beyond the depths that are asked for.
            let is_ray = seed % 2 == 0;
            let (mut axis, strata, length) = if is_ray {
                let ray = FieldX8::of(&field).ray(eight(from), eight(direction.as_vec3().to_array()));
                (ray, twin(&field).strata_of_ray(real(from), direction), f64::INFINITY)
            } else {
                let axis = FieldX8::of(&field).axis(eight(from), eight(to), f32x8::splat(length as f32));
                (axis, twin(&field).strata(real(from), real(to)), length)
            };
            let far = |found: f32x8, truth: f64| (f64::from(found.to_array()[0]) - truth).abs() > 2e-3 * (1.0 + truth);

            let mut place = 0.0;
            for depth in [0.1, 0.4, 0.02, 1.5] {
                let truth = reach(&strata, depth_until(&strata, place) + depth);
                let step = axis.advance(f32x8::splat(depth as f32)).to_array()[0];
                place += f64::from(step);
                if !truth.is_finite() && is_ray {
                    assert!(axis.reached().to_array()[0] == 0.0, "seed {seed}: {place} is not nowhere");
                    break;
                }
                if !truth.is_finite() {
                    assert!(place > length * 0.999, "seed {seed}: {place} of {length}");
                    break;
                }
                tried += 1;
                let along = f32x8::splat(place as f32);
                let as_reached = axis.reached().to_array()[0] == axis.extinction(along).to_array()[0];
                let wrong = [
                    far(f32x8::splat(place as f32), truth),
                    far(axis.depths(along, f32x8::splat(f32::INFINITY))[0], depth_until(&strata, place)),
                    far(axis.extinction(along), extinction_along(&strata, place)),
                    !as_reached,
                ];
                apart += u32::from(wrong.contains(&true));
            }
        }
    }
    assert!(tried > 1000 && apart * 50 <= tried, "{apart} of {tried} are apart");
}

#[test]
fn depths_are_exact_up_to_the_most_that_is_asked_for() {
    let (mut within, mut beyond) = (0, 0);
    for field in grids() {
        for seed in 0..300 {
            let lane = |nth: u32| point(8 * seed + nth);
            let eight = |first: u32| {
                let axis = |axis: usize| f32x8::new(core::array::from_fn(|nth| lane(first + nth as u32)[axis]));
                Vec3x8::new(axis(0), axis(1), axis(2))
            };
            let (from, to) = (eight(0), eight(10_000));
            let length = (to - from).length_squared().sqrt();
            let [most, flight] = [0.1 + 0.01 * seed as f32, 0.3].map(f32x8::splat);
            let whole = f32x8::splat(f32::INFINITY);
            let (axis, along) = (FieldX8::of(&field).axis(from, to, length), length * f32x8::splat(0.4));
            let (mut after, mut at_once) = (axis, axis);
            let [distance, depth] = at_once.first_advance(flight, most);
            let found = [depth, axis.depth(most), axis.depths(along, most)[1]];
            let truths = [axis.depth(whole), axis.depth(whole), axis.depths(along, whole)[1]];
            let alike = [
                [axis.depths(along, most)[0], axis.depths(along, whole)[0]],
                [distance, after.advance(flight)],
                [at_once.reached(), after.reached()],
                [at_once.advance(flight), after.advance(flight)],
            ];
            for lane in 0..8 {
                let in_lane = |values: f32x8| values.to_array()[lane];
                for (found, truth) in found.map(in_lane).into_iter().zip(truths.map(in_lane)) {
                    let is_deeper = truth > in_lane(most);
                    assert!(if is_deeper { found > in_lane(most) } else { found == truth }, "{found} for {truth}");
                }
                if in_lane(truths[0]) > in_lane(most) {
                    beyond += 1;
                } else {
                    within += 1;
                    alike.iter().for_each(|pair| assert_eq!(in_lane(pair[0]), in_lane(pair[1]), "seed {seed}"));
                }
            }
        }
    }
    assert!(within > 5000 && beyond > 5000, "{within} within, {beyond} beyond");
}

#[test]
fn axes_into_the_void_find_no_cells_and_do_not_fail() {
    for field in grids() {
        for bad in [f32::NAN, f32::INFINITY, -1e30, 1e30] {
            let [good, mut there] = [point(1), point(2)];
            there[1] = bad;
            let lanes = |axis: usize| f32x8::new(core::array::from_fn(|lane| [good, there][lane % 2][axis]));
            let (from, to) = (Vec3x8::splat(point(3)), Vec3x8::new(lanes(0), lanes(1), lanes(2)));
            let axis = |to: Vec3x8| FieldX8::of(&field).axis(from, to, (to - from).length_squared().sqrt());
            let (mut mixed, mut alone) = (axis(to), axis(Vec3x8::splat(good)));
            let [depth, most] = [0.2, 3.0].map(f32x8::splat);
            let [of_mixed, of_alone] = [mixed.first_advance(depth, most), alone.first_advance(depth, most)];
            for (mixed, alone) in of_mixed.into_iter().zip(of_alone) {
                assert_eq!(mixed.to_array()[0], alone.to_array()[0]);
            }
        }
    }
}
