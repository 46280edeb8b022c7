//! Walls that stand along x, centred on z = 0, and the arches in them.

use core::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::Mesh;

/// A semicircular arch.
#[derive(Clone, Copy, Debug)]
pub struct Arch {
    /// Middle of the opening along the wall `[m]`.
    pub center: f64,
    /// Height at which the curve begins `[m]`.
    pub spring: f64,
    /// Radius of the curve, half the width of the opening `[m]`.
    pub radius: f64,
}

impl Arch {
    /// Flat pieces that stand for the curve.
    pub const SEGMENTS: u32 = 24;

    /// The curve at another radius, from left to right.
    fn curve(self, radius: f64) -> impl Iterator<Item = DVec2> {
        (0..=Self::SEGMENTS).map(move |i| {
            let (sin, cos) = (PI * f64::from(i) / f64::from(Self::SEGMENTS)).sin_cos();
            // The ends stand at the spring exactly, where the sine of half a turn would miss it.
            let rise = if i % Self::SEGMENTS == 0 { 0.0 } else { radius * sin };
            DVec2::new(self.center - radius * cos, self.spring + rise)
        })
    }
}

/// The solid between a lower and an upper chain of points (x along the wall, y up), both from left to right and of as
/// many points; `thickness` extends half to either side.
///
/// # Panics
/// If the chains do not pair up.
pub fn wall(lower: &[DVec2], upper: &[DVec2], thickness: f64) -> Mesh {
    assert_eq!(lower.len(), upper.len(), "chains pair up");
    // Four rows of vertices: lower and upper at the back, then at the front.
    let count = lower.len() as u32;
    let row = |chain: &[DVec2], z: f64| chain.iter().map(|point| point.extend(z)).collect::<Vec<DVec3>>();
    let half = 0.5 * thickness;
    let positions = [row(lower, -half), row(upper, -half), row(lower, half), row(upper, half)].concat();
    let mut mesh = Mesh { positions, triangles: vec![] };
    let rows = |i: u32| [i, count + i, 2 * count + i, 3 * count + i];
    for i in 0..count - 1 {
        let [lower, upper, front_lower, front_upper] = rows(i);
        let [next_lower, next_upper, next_front_lower, next_front_upper] = rows(i + 1);
        mesh.quad([front_lower, next_front_lower, next_front_upper, front_upper]);
        mesh.quad([next_lower, lower, upper, next_upper]);
        mesh.quad([lower, next_lower, next_front_lower, front_lower]);
        mesh.quad([front_upper, next_front_upper, next_upper, upper]);
    }
    let [lower, upper, front_lower, front_upper] = rows(0);
    mesh.quad([lower, front_lower, front_upper, upper]);
    let [lower, upper, front_lower, front_upper] = rows(count - 1);
    mesh.quad([front_lower, lower, upper, front_upper]);
    mesh
}

/// The part of a wall above the spring of a row of arches, from `left` to `right` and up to `top`.
///
/// # Panics
/// If the arches overlap or reach beyond the wall.
pub fn arch_band([left, right]: [f64; 2], top: f64, arches: &[Arch], thickness: f64) -> Mesh {
    let spring = arches[0].spring;
    let curves = arches.iter().flat_map(|arch| arch.curve(arch.radius));
    let lower: Vec<DVec2> =
        [DVec2::new(left, spring)].into_iter().chain(curves).chain([DVec2::new(right, spring)]).collect();
    assert!(lower.windows(2).all(|pair| pair[0].x < pair[1].x), "arches overlap or do not fit: {arches:?}");
    assert!(lower.iter().all(|point| point.y < top), "arches reach above {top}: {arches:?}");
    let upper: Vec<DVec2> = lower.iter().map(|point| DVec2::new(point.x, top)).collect();
    wall(&lower, &upper, thickness)
}

/// The ring of stones around an arch, `width` wide.
pub fn arch_ring(arch: Arch, width: f64, thickness: f64) -> Mesh {
    let inner: Vec<DVec2> = arch.curve(arch.radius).collect();
    let outer: Vec<DVec2> = arch.curve(arch.radius + width).collect();
    wall(&inner, &outer, thickness)
}
