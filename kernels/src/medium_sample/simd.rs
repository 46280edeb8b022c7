//! ```text
//! flight outlasted by 1 - u of all flights       u, v: first and last word of the SEGMENT block at the path's depth
//! end the path if v >= survival(depth), unless its vertex is the camera
//! ```
//!
//! 1. The numbers `u` and `1 - u` have the same distribution, but only `1 - u` keeps the flight short where `u` is
//!    small.
//! 2. Flights are drawn for whole batches, dying paths included.
//! 3. In a field their optical depths are drawn, with which they are tracked ([`tracking`]), where channels are apart
//!    those of one hero after the other.

use core::cell::RefCell;

use wide::{f32x8, u32x8};

use super::Columns;
use crate::lanes::LANES;
use crate::media::MediumLanes;
use crate::media::field::Field;
use crate::media::field::tracking::{self, FlightsX8};
use crate::media::spectral::CHANNELS;
use crate::random::{self, Stream, uniform_x8};
use crate::survival::Survival;
use crate::transcendental::neg_ln;
use crate::{Step, lanes, with_homogeneous};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, mut columns: Columns<'_, '_>) {
    if let Some(field) = columns.medium.field() {
        sample(step, &mut columns, |_, rest| neg_ln(rest));
        return track(step, columns, field);
    }
    let hero = columns.immersion.hero.view(columns.live.batches());
    with_homogeneous!(columns.medium, |medium| {
        sample(step, &mut columns, |b, rest| medium.in_channel(|| hero[b]).flight(rest));
    });
}

/// Overwrites the optical depths of flights of live paths with flights through a field.
fn track(step: Step, columns: Columns<'_, '_>, field: &Field) {
    let Columns { live, paths, immersion, vertex, ray, flights, .. } = columns;
    let flights = RefCell::new(&mut flights.flight);
    let batch = |b: usize, live: u32, hue: f32x8| FlightsX8 {
        first: LANES * b,
        live,
        origin: vertex.position.batch(b),
        direction: ray.direction.batch(b),
        hue,
        budget: flights.borrow().batch(b),
    };
    let stream = |first: usize| {
        let b = first / LANES;
        let block = random::block_x8(u32x8::splat(step.clock) - paths.birth.batch(b), random::TRACKING);
        Stream::new_x8(paths.pixel.batch(b), paths.sample.batch(b), block, step.seed, 0)
    };
    let mut end = |first: usize, ended: u32, flown: f32x8| {
        let b = first / LANES;
        let mut flights = flights.borrow_mut();
        let before = flights.batch(b);
        flights.set_batch(b, lanes::mask(ended).select(flown, before));
    };
    let heroes = |b: usize| immersion.hero.batch(b);
    if let Some(apart) = field.apart() {
        for hero in 0..CHANNELS {
            let of_hero = |(b, live)| batch(b, live & lanes::equal(heroes(b), hero), f32x8::ONE);
            tracking::simd::flights(apart.channel(hero), live.each_batch().map(of_hero), stream, &mut end);
        }
        return;
    }
    let hues = field.hues();
    let hue = |b: usize| heroes(b).to_array().map(|hero| hues[(hero as usize).min(CHANNELS - 1)]);
    let hue = |b: usize| if field.is_grey() { f32x8::ONE } else { f32x8::new(hue(b)) };
    tracking::simd::flights(field, live.each_batch().map(|(b, live)| batch(b, live, hue(b))), stream, end);
}

/// Draws the words of the segment; `fly` gives the flights of a batch that so large shares outlast.
#[inline(always)]
fn sample(step: Step, columns: &mut Columns<'_, '_>, fly: impl Fn(usize, f32x8) -> f32x8) {
    let Columns { walk, live, paths, flights, .. } = columns;
    let n = live.batches();
    let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.view(n));
    let flight = flights.flight.view_mut(n);
    let [cosine, azimuth] = [&mut flights.cosine, &mut flights.azimuth].map(|column| column.view_mut(n));
    let ends_walks = !walk.survival.is_certain();
    for b in 0..n {
        if live.batch(b) == 0 {
            continue;
        }
        let depth = u32x8::splat(step.clock) - birth[b];
        let block = random::block_x8(depth, random::SEGMENT);
        let words = random::words_x8(pixel[b], sample[b], block, step.seed);
        flight[b] = fly(b, f32x8::ONE - uniform_x8(words[0]));
        (cosine[b], azimuth[b]) = (words[1], words[2]);
        if ends_walks {
            let survival = match &walk.survival {
                Survival::Constant(survival) => f32x8::splat(*survival),
                Survival::ByOctave(octaves) => octaves.at(depth),
            };
            let ends = uniform_x8(words[3]).simd_ge(survival) & lanes::as_mask(depth.simd_gt(u32x8::splat(0)));
            live.remove_batch(b, lanes::bits(ends));
        }
    }
}
