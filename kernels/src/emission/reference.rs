//! Emission in f64.
//!
//! ```text
//! profile   = 1,   (k + 1) / (2 pi) cos^k theta,   or  clamp(a cos + b, 0, 1)^2 / cos
//! p_dir(w)  = (k + 2) / (2 pi) cos^{k+1} theta     (solid angle, over the hemisphere of the front, half of it on either side
//!                                                   where both shine)
//! cos theta = u_1^{1 / (k + 2)},   phi = 2 pi u_2
//! ```
//!
//! The cosine inverts the distribution of p_dir: `int_c^1 (k + 2) x^{k+1} dx = 1 - c^{k+2}`, and u may stand for 1 - u.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::phase::reference::frame;
use crate::tables::lights::{Emitter, Shape};

/// Cosine between the normal of an emitter at `point`, on the side that shines, and the way back of a ray that arrives
/// there in `direction`; negative where it is dark, 0 if there is no direction.
pub fn cosine(emitter: &Emitter, point: DVec3, direction: DVec3) -> f64 {
    -direction.normalize_or_zero().dot(normal(emitter, point, direction))
}

/// Unit normal of an emitter at `point`, on the side that shines; where both do, on the one where a ray in `direction`
/// arrives. What is at infinity faces every ray.
pub fn normal(emitter: &Emitter, point: DVec3, direction: DVec3) -> DVec3 {
    let [origin, flat] = [emitter.origin, emitter.normal].map(|v| DVec3::from(v.map(f64::from)));
    match emitter.shape {
        Shape::Sphere => (point - origin) / f64::from(emitter.radius),
        Shape::Distant => -direction.normalize_or_zero(),
        _ if emitter.double_sided && direction.dot(flat) > 0.0 => -flat,
        _ => flat,
    }
}

/// Radiance of an emitter from `point` towards where a ray in `direction` comes from, over its `radiance`; 0 from its
/// back.
pub fn profile(emitter: &Emitter, point: DVec3, direction: DVec3) -> f64 {
    let cosine = cosine(emitter, point, direction);
    if cosine <= 0.0 {
        return 0.0;
    }
    let ([a, b], exponent) = (emitter.window.map(f64::from), f64::from(emitter.exponent));
    if a > 0.0 {
        return (a * cosine + b).clamp(0.0, 1.0).powi(2) / cosine;
    }
    if emitter.focused { (exponent + 1.0) / (2.0 * PI) * cosine.powf(exponent) } else { 1.0 }
}

/// p_dir: the density with which `point` of an emitter sends a ray in the unit direction `w` (solid angle) [1/sr].
pub fn direction_density(emitter: &Emitter, point: DVec3, w: DVec3) -> f64 {
    let cosine = cosine(emitter, point, -w);
    if cosine <= 0.0 {
        return 0.0;
    }
    let exponent = f64::from(emitter.exponent);
    let side = if emitter.double_sided { 0.5 } else { 1.0 };
    side * (exponent + 2.0) / TAU * cosine.powf(exponent + 1.0)
}

/// The unit direction in which `point` of an emitter sends a ray, for uniform numbers that decide on cosine, azimuth,
/// nothing, and side.
pub fn emit(emitter: &Emitter, point: DVec3, u: [f64; 4]) -> DVec3 {
    let front = normal(emitter, point, DVec3::ZERO).normalize();
    let normal = if emitter.double_sided && u[3] < 0.5 { -front } else { front };
    let (tangent, bitangent) = frame(normal);
    let cosine = u[0].powf(1.0 / (f64::from(emitter.exponent) + 2.0));
    let sine = (1.0 - cosine * cosine).sqrt();
    let (sin_azimuth, cos_azimuth) = (TAU * u[1]).sin_cos();
    cosine * normal + sine * (cos_azimuth * tangent + sin_azimuth * bitangent)
}
