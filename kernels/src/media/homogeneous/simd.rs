//! ```text
//! flight = -ln(rest) / mu_t,      tau = mu_t L
//! ```
//!
//! 1. Rows that are not in use may ask for any channel.
//! 2. In vacuum the mean free path is infinite and `rest` below 1, so that flights are endless.

use wide::{f32x8, u32x8};

use super::Homogeneous;
use crate::connect::suffix::SuffixVertex;
use crate::media::spectral::CHANNELS;
use crate::media::{MediumLanes, MediumX8};
use crate::transcendental::neg_ln;
use crate::vec3x8::Vec3x8;

/// A homogeneous medium in one channel per row.
#[derive(Clone, Copy)]
pub struct HomogeneousX8 {
    extinction: f32x8,
    mean_free_path: f32x8,
}

impl MediumLanes for Homogeneous {
    type Channel = HomogeneousX8;

    #[inline(always)]
    fn is_grey(&self) -> bool {
        Homogeneous::is_grey(self)
    }

    #[inline(always)]
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> HomogeneousX8 {
        if Homogeneous::is_grey(self) {
            let [extinction, mean_free_path] = [self.extinction[0], self.mean_free_path[0]].map(f32x8::splat);
            return HomogeneousX8 { extinction, mean_free_path };
        }
        let channel = channel().to_array();
        let [extinction, mean_free_path] = [&self.extinction, &self.mean_free_path]
            .map(|of| f32x8::new(channel.map(|channel| of[(channel as usize).min(CHANNELS - 1)])));
        HomogeneousX8 { extinction, mean_free_path }
    }

    fn hues(&self) -> [f32; 3] {
        self.extinction
    }
}

impl MediumX8 for HomogeneousX8 {
    #[inline(always)]
    fn flight(self, rest: f32x8) -> f32x8 {
        neg_ln(rest) * self.mean_free_path
    }

    #[inline(always)]
    fn optical_depth(self, _: Vec3x8, _: Vec3x8, length: f32x8) -> f32x8 {
        self.extinction * length
    }

    #[inline(always)]
    fn optical_depth_along(self, arc: f32x8) -> f32x8 {
        self.extinction * arc
    }

    #[inline(always)]
    fn extinction(self, _: Vec3x8) -> f32x8 {
        self.extinction
    }

    #[inline(always)]
    fn crowding(self, _: &SuffixVertex) -> f32x8 {
        self.extinction
    }
}
