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

use crate::lanes::LANES;
use crate::vec3::Vec3x8;

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

/// Rows of every path over the bounce clock, those of a lane next to each other.
struct LaneRings<'q, T> {
    rows: &'q mut [T],
    slots: usize,
    /// Rows from one lane to the next: odd, so that lanes do not share sets of the cache.
    stride: usize,
}

impl<'q, T: Copy> LaneRings<'q, T> {
    /// `slots` rows for each of `lanes` paths.
    fn new_in(arena: &'q Bump, lanes: usize, slots: usize, zero: T) -> Self {
        let stride = if slots == 0 { 0 } else { slots | 1 };
        Self { rows: arena.alloc_slice_fill_copy(lanes.next_multiple_of(LANES) * stride, zero), slots, stride }
    }

    #[inline(always)]
    fn index(&self, lane: usize, clock: u32) -> usize {
        lane * self.stride + clock as usize % self.slots
    }

    #[inline(always)]
    fn at(&self, lane: usize, clock: u32) -> T {
        self.rows[self.index(lane, clock)]
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, clock: u32, row: T) {
        let index = self.index(lane, clock);
        self.rows[index] = row;
    }
}

/// Vertices of every path, as many as there are slots.
pub struct TrailTable<'q> {
    rings: LaneRings<'q, f32x8>,
}

impl<'q> TrailTable<'q> {
    /// Room for the last `slots` vertices of `lanes` paths; none at all if nothing looks back.
    pub fn new_in(arena: &'q Bump, lanes: usize, slots: usize) -> Self {
        Self { rings: LaneRings::new_in(arena, lanes, slots, f32x8::ZERO) }
    }

    /// Vertices that are remembered at a time.
    pub fn slots(&self) -> usize {
        self.rings.slots
    }

    /// Overwrites the vertices that were current at `clock` in the lanes of batch `b`.
    #[inline(always)]
    pub fn set_batch(&mut self, b: usize, clock: u32, mark: MarkBatch) {
        let MarkBatch { position, arc, leaving, light_sum } = mark;
        let columns = [position.x, position.y, position.z, arc, leaving.x, leaving.y, leaving.z, light_sum];
        for (i, row) in f32x8::transpose(columns).into_iter().enumerate() {
            self.rings.set(b * LANES + i, clock, row);
        }
    }

    /// The vertices that were current at `clock` in the lanes that `lanes` names.
    #[inline(always)]
    pub fn gather(&self, lanes: &[u32; LANES], clock: u32) -> MarkBatch {
        let [x, y, z, arc, dx, dy, dz, light_sum] =
            f32x8::transpose(lanes.map(|lane| self.rings.at(lane as usize, clock)));
        MarkBatch { position: Vec3x8::new(x, y, z), arc, leaving: Vec3x8::new(dx, dy, dz), light_sum }
    }

    /// Lanes of the table.
    pub fn lanes(&self) -> usize {
        self.rings.rows.len().checked_div(self.rings.stride).unwrap_or(0)
    }

    /// The eight numbers of a row.
    pub fn numbers(&self, lane: usize, clock: u32) -> [f32; 8] {
        self.rings.at(lane, clock).to_array()
    }

    /// Overwrites the eight numbers of a row.
    pub fn set_numbers(&mut self, lane: usize, clock: u32, numbers: [f32; 8]) {
        self.rings.set(lane, clock, f32x8::new(numbers));
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

/// What every path had passed through at the vertices that it has left: the fields of
/// [`Passage`](super::paths::Passage), in as many slots as the trail has, where extinction varies.
pub struct PassageTrail<'q> {
    rings: LaneRings<'q, [f32; 2]>,
}

impl<'q> PassageTrail<'q> {
    /// Room for the last `slots` vertices of `lanes` paths.
    pub fn new_in(arena: &'q Bump, lanes: usize, slots: usize) -> Self {
        Self { rings: LaneRings::new_in(arena, lanes, slots, [0.0; 2]) }
    }

    /// Vertices that are remembered at a time.
    pub fn slots(&self) -> usize {
        self.rings.slots
    }

    /// Overwrites what the lanes of batch `b` had passed through at `clock`, if anything is remembered.
    #[inline(always)]
    pub fn set_batch(&mut self, b: usize, clock: u32, [depth, log_extinction]: [f32x8; 2]) {
        let pairs = depth.to_array().into_iter().zip(log_extinction.to_array());
        pairs.enumerate().for_each(|(i, pair)| self.set_row(b * LANES + i, clock, pair.into()));
    }

    /// Overwrites what `lane` had passed through at `clock`, if anything is remembered.
    #[inline(always)]
    pub fn set_row(&mut self, lane: usize, clock: u32, pair: [f32; 2]) {
        if self.slots() > 0 {
            self.rings.set(lane, clock, pair);
        }
    }

    /// What `lane` had passed through at `clock`.
    pub fn row(&self, lane: usize, clock: u32) -> [f32; 2] {
        self.rings.at(lane, clock)
    }

    /// What the lanes that `lanes` names had passed through at `clock`.
    #[inline(always)]
    pub fn gather(&self, lanes: &[u32; LANES], clock: u32) -> [f32x8; 2] {
        let pairs = lanes.map(|lane| self.rings.at(lane as usize, clock));
        [0, 1].map(|i| f32x8::new(pairs.map(|pair| pair[i])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_holds_the_last_vertices_of_every_lane() {
        let arena = Bump::new();
        let mut trail = TrailTable::new_in(&arena, 16, 4);
        let mark = |clock: u32, lane: usize| {
            let number = (100 * clock) as f32 + lane as f32;
            let leaving = [number + 0.5, 0.25, -number];
            Mark { position: [number, -1.0, 2.0 * number], arc: number + 1.0, leaving, light_sum: 7.0 + number }
        };
        let of_batch = |clock: u32, b: usize| {
            let real = |value: &dyn Fn(Mark) -> f32| {
                f32x8::new(core::array::from_fn(|lane| value(mark(clock, b * LANES + lane))))
            };
            let vector = |value: &dyn Fn(Mark) -> [f32; 3]| {
                let [x, y, z] = [0, 1, 2].map(|axis| real(&|mark| value(mark)[axis]));
                Vec3x8::new(x, y, z)
            };
            MarkBatch {
                position: vector(&|mark| mark.position),
                arc: real(&|mark| mark.arc),
                leaving: vector(&|mark| mark.leaving),
                light_sum: real(&|mark| mark.light_sum),
            }
        };
        for clock in 40..50 {
            (0..2).for_each(|b| trail.set_batch(b, clock, of_batch(clock, b)));
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
}
