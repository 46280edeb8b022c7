//! ```text
//! (x, y) = pixel + ((i, j) + (u_0, u_1)) / side,      cell = i + side j
//! position, direction: those of the film at (x, y)
//! ```

use wide::{f32x8, u32x8};

use super::{Columns, SIDE};
use crate::Step;
use crate::generate::simd::{Film, real};
use crate::random::{self, uniform_f32};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { camera, cell, outlined, requests, vertex, ray } = columns;
    let film = Film::new(camera);
    let block = u32x8::splat(random::block(0, random::OUTLINE.nth(cell)));
    let within =
        |index: u32, word: u32x8| (f32x8::splat(index as f32) + uniform_f32(word)) * f32x8::splat(1.0 / SIDE as f32);
    for (b, _) in outlined.each_batch().filter(|(_, bits)| *bits != 0) {
        let (x, y, sample) = (requests.x.batch(b), requests.y.batch(b), requests.sample.batch(b));
        let pixel = y * u32x8::splat(camera.width) + x;
        let [a, c, ..] = random::words(pixel, sample, block, step.seed);
        let (at, toward) = film.at(real(x) + within(cell % SIDE, a), real(y) + within(cell / SIDE, c));
        vertex.position.set_batch(b, at);
        ray.direction.set_batch(b, toward);
    }
}
