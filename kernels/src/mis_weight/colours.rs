//! Weights where extinction differs between channels, as [`spectral`](crate::media::spectral) derives them.
//!
//! ```text
//! * = channel of the largest posterior_c(s) p_c(x_s .. x_n)
//! W_i = sum_c posterior_c(s) (p_c / p_*)(x_s .. x_i);      share_c(i) = its term over it
//! sum = reach(n) W_n + sum_i reach(i) W_i r_i,             factor_k = albedo^m (p_k / p_*)(x_s .. x_n)
//! ```
//!
//! 1. Vertices are counted from the start s, and depths measured from there: both are negative for the vertices before
//!    it, which makes the quotients the reciprocals that they have to be.
//! 2. Logarithms are added before anything is exponentiated.

use core::ops::RangeInclusive;

use wide::{f32x8, u32x8};

use crate::columns::queues::WorthTable;
use crate::connect::suffix::{Passage, Suffix, SuffixVertex};
use crate::lanes;
use crate::media::spectral::{CHANNELS, Hues, largest};
use crate::media::{MediumLanes, MediumX8};
use crate::transcendental::exp;

/// Largest exponent of a factor: a channel in which a path is likelier by more is not the reference only if almost
/// nothing of it came as far as the start.
const LARGEST_EXPONENT: f32 = 80.0;

/// Eight candidates in all channels.
pub(super) struct Colours {
    /// The channel in which each is weighed.
    pub reference: u32x8,
    /// ln of the probability that a path was drawn for a channel, given its way to the start.
    log_posterior: [f32x8; CHANNELS],
    /// Vertices between start and light.
    inserted: usize,
    walks: Walks,
}

/// What is known of walks in all channels.
enum Walks {
    /// Channels are multiples of each other.
    Together {
        /// Extinction of all channels over that of the reference.
        hues: Hues,
        /// The reference's optical depth from the start to the light.
        depth: f32x8,
    },
    /// Each channel has sums of its own: those of the start.
    Apart([Passage; CHANNELS]),
}

impl Colours {
    /// Those of candidates of paths with this ln of posteriors, whose suffixes know their arcs and, in their own channel,
    /// depths, and end with a segment of this length `[m]`.
    #[inline(always)]
    pub fn new(
        inserted: usize,
        medium: impl MediumLanes,
        log_posterior: [f32x8; CHANNELS],
        suffix: &Suffix<'_>,
        last_length: f32x8,
    ) -> Self {
        let first = u32x8::splat(0);
        let SuffixVertex { arc, depth: summed, .. } = suffix.vertices[inserted + 1];
        let arc = arc + last_length;
        let depth = medium.in_channel(|| first).optical_depth_along(arc, summed);
        let quotients = Hues::new(medium, first).log_quotients(f32x8::splat(inserted as f32), depth);
        let reference = largest(core::array::from_fn(|c| log_posterior[c] + quotients[c]));
        let depth = medium.in_channel(|| reference).optical_depth_along(arc, summed);
        let walks = Walks::Together { hues: Hues::new(medium, reference), depth };
        Self { reference, log_posterior, inserted, walks }
    }

    /// The same where channels are [apart](crate::media::field::Apart). Depths and extinctions of the suffix, up to
    /// `most_edges` from the light, become those of the reference.
    #[inline(always)]
    pub fn apart(
        inserted: usize,
        log_posterior: [f32x8; CHANNELS],
        suffix: &mut Suffix<'_>,
        most_edges: usize,
    ) -> Self {
        let start = suffix.apart[inserted + 1];
        let reference = largest(core::array::from_fn(|c| log_posterior[c] + start[c].log_extinction - start[c].depth));
        let vertices = 1..=most_edges.max(inserted + 1);
        for (vertex, passages) in suffix.vertices[vertices.clone()].iter_mut().zip(&suffix.apart[vertices]) {
            let own = of_reference(reference, passages);
            (vertex.depth, vertex.log_extinction) = (own.depth, own.log_extinction);
        }
        Self { reference, log_posterior, inserted, walks: Walks::Apart(start) }
    }

    /// Extinction of all channels over that of the reference, by which connections are drawn for the hero; none where they
    /// are drawn for none.
    #[inline(always)]
    pub fn hues(&self) -> Option<&Hues> {
        match &self.walks {
            Walks::Together { hues, .. } => Some(hues),
            Walks::Apart(_) => None,
        }
    }

    /// `ln (p_c / p_*)` of a walk from the start to vertex `a`, counted from the light.
    #[inline(always)]
    fn log_quotients(&self, a: usize, suffix: &Suffix<'_>) -> [f32x8; CHANNELS] {
        match &self.walks {
            Walks::Together { hues, depth } => {
                let vertices = (self.inserted + 1) as f32 - a.max(1) as f32;
                let left = if a == 0 { f32x8::ZERO } else { suffix.vertices[a].depth };
                hues.log_quotients(f32x8::splat(vertices), *depth - left)
            }
            Walks::Apart(start) => {
                let walked = |c: usize| {
                    let (from, to) = (start[c], suffix.apart[a]);
                    (from.log_extinction - to[c].log_extinction) - (from.depth - to[c].depth)
                };
                let logs = [0, 1, 2].map(walked);
                let own = select(self.reference, logs);
                logs.map(|log| log - own)
            }
        }
    }

    /// `posterior_c(s) (p_c / p_*)` of such a walk.
    #[inline(always)]
    fn walked(&self, a: usize, suffix: &Suffix<'_>) -> [f32x8; CHANNELS] {
        let quotients = self.log_quotients(a, suffix);
        core::array::from_fn(|c| exp(self.log_posterior[c] + quotients[c]))
    }

    /// W_n: the density with which walks, in all channels, go on from the start to the light, over that in the
    /// reference.
    #[inline(always)]
    pub fn walked_to_the_light(&self, suffix: &Suffix<'_>) -> f32x8 {
        let [a, b, c] = self.walked(0, suffix);
        a + b + c
    }

    /// Multiplies the attempts of `starts`, counted from the light, by W_i, and fills the channels' shares of it.
    #[inline(always)]
    pub fn share(&self, starts: RangeInclusive<usize>, suffix: &mut Suffix<'_>) {
        for a in starts {
            let terms @ [x, y, z] = self.walked(a, suffix);
            let sum = x + y + z;
            suffix.vertices[a].attempt *= sum;
            suffix.shares[a] = terms.map(|term| term / sum);
        }
    }

    /// Multiplies the factors of batch `b` by the light that arrives in each channel over that in the reference.
    #[inline(always)]
    pub fn fill_quotients(&self, b: usize, suffix: &Suffix<'_>, worth: &mut WorthTable<'_>) {
        let quotients = self.log_quotients(0, suffix);
        for (factor, quotient) in worth.factor.channels_mut().iter_mut().zip(quotients) {
            let quotient = exp(quotient.fast_min(f32x8::splat(LARGEST_EXPONENT)));
            factor.set_batch(b, factor.batch(b) * quotient);
        }
    }
}

/// What row i has passed in channel `reference[i]`.
#[inline(always)]
fn of_reference(reference: u32x8, passages: &[Passage; CHANNELS]) -> Passage {
    Passage {
        depth: select(reference, passages.map(|passage| passage.depth)),
        log_extinction: select(reference, passages.map(|passage| passage.log_extinction)),
    }
}

/// Of each row i, the value of channel `reference[i]`.
#[inline(always)]
fn select(reference: u32x8, [first, second, third]: [f32x8; CHANNELS]) -> f32x8 {
    let is = |channel: u32| lanes::as_mask(reference.simd_eq(u32x8::splat(channel)));
    is(2).select(third, is(1).select(second, first))
}
