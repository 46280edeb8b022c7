//! The state of every path in flight: one lane of [`PathTable`] each, its last vertices and rays in [`VertexTable`]
//! and [`RayTable`].
//!
//! A path keeps its lane from birth to death. Vertices and rays are rings over the bounce clock: at clock `t` every live
//! path, whatever its depth, has its current vertex and the ray that leaves it in the slot of `t`, its previous vertex
//! in the slot of `t - 1`, its next one in that of `t + 1`. The depth of a path is the clock minus its birth. What lies
//! farther back stands in the [`TrailTable`](super::trail::TrailTable).

use bumpalo::Bump;
use wide::{f32x8, u32x8};

use super::Column;
use crate::columns;
use crate::lanes::{self, LaneSet};

columns! {
    /// What belongs to a path as a whole.
    table PathColumns of Path {
        /// Index in the whole image, row-major from the upper left corner.
        pixel: u32,
        /// Number of the sample in its pixel.
        sample: u32,
        /// Bounce clock at which the path's camera vertex was made.
        birth: u32,
        /// Depth of the last surface vertex, 0 if there is none: starts before it are not eligible, because connections
        /// insert medium vertices only. Between it and the current vertex all vertices lie in the medium.
        last_surface: u32,
        /// Unit normal of that surface, on the side on which the path is; undefined if there is none.
        surface_normal: [f32; 3],
        /// Depth of the first vertex from which a light is within the distance limit of a technique that has one;
        /// `u32::MAX` if none is. Conservative: starts before it are certainly out of reach of every limited technique.
        first_near: u32,
        /// Product of `f / p` over all vertices before the current ray, per channel (transport: T): albedos, and where first
        /// flights are aimed the first one's weight.
        throughput: [f32; 3],
        /// Sum of the contributions found so far, per channel [W/(m^2 sr)].
        radiance: [f32; 3],
    }
}

columns! {
    /// One vertex of every path.
    table VertexColumns of Vertex {
        /// Where the vertex is `[m]`.
        position: [f32; 3],
        /// Length of the path from its first vertex after the camera to this one `[m]`; 0 at the camera.
        arc: f32,
        /// Normalisation of the light selection at this vertex, sum over lights of share / distance [1/m]; undefined
        /// where the selection does not depend on the vertex.
        light_sum: f32,
    }
}

columns! {
    /// The ray that leaves a vertex of every path.
    table RayColumns of Ray {
        /// Unit direction, away from the camera.
        direction: [f32; 3],
    }
}

/// All paths of a worker, one lane each.
pub struct PathTable<'q> {
    /// Their columns.
    pub columns: PathColumns<'q>,
    /// Lanes whose path goes on.
    pub live: LaneSet<'q>,
    /// Lanes that hold a path: a path that has ended stays until it is accumulated and its lane refilled.
    pub occupied: LaneSet<'q>,
    /// Lanes whose current segment ends on a surface.
    pub on_surface: LaneSet<'q>,
    /// Channels in use: 1 where everything is grey, 3 otherwise.
    pub channels: usize,
    /// Whether there are surfaces that a path may meet.
    pub has_surfaces: bool,
}

impl<'q> PathTable<'q> {
    /// An empty table of `lanes` lanes, for a world without surfaces.
    pub fn new_in(arena: &'q Bump, lanes: usize, channels: usize) -> Self {
        assert!(channels == 1 || channels == 3, "{channels} channels; 1 or 3 are possible");
        Self {
            columns: PathColumns::new_in(arena, lanes),
            live: LaneSet::new_in(arena, lanes),
            occupied: LaneSet::new_in(arena, lanes),
            on_surface: LaneSet::new_in(arena, lanes),
            channels,
            has_surfaces: false,
        }
    }

    /// Number of batches.
    pub fn batches(&self) -> usize {
        self.live.batches()
    }

    /// Depth of the current vertex of the path in `lane`.
    pub fn depth(&self, clock: u32, lane: usize) -> u32 {
        clock - self.columns.birth.rows()[lane]
    }

    /// Depth of the first eligible start of the path in `lane`, >= 1: the camera segment is never sampled again.
    pub fn first_start(&self, lane: usize) -> u32 {
        self.columns.last_surface.rows()[lane].max(1)
    }

    /// Ends the paths whose current segment is their `longest`-th.
    pub fn end_after(&mut self, clock: u32, longest: u32) {
        let born = u32x8::splat(clock + 1 - longest);
        for b in 0..self.live.batches() {
            let ended = lanes::as_mask(self.columns.birth.batch(b).simd_eq(born));
            self.live.remove_batch(b, lanes::bits(ended));
        }
    }

    /// Multiplies the throughput of the live paths among `chosen` by their row of `factor`.
    pub fn scale_throughput(&mut self, chosen: &LaneSet<'_>, factor: &Column<'_, f32>) {
        for (b, bits) in chosen.each_batch() {
            let scaled = lanes::mask(bits & self.live.batch(b));
            let factor = scaled.select(factor.batch(b), f32x8::ONE);
            for channel in self.columns.throughput.channels_mut().into_iter().take(self.channels) {
                channel.set_batch(b, channel.batch(b) * factor);
            }
        }
    }

    /// Ends the paths that stay in the medium.
    pub fn end_in_medium(&mut self) {
        for b in 0..self.live.batches() {
            self.live.remove_batch(b, !self.on_surface.batch(b));
        }
    }
}

/// A ring of tables over the bounce clock.
pub struct Ring<'q, T> {
    slots: &'q mut [T],
}

/// The vertices at which all paths are: the current one, the one before, and the one after.
pub type VertexTable<'q> = Ring<'q, VertexColumns<'q>>;

/// The rays that leave them.
pub type RayTable<'q> = Ring<'q, RayColumns<'q>>;

impl<'q> VertexTable<'q> {
    /// The three vertices of every lane.
    pub fn new_in(arena: &'q Bump, lanes: usize) -> Self {
        Self { slots: arena.alloc_slice_fill_with(3, |_| VertexColumns::new_in(arena, lanes)) }
    }
}

impl<'q> RayTable<'q> {
    /// The three rays of every lane.
    pub fn new_in(arena: &'q Bump, lanes: usize) -> Self {
        Self { slots: arena.alloc_slice_fill_with(3, |_| RayColumns::new_in(arena, lanes)) }
    }
}

impl<T> Ring<'_, T> {
    /// Number of slots: as many clocks as are remembered at a time.
    pub fn slots(&self) -> usize {
        self.slots.len()
    }

    #[inline(always)]
    fn index(&self, clock: u32) -> usize {
        clock as usize % self.slots.len()
    }

    /// What was current at `clock`.
    #[inline(always)]
    pub fn at(&self, clock: u32) -> &T {
        &self.slots[self.index(clock)]
    }

    /// What was current at `clock`, to change.
    #[inline(always)]
    pub fn at_mut(&mut self, clock: u32) -> &mut T {
        let index = self.index(clock);
        &mut self.slots[index]
    }

    /// The slot of `clock`, to read, and that of `clock + 1`, to fill.
    #[inline(always)]
    pub fn step(&mut self, clock: u32) -> (&T, &mut T) {
        let (from, to) = (self.index(clock), self.index(clock + 1));
        let [from, to] = self.slots.get_disjoint_mut([from, to]).expect("a ring has at least two slots");
        (from, to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_remembers_the_vertex_before() {
        let arena = Bump::new();
        let mut vertices = VertexTable::new_in(&arena, 8);
        let start = 100;
        for clock in start..start + 20 {
            vertices.step(clock).1.position.set_row(2, [clock as f32, 0.0, 0.0]);
            for back in 0..=1.min(clock - start) {
                assert_eq!(vertices.at(clock + 1 - back).position.row(2)[0], (clock - back) as f32);
            }
        }
    }

    #[test]
    fn starts_run_from_the_last_surface() {
        let arena = Bump::new();
        let mut paths = PathTable::new_in(&arena, 8, 1);
        assert_eq!(paths.first_start(0), 1);
        paths.columns.last_surface.rows_mut()[0] = 4;
        assert_eq!(paths.first_start(0), 4);
    }
}
