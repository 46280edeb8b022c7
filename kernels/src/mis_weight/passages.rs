//! What lies between the starts of a candidate and its light, where extinction varies: optical depths and extinctions,
//! as running sums.
//!
//! ```text
//! inserted vertices:  sums over segments and vertices, from the light to the start
//! history:            sum up to the start, plus what its path passed through, minus what it had passed through there
//! ```

use wide::f32x8;

use crate::Step;
use crate::columns::paths::PassageColumns;
use crate::columns::trail::PassageTrail;
use crate::connect::suffix::{Passage, Suffix};
use crate::lanes::{self, LANES};
use crate::media::spectral::CHANNELS;
use crate::media::{MediumLanes, MediumX8, log_event};

/// Where the running sums of eight paths are, as many of each as the medium has.
pub struct Passages<'a, 'q> {
    pub lane_of: [u32; LANES],
    /// Up to the current vertices.
    pub current: &'a [PassageColumns<'q>],
    /// Up to those before.
    pub trail: &'a [PassageTrail<'q>],
    pub step: Step,
}

impl Passages<'_, '_> {
    /// Whether channels are [apart](crate::media::field::Apart).
    #[inline(always)]
    pub fn are_apart(&self) -> bool {
        self.current.len() > 1
    }

    /// Fills depths and extinctions of the suffix up to `most_edges` from the light, with `inserted` vertices of it made
    /// by a connection; where channels are apart, in each of them. Gives the rows of which none of these is in vacuum,
    /// where nothing scatters.
    #[inline(always)]
    pub fn fill(&self, media: impl MediumLanes, suffix: &mut Suffix<'_>, inserted: usize, most_edges: usize) -> f32x8 {
        if !self.are_apart() {
            return self.fill_one(0, media.own(), suffix, inserted, most_edges);
        }
        for c in 0..CHANNELS {
            self.fill_one(c, media.of_sum(c), suffix, inserted, most_edges);
            let vertices = 1..=most_edges.max(inserted + 1);
            for (apart, vertex) in suffix.apart[vertices.clone()].iter_mut().zip(&suffix.vertices[vertices]) {
                apart[c] = Passage { depth: vertex.depth, log_extinction: vertex.log_extinction };
            }
        }
        let vertices = suffix.vertices[1..=inserted].iter();
        vertices.fold(lanes::mask(lanes::ALL), |dense, vertex| {
            dense & media.own().extinction(vertex.position).simd_gt(f32x8::ZERO)
        })
    }

    /// The same in the channel of one of the sums.
    #[inline(always)]
    fn fill_one(
        &self,
        channel: usize,
        medium: impl MediumX8,
        suffix: &mut Suffix<'_>,
        inserted: usize,
        most_edges: usize,
    ) -> f32x8 {
        let (current, trail) = (&self.current[channel], &self.trail[channel]);
        let (mut depth, mut log, mut dense) = (f32x8::ZERO, f32x8::ZERO, lanes::mask(lanes::ALL));
        for a in 1..=inserted + 1 {
            let next = suffix.vertices[a - 1].position;
            let vertex = &mut suffix.vertices[a];
            let length = (next - vertex.position).length_squared().sqrt();
            depth += medium.optical_depth(vertex.position, next, length);
            (vertex.depth, vertex.log_extinction) = (depth, log);
            if a <= inserted {
                let extinction = medium.extinction(vertex.position);
                dense &= extinction.simd_gt(f32x8::ZERO);
                log += log_event(extinction);
            }
        }
        if most_edges > inserted + 1 {
            let [whole, whole_log] =
                [&current.depth, &current.log_extinction].map(|column| column.gather(&self.lane_of));
            for a in inserted + 2..=most_edges {
                let [before, log_before] = trail.gather(&self.lane_of, self.step.clock - (a - inserted - 1) as u32);
                let vertex = &mut suffix.vertices[a];
                vertex.depth = depth + (whole - before);
                vertex.log_extinction = log + (whole_log - log_before);
            }
        }
        dense
    }
}
