use std::sync::Arc;

use glam::DVec3;
use wide::f32x8;

use super::reference::FieldTwin;
use super::tracking::{Ray, batches, reference as tracking_twin, simd as tracking};
use super::*;
use crate::media::reference::{Medium as _, depth_until, extinction_along, reach};
use crate::media::{AxisX8 as _, MediumX8};
use crate::phase::HenyeyGreenstein;
use crate::random::Stream;

/// A twentieth of a metre per voxel, with the centre of voxel (8, 8, 8) in the origin.
const TO_INDEX: ToIndex = [[20.0, 0.0, 0.0, 8.0], [0.0, 20.0, 0.0, 8.0], [0.0, 0.0, 20.0, 8.0]];

/// A cube of 16^3 voxels with these densities.
fn leaves(density: impl Fn([i32; 3]) -> f32) -> Vec<Leaf> {
    let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| 8 * (corner >> axis & 1)));
    corners
        .map(|origin| {
            let mut values = [0.0; 512];
            for (index, value) in values.iter_mut().enumerate() {
                let local = [index % 8, index / 8 % 8, index / 64].map(|component| component as i32);
                *value = density([0, 1, 2].map(|axis| origin[axis] + local[axis]));
            }
            Leaf { origin, values: values.into() }
        })
        .collect()
}

fn blob([x, y, z]: [i32; 3]) -> f32 {
    let distance = [x, y, z].map(|component| (f64::from(component) - 7.5) / 4.0);
    (-0.5 * distance.map(|d| d * d).iter().sum::<f64>()).exp() as f32
}

fn grids() -> Vec<Field> {
    let smooth = Field::grid(Voxels::new(&leaves(blob), &TO_INDEX, Interpolation::Trilinear), 6.0);
    let blocky = Field::grid(Voxels::new(&leaves(blob), &TO_INDEX, Interpolation::Nearest), 6.0);
    let turned = [[14.0, -14.0, 1.0, 8.0], [14.0, 14.0, 0.0, 8.0], [0.0, 2.0, 25.0, 8.0]];
    let turned = Field::grid(Voxels::new(&leaves(blob), &turned, Interpolation::Trilinear), 9.0);
    let ball = |center: [f64; 3], radius, extinction| Volume {
        shape: Some(Shape::Sphere { center: DVec3::from(center), radius }),
        voxels: None,
        extinction,
    };
    let lumpy = Volume {
        shape: None,
        voxels: Some(Voxels::new(&leaves(blob), &TO_INDEX, Interpolation::Trilinear)),
        extinction: 5.0,
    };
    let bounded = Volume { shape: Some(Shape::block([[-0.2, -0.9, -0.3], [0.8, 0.1, 0.4]])), ..lumpy.clone() };
    let slab =
        Volume { shape: Some(Shape::block([[-0.6, -0.5, -0.4], [0.5, 0.7, 0.3]])), voxels: None, extinction: 2.5 };
    let solid =
        Field::grid(Voxels::new(&leaves(|_| 0.5), &TO_INDEX, Interpolation::Trilinear), 4.0).with_cells(1, 1.0, 1.0);
    assert!(solid.even.is_some());
    let mut scattered = leaves(blob);
    scattered.push(Leaf { origin: [160; 3], values: [0.5; 512].into() });
    let scattered = Field::grid(Voxels::new(&scattered, &TO_INDEX, Interpolation::Trilinear), 6.0);
    let room =
        Volume { shape: Some(Shape::block([[-7.0, -8.0, -7.5], [7.0, 7.2, 6.9]])), voxels: None, extinction: 0.4 };
    let small = vec![ball([0.11, 0.07, -0.13], 0.08, 40.0), ball([-0.31, 0.2, 0.4], 0.05, 60.0), room];
    let in_fog = Field::new(small.clone(), 0.0);
    let in_room = Field::new(small, 0.2).with_cells(4, 1.5, 0.5);
    assert!([&in_fog, &in_room].iter().all(|field| field.blocks.cores.is_some()));
    let several = vec![ball([0.3, 0.1, 0.0], 0.3, 0.0), bounded, ball([-0.4, 0.2, 0.2], 0.5, 4.0), lumpy];
    vec![
        smooth.clone().with_cells(2, 1.0, 1.0),
        scattered.with_cells(2, 1.0, 1.0),
        blocky,
        turned,
        smooth.with_cells(4, 1.5, 0.5),
        Field::new(several.clone(), 0.0),
        Field::new(several, 0.6),
        Field::new(vec![ball([0.1, 0.0, 0.2], 0.6, 3.0)], 0.3),
        Field::new(vec![ball([0.1, 0.0, 0.2], 0.6, 3.0)], 0.3).with_cells(4, 1.0, 1.0),
        Field::new(vec![ball([0.1, 0.0, -0.2], 0.5, 2.0)], 0.0),
        Field::new(vec![ball([0.0; 3], 0.7, 0.0)], 2.0),
        Field::block([[-0.6, -0.5, -0.4], [0.5, 0.7, 0.3]], 2.5),
        Field::new(vec![slab], 0.7),
        solid,
        in_fog,
        in_room,
    ]
}

fn twin(grid: &Field) -> FieldTwin<'_> {
    FieldTwin { field: grid, hue: 1.0, phase: &HenyeyGreenstein { g: 0.0 } }
}

/// Numbers in (-1, 1), other ones for every `seed` and axis.
fn point(seed: u32) -> [f32; 3] {
    let words = crate::random::words(seed, 1, 2, 3);
    [0, 1, 2].map(|axis| (2.0 * crate::random::uniform(words[axis]) - 1.0) as f32)
}

fn real(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

#[test]
fn voxels_have_their_values_at_their_centres_and_are_mixed_between() {
    let grid = Field::grid(Voxels::new(&leaves(blob), &TO_INDEX, Interpolation::Trilinear), 2.0);
    let at = |place: [f64; 3]| twin(&grid).extinction((DVec3::from(place) - 8.0) / 20.0) / 2.0;
    for place in [[0, 0, 0], [7, 8, 3], [15, 15, 15], [4, 9, 15]] {
        let expected = f64::from(blob(place));
        let found = at(place.map(f64::from));
        assert!((found - expected).abs() < 2e-5, "{place:?}: {found} instead of {expected}");
    }
    let between = (f64::from(blob([3, 4, 5])) + f64::from(blob([4, 4, 5]))) / 2.0;
    assert!((at([3.5, 4.0, 5.0]) - between).abs() < 2e-5);
    // Half a voxel beyond the last one half of it is left, and a whole one beyond nothing.
    assert!((at([15.5, 8.0, 8.0]) - f64::from(blob([15, 8, 8])) / 2.0).abs() < 2e-5);
    assert_eq!([at([16.0, 8.0, 8.0]), at([-1.0, 8.0, 8.0]), at([8.0, 8.0, 99.0])], [0.0; 3]);
}

#[test]
fn lanes_are_those_of_the_twin() {
    for (number, grid) in grids().iter().enumerate() {
        let lanes = FieldX8::of(grid);
        let mut off = 0;
        for round in 0..400 {
            let ends: [[[f32; 3]; 2]; 8] =
                core::array::from_fn(|lane| [2, 3].map(|i| point(1000 * i + 8 * round + lane as u32)));
            let of = |end: usize| {
                let axis = |axis: usize| f32x8::new(ends.map(|ends| ends[end][axis]));
                Vec3x8::new(axis(0), axis(1), axis(2))
            };
            let (from, to) = (of(0), of(1));
            let depth = lanes.optical_depth(from, to, (to - from).length_squared().sqrt()).to_array();
            let extinction = lanes.extinction(from).to_array();
            for lane in 0..8 {
                let [from, to] = ends[lane].map(real);
                let (expected, known) = (twin(grid).extinction(from), twin(grid).optical_depth(from, to));
                assert!(
                    (f64::from(extinction[lane]) - expected).abs() < 1e-4,
                    "{number}: {} {expected}",
                    extinction[lane]
                );
                let is_off = (f64::from(depth[lane]) - known).abs() > 1e-4 * (1.0 + known);
                off += u32::from(is_off);
            }
        }
        // Of 3200 segments, a few have a point, or the number of their points, on the edge of rounding.
        assert!(off < 10, "grid {number}: {off} depths are off");
    }
}

#[test]
fn depths_are_the_same_both_ways_and_near_the_integral() {
    for grid in grids().iter().take(3) {
        for round in 0..100 {
            let [from, to] = [2, 3].map(|i| real(point(1000 * i + round)));
            let [there, back] = [twin(grid).optical_depth(from, to), twin(grid).optical_depth(to, from)];
            assert!((there - back).abs() < 1e-9 * (1.0 + there), "{there} {back}");
            let integral = integral(grid, from, to, 2000);
            assert!((there - integral).abs() < 0.3 + 0.3 * integral, "{there} for {integral}");
        }
    }
}

/// The optical depth of a segment, by a fine midpoint rule.
fn integral(grid: &Field, from: DVec3, to: DVec3, steps: i32) -> f64 {
    let at = |i: i32| twin(grid).extinction(from + (f64::from(i) + 0.5) / f64::from(steps) * (to - from));
    (0..steps).map(at).sum::<f64>() / f64::from(steps) * from.distance(to)
}

fn rays(count: u32) -> Vec<Ray> {
    let ray = |i: u32| {
        let (origin, end) = (point(i), point(50_000 + i));
        let direction = real(end).normalize().as_vec3().to_array();
        Ray { origin, direction, stream: Stream::new(i, 5, 6, 7, 0), hues: [1.0; 3] }
    };
    (0..count).map(ray).collect()
}

#[test]
fn tracked_flights_are_those_of_the_twin_in_any_lane() {
    for grid in &grids() {
        for count in [1, 7, 8, 9, 700] {
            let rays = rays(count);
            let fly = |rays: &[Ray]| {
                let mut found = vec![f32::NAN; rays.len()];
                tracking::flights(grid, batches(rays), |first, ended, flights| {
                    crate::lanes::each(ended).for_each(|lane| found[first + lane] = flights.to_array()[lane]);
                });
                found
            };
            let found = fly(&rays);
            let mut reversed = fly(&rays.iter().copied().rev().collect::<Vec<_>>());
            reversed.reverse();
            assert!(found.iter().zip(&reversed).all(|(a, b)| a.to_bits() == b.to_bits()), "{count} rays");
            let off = rays.iter().zip(&found).filter(|(ray, found)| {
                let expected = tracking_twin::flight(grid, 1.0, real(ray.origin), real(ray.direction), ray.stream);
                let close = (f64::from(**found) - expected).abs() < 1e-4 * (1.0 + expected);
                !(close || expected.is_infinite() && found.is_infinite())
            });
            assert!(off.count() <= 2, "of {count}");
        }
    }
}

#[test]
fn transmittances_are_those_of_the_twin() {
    for grid in &grids() {
        let segments: Vec<Ray> = (0..700)
            .map(|i| {
                let (origin, end) = (real(point(i)), real(point(70_000 + i)));
                Ray {
                    origin: point(i),
                    direction: (end - origin).as_vec3().to_array(),
                    stream: Stream::new(i, 5, 6, 7, 1),
                    hues: [1.0; 3],
                }
            })
            .collect();
        let mut found = vec![(f32::NAN, f32::NAN); segments.len()];
        tracking::transmittances(grid, batches(&segments), |row, [product], known| found[row] = (product, known));
        let off = segments.iter().zip(&found).filter(|(ray, (product, known))| {
            let (from, way) = (real(ray.origin), real(ray.direction));
            let ([p], k) = tracking_twin::transmittance(grid, [1.0], from, from + way, ray.stream);
            let known_matters = p > 0.0;
            (f64::from(*product) - p).abs() > 1e-3 || known_matters && (f64::from(*known) - k).abs() > 1e-3 * (1.0 + k)
        });
        assert!(off.count() <= 4);
    }
}

/// A voxel so dense, and rays from so far away, that the way to the next candidate is lost to rounding: rays beside the
/// voxel, in its block, come through all the same.
#[test]
fn no_block_is_too_dense_to_leave() {
    let lone = leaves(|voxel| if voxel == [8; 3] { 1.0 } else { 0.0 });
    let grid = Field::grid(Voxels::new(&lone, &TO_INDEX, Interpolation::Nearest), 1e9).with_cells(4, 1.0, 1.0);
    let beside = Ray {
        origin: [-1e5, 0.25, 0.25],
        direction: [1.0, 0.0, 0.0],
        stream: Stream::new(1, 5, 6, 7, 0),
        hues: [1.0; 3],
    };
    let mut ended = 0;
    tracking::flights(&grid, batches(&[beside]), |_, _, flights| {
        assert_eq!(flights.to_array()[0], f32::INFINITY);
        ended += 1;
    });
    let whole = Ray { direction: [1e5 + 1.0, 0.0, 0.0], ..beside };
    tracking::transmittances(&grid, batches(&[whole]), |_, [product], known| {
        assert_eq!((product, known), (1.0, 0.0));
        ended += 1;
    });
    assert_eq!(ended, 2);
}

/// Fog is even, so that every candidate in it is a collision; there were thousands of others where the whole block had the
/// majorant of the ball.
#[test]
fn rays_beside_what_is_small_and_dense_meet_no_candidates_for_it() {
    let ball = Shape::Sphere { center: DVec3::new(0.3, -0.2, 0.1), radius: 0.05 };
    let hall = Shape::block([[-100.0; 3], [100.0; 3]]);
    let volumes = [(ball, 400.0), (hall, 0.05)];
    let volumes = volumes.map(|(shape, extinction)| Volume { shape: Some(shape), voxels: None, extinction });
    let field = Field::new(volumes.to_vec(), 0.0);
    let rays = 500;
    let candidates = |i: u32| {
        let from = DVec3::new(0.0, 0.0, -2.0) + real(point(i));
        let direction = (real(point(9000 + i)) - from).normalize();
        tracking_twin::fly(&field, 1.0, from, direction, Stream::new(i, 5, 6, 7, 0)).1
    };
    let all: u32 = (0..rays).map(candidates).sum();
    assert!(all < 2 * rays, "{all} candidates on {rays} rays");
}

#[test]
fn flights_and_transmittances_have_the_means_of_the_integral() {
    for (number, grid) in grids().iter().enumerate() {
        let (from, to) = (DVec3::new(-0.9, -0.3, -0.2), DVec3::new(0.8, 0.3, 0.25));
        let (expected, samples) = ((-integral(grid, from, to, 400_000)).exp(), 40_000_u32);
        let direction = (to - from).normalize();
        let (mut passed, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for i in 0..samples {
            let stream = |part| Stream::new(i, 3, 4, 5, part);
            passed +=
                f64::from(u8::from(tracking_twin::flight(grid, 1.0, from, direction, stream(0)) > from.distance(to)));
            let ([product], known) = tracking_twin::transmittance(grid, [1.0], from, to, stream(1));
            let estimate = product * (-known).exp();
            sum += estimate;
            squares += estimate * estimate;
        }
        let n = f64::from(samples);
        let (share, mean) = (passed / n, sum / n);
        let error = (expected * (1.0 - expected) / n).sqrt();
        assert!((share - expected).abs() < 4.5 * error, "grid {number}: {share} of flights pass, not {expected}");
        let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
        assert!((mean - expected).abs() < 4.5 * error + 1e-5, "grid {number}: {mean} +- {error}, not {expected}");
        // Known about where it is, the transmittance is worth more than a yes or no.
        assert!(error < 0.7 * (expected * (1.0 - expected) / n).sqrt(), "grid {number}: {error}");
    }
}

#[test]
fn a_constant_grid_leaves_nothing_to_chance() {
    let grid =
        Field::grid(Voxels::new(&leaves(|_| 0.5), &TO_INDEX, Interpolation::Nearest), 3.0).with_cells(3, 1.0, 1.0);
    let ray = Ray { origin: [-0.3; 3], direction: [0.6, 0.5, 0.3], stream: Stream::new(1, 2, 3, 4, 0), hues: [1.0; 3] };
    tracking::transmittances(&grid, batches(&[ray]), |_, [product], known| {
        let expected = 1.5 * real(ray.direction).length();
        assert!((f64::from(known) / expected - 1.0).abs() < 1e-5 && product == 1.0, "{product} {known} {expected}");
    });
}

#[test]
fn bricks_take_less_than_their_voxels() {
    let many: Vec<Leaf> = (0..1000)
        .map(|i| {
            let value = |j: usize| crate::random::uniform(crate::random::words(i, j as u32, 0, 0)[0]) as f32;
            let values = Arc::new(core::array::from_fn(value));
            Leaf { origin: [i % 10, i / 10 % 10, i / 100].map(|c| 8 * c as i32), values }
        })
        .collect();
    let grid = Field::grid(Voxels::new(&many, &TO_INDEX, Interpolation::Trilinear), 1.0);
    let voxels = many.len() * 512 * size_of::<f32>();
    let bytes = bytes_of(grid.voxels()) + grid.bytes_besides_voxels();
    assert!(bytes as f64 <= 1.3 * voxels as f64, "{bytes} bytes for {voxels}");
}

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
