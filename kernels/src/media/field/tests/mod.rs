//! Fields of all kinds, asked by lanes and by twins.

mod axis;
mod tracking;

use std::sync::Arc;

use glam::DVec3;
use wide::f32x8;

use super::reference::FieldTwin;
use super::*;
use crate::media::MediumX8;
use crate::media::reference::Medium as _;
use crate::phase::HenyeyGreenstein;

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
    let spiky = leaves(|at| if at == [5, 9, 8] { 2000.0 } else { blob(at) });
    let spiky = Field::grid(Voxels::new(&spiky, &TO_INDEX, Interpolation::Trilinear), 0.01);
    let several = vec![ball([0.3, 0.1, 0.0], 0.3, 0.0), bounded, ball([-0.4, 0.2, 0.2], 0.5, 4.0), lumpy];
    vec![
        smooth.clone().with_cells(2, 1.0, 1.0),
        scattered.with_cells(2, 1.0, 1.0),
        spiky.with_cells(2, 1.0, 1.0),
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
