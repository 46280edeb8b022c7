//! ```text
//! (a, b) = first two uniforms of the CAMERA block
//! v = corner + (px + a) pixel_x + (py + b) pixel_y          one metre ahead along the axis
//! position = pinhole + near v,   direction = v / |v|
//! ```
//!
//! 1. Requests stand in the lanes that they fill: mostly whole batches die together, and a batch with one vacant lane
//!    is computed as a whole and blended in.

use wide::{f32x8, i32x8, u32x8};

use super::Columns;
use crate::columns::Spectrum;
use crate::media::spectral::{CHANNELS, SHARE};
use crate::random::{self, uniform_f32};
use crate::tables::camera::Camera;
use crate::vec3::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { camera, medium, requested, requests, live, occupied, .. } = columns;
    let Columns { paths, immersion, log_posterior, last_surface, outlook, throughput, radiance, vertex, ray, .. } =
        columns;
    let coloured = medium.is_coloured();
    let n = requested.batches();
    let (x, y, sample) = (requests.x.view(n), requests.y.view(n), requests.sample.view(n));
    let film = Film::new(camera);
    let (mut position, mut direction) = (vertex.position.view_mut(n), ray.direction.view_mut(n));
    let [pixels, samples, births, surfaces, nears, heroes] = [
        &mut paths.pixel,
        &mut paths.sample,
        &mut paths.birth,
        &mut last_surface.depth,
        &mut outlook.first_near,
        &mut immersion.hero,
    ]
    .map(|column| column.view_mut(n));
    let arc = vertex.arc.view_mut(n);
    let mut normal = last_surface.normal.view_mut(n);
    for (b, bits) in requested.each_batch() {
        let pixel = y[b] * u32x8::splat(camera.width) + x[b];
        let block = u32x8::splat(random::block(0, random::CAMERA));
        let words = random::words(pixel, sample[b], block, step.seed);
        let (at, toward) = film.ray(x[b], y[b], words);

        let mask = lanes::mask(bits);
        position.blend(b, mask, at);
        direction.blend(b, mask, toward);
        fill(throughput, b, mask, f32x8::ONE);
        fill(radiance, b, mask, f32x8::ZERO);
        normal.blend(b, mask, Vec3x8::ZERO);
        arc[b] = mask.select(f32x8::ZERO, arc[b]);
        let set = |column: &mut [u32x8], value: u32x8| {
            column[b] = lanes::as_integer_mask(mask).select(value, column[b]);
        };
        set(pixels, pixel);
        set(samples, sample[b]);
        set(births, u32x8::splat(step.clock));
        set(surfaces, u32x8::splat(0));
        set(nears, u32x8::splat(u32::MAX));
        set(heroes, if coloured { hero(pixel, sample[b], step.seed) } else { u32x8::splat(0) });
        if coloured {
            fill(log_posterior, b, mask, f32x8::splat(SHARE.ln()));
        }
        live.insert_batch(b, bits);
        occupied.insert_batch(b, bits);
    }
}

/// The channels for which the flights of paths are drawn.
#[inline(always)]
fn hero(pixel: u32x8, sample: u32x8, seed: u32) -> u32x8 {
    let block = u32x8::splat(random::block(0, random::HERO));
    let [u, ..] = random::words(pixel, sample, block, seed).map(uniform_f32);
    bytemuck::cast((u * f32x8::splat(CHANNELS as f32)).fast_trunc_int())
}

/// Overwrites the lanes of batch `b` that are set in `mask`, in all channels.
#[inline(always)]
fn fill(spectrum: &mut Spectrum<'_>, b: usize, mask: f32x8, value: f32x8) {
    for channel in spectrum.channels_mut() {
        channel.set_batch(b, mask.select(value, channel.batch(b)));
    }
}

/// The camera, splatted.
pub struct Film {
    pinhole: Vec3x8,
    corner: Vec3x8,
    pixel_x: Vec3x8,
    pixel_y: Vec3x8,
    near: f32x8,
}

impl Film {
    /// That of `camera`.
    pub fn new(camera: &Camera) -> Self {
        let [pinhole, corner, pixel_x, pixel_y] =
            [camera.position, camera.corner, camera.pixel_x, camera.pixel_y].map(Vec3x8::splat);
        Self { pinhole, corner, pixel_x, pixel_y, near: f32x8::splat(camera.near) }
    }

    /// Position and direction of the rays through pixels (x, y).
    #[inline(always)]
    fn ray(&self, x: u32x8, y: u32x8, words: [u32x8; 4]) -> (Vec3x8, Vec3x8) {
        let [a, b, ..] = words;
        self.at(real(x) + uniform_f32(a), real(y) + uniform_f32(b))
    }

    /// Position and direction of the rays through film coordinates (x, y), in pixels.
    #[inline(always)]
    pub fn at(&self, x: f32x8, y: f32x8) -> (Vec3x8, Vec3x8) {
        let v = self.pixel_y.mul_add(y, self.pixel_x.mul_add(x, self.corner));
        (v.mul_add(self.near, self.pinhole), v * (f32x8::ONE / v.length_squared().sqrt()))
    }
}

/// Whole numbers below 2^31 as real ones.
#[inline(always)]
pub fn real(v: u32x8) -> f32x8 {
    f32x8::from_i32x8(bytemuck::cast::<u32x8, i32x8>(v))
}
