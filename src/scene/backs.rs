//! Backs of single-sided surfaces that the camera sees: they are black, which is rarely what their author meant.

use fogbow_kernels::generate::reference::camera_ray;
use fogbow_kernels::trace::{self, Ray};
use glam::DVec3;

use crate::frame::Frame;
use crate::gltf::{Material, label};
use crate::warning::Warning;

/// Longest side of the image that is looked at, in pixels.
const SIDE: u32 = 64;

/// A warning about the backs that `frame` sees, whose materials are `looks` of `file` and whose image has `size`
/// pixels.
pub fn seen(frame: &Frame, size: [u32; 2], file: &str, looks: &[Material]) -> Option<Warning> {
    if frame.surfaces.is_empty() {
        return None;
    }
    let (frame, region) = frame.small(size, SIDE);
    let mut pixels = vec![0_u64; looks.len()];
    for pixel in 0..region.pixels() as u32 {
        if let Some(material) = black_back(&frame, pixel) {
            pixels[material] += 1;
        }
    }
    let seen = pixels.iter().enumerate().filter(|(_, pixels)| **pixels > 0);
    let places: Vec<_> = seen.map(|(index, _)| label("material", index, looks[index].name.as_deref())).collect();
    let share = 100.0 * pixels.iter().sum::<u64>() as f64 / region.pixels() as f64;
    let finding =
        format!("black backs of surfaces cover {share:.1} % of the image; a doubleSided material is lit on both sides");
    (!places.is_empty()).then(|| Warning { places, ..Warning::new(file, finding) })
}

/// The material whose back is the first thing that the ray through `pixel` meets, if it is black there but not in
/// front.
fn black_back(frame: &Frame, pixel: u32) -> Option<usize> {
    let (origin, direction) = camera_ray(&frame.camera, pixel, 0, 0);
    let [origin, towards] = [origin, direction].map(|v| v.as_vec3().to_array());
    let hit = trace::closest(frame.surfaces.geometry(), &Ray { origin, direction: towards, max: f32::INFINITY })?;
    let [a, b, c] = frame.surfaces.geometry().corners(hit.triangle as usize).map(|x| DVec3::from(x.map(f64::from)));
    let on_back = (b - a).cross(c - a).dot(direction) > 0.0;
    let material = frame.surfaces.material_index(hit.triangle);
    let looks = &frame.surfaces.materials()[material];
    // Lamps that shine to one side are meant to.
    let is_lamp = frame.lights.of_triangle(hit.triangle).is_some();
    (on_back && !looks.double_sided && looks.albedo != [0.0; 3] && !is_lamp).then_some(material)
}
