//! ```text
//! t = flight, or distance of what ends it
//! sum = 0
//! for i in 0 .. n:  sum += e(x + (t0 + (i + u_i) stratum) w)             stratum = (t1 - t0) / n
//! radiance += S / reach(depth + 1) (sum stratum + e_around (t - (t1 - t0)))
//! S_c = T_c, or in coloured extinction  c = h ? T_c / posterior_c : 0
//! ```
//!
//! 1. Hits are few, and scattered to their lanes first.
//! 2. Lanes with fewer strata wait for those with more.
//! 3. Where nothing is emitted around the volumes, the way may be endless: that term is left out.

use wide::{f32x8, u32x8};

use super::{Columns, MOST_POINTS};
use crate::columns::queues::{HitQueue, SurfaceHitQueue};
use crate::columns::{Column, Spectrum};
use crate::lanes::LANES;
use crate::media::spectral::CHANNELS;
use crate::media::{Field, Glow};
use crate::random::{self, Stream, uniform_f32};
use crate::survival::LogSurvival;
use crate::tables::lights::{Lights, Shape};
use crate::transcendental::exp;
use crate::vec3::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, glow, lights, lengths, walk, live, paths, vertex, ray, flight, hits, .. } = columns;
    let Columns { surface_hits, throughput, immersion, log_posterior, flown, glowing, .. } = columns;
    let Columns { radiance, origin, parts, dropped, .. } = columns;
    live.each_batch().for_each(|(b, _)| flown.set_batch(b, flight.batch(b)));
    shorten(flown, lights, hits, surface_hits);
    let (survival, is_coloured) = (LogSurvival::of(&walk.survival), medium.is_coloured());
    for (b, bits) in live.each_batch() {
        let (birth, pixel, sample) = (paths.birth.batch(b), paths.pixel.batch(b), paths.sample.batch(b));
        let depth = u32x8::splat(step.clock) - birth;
        let segments = depth + u32x8::splat(1);
        let counted = segments.simd_ge(u32x8::splat(lengths.min)) & segments.simd_le(u32x8::splat(lengths.max));
        let mut counts = lanes::bits(lanes::as_mask(counted)) & bits;
        let way = Way { origin: vertex.position.batch(b), direction: ray.direction.batch(b), length: flown.batch(b) };
        let words = random::words(pixel, sample, random::block(depth, random::GLOW), step.seed);
        let met = match medium.field() {
            Some(field) => way.through(field, glow, words, lanes::mask(counts)),
            None => glow.around().map(|emission| f32x8::splat(emission) * way.length),
        };
        let reach = survival.reach(segments);
        let share = |c: usize| {
            let throughput = throughput.channels()[c].batch(b);
            if !is_coloured {
                return throughput;
            }
            let own = lanes::as_mask(immersion.hero.batch(b).simd_eq(u32x8::splat(c as u32)));
            own.select(throughput * exp(-log_posterior.channels()[c].batch(b)), f32x8::ZERO)
        };
        let found = |c: usize| met[c] * share(c) / reach;
        let used = radiance.channels().len();
        let finite =
            (0..used).map(|c| lanes::bits(found(c).is_finite())).fold(lanes::ALL, |all, channel| all & channel);
        for lane in lanes::each(counts & !finite) {
            dropped.note(pixel.to_array()[lane], sample.to_array()[lane]);
        }
        counts &= finite;
        for c in 0..used {
            let found = lanes::mask(counts).select(found(c), f32x8::ZERO);
            glowing.channels_mut()[c].set_batch(b, found);
            let channel = &mut radiance.channels_mut()[c];
            channel.set_batch(b, channel.batch(b) + found);
        }
        if !parts.is_empty() {
            for (lane, segments) in lanes::each(counts).map(|i| (b * LANES + i, segments.to_array()[i])) {
                parts.of(origin, segments).for_each(|part| add(part, lane, glowing));
            }
        }
    }
}

/// Adds what a path has found on its flight.
fn add(part: &mut Spectrum<'_>, lane: usize, found: &Spectrum<'_>) {
    for (part, found) in part.channels_mut().iter_mut().zip(found.channels()) {
        part.rows_mut()[lane] += found.rows()[lane];
    }
}

/// Ends flights on what they meet.
fn shorten(flown: &mut Column<'_, f32>, lights: &Lights, hits: &HitQueue<'_>, surface_hits: &SurfaceHitQueue<'_>) {
    let flown = flown.rows_mut();
    for hit in 0..hits.len {
        let end = &mut flown[hits.lane.rows()[hit] as usize];
        // Triangles that shine are surfaces, and nothing ends at infinity.
        if matches!(lights.emitters()[hits.emitter.rows()[hit] as usize].shape, Shape::Disk | Shape::Sphere) {
            *end = end.min(hits.distance.rows()[hit]);
        }
    }
    for hit in 0..surface_hits.len {
        flown[surface_hits.lane.rows()[hit] as usize] = surface_hits.distance.rows()[hit];
    }
}

/// Eight flights.
struct Way {
    origin: Vec3x8,
    direction: Vec3x8,
    length: f32x8,
}

impl Way {
    /// Integrals of emission in a field, of those in `asked`; `words` are those of their streams.
    fn through(&self, field: &Field, glow: &Glow, words: [u32x8; 4], asked: f32x8) -> [f32x8; CHANNELS] {
        let [enter, exit] = glow.part(field, self.origin, self.direction, self.length);
        let part = (exit - enter).fast_max(f32x8::ZERO);
        let points = (part * f32x8::splat(glow.rate())).ceil().fast_max(f32x8::ONE);
        let points = points.fast_min(f32x8::splat(MOST_POINTS as f32));
        let stratum = part / points;
        let inside = asked & part.simd_gt(f32x8::ZERO);
        let most = inside.select(points, f32x8::ZERO).to_array().into_iter().fold(0.0, f32::max) as u32;
        let (mut sum, mut numbers) = ([f32x8::ZERO; CHANNELS], [f32x8::ZERO; 4]);
        for i in 0..most {
            if i % 4 == 0 {
                numbers = Stream::words_x8(words, u32x8::splat(i / 4)).map(uniform_f32);
            }
            let index = f32x8::splat(i as f32);
            let here = inside & index.simd_lt(points);
            let t = here.select((index + numbers[i as usize % 4]).mul_add(stratum, enter), f32x8::ZERO);
            let at = self.direction.mul_add(t, self.origin);
            let emission = glow.at(field.who(at), at);
            sum = core::array::from_fn(|c| sum[c] + here.select(emission[c], f32x8::ZERO));
        }
        let around = |c: usize| match glow.around()[c] {
            0.0 => f32x8::ZERO,
            emission => f32x8::splat(emission) * (self.length - part),
        };
        core::array::from_fn(|c| sum[c].mul_add(stratum, around(c)))
    }
}
