//! Collisions along a ray through a field: free flights, and estimates of transmittance.
//!
//! Both walk from block to block and draw *candidates* with a rate that is constant in each: a budget of -ln(1 - u) mean
//! free paths is spent on the blocks' majorants, and where it is used up there is a candidate.
//!
//! ```text
//! free flights:    rate mu_max >= mu;     a candidate at x is a collision if u mu_max < mu(x)       (Woodcock 1965)
//! transmittance:   rate mu_r >= |mu - mu_c| about the block's mean mu_c, or about its least extinction;
//!                  T' = e^{-int mu_c} prod (1 - (mu(x) - mu_c) / mu_r)           (Novak, Selle, Jarosz 2014)
//! ```
//!
//! The majorants are those of the block, so that empty and even blocks cost a step and no candidate. Where extinction is
//! coloured, flights are those of one channel, and one set of points serves all transmittances, since rates are those of
//! the largest extinction: `T'_c = e^{-k_c int mu_c} prod (1 - k_c (mu(x) - mu_c) / mu_r)`. Each candidate has
//! two numbers of the ray's [stream](crate::random::Stream), in the order in which they are met: one decides what becomes
//! of it, one how far away the next is. A flight's first candidate is as far away as its caller says.

mod one_shape;
mod quest;
mod rays;
pub mod reference;
pub mod simd;

use wide::{f32x8, u32x8};

use crate::lanes::LANES;
use crate::media::spectral::CHANNELS;
use crate::random::{Stream, uniform, uniform_f32};
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;

/// A ray through a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts `[m]`.
    pub origin: [f32; 3],
    /// Where it goes: a unit direction for a flight, the whole segment for a transmittance `[m]`.
    pub direction: [f32; 3],
    /// Where its numbers come from.
    pub stream: Stream,
    /// Extinctions that count, over those of the field: that of a flight, or those of up to three transmittances, from -1
    /// to 1.
    pub hues: [f32; CHANNELS],
}

/// Eight rays with N hues each.
#[derive(Clone, Copy, Debug)]
pub struct RaysX8<const N: usize> {
    /// Row of that in lane 0; the others are in the rows behind it.
    pub first: usize,
    /// Lanes with a ray.
    pub live: u32,
    /// Where they start `[m]`.
    pub origin: Vec3x8,
    /// Where they go: unit directions for flights, whole segments for transmittances `[m]`.
    pub direction: Vec3x8,
    /// Where their numbers come from, word by word.
    pub stream: [u32x8; 4],
    /// Extinctions that count, over those of the field.
    pub hues: [f32x8; N],
}

/// Eight flights that have not drawn anything but how far away their first candidates are.
#[derive(Clone, Copy, Debug)]
pub struct FlightsX8 {
    /// Row of that in lane 0; the others are in the rows behind it.
    pub first: usize,
    /// Lanes with a flight.
    pub live: u32,
    /// Where they start `[m]`.
    pub origin: Vec3x8,
    /// Where they go: unit directions.
    pub direction: Vec3x8,
    /// Extinctions that count, over that of the field.
    pub hue: f32x8,
    /// Mean free paths to their first candidates.
    pub budget: f32x8,
}

impl FlightsX8 {
    /// The rays of some `live` lanes, which draw from `stream`.
    #[inline(always)]
    fn rays(&self, live: u32, stream: [u32x8; 4]) -> RaysX8<1> {
        let Self { first, origin, direction, hue, .. } = *self;
        RaysX8 { first, live, origin, direction, stream, hues: [hue] }
    }
}

impl From<RaysX8<1>> for FlightsX8 {
    /// The flights of rays without numbers from elsewhere.
    fn from(rays: RaysX8<1>) -> Self {
        let RaysX8 { first, live, origin, direction, stream, hues: [hue] } = rays;
        Self { first, live, origin, direction, hue, budget: first_budgets(stream) }
    }
}

/// Mean free paths to the first candidate, for a ray without a number from elsewhere.
pub fn first_budget(stream: Stream) -> f64 {
    let [first, ..] = stream.words(0);
    -(1.0 - uniform(first)).ln()
}

/// [`first_budget`] of eight streams.
#[inline(always)]
pub fn first_budgets(stream: [u32x8; 4]) -> f32x8 {
    let [first, ..] = Stream::words_x8(stream, u32x8::splat(0));
    neg_ln(f32x8::ONE - uniform_f32(first))
}

/// `rays` with the first N of their hues, eight at a time; their rows are their places.
pub fn batches<const N: usize>(rays: &[Ray]) -> impl Iterator<Item = RaysX8<N>> {
    rays.chunks(LANES).enumerate().map(|(number, rays)| {
        let of = |lane: usize| rays.get(lane).unwrap_or(&rays[0]);
        let reals = |pick: &dyn Fn(&Ray) -> f32| f32x8::new(core::array::from_fn(|lane| pick(of(lane))));
        let words = |word: usize| u32x8::new(core::array::from_fn(|lane| of(lane).stream.0[word]));
        let [x, y, z] = [0, 1, 2].map(|axis| reals(&|ray| ray.origin[axis]));
        let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| reals(&|ray| ray.direction[axis]));
        RaysX8 {
            first: LANES * number,
            live: crate::lanes::first(rays.len()),
            origin: Vec3x8::new(x, y, z),
            direction: Vec3x8::new(along_x, along_y, along_z),
            stream: [0, 1, 2, 3].map(words),
            hues: core::array::from_fn(|hue| reals(&|ray| ray.hues[hue])),
        }
    })
}
