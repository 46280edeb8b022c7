//! Camera rays in f64.
//!
//! ```text
//! film = corner + x step_x + y step_y,      (x, y) = pixel + (u_0, u_1)
//! position = pinhole + near film,           direction = film / |film|
//! ```
//!
//! The film stands one metre ahead along the viewing axis, so `near film` ends on the plane at distance `near`.

use glam::DVec3;

use super::Columns;
use crate::columns::LANES;
use crate::columns::paths::Path;
use crate::columns::queues::Request;
use crate::tables::camera::Camera;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(camera: &Camera, step: Step, columns: Columns<'_, '_>) {
    let Columns { requests, paths, vertices, rays } = columns;
    for lane in 0..paths.batches() * LANES {
        if !requests.lanes.contains(lane as u32) {
            continue;
        }
        let Request { x, y, sample } = requests.columns.row(lane);
        let pixel = y * camera.width + x;
        let (position, direction) = camera_ray(camera, pixel, sample, step.seed);
        paths.columns.set_row(
            lane,
            Path {
                pixel,
                sample,
                birth: step.clock,
                last_surface: 0,
                surface_normal: [0.0; 3],
                first_near: u32::MAX,
                throughput: [1.0; 3],
                radiance: [0.0; 3],
            },
        );
        paths.live.insert(lane as u32);
        paths.occupied.insert(lane as u32);
        vertices.at_mut(step.clock).position.set_row(lane, position.as_vec3().to_array());
        rays.at_mut(step.clock).direction.set_row(lane, direction.as_vec3().to_array());
    }
}

/// Where the path of `sample` of `pixel` starts `[m]`, and its unit direction.
pub fn camera_ray(camera: &Camera, pixel: u32, sample: u32, seed: u32) -> (DVec3, DVec3) {
    let words = random::words(pixel, sample, random::block(0, random::CAMERA), seed);
    let x = f64::from(pixel % camera.width) + random::uniform(words[0]);
    let y = f64::from(pixel / camera.width) + random::uniform(words[1]);
    let [pinhole, corner, step_x, step_y] =
        [camera.position, camera.corner, camera.step_x, camera.step_y].map(|v| DVec3::from(v.map(f64::from)));
    let film = corner + x * step_x + y * step_y;
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
