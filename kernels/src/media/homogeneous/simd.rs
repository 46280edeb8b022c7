//! ```text
//! flight = -ln(rest) / mu_t,      tau = mu_t L
//! ```
//!
//! 1. Rows that are not in use may ask for any channel.
//! 2. In vacuum the mean free path is infinite and `rest` below 1, so that flights are endless.

use wide::{f32x8, u32x8};

use super::Homogeneous;
use crate::lanes;
use crate::media::lanes::Crowding;
use crate::media::spectral::CHANNELS;
use crate::media::{AxisX8, MediumLanes, MediumX8};
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;

/// A homogeneous medium of the same extinction in all channels.
#[derive(Clone, Copy)]
pub struct GreyLanes(HomogeneousX8);

/// A homogeneous medium before it is known which channel counts for each row.
#[derive(Clone, Copy)]
pub struct ColouredLanes<'a>(&'a Homogeneous);

/// A homogeneous medium in one channel per row.
#[derive(Clone, Copy)]
pub struct HomogeneousX8 {
    extinction: f32x8,
    mean_free_path: f32x8,
}

/// A segment in it.
#[derive(Clone, Copy)]
pub struct HomogeneousAxis {
    medium: HomogeneousX8,
    /// Length `[m]`.
    length: f32x8,
}

impl GreyLanes {
    /// Those of a grey `medium`.
    #[inline(always)]
    pub fn new(medium: &Homogeneous) -> Self {
        let [extinction, mean_free_path] = [medium.extinction[0], medium.mean_free_path[0]].map(f32x8::splat);
        Self(HomogeneousX8 { extinction, mean_free_path })
    }
}

impl MediumLanes for GreyLanes {
    type Channel = HomogeneousX8;

    const COLOURED: bool = false;

    #[inline(always)]
    fn in_channel(&self, _: impl FnOnce() -> u32x8) -> HomogeneousX8 {
        self.0
    }

    #[inline(always)]
    fn own(&self) -> HomogeneousX8 {
        self.0
    }

    fn hues(&self) -> [f32; CHANNELS] {
        [1.0; CHANNELS]
    }
}

impl<'a> ColouredLanes<'a> {
    /// Those of a coloured `medium`.
    #[inline(always)]
    pub fn new(medium: &'a Homogeneous) -> Self {
        Self(medium)
    }
}

impl MediumLanes for ColouredLanes<'_> {
    type Channel = HomogeneousX8;

    const COLOURED: bool = true;

    #[inline(always)]
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> HomogeneousX8 {
        let channel = channel().to_array().map(|channel| (channel as usize).min(CHANNELS - 1));
        let [extinction, mean_free_path] =
            [&self.0.extinction, &self.0.mean_free_path].map(|of| f32x8::new(channel.map(|channel| of[channel])));
        HomogeneousX8 { extinction, mean_free_path }
    }

    #[inline(always)]
    fn own(&self) -> HomogeneousX8 {
        self.in_channel(|| u32x8::splat(0))
    }

    fn hues(&self) -> [f32; CHANNELS] {
        self.0.extinction
    }
}

impl HomogeneousX8 {
    /// One over the extinction `[m]`.
    #[inline(always)]
    pub fn mean_free_path(self) -> f32x8 {
        self.mean_free_path
    }
}

impl MediumX8 for HomogeneousX8 {
    type Axis = HomogeneousAxis;
    type Ray = HomogeneousAxis;
    type Even = Self;

    const VARIES: bool = false;

    #[inline(always)]
    fn axis(self, _: Vec3x8, _: Vec3x8, length: f32x8) -> HomogeneousAxis {
        HomogeneousAxis { medium: self, length }
    }

    #[inline(always)]
    fn ray(self, _: Vec3x8, _: Vec3x8) -> HomogeneousAxis {
        HomogeneousAxis { medium: self, length: f32x8::splat(f32::INFINITY) }
    }

    #[inline(always)]
    fn optical_depth(self, _: Vec3x8, _: Vec3x8, length: f32x8) -> f32x8 {
        self.extinction * length
    }

    #[inline(always)]
    fn optical_depth_along(self, arc: f32x8, _: f32x8) -> f32x8 {
        self.extinction * arc
    }

    #[inline(always)]
    fn over_clearest(self) -> f32x8 {
        f32x8::ONE
    }

    #[inline(always)]
    fn extinction(self, _: Vec3x8) -> f32x8 {
        self.extinction
    }

    #[inline(always)]
    fn crowding(self, _: usize, _: f32x8, _: f32x8, _: f32x8) -> Crowding {
        Crowding { log: f32x8::ZERO, scale: self.extinction }
    }

    #[inline(always)]
    fn log_extinction_along(self, events: usize, _: f32x8) -> f32x8 {
        f32x8::splat(-(events as f32)) * neg_ln(self.extinction)
    }

    #[inline(always)]
    fn is_even_at(self, _: Vec3x8) -> f32x8 {
        lanes::mask(lanes::ALL)
    }

    #[inline(always)]
    fn as_even(self) -> Self {
        self
    }
}

impl AxisX8 for HomogeneousAxis {
    const VARIES: bool = false;

    #[inline(always)]
    fn depth(&self, _: f32x8) -> f32x8 {
        self.medium.extinction * self.length
    }

    #[inline(always)]
    fn depths(&self, along: f32x8, most: f32x8) -> [f32x8; 2] {
        [self.medium.extinction * along, self.depth(most)]
    }

    #[inline(always)]
    fn extinction(&self, _: f32x8) -> f32x8 {
        self.medium.extinction
    }

    #[inline(always)]
    fn advance(&mut self, depth: f32x8) -> f32x8 {
        depth * self.medium.mean_free_path
    }

    #[inline(always)]
    fn even(&self) -> (f32x8, f32x8) {
        (lanes::mask(lanes::ALL), self.medium.extinction)
    }

    #[inline(always)]
    fn reached(&self) -> f32x8 {
        self.medium.extinction
    }
}
