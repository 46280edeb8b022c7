//! The last vertices of eight candidates, and the sums over them that every start shares.

use bumpalo::Bump;
use wide::f32x8;

use super::likelihood::LengthLikelihood;
use crate::media::spectral::{CHANNELS, Hues};
use crate::vec3::Vec3x8;

/// What a vertex of the suffix contributes to the ratios.
#[derive(Clone, Copy)]
pub struct SuffixVertex {
    /// Position `[m]`.
    pub position: Vec3x8,
    /// Length of the path from here to vertex 1, the last before the light `[m]`: what is short beside the way to a lamp
    /// far away would be lost in a sum with it.
    pub arc: f32x8,
    /// Optical depth of the path from here to the light, in the channel of the row's medium (tau); known where a
    /// connection may start.
    pub depth: f32x8,
    /// ln of the product of the extinctions at the vertices between here and the light; known where extinction varies.
    pub log_extinction: f32x8,
    /// One over the density of the direction in which the path leaves (p_w) `[sr]`.
    pub inverse_density: f32x8,
    /// Squared length of the segment that arrives here, over pi p_w [m^2 sr].
    pub spread: f32x8,
    /// Unit direction in which the path leaves.
    pub leaving: Vec3x8,
    /// Normalisation of the light selection from here [1/m]; where it depends on the vertex, and only from the start
    /// on.
    pub light_sum: f32x8,
    /// Probability that a walk gets here and selects the candidate's light; where extinction is coloured, times the
    /// density of walks up to here, in all channels, over that of the row's.
    pub attempt: f32x8,
    /// Whether a connection may start here.
    pub eligible: f32x8,
    /// Whether it is on a surface.
    pub on_surface: f32x8,
}

/// How one start sees a vertex between it and the light, reprojected on its axis (MVNEE).
#[derive(Clone, Copy)]
pub struct Projection {
    /// Squared distance between the projections of this vertex and the one before it [m^2].
    pub segment_squared: f32x8,
    /// Sum of `segment_squared` from the start up to this vertex (L) [m^2].
    pub before: f32x8,
    /// Squared distance from the axis (rho^2) [m^2].
    pub offset_squared: f32x8,
    /// Distance from the start along the axis `[m]`.
    pub along: f32x8,
}

/// Suffixes of eight candidates, indexed from the light: vertex 0 is the point on the light, vertex `a` is `a` segments
/// away from it.
pub struct Suffix<'q> {
    /// The vertices; index 0 has a position only.
    pub vertices: &'q mut [SuffixVertex],
    /// Scratch for one start at a time.
    pub projections: &'q mut [Projection],
    /// What the lengths of bridges say, by their number of edges.
    pub likelihoods: &'q [LengthLikelihood],
    /// Where extinction is coloured: how probable every channel is as that of which the walk up to here was drawn; they
    /// add up to 1.
    pub shares: &'q mut [[f32x8; CHANNELS]],
    /// Where channels are [apart](crate::media::field::Apart): depth and log_extinction of the vertices in each of them; 0
    /// of vertex 0.
    pub apart: &'q mut [[Passage; CHANNELS]],
}

/// [`SuffixVertex::depth`] and [`SuffixVertex::log_extinction`] in one channel.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Optical depth from here to the light.
    pub depth: f32x8,
    /// ln of the product of the extinctions between.
    pub log_extinction: f32x8,
}

impl Passage {
    /// Nothing.
    pub const NOTHING: Self = Self { depth: f32x8::ZERO, log_extinction: f32x8::ZERO };
}

impl<'q> Suffix<'q> {
    /// Room for paths of `longest` segments.
    pub fn new_in(arena: &'q Bump, longest: usize) -> Self {
        let zero = f32x8::ZERO;
        let vertex = SuffixVertex {
            position: Vec3x8::ZERO,
            arc: zero,
            depth: zero,
            log_extinction: zero,
            inverse_density: zero,
            spread: zero,
            leaving: Vec3x8::ZERO,
            light_sum: zero,
            attempt: zero,
            eligible: zero,
            on_surface: zero,
        };
        let projection = Projection { segment_squared: zero, before: zero, offset_squared: zero, along: zero };
        Self {
            // One more, the vertex before the farthest start: it knows the direction in which the path arrives.
            vertices: arena.alloc_slice_fill_copy(longest + 2, vertex),
            projections: arena.alloc_slice_fill_copy(longest + 1, projection),
            likelihoods: arena.alloc_slice_fill_with(longest + 1, |edges| LengthLikelihood::new(edges.max(1))),
            shares: arena.alloc_slice_fill_copy(longest + 2, [zero; CHANNELS]),
            apart: arena.alloc_slice_fill_copy(longest + 2, [Passage::NOTHING; CHANNELS]),
        }
    }
}

/// What all starts of a candidate have in common.
#[derive(Clone, Copy)]
pub struct Arrival<'a, M> {
    /// The medium, in the channel in which each row is weighed.
    pub medium: M,
    /// Its extinction in all channels over that one, if they differ.
    pub hues: Option<&'a Hues>,
    /// Density of the point on its light, p_A [1/m^2].
    pub inverse_area: f32x8,
    /// Squared length of the last segment, l_{n-1}^2 [m^2].
    pub last_squared: f32x8,
    /// Its optical depth, in the channel of the row's medium.
    pub last_depth: f32x8,
    /// Cosine between the last segment and the light's normal, > 0 where the light is seen from its front.
    pub cos_light: f32x8,
    /// Length of the last segment where arcs leave it out: 0 where vertex 0 is the last before the light `[m]`.
    pub last_arc: f32x8,
    /// What the suffix counts beyond vertex 0: nothing where that is on the light.
    pub skipped: Passage,
}

impl<M> Arrival<'_, M> {
    /// What the path passes from `start` to vertex 0.
    #[inline(always)]
    pub fn way(&self, start: &SuffixVertex) -> Passed {
        Passed {
            arc: start.arc + self.last_arc,
            depth: start.depth - self.skipped.depth,
            log_extinction: start.log_extinction - self.skipped.log_extinction,
        }
    }
}

/// What a path passes on the way from one of its vertices to another.
#[derive(Clone, Copy)]
pub struct Passed {
    /// Length `[m]`.
    pub arc: f32x8,
    /// Optical depth, in the channel of the row's medium.
    pub depth: f32x8,
    /// ln of the product of the extinctions at the vertices between; known where extinction varies.
    pub log_extinction: f32x8,
}
