//! Lights as light that has wandered far sees them.

use fogbow_kernels::tables::lights::{Emitter, Lights};
use glam::DVec3;

use crate::frame::Frame;

/// Least radius of a light in mean free paths of the densest channel.
const LEAST_RADIUS: f32 = 0.5;

/// The lights of `frame`, small ones wider and as much fainter; as they are where something is solid, which they might
/// cut into, and where the camera would be inside.
pub fn widened(frame: &Frame) -> Lights {
    let lights = &frame.lights;
    if frame.medium.never_scatters() || !frame.surfaces.is_empty() || lights.has_meshes() {
        return lights.clone();
    }
    let radius = LEAST_RADIUS / frame.medium.largest_extinction();
    let camera = DVec3::from(frame.camera.position.map(f64::from));
    let is_small =
        |emitter: &Emitter| emitter.radius < radius && emitter.bounds().0.distance(camera) > 2.0 * f64::from(radius);
    let widen = |emitter: &Emitter| if is_small(emitter) { with_radius(emitter, radius) } else { *emitter };
    lights.with_bodies(lights.bodies().iter().map(widen).collect())
}

/// A disk or sphere of the same intensity.
fn with_radius(emitter: &Emitter, radius: f32) -> Emitter {
    let ratio = emitter.radius / radius;
    Emitter {
        radius,
        curvature: emitter.curvature * ratio,
        radiance: emitter.radiance.map(|channel| channel * ratio * ratio),
        density: emitter.density * ratio * ratio,
        ..*emitter
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wider_light_is_as_bright() {
        let center = DVec3::new(1.0, 2.0, 3.0);
        for light in [Emitter::disk(center, DVec3::Y, 0.1, [8.0; 3]), Emitter::sphere(center, 0.1, [8.0; 3])] {
            let wide = with_radius(&light, 0.5);
            assert!((wide.intensity() / light.intensity() - 1.0).abs() < 1e-6);
            assert!((f64::from(wide.density) * wide.area() - 1.0).abs() < 1e-6);
            assert_eq!((wide.curvature > 0.0, wide.radius), (light.curvature > 0.0, 0.5));
        }
    }
}
