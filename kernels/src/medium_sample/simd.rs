//! ```text
//! flight outlasted by 1 - u of all flights       u, v: first and last word of the SEGMENT block at the path's depth
//! end the path if v >= survival(depth), unless its vertex is the camera
//! ```
//!
//! 1. The numbers `u` and `1 - u` have the same distribution, but only `1 - u` keeps the flight short where `u` is
//!    small.
//! 2. Flights are drawn row by row for whole stretches, dying paths included.
//! 3. In a field their optical depths are drawn, with which they are tracked ([`tracking`]), where channels are apart
//!    those of one hero after the other.

use core::cell::RefCell;

use fogbow_processor::Avx512;
use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::paths::PathRows;
use crate::lanes::{LANES, STRETCH};
use crate::media::field::Field;
use crate::media::field::tracking::{self, FlightsX8};
use crate::media::homogeneous::{ColouredLanes, Homogeneous};
use crate::media::spectral::CHANNELS;
use crate::media::{Kind, Medium, MediumLanes};
use crate::random::{self, Stream, uniform_f32};
use crate::survival::Survival;
use crate::transcendental::neg_ln;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, mut columns: Columns<'_, '_>) {
    sample(step, &mut columns);
    finish(step, columns);
}

/// The same, for the widest registers that there are.
pub fn run_widest(step: Step, mut columns: Columns<'_, '_>) {
    match Avx512::detect() {
        Some(avx512) => avx512.run(
            #[inline(always)]
            || sample(step, &mut columns),
        ),
        None => sample(step, &mut columns),
    }
    finish(step, columns);
}

/// The mean free path `[m]`, if it is the same everywhere and in all channels; else 1, as if depths were flights.
fn mean_free_path(medium: &Medium) -> f32 {
    match &medium.kind {
        Kind::Homogeneous(medium) if medium.is_grey() => medium.mean_free_path(0),
        _ => 1.0,
    }
}

/// Turns optical depths into flights, where they are none yet.
fn finish(step: Step, columns: Columns<'_, '_>) {
    match &columns.medium.kind {
        Kind::Homogeneous(medium) if medium.is_grey() => {}
        Kind::Homogeneous(medium) => lengthen(columns, medium),
        Kind::Field(field) => track(step, columns, field),
    }
}

/// Turns optical depths into flights in a homogeneous medium, each in the channel of its path's hero.
fn lengthen(columns: Columns<'_, '_>, medium: &Homogeneous) {
    let Columns { live, immersion, flights, .. } = columns;
    let heroes = immersion.hero.view(live.batches());
    for (b, _) in live.each_batch() {
        let mean_free_path = ColouredLanes::new(medium).in_channel(|| heroes[b]).mean_free_path();
        flights.flight.set_batch(b, flights.flight.batch(b) * mean_free_path);
    }
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
        let block = random::block(u32x8::splat(step.clock) - paths.birth.batch(b), random::TRACKING);
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

/// Draws the words of the segment, and flights or, where it is not known how long these are, optical depths.
#[inline(always)]
fn sample(step: Step, columns: &mut Columns<'_, '_>) {
    let Columns { medium, walk, live, paths, flights, .. } = columns;
    let mean_free_path = mean_free_path(medium);
    let ends_walks = !walk.survival.is_certain();
    let mut last = [u32x8::splat(0); STRETCH];
    for k in 0..live.stretches() {
        let Some(batches) = live.stretch(k) else { continue };
        let segments = Segments { step, mean_free_path, paths: paths.stretch(batches.clone()) };
        segments.draw(
            flights.flight.stretch_mut::<f32>(batches.clone()),
            flights.cosine.stretch_mut::<f32>(batches.clone()),
            flights.azimuth.stretch_mut::<f32>(batches.clone()),
            bytemuck::cast_slice_mut(&mut last),
        );
        if ends_walks {
            for (b, word) in batches.zip(last) {
                let depth = u32x8::splat(step.clock) - paths.birth.batch(b);
                live.remove_batch(b, ends(&walk.survival, depth, word));
            }
        }
    }
}

/// Segments that begin.
struct Segments<'a> {
    step: Step,
    mean_free_path: f32,
    paths: PathRows<'a>,
}

impl Segments<'_> {
    /// Draws flights, the words for the turns at their ends, and the last word of each block. Slices that are arguments
    /// are known not to overlap, so that the loop needs no checks of it.
    #[inline(always)]
    fn draw(&self, flight: &mut [f32], cosine: &mut [u32], azimuth: &mut [u32], last: &mut [u32]) {
        let Self { step, mean_free_path, paths } = self;
        let n = flight.len();
        let (cosine, azimuth, last) = (&mut cosine[..n], &mut azimuth[..n], &mut last[..n]);
        let (pixel, sample, birth) = (&paths.pixel[..n], &paths.sample[..n], &paths.birth[..n]);
        for i in 0..n {
            let block = random::block(step.clock.wrapping_sub(birth[i]), random::SEGMENT);
            let words = random::words(pixel[i], sample[i], block, step.seed);
            flight[i] = neg_ln(1.0 - uniform_f32(words[0])) * mean_free_path;
            (cosine[i], azimuth[i], last[i]) = (words[1], words[2], words[3]);
        }
    }
}

/// The walks that end at vertices of these depths, by words that decide.
#[inline(always)]
fn ends(survival: &Survival, depth: u32x8, word: u32x8) -> u32 {
    let survival = match survival {
        Survival::Constant(survival) => f32x8::splat(*survival),
        Survival::ByOctave(octaves) => octaves.at(depth),
    };
    let ends = uniform_f32(word).simd_ge(survival) & lanes::as_mask(depth.simd_gt(u32x8::splat(0)));
    lanes::bits(ends)
}
