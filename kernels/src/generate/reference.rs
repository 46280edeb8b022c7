//! Camera rays in f64.
//!
//! ```text
//! film = corner + x pixel_x + y pixel_y,      (x, y) = pixel + (u_0, u_1)
//! position = pinhole + near film,           direction = film / |film|
//! ```
//!
//! The film stands one metre ahead along the viewing axis, so `near film` ends on the plane at distance `near`.

use glam::DVec3;

use super::Columns;
use crate::columns::paths::{Immersion, LastSurface, Path, Vertex};
use crate::columns::queues::Request;
use crate::media::spectral::{CHANNELS, SHARE};
use crate::tables::camera::Camera;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { camera, medium, requested, requests, live, occupied, .. } = columns;
    let Columns { paths, immersion, log_posterior, last_surface, outlook, throughput, radiance, vertex, ray, .. } =
        columns;
    for lane in requested.each() {
        let Request { x, y, sample } = requests.row(lane);
        let pixel = y * camera.width + x;
        let (position, direction) = camera_ray(camera, pixel, sample, step.seed);
        paths.set_row(lane, Path { pixel, sample, birth: step.clock });
        let hero = if medium.is_coloured() { hero(pixel, sample, step.seed) } else { 0 };
        immersion.set_row(lane, Immersion { hero });
        if medium.is_coloured() {
            log_posterior.set_row(lane, [SHARE.ln(); CHANNELS]);
        }
        last_surface.set_row(lane, LastSurface { depth: 0, normal: [0.0; 3] });
        outlook.first_near.rows_mut()[lane] = u32::MAX;
        throughput.set_row(lane, [1.0; 3]);
        radiance.set_row(lane, [0.0; 3]);
        vertex.set_row(lane, Vertex { position: position.as_vec3().to_array(), arc: 0.0 });
        ray.direction.set_row(lane, direction.as_vec3().to_array());
        live.insert(lane);
        occupied.insert(lane);
    }
}

/// The channel for which the flights of a path are drawn where extinction is coloured, 0 to 2.
pub fn hero(pixel: u32, sample: u32, seed: u32) -> u32 {
    let [word, ..] = random::words(pixel, sample, random::block(0, random::HERO), seed);
    (random::uniform(word) * CHANNELS as f64) as u32
}

/// Where the path of `sample` of `pixel` starts `[m]`, and its unit direction.
pub fn camera_ray(camera: &Camera, pixel: u32, sample: u32, seed: u32) -> (DVec3, DVec3) {
    let words = random::words(pixel, sample, random::block(0, random::CAMERA), seed);
    let x = f64::from(pixel % camera.width) + random::uniform(words[0]);
    let y = f64::from(pixel / camera.width) + random::uniform(words[1]);
    film_ray(camera, x, y)
}

/// Where the ray through film coordinates (x, y), in pixels, starts `[m]`, and its unit direction.
pub fn film_ray(camera: &Camera, x: f64, y: f64) -> (DVec3, DVec3) {
    let [pinhole, corner, pixel_x, pixel_y] =
        [camera.position, camera.corner, camera.pixel_x, camera.pixel_y].map(|v| DVec3::from(v.map(f64::from)));
    let film = corner + x * pixel_x + y * pixel_y;
    (pinhole + f64::from(camera.near) * film, film.normalize_or_zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_leave_the_near_plane_through_their_pixel() {
        let camera = Camera::new(DVec3::new(1.0, 2.0, 3.0), DVec3::X, DVec3::Z, 0.9, 0.25, [8, 4]);
        for pixel in 0..32 {
            let (position, direction) = camera_ray(&camera, pixel, 5, 1);
            assert!((position.x - 1.25).abs() < 1e-6, "pixel {pixel} starts at {position}");
            let film = direction / direction.x;
            let half = 0.45_f64.tan();
            // Image right is forward x up = -y.
            let column = 4.0 * (1.0 - film.y / (2.0 * half));
            let row = 2.0 * (1.0 - film.z / half);
            assert_eq!((column.floor(), row.floor()), (f64::from(pixel % 8), f64::from(pixel / 8)), "{column} {row}");
        }
    }
}
