//! A field in f64.
//!
//! ```text
//! extinction: that of the first volume that the point is in, or else of what is around
//! density:    sum over the eight voxels about the point of value * prod over axes of (1 - distance from the voxel)
//! tau~:       a segment has as many strata as it is cells long, at most 16, over its part in a box a little larger than
//!             all cells, each with the mean of the cell at its middle; the rest of it is in what is around
//! one shape:  the pieces before, within and behind it
//! ```
//!
//! Which cell a point is in, and how many strata there are, are decisions on the edge of rounding: a twin may decide
//! otherwise for one point in many thousands.

use glam::DVec3;

use super::Field;
use super::axis::{ABOVE, BELOW, MOST_DEPTH, MOST_STRATA};
use super::known::OneShape;
use crate::media::reference::{Medium, Stratum, depth_until};
use crate::phase::reference::Phase;

/// A field in one channel, and where its scattering events send light.
#[derive(Clone, Copy)]
pub struct FieldTwin<'a> {
    /// The field.
    pub field: &'a Field,
    /// Extinction of the channel over that of the field.
    pub hue: f64,
    /// The phase function.
    pub phase: &'a dyn Phase,
}

impl Field {
    /// A point in cells from the first one on.
    pub fn cells_of(&self, at: DVec3) -> DVec3 {
        self.to_cells.point(at)
    }

    /// A direction in cells.
    pub fn cells_along(&self, way: DVec3) -> DVec3 {
        self.to_cells.direction(way)
    }

    /// Extinction at a point in cells from the first one on [1/m].
    pub fn extinction_at(&self, at: DVec3) -> f64 {
        self.here(at).1
    }

    /// Who is at a point in cells, as [`Self::who`] tells, and the extinction there [1/m].
    pub fn here(&self, at: DVec3) -> (u32, f64) {
        let there = (1..).zip(&self.volumes).find_map(|(who, volume)| Some((who, volume.extinction_at(at)?)));
        there.unwrap_or((0, f64::from(self.around)))
    }

    /// The extinction where the hue is 1, if both ends of a segment are in the even part [1/m].
    pub fn even_between(&self, from: DVec3, to: DVec3) -> Option<f64> {
        let even = self.even.filter(|even| [from, to].into_iter().all(|end| even.holds_one(self.cells_of(end))))?;
        Some(f64::from(even.extinction))
    }

    /// The part of a ray, in cells, up to `end` within all cells and so much more below and above.
    pub fn part_within(&self, from: DVec3, way: DVec3, [below, above]: [f64; 2], end: f64) -> Option<(f64, f64)> {
        let counts = DVec3::from(self.cells.dims().map(f64::from));
        part_in_box([DVec3::splat(-below), counts + above], from, way, end)
    }

    /// The cell that a point, in cells, is in.
    pub fn cell_at(&self, at: DVec3) -> [u32; 3] {
        [0, 1, 2].map(|axis| at[axis].clamp(0.0, f64::from(self.cells.dims()[axis] - 1)) as u32)
    }

    /// The way from `from` along `edge`, up to the share `end` of it, as weights see it, where the hue is 1.
    pub fn strata_along(&self, from: DVec3, edge: DVec3, end: f64) -> Vec<Stratum> {
        let (start, way, around) = (self.cells_of(from), self.cells_along(edge), f64::from(self.around));
        let piece = |share: f64, extinction: f64| Stratum { length: share * edge.length(), extinction };
        if let Some(shape) = &self.one {
            let Some((enter, exit)) = part_in_shape(shape, start, way, end) else { return vec![piece(end, around)] };
            return vec![
                piece(enter, around),
                piece(exit - enter, f64::from(shape.extinction)),
                piece(end - exit, around),
            ];
        }
        let Some((enter, exit)) = self.part_within(start, way, [BELOW, ABOVE].map(f64::from), end) else {
            return vec![piece(end, around)];
        };
        let count = (way.length() * (exit - enter)).ceil().clamp(1.0, f64::from(MOST_STRATA));
        let mean_at = |i: u32| {
            let at = start + (enter + (exit - enter) * (f64::from(i) + 0.5) / count) * way;
            let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < f64::from(self.cells.dims()[axis]));
            if inside { f64::from(self.cells.mean(self.cell_at(at))) } else { around }
        };
        let mut strata = vec![piece(enter, around)];
        strata.extend((0..count as u32).map(|i| piece((exit - enter) / count, mean_at(i))));
        strata.push(piece(end - exit, around));
        strata
    }
}

/// The part of a ray up to `end` within the box between two corners; none if it is empty.
pub fn part_in_box([low, high]: [DVec3; 2], from: DVec3, way: DVec3, end: f64) -> Option<(f64, f64)> {
    let (mut enter, mut exit) = (0.0_f64, end);
    for axis in 0..3 {
        if way[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let [a, b] = [low, high].map(|corner| (corner[axis] - from[axis]) / way[axis]);
        (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
    }
    (enter < exit).then_some((enter, exit))
}

/// The part of a ray, in cells, up to `end` within a shape: the cell from 0 to 1, or the largest ball in it.
fn part_in_shape(shape: &OneShape, from: DVec3, way: DVec3, end: f64) -> Option<(f64, f64)> {
    let (mut enter, mut exit) = (0.0_f64, end);
    if shape.is_round {
        // |from + t way - m|^2 = r^2
        let from_middle = from - 0.5;
        let (a, b, c) = (way.length_squared(), from_middle.dot(way), from_middle.length_squared() - 0.25);
        let root = (b * b - a * c).sqrt();
        if root.is_nan() || a == 0.0 {
            return (a == 0.0 && c < 0.0).then_some((0.0, end));
        }
        (enter, exit) = (enter.max((-b - root) / a), exit.min((-b + root) / a));
    } else {
        for axis in 0..3 {
            let [a, b] = [0.0, 1.0].map(|border| (border - from[axis]) / way[axis]);
            if way[axis] == 0.0 && !(0.0..=1.0).contains(&from[axis]) {
                return None;
            }
            if way[axis] != 0.0 {
                (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
            }
        }
    }
    (enter < exit).then_some((enter, exit))
}

impl FieldTwin<'_> {
    /// Strata of the field, in the twin's channel.
    fn coloured(&self, mut strata: Vec<Stratum>) -> Vec<Stratum> {
        strata.iter_mut().for_each(|stratum| stratum.extinction *= self.hue);
        strata
    }
}

impl Medium for FieldTwin<'_> {
    fn strata(&self, from: DVec3, to: DVec3) -> Vec<Stratum> {
        self.coloured(self.field.strata_along(from, to - from, 1.0))
    }

    fn strata_of_ray(&self, from: DVec3, direction: DVec3) -> Vec<Stratum> {
        self.coloured(self.field.strata_along(from, direction, f64::INFINITY))
    }

    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64 {
        let depth = depth_until(&self.strata(from, to), from.distance(to)).max(1e-9);
        if self.field.is_known() { depth } else { depth.min((f64::from(MOST_DEPTH) * self.hue).max(1e-9)) }
    }

    fn over_clearest(&self) -> f64 {
        self.hue / f64::from(self.field.clearest())
    }

    fn extinction(&self, at: DVec3) -> f64 {
        self.field.extinction_at(self.field.cells_of(at)) * self.hue
    }

    fn phase(&self) -> &dyn Phase {
        self.phase
    }
}
