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

use crate::columns::Spectrum;
use crate::columns::queues::WorthTable;
use crate::connect::suffix::{Suffix, SuffixVertex};
use crate::lanes::LANES;
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
    /// Extinction of all channels over that of the reference.
    pub hues: Hues,
    /// ln of the probability that a path was drawn for a channel, given its way to the start.
    log_posterior: [f32x8; CHANNELS],
    /// Vertices between start and light.
    inserted: usize,
    /// The reference's optical depth between them.
    depth: f32x8,
}

impl Colours {
    /// Those of the candidates of the paths in eight lanes, whose suffixes know their arcs and, in their own channel, depths.
    #[inline(always)]
    pub fn new(
        lane_of: [u32; LANES],
        inserted: usize,
        medium: impl MediumLanes,
        log_posterior: &Spectrum<'_>,
        suffix: &Suffix<'_>,
    ) -> Self {
        let log_posterior: [f32x8; CHANNELS] = core::array::from_fn(|c| log_posterior.channels()[c].gather(&lane_of));
        let first = u32x8::splat(0);
        let SuffixVertex { arc, depth: summed, .. } = suffix.vertices[inserted + 1];
        let depth = medium.in_channel(|| first).optical_depth_along(arc, summed);
        let quotients = Hues::new(medium, first).log_quotients(f32x8::splat(inserted as f32), depth);
        let reference = largest(core::array::from_fn(|c| log_posterior[c] + quotients[c]));
        let depth = medium.in_channel(|| reference).optical_depth_along(arc, summed);
        Self { reference, hues: Hues::new(medium, reference), log_posterior, inserted, depth }
    }

    /// `posterior_c(s) (p_c / p_*)` of a walk from the start past `vertices` vertices over the reference's `depth`.
    #[inline(always)]
    fn walked(&self, vertices: f32, depth: f32x8) -> [f32x8; CHANNELS] {
        let quotients = self.hues.log_quotients(f32x8::splat(vertices), depth);
        core::array::from_fn(|c| exp(self.log_posterior[c] + quotients[c]))
    }

    /// W_n: the density with which walks, in all channels, go on from the start to the light, over that in the
    /// reference.
    #[inline(always)]
    pub fn walked_to_the_light(&self) -> f32x8 {
        let [a, b, c] = self.walked(self.inserted as f32, self.depth);
        a + b + c
    }

    /// Multiplies the attempts of `starts`, counted from the light, by W_i, and fills the channels' shares of it.
    #[inline(always)]
    pub fn share(&self, starts: RangeInclusive<usize>, suffix: &mut Suffix<'_>) {
        for a in starts {
            let vertices = (self.inserted + 1) as f32 - a as f32;
            let terms @ [x, y, z] = self.walked(vertices, self.depth - suffix.vertices[a].depth);
            let sum = x + y + z;
            suffix.vertices[a].attempt *= sum;
            suffix.shares[a] = terms.map(|term| term / sum);
        }
    }

    /// Multiplies the factors of batch `b` by the light that arrives in each channel over that in the reference.
    #[inline(always)]
    pub fn fill_quotients(&self, b: usize, worth: &mut WorthTable<'_>) {
        let quotients = self.hues.log_quotients(f32x8::splat(self.inserted as f32), self.depth);
        for (factor, quotient) in worth.factor.channels_mut().iter_mut().zip(quotients) {
            let quotient = exp(quotient.fast_min(f32x8::splat(LARGEST_EXPONENT)));
            factor.set_batch(b, factor.batch(b) * quotient);
        }
    }
}
