//! The vertices behind every path, as walks back along them read them.
//!
//! Weights look at all vertices of a path, from the current one back to the camera, for candidates whose lanes are
//! scattered over the table. A vertex is therefore one row of eight numbers, and the rows of a lane stand next to each
//! other: eight loads and a transposition give eight vertices, and the next step back finds its rows in the same cache
//! lines: of columns a batch would touch twenty-four per vertex. Measured, weights took a tenth less time.
//!
//! Like the [`Ring`](super::paths::Ring) of the current vertices it is a ring over the bounce clock.

use bumpalo::Bump;
use wide::f32x8;

use super::LANES;
use super::paths::{RayTable, VertexTable};
use crate::lanes::LaneSet;
use crate::vec3x8::Vec3x8;

/// A vertex that a path has left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Where it is `[m]`.
    pub position: [f32; 3],
    /// Length of the path from its first vertex after the camera to here `[m]`.
    pub arc: f32,
    /// Unit direction of the ray that leaves it.
    pub leaving: [f32; 3],
    /// Normalisation of the light selection there [1/m], where it depends on the vertex.
    pub light_sum: f32,
}

/// Eight vertices that paths have left; the fields of [`Mark`].
#[derive(Clone, Copy, Debug)]
pub struct MarkBatch {
    /// Where they are `[m]`.
    pub position: Vec3x8,
    /// Lengths of the paths up to them `[m]`.
    pub arc: f32x8,
    /// Unit directions in which they are left.
    pub leaving: Vec3x8,
    /// Normalisations of the light selection there [1/m].
    pub light_sum: f32x8,
}

/// Vertices of every path, as many as there are slots.
pub struct TrailTable<'q> {
    rows: &'q mut [f32x8],
    slots: usize,
    /// Rows from one lane to the next: odd, so that lanes do not share sets of the cache.
    stride: usize,
}

impl<'q> TrailTable<'q> {
    /// Room for the last `slots` vertices of `lanes` paths; none at all if nothing looks back.
    pub fn new_in(arena: &'q Bump, lanes: usize, slots: usize) -> Self {
        let stride = if slots == 0 { 0 } else { slots | 1 };
        Self { rows: arena.alloc_slice_fill_copy(lanes.next_multiple_of(LANES) * stride, f32x8::ZERO), slots, stride }
    }

    /// Vertices that are remembered at a time.
    pub fn slots(&self) -> usize {
        self.slots
    }

    #[inline(always)]
    fn slot(&self, clock: u32) -> usize {
        clock as usize % self.slots
    }

    /// Remembers the current vertices of the live lanes, and the rays that leave them.
    pub fn remember(&mut self, clock: u32, live: &LaneSet<'_>, vertices: &VertexTable<'_>, rays: &RayTable<'_>) {
        if self.slots == 0 {
            return;
        }
        let slot = self.slot(clock);
        let (vertex, ray) = (vertices.at(clock), rays.at(clock));
        for (b, _) in live.each_batch() {
            let (position, leaving) = (vertex.position.batch(b), ray.direction.batch(b));
            let rows = f32x8::transpose([
                position.x,
                position.y,
                position.z,
                vertex.arc.batch(b),
                leaving.x,
                leaving.y,
                leaving.z,
                vertex.light_sum.batch(b),
            ]);
            for (i, row) in rows.into_iter().enumerate() {
                self.rows[(b * LANES + i) * self.stride + slot] = row;
            }
        }
    }

    /// The vertices that were current at `clock` in the lanes that `lanes` names.
    #[inline(always)]
    pub fn gather(&self, lanes: &[u32; LANES], clock: u32) -> MarkBatch {
        let slot = self.slot(clock);
        let [x, y, z, arc, dx, dy, dz, light_sum] =
            f32x8::transpose(lanes.map(|lane| self.rows[lane as usize * self.stride + slot]));
        MarkBatch { position: Vec3x8::new(x, y, z), arc, leaving: Vec3x8::new(dx, dy, dz), light_sum }
    }

    /// Lanes of the table.
    pub fn lanes(&self) -> usize {
        self.rows.len().checked_div(self.stride).unwrap_or(0)
    }

    /// The eight numbers of a row.
    pub fn numbers(&self, lane: usize, clock: u32) -> [f32; 8] {
        self.rows[lane * self.stride + self.slot(clock)].to_array()
    }

    /// Overwrites the eight numbers of a row.
    pub fn set_numbers(&mut self, lane: usize, clock: u32, numbers: [f32; 8]) {
        self.rows[lane * self.stride + self.slot(clock)] = f32x8::new(numbers);
    }

    /// The vertex that was current at `clock` in `lane`.
    pub fn row(&self, lane: usize, clock: u32) -> Mark {
        let [x, y, z, arc, dx, dy, dz, light_sum] = self.numbers(lane, clock);
        Mark { position: [x, y, z], arc, leaving: [dx, dy, dz], light_sum }
    }

    /// Overwrites the vertex that was current at `clock` in `lane`.
    pub fn set_row(&mut self, lane: usize, clock: u32, mark: Mark) {
        let Mark { position: [x, y, z], arc, leaving: [dx, dy, dz], light_sum } = mark;
        self.set_numbers(lane, clock, [x, y, z, arc, dx, dy, dz, light_sum]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_holds_the_last_vertices_of_every_lane() {
        let arena = Bump::new();
        let (mut vertices, mut rays) = (VertexTable::new_in(&arena, 16), RayTable::new_in(&arena, 16));
        let mut live = LaneSet::new_in(&arena, 16);
        (0..16).for_each(|lane| live.insert(lane));
        let mut trail = TrailTable::new_in(&arena, 16, 4);
        let mark = |clock: u32, lane: usize| {
            let number = (100 * clock) as f32 + lane as f32;
            let leaving = [number + 0.5, 0.25, -number];
            Mark { position: [number, -1.0, 2.0 * number], arc: number + 1.0, leaving, light_sum: 7.0 + number }
        };
        for clock in 40..50 {
            for lane in 0..16 {
                let Mark { position, arc, leaving, light_sum } = mark(clock, lane);
                vertices.at_mut(clock).set_row(lane, super::super::paths::Vertex { position, arc, light_sum });
                rays.at_mut(clock).direction.set_row(lane, leaving);
            }
            trail.remember(clock, &live, &vertices, &rays);
        }
        for clock in 46..50 {
            assert_eq!(trail.row(11, clock), mark(clock, 11));
            let lanes = [3, 0, 15, 15, 8, 1, 2, 9];
            let batch = trail.gather(&lanes, clock);
            for (i, lane) in lanes.into_iter().enumerate() {
                let expected = mark(clock, lane as usize);
                let of = |v: f32x8| v.to_array()[i];
                assert_eq!([batch.position.x, batch.position.y, batch.position.z].map(of), expected.position);
                assert_eq!([batch.leaving.x, batch.leaving.y, batch.leaving.z].map(of), expected.leaving);
                assert_eq!((of(batch.arc), of(batch.light_sum)), (expected.arc, expected.light_sum));
            }
        }
    }

    #[test]
    fn nothing_is_remembered_where_nothing_looks_back() {
        let arena = Bump::new();
        let (vertices, rays) = (VertexTable::new_in(&arena, 8), RayTable::new_in(&arena, 8));
        let mut live = LaneSet::new_in(&arena, 8);
        live.insert(3);
        let mut trail = TrailTable::new_in(&arena, 8, 0);
        trail.remember(9, &live, &vertices, &rays);
        assert_eq!(trail.slots(), 0);
    }
}
