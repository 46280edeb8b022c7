//! Pointed arches in walls along x.

use glam::DVec2;

use super::wall::wall;
use crate::Mesh;

/// An arch of two arcs that meet in a point.
#[derive(Clone, Copy, Debug)]
pub struct Lancet {
    /// Middle of the opening along the wall `[m]`.
    pub center: f64,
    /// Height at which the arcs begin `[m]`.
    pub spring: f64,
    /// Half the width of the opening `[m]`.
    pub half_width: f64,
    /// Radius of the arcs over half the width: 1 is a semicircle, 2 an equilateral arch.
    pub sharpness: f64,
}

impl Lancet {
    /// Flat pieces that stand for one arc.
    pub const SEGMENTS: u32 = 8;

    /// Height of the point `[m]`.
    pub fn apex(self) -> f64 {
        self.spring + self.half_width * (2.0 * self.sharpness - 1.0).sqrt()
    }

    /// The arcs, moved outward by `offset`, from left to right.
    pub fn curve(self, offset: f64) -> impl Iterator<Item = DVec2> {
        let radius = self.sharpness * self.half_width;
        let [beside, moved] = [radius - self.half_width, radius + offset];
        let turn = (beside / moved).acos();
        // Both arcs have the apex; the right one leaves it to the left one.
        let left = move |i: u32| {
            let (sin, cos) = (turn * f64::from(i) / f64::from(Self::SEGMENTS)).sin_cos();
            let inward = if i == Self::SEGMENTS { 0.0 } else { beside - moved * cos };
            DVec2::new(inward, if i == 0 { 0.0 } else { moved * sin })
        };
        let place = move |point: DVec2| DVec2::new(self.center, self.spring) + point;
        let right = (0..Self::SEGMENTS).rev().map(move |i| place(left(i) * DVec2::new(-1.0, 1.0)));
        (0..=Self::SEGMENTS).map(move |i| place(left(i))).chain(right)
    }
}

/// The part of a wall above the spring of a row of pointed arches, from `left` to `right` and up to `top`.
///
/// # Panics
/// If the arches overlap or reach beyond the wall.
pub fn lancet_band([left, right]: [f64; 2], top: f64, lancets: &[Lancet], thickness: f64) -> Mesh {
    let spring = lancets[0].spring;
    let curves = lancets.iter().flat_map(|lancet| lancet.curve(0.0));
    let lower: Vec<DVec2> =
        [DVec2::new(left, spring)].into_iter().chain(curves).chain([DVec2::new(right, spring)]).collect();
    assert!(lower.windows(2).all(|pair| pair[0].x < pair[1].x), "arches overlap or do not fit: {lancets:?}");
    assert!(lower.iter().all(|point| point.y < top), "arches reach above {top}: {lancets:?}");
    let upper: Vec<DVec2> = lower.iter().map(|point| DVec2::new(point.x, top)).collect();
    wall(&lower, &upper, thickness)
}

/// The stones along a pointed arch, between two curves around it.
pub fn lancet_ring(lancet: Lancet, [inner, outer]: [f64; 2], thickness: f64) -> Mesh {
    let [inner, outer] = [inner, outer].map(|offset| lancet.curve(offset).collect::<Vec<DVec2>>());
    wall(&inner, &outer, thickness)
}
