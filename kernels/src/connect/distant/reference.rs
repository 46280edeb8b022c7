//! Lights at infinity in f64.
//!
//! ```text
//! cap of angle theta about an axis:   cos = 1 - u (1 - cos theta),                         p_dir = 1 / (2 pi (1 - cos theta))
//! pixel (i, j) of an image:           cos = cos theta_i - u (cos theta_i - cos theta_{i+1}),
//!                                     azimuth = 2 pi ((j + v) / w - 1/2) - turn,           p_dir = L / integral of L
//! ```
//!
//! with the azimuth counted from -z towards +x, and `theta_i = pi i / h` from +y. The table knows 1 - cos theta of a cap
//! as twice its share of the sphere, and the integral as flux.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::connect::density::Density;
use crate::connect::light_sample::reference::Uniforms;
use crate::tables::lights::{Distant, FAR, Lights, Panorama};

/// The light whose interval of [0, 1) holds `u`.
fn choose(lights: &Lights, u: f64) -> usize {
    let mut below = 0.0;
    let within = |light: &Distant| {
        below += f64::from(light.share);
        u < below
    };
    lights.distant().iter().position(within).unwrap_or(lights.distant().len() - 1)
}

/// The emitter at infinity, and the point on it, that `start` is to be connected with.
pub fn connect(lights: &Lights, start: DVec3, u: Uniforms) -> (usize, DVec3) {
    let index = choose(lights, u.light);
    let direction = direction(&lights.distant()[index], u);
    (lights.first_distant() as usize + index, point(start, direction))
}

/// Where a light at infinity is that is seen from `start` in this direction `[m]`.
pub fn point(start: DVec3, direction: DVec3) -> DVec3 {
    start + f64::from(FAR) * direction
}

/// A direction towards a light.
fn direction(light: &Distant, u: Uniforms) -> DVec3 {
    let [along, around] = u.point;
    if let Some(panorama) = &light.panorama {
        return in_pixel(panorama, panorama.choose(u.emitter), u.point);
    }
    let [axis, tangent, bitangent] =
        [light.axis, light.tangent, light.bitangent].map(|v| DVec3::from(v.map(f64::from)));
    let from_axis = 2.0 * f64::from(light.cap) * along;
    let sine = (from_axis * (2.0 - from_axis)).sqrt();
    let (sin, cos) = (TAU * around).sin_cos();
    (1.0 - from_axis) * axis + sine * (cos * tangent + sin * bitangent)
}

fn in_pixel(panorama: &Panorama, [column, row]: [u32; 2], [u, v]: [f64; 2]) -> DVec3 {
    let [width, height] = panorama.size().map(f64::from);
    let cosine_of = |row: f64| (PI * row / height).cos();
    let (upper, lower) = (cosine_of(f64::from(row)), cosine_of(f64::from(row) + 1.0));
    let cosine = upper + u * (lower - upper);
    let azimuth = TAU * ((f64::from(column) + v) / width - 0.5 - f64::from(panorama.turn()));
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    DVec3::new(sine * azimuth.sin(), cosine, -sine * azimuth.cos())
}

/// Column and row of the pixel that is seen in a direction.
pub fn pixel(panorama: &Panorama, direction: DVec3) -> [u32; 2] {
    let DVec3 { x, y, z } = direction.normalize();
    let [width, height] = panorama.size();
    let across = (x.atan2(-z) / TAU + 0.5 + f64::from(panorama.turn())).rem_euclid(1.0);
    let down = y.clamp(-1.0, 1.0).acos() / PI;
    let column = (across * f64::from(width)) as u32;
    let row = (down * f64::from(height)) as u32;
    [column.min(width - 1), row.min(height - 1)]
}

/// Radiance of an emitter in the direction in which it is seen, over its `radiance`, per channel: not 1 of images alone.
pub fn colour(lights: &Lights, emitter: usize, direction: DVec3) -> [f64; 3] {
    let Some(panorama) = lights.distant_of(emitter as u32).and_then(|light| light.panorama.as_ref()) else {
        return [1.0; 3];
    };
    let [column, row] = pixel(panorama, direction);
    panorama.texel(column, row).map(f64::from)
}

/// Whether a ray in a direction goes to the light.
pub fn is_met(light: &Distant, direction: DVec3) -> bool {
    let axis = DVec3::from(light.axis.map(f64::from)).normalize();
    light.cap >= 1.0 || direction.normalize().dot(axis) >= 1.0 - 2.0 * f64::from(light.cap)
}

/// The emitters at infinity that a ray meets where nothing is in its way.
pub fn met(lights: &Lights, direction: DVec3) -> impl Iterator<Item = usize> {
    let first = lights.first_distant() as usize;
    let is_met = move |(_, light): &(usize, &Distant)| is_met(light, direction);
    lights.distant().iter().enumerate().filter(is_met).map(move |(index, _)| first + index)
}

/// p_dir P_l: the density of connections to an emitter at infinity in a direction in which it is seen [1/sr].
pub fn direction_density(lights: &Lights, emitter: usize, direction: DVec3) -> f64 {
    let light = lights.distant_of(emitter as u32).expect("an emitter at infinity");
    let density = match &light.panorama {
        Some(panorama) if panorama.flux() > 0.0 => {
            let radiance = colour(lights, emitter, direction).map(|channel| channel * f64::from(panorama.largest()));
            radiance.iter().sum::<f64>() / 3.0 / panorama.flux()
        }
        Some(_) => 0.0,
        None => 1.0 / (TAU * 2.0 * f64::from(light.cap)),
    };
    f64::from(light.share) * density
}

/// The density of connecting `start` with `point` of an emitter at infinity, over the square of the distance, as if it
/// were an area there that faces the start [1/m^2].
pub fn density(lights: &Lights, emitter: usize, start: DVec3, point: DVec3) -> Density {
    let way = point - start;
    Density::new(direction_density(lights, emitter, way) / way.length_squared())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tables::lights::{Selection, Source};

    fn lights(sources: &[Source]) -> Lights {
        Lights::new(Vec::new(), Selection::Uniform).with_distant(sources, Selection::Intensity)
    }

    fn panorama(angle: f64) -> Source {
        let pixel = |i: u32| [i % 5, i % 3, i % 7].map(|x| x as f32);
        Source::Panorama(Arc::new(Panorama::new([8, 4], (0..32).map(pixel).collect(), angle)))
    }

    fn sun(degrees: f64) -> Source {
        let direction = DVec3::new(0.3, -0.8, 0.2);
        Source::Sun { direction, irradiance: [1.0; 3], angular_radius: degrees.to_radians() }
    }

    /// Directions in the middles of cells of about the same solid angle, and that of a cell.
    fn sphere() -> (Vec<DVec3>, f64) {
        let (rings, steps) = (1000, 2000);
        let direction = |i: u32, j: u32| {
            let y = 1.0 - (f64::from(i) + 0.5) / f64::from(rings) * 2.0;
            let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(steps)).sin_cos();
            let radius = (1.0 - y * y).sqrt();
            DVec3::new(radius * cos, y, radius * sin)
        };
        let all = (0..rings).flat_map(|i| (0..steps).map(move |j| direction(i, j))).collect();
        (all, 2.0 * TAU / f64::from(rings * steps))
    }

    #[test]
    fn densities_integrate_to_one() {
        let lights = lights(&[Source::Sky([1.0, 2.0, 3.0]), panorama(1.0), sun(40.0)]);
        let (directions, cell) = sphere();
        let sum: f64 = directions
            .iter()
            .map(|d| met(&lights, *d).map(|emitter| direction_density(&lights, emitter, *d)).sum::<f64>())
            .sum();
        assert!((sum * cell - 1.0).abs() < 1e-3, "{}", sum * cell);
    }

    #[test]
    fn the_flux_of_an_image_is_its_integral() {
        let source = panorama(0.7);
        let lights = lights(std::slice::from_ref(&source));
        let (directions, cell) = sphere();
        let mean = |d: &DVec3| colour(&lights, 0, *d).iter().sum::<f64>() / 3.0;
        let integral = directions.iter().map(mean).sum::<f64>() * cell * source.radiance()[0];
        assert!((integral / source.flux() - 1.0).abs() < 1e-3, "{integral}, not {}", source.flux());
    }

    #[test]
    fn what_is_drawn_is_met_where_it_was_drawn() {
        for source in [Source::Sky([1.0; 3]), panorama(2.0), sun(0.265), sun(80.0)] {
            let lights = lights(&[source]);
            for i in 0..200_u32 {
                let word = |k: u32| (i * 4 + k).wrapping_mul(2_654_435_769);
                let u = [0, 1].map(|k| f64::from(word(k) >> 8) / f64::from(1 << 24));
                let u = Uniforms { light: 0.5, emitter: [0, 1, 2, 3].map(word), point: u };
                let (emitter, point) = connect(&lights, DVec3::ONE, u);
                let direction = (point - DVec3::ONE).normalize();
                assert_eq!(met(&lights, direction).collect::<Vec<_>>(), [emitter]);
                assert!(direction_density(&lights, emitter, direction) > 0.0);
                if let Some(panorama) = &lights.distant()[0].panorama {
                    assert_eq!(pixel(panorama, direction), panorama.choose(u.emitter));
                }
            }
        }
    }

    #[test]
    fn images_show_the_sky_from_inside() {
        // The middle is towards -z, the right half towards +x, the top towards +y.
        let at = |source: &Source, d: [f64; 3]| {
            let Source::Panorama(panorama) = source else { panic!("an image") };
            pixel(panorama, DVec3::from(d))
        };
        let straight = panorama(0.0);
        assert_eq!(at(&straight, [0.1, 0.2, -1.0]), [4, 1]);
        assert_eq!(at(&straight, [-0.1, -0.2, -1.0]), [3, 2]);
        assert_eq!(at(&straight, [1.0, 0.1, -0.1]), [5, 1]);
        assert_eq!(at(&straight, [0.1, 9.0, -0.1])[1], 0);
        // A quarter turn counterclockwise, seen from above, brings what was at -z to -x.
        let turned = panorama(0.5 * PI);
        assert_eq!(at(&turned, [-1.0, 0.2, -0.1]), at(&straight, [0.1, 0.2, -1.0]));
        assert_eq!(at(&turned, [-0.1, 0.2, -1.0]), at(&straight, [1.0, 0.2, -0.1]));
    }
}
