//! Rays through cells of pixels in f64.
//!
//! ```text
//! (x, y) = pixel + ((i, j) + (u_0, u_1)) / side,      cell = i + side j
//! ```

use glam::DVec3;

use super::{Columns, SIDE};
use crate::columns::queues::Request;
use crate::generate::reference::film_ray;
use crate::tables::camera::Camera;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { camera, cell, outlined, requests, vertex, ray } = columns;
    for lane in outlined.each() {
        let Request { x, y, sample } = requests.row(lane);
        let (position, direction) = look(camera, y * camera.width + x, sample, cell, step.seed);
        vertex.position.set_row(lane, position.as_vec3().to_array());
        ray.direction.set_row(lane, direction.as_vec3().to_array());
    }
}

/// Where the ray of a sample through a cell of its pixel starts `[m]`, and its unit direction.
pub fn look(camera: &Camera, pixel: u32, sample: u32, cell: u32, seed: u32) -> (DVec3, DVec3) {
    let words = random::words(pixel, sample, random::block(0, random::OUTLINE.nth(cell)), seed);
    let within = |index: u32, word: u32| (f64::from(index) + random::uniform(word)) / f64::from(SIDE);
    let x = f64::from(pixel % camera.width) + within(cell % SIDE, words[0]);
    let y = f64::from(pixel / camera.width) + within(cell / SIDE, words[1]);
    film_ray(camera, x, y)
}
