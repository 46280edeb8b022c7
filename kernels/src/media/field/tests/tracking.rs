//! Flights and transmittances.

use glam::DVec3;
use wide::f32x8;

use super::{TO_INDEX, grids, integral, leaves, point, real};
use crate::lanes::LANES;
use crate::media::field::tracking::{
    FlightsX8, Ray, RaysX8, batches, first_budget, reference as tracking_twin, simd as tracking,
};
use crate::media::field::{Field, Interpolation, Shape, Volume, Voxels};
use crate::random::Stream;

fn fly(grid: &Field, rays: &[Ray], end: impl FnMut(usize, u32, f32x8)) {
    let batches: Vec<RaysX8<1>> = batches(rays).collect();
    let flights = batches.iter().map(|batch| FlightsX8::from(*batch));
    tracking::flights(grid, flights, |first| batches[first / LANES].stream, end);
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
                fly(grid, rays, |first, ended, flights| {
                    crate::lanes::each(ended).for_each(|lane| found[first + lane] = flights.to_array()[lane]);
                });
                found
            };
            let found = fly(&rays);
            let mut reversed = fly(&rays.iter().copied().rev().collect::<Vec<_>>());
            reversed.reverse();
            assert!(found.iter().zip(&reversed).all(|(a, b)| a.to_bits() == b.to_bits()), "{count} rays");
            let off = rays.iter().zip(&found).filter(|(ray, found)| {
                let expected = tracking_twin::flight(
                    grid,
                    1.0,
                    real(ray.origin),
                    real(ray.direction),
                    first_budget(ray.stream),
                    ray.stream,
                );
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
    fly(&grid, &[beside], |_, _, flights| {
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

/// Rays through the field that begin `away` from it, and their ends beyond it.
fn rays_from(away: f64, count: u32) -> Vec<Ray> {
    let ray = |i: u32| {
        let direction = real(point(50_000 + i)).normalize();
        let origin = (0.5 * real(point(i)) - away * direction).as_vec3().to_array();
        Ray { origin, direction: direction.as_vec3().to_array(), stream: Stream::new(i, 5, 6, 7, 2), hues: [1.0; 3] }
    };
    (0..count).map(ray).collect()
}

/// As seen from far away, blocks are no wider than a digit of the distance.
#[test]
fn rays_from_far_away_come_through() {
    for (number, grid) in grids().iter().enumerate() {
        for away in [30.0, 1e3, 3e4, 1e6, 1e7, 1e9] {
            let rays = rays_from(away, 2000);
            fly(grid, &rays, |_, ended, flights| {
                let away = away as f32;
                crate::lanes::each(ended).map(|lane| flights.to_array()[lane]).for_each(|flown| {
                    assert!(flown >= 0.0, "grid {number}, {away} m: {flown}");
                    let is_beside = flown.is_finite() && (flown - away).abs() > 15.0 + 4.0 * f32::EPSILON * away;
                    assert!(!is_beside || grid.around() > 0.0, "grid {number}, {away} m: {flown}");
                });
            });
            let through = |ray: Ray| Ray { direction: ray.direction.map(|part| 2.0 * away as f32 * part), ..ray };
            let segments: Vec<_> = rays.into_iter().map(through).collect();
            let (mut found, mut expected) = (0.0, 0.0);
            tracking::transmittances(grid, batches(&segments), |_, [product], known| {
                assert!(product >= 0.0 && known >= 0.0, "grid {number}, {away} m: {product}, {known}");
                found += f64::from(product * (-known).exp());
            });
            for ray in &segments {
                let (from, way) = (real(ray.origin), real(ray.direction));
                let ([product], known) = tracking_twin::transmittance(grid, [1.0], from, from + way, ray.stream);
                expected += product * (-known).exp();
            }
            let [found, expected] = [found, expected].map(|sum| sum / segments.len() as f64);
            let is_near = away <= 1e6;
            assert!(
                !is_near || (found - expected).abs() < 0.01,
                "grid {number}, {away} m: {found} instead of {expected}"
            );
        }
    }
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
        let stream = Stream::new(i, 5, 6, 7, 0);
        tracking_twin::fly(&field, 1.0, from, direction, first_budget(stream), stream).1
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
            let flight = tracking_twin::flight(grid, 1.0, from, direction, first_budget(stream(0)), stream(0));
            passed += f64::from(u8::from(flight > from.distance(to)));
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
