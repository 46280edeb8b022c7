//! The state of every path in flight: one lane of each table here.
//!
//! A path keeps its lane from birth to death. Vertices and rays are rings over the bounce clock: at clock `t` every
//! live path, whatever its depth, has its current vertex and the ray that leaves it in the slot of `t`, its previous
//! vertex in the slot of `t - 1`, its next one in that of `t + 1`. The depth of a path is the clock minus its birth.
//! What lies farther back stands in the [`TrailTable`](super::trail::TrailTable).

use core::ops::Range;

use bumpalo::Bump;

use crate::columns;
use crate::real::Real;

columns! {
    /// Which sample a path is.
    table PathColumns of Path {
        /// Index in the whole image, row-major from the upper left corner.
        pixel: u32,
        /// Number of the sample in its pixel.
        sample: u32,
        /// Bounce clock at which the path's camera vertex was made.
        birth: u32,
    }
}

columns! {
    /// How every path sees what it is in.
    table ImmersionColumns of Immersion {
        /// Channel for which the path's flights are drawn, 0 to 2; 0 where extinction is grey.
        hero: u32,
    }
}

columns! {
    /// The last vertex on a surface of every path. Between it and the current vertex all vertices lie in the medium:
    /// starts before it are not eligible, because connections insert medium vertices only.
    table LastSurfaceColumns of LastSurface {
        /// Its depth, 0 if there is none.
        depth: u32,
        /// Unit normal there, on the side on which the path is; undefined if there is none.
        normal: [f32; 3],
    }
}

columns! {
    /// One vertex of every path.
    table VertexColumns of Vertex {
        /// Where the vertex is `[m]`.
        position: [f32; 3],
        /// Length of the path from its first vertex after the camera to this one `[m]`; 0 at the camera.
        arc: f32,
    }
}

columns! {
    /// What every path has passed through from its first vertex after the camera to the current one, where extinction
    /// varies.
    table PassageColumns of Passage {
        /// Optical depth, as weights count it.
        depth: f32,
        /// ln of the product of the extinctions at these vertices, both included, but for those on surfaces [1/m].
        log_extinction: f32,
    }
}

columns! {
    /// The ray that leaves a vertex of every path.
    table RayColumns of Ray {
        /// Unit direction, away from the camera.
        direction: [f32; 3],
    }
}

columns! {
    /// What the current vertex of every path knows of the lights.
    table OutlookColumns of Outlook {
        /// Normalisation of the light selection at the vertex, sum over lights of share / distance [1/m]; undefined
        /// where the selection does not depend on the vertex.
        light_sum: f32,
        /// Depth of the first vertex of the path from which a light is within the distance limit of a technique that
        /// has one; `u32::MAX` if none is. Conservative: starts before it are certainly too far for every limited
        /// technique.
        first_near: u32,
    }
}

columns! {
    /// What the camera sees first along the ray of every path's sample, for layers of the film beside radiance.
    table FeatureColumns of Feature {
        /// Distance of the first surface or lamp from the start of the ray `[m]`; infinite if there is none.
        clear: f32,
        /// Distance from the camera, along its axis, of where the sample's light is first scattered or absorbed `[m]`;
        /// 0 if that is nowhere.
        depth: f32,
        /// Whether there is such a place: 1 or 0.
        hit: f32,
        /// Unit normal of the surface or lamp there, on the side of the camera; zero in a medium, or if there is no
        /// such place.
        normal: [f32; 3],
        /// Share of the light that is reflected or scattered there, per channel, [0, 1]; 0 of lamps, or if there is no
        /// such place.
        albedo: [f32; 3],
        /// What media leave of light from the first surface or lamp, or from infinity, per channel: an estimate without
        /// bias, >= 0.
        transmittance: [f32; 3],
    }
}

impl PathColumns<'_> {
    /// Depth of the current vertex of the path in `lane`.
    pub fn depth_of(&self, clock: u32, lane: usize) -> u32 {
        clock - self.birth.rows()[lane]
    }
}

/// Some rows of a [`PathColumns`], to read.
#[derive(Clone, Copy)]
pub struct PathRows<'a, F: Real = f32> {
    /// Pixels.
    pub pixel: &'a [F::Word],
    /// Samples.
    pub sample: &'a [F::Word],
    /// Births.
    pub birth: &'a [F::Word],
}

impl<F: Real> PathRows<'_, F> {
    /// The first `n` of them.
    #[inline(always)]
    pub fn first(self, n: usize) -> Self {
        Self { pixel: &self.pixel[..n], sample: &self.sample[..n], birth: &self.birth[..n] }
    }
}

impl PathColumns<'_> {
    /// The rows of some batches.
    #[inline(always)]
    pub fn stretch<F: Real>(&self, batches: Range<usize>) -> PathRows<'_, F> {
        let [pixel, sample, birth] =
            [&self.pixel, &self.sample, &self.birth].map(|column| column.stretch::<F>(batches.clone()));
        PathRows { pixel, sample, birth }
    }
}

impl LastSurfaceColumns<'_> {
    /// Depth of the first eligible start of the path in `lane`, >= 1: the camera segment is never sampled again.
    pub fn first_start(&self, lane: usize) -> u32 {
        self.depth.rows()[lane].max(1)
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

    /// The slot of `clock - 1`, and that of `clock`.
    #[inline(always)]
    pub fn last_two(&self, clock: u32) -> [&T; 2] {
        [self.at(clock - 1), self.at(clock)]
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
        let mut last_surface = LastSurfaceColumns::new_in(&arena, 8);
        assert_eq!(last_surface.first_start(0), 1);
        last_surface.depth.rows_mut()[0] = 4;
        assert_eq!(last_surface.first_start(0), 4);
    }
}
