//! ```text
//! (a, b) = first two uniforms of the CAMERA block
//! v = corner + (px + a) step_x + (py + b) step_y          one metre ahead along the axis
//! position = pinhole + near v,   direction = v / |v|
//! ```
//!
//! 1. Requests stand in the lanes that they fill: mostly whole batches die together, and a batch with one vacant lane is
//!    computed as a whole and blended in.

use wide::{f32x8, i32x8, u32x8};

use super::Columns;
use crate::random::{self, uniform_x8};
use crate::tables::camera::Camera;
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(camera: &Camera, step: Step, columns: Columns<'_, '_>) {
    let Columns { requests, paths, vertices, rays } = columns;
    let n = paths.batches();
    let (x, y, sample) = (requests.columns.x.view(n), requests.columns.y.view(n), requests.columns.sample.view(n));
    let film = Film::new(camera);
    let mut position = vertices.at_mut(step.clock).position.view_mut(n);
    let mut direction = rays.at_mut(step.clock).direction.view_mut(n);
    let path = &mut paths.columns;
    let [pixels, samples, births, surfaces, nears] =
        [&mut path.pixel, &mut path.sample, &mut path.birth, &mut path.last_surface, &mut path.first_near]
            .map(|column| column.view_mut(n));
    let [mut throughput, mut radiance, mut normal] =
        [&mut path.throughput, &mut path.radiance, &mut path.surface_normal].map(|column| column.view_mut(n));
    for (b, bits) in requests.lanes.each_batch() {
        let pixel = y[b] * u32x8::splat(camera.width) + x[b];
        let block = u32x8::splat(random::block(0, random::CAMERA));
        let words = random::words_x8(pixel, sample[b], block, step.seed);
        let (at, toward) = film.ray(x[b], y[b], words);

        let mask = lanes::mask(bits);
        position.blend(b, mask, at);
        direction.blend(b, mask, toward);
        throughput.blend(b, mask, Vec3x8::splat([1.0; 3]));
        radiance.blend(b, mask, Vec3x8::ZERO);
        normal.blend(b, mask, Vec3x8::ZERO);
        let set = |column: &mut [u32x8], value: u32x8| {
            column[b] = bytemuck::cast::<f32x8, u32x8>(mask).select(value, column[b]);
        };
        set(pixels, pixel);
        set(samples, sample[b]);
        set(births, u32x8::splat(step.clock));
        set(surfaces, u32x8::splat(0));
        set(nears, u32x8::splat(u32::MAX));
        paths.live.insert_batch(b, bits);
        paths.occupied.insert_batch(b, bits);
    }
}

/// The camera, splatted.
struct Film {
    pinhole: Vec3x8,
    corner: Vec3x8,
    step_x: Vec3x8,
    step_y: Vec3x8,
    near: f32x8,
}

impl Film {
    fn new(camera: &Camera) -> Self {
        let [pinhole, corner, step_x, step_y] =
            [camera.position, camera.corner, camera.step_x, camera.step_y].map(Vec3x8::splat);
        Self { pinhole, corner, step_x, step_y, near: f32x8::splat(camera.near) }
    }

    /// Position and direction of the rays through pixels (x, y).
    #[inline(always)]
    fn ray(&self, x: u32x8, y: u32x8, words: [u32x8; 4]) -> (Vec3x8, Vec3x8) {
        let real = |v: u32x8| f32x8::from_i32x8(bytemuck::cast::<u32x8, i32x8>(v));
        let [a, b, ..] = words;
        let (x, y) = (real(x) + uniform_x8(a), real(y) + uniform_x8(b));
        let v = self.step_y.mul_add(y, self.step_x.mul_add(x, self.corner));
        (v.mul_add(self.near, self.pinhole), v * (f32x8::ONE / v.length_squared().sqrt()))
    }
}
