//! The sky of a clear day: light that air and haze scattered once, in an atmosphere of plane layers.
//!
//! ```text
//! L = E (beta_r p_r(gamma) + beta_m p_m(gamma)) / (beta_r + beta_m) (1 - e^{-(beta_r + beta_m) m(theta)})
//! ```
//!
//! per channel: vertical optical depths beta and phase functions p of air (Rayleigh) and haze (Henyey-Greenstein), gamma
//! the angle from the sun, and the air mass m (Kasten, Young 1989) that is seen at theta from the zenith.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use super::TO_SUN;

/// Width and height of the image: a lat-long one, the middle of its width towards -z.
pub const SIZE: [usize; 2] = [1024, 512];
/// What shines on the air: about three times the sun, since light is scattered more than once `[W/m^2]`.
const IRRADIANCE: f64 = 26.0;
/// Vertical optical depths of air, per channel, and of haze.
const AIR: DVec3 = DVec3::new(0.045, 0.1, 0.235);
const HAZE: f64 = 0.045;
/// Mean cosine of what haze scatters.
const FORWARD: f64 = 0.7;
/// What is below the horizon `[W/(m^2 sr)]`, and angle in which the sky gets there.
const GROUND: DVec3 = DVec3::new(0.3, 0.33, 0.2);
const EDGE: f64 = 0.06;

/// The image, row by row from the top: radiance per channel `[W/(m^2 sr)]`.
pub fn pixels() -> Vec<[f32; 3]> {
    let [width, height] = SIZE;
    let pixel = |i: usize| {
        let polar = PI * ((i / width) as f64 + 0.5) / height as f64;
        let azimuth = TAU * ((i % width) as f64 + 0.5) / width as f64 - PI;
        radiance(polar, azimuth).as_vec3().to_array()
    };
    (0..width * height).map(pixel).collect()
}

/// Radiance from a direction, by its angle from the zenith and that from -z towards +x.
fn radiance(polar: f64, azimuth: f64) -> DVec3 {
    let above = polar.min(0.5 * PI);
    let direction = DVec3::new(above.sin() * azimuth.sin(), above.cos(), -above.sin() * azimuth.cos());
    let below = ((polar - above) / EDGE).clamp(0.0, 1.0);
    of_sky(direction, above).lerp(GROUND, below)
}

/// Radiance of the sky in a direction, at an angle from the zenith.
fn of_sky(direction: DVec3, polar: f64) -> DVec3 {
    let cos = direction.dot(TO_SUN.normalize());
    let rayleigh = 3.0 / (16.0 * PI) * (1.0 + cos * cos);
    let haze = (1.0 - FORWARD * FORWARD) / (2.0 * TAU * (1.0 + FORWARD * FORWARD - 2.0 * FORWARD * cos).powf(1.5));
    let degrees = polar.to_degrees();
    let air_mass = 1.0 / (direction.y + 0.50572 * (96.07995 - degrees).powf(-1.6364));
    let depth = AIR + HAZE;
    let scattered = (AIR * rayleigh + DVec3::splat(HAZE * haze)) / depth;
    IRRADIANCE * scattered * (DVec3::ONE - (-depth * air_mass).exp())
}
