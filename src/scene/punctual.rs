//! Punctual lights of a model as lights with an extent, of the same intensity.
//!
//! A point light of intensity I [W/sr] becomes a sphere, whose intensity is pi r^2 times its radiance. A spot becomes a
//! disk, whose intensity at the angle theta is pi r^2 cos theta Le(theta): its cone is that of the file, with Le so
//! that it falls as `KHR_lights_punctual` recommends. Of a cone too narrow for that single precision is left with a
//! power of the cosine. A directional light of illuminance E [lux] becomes a sun of irradiance E [W/m^2].

use core::f64::consts::PI;

use super::lights::{ANGULAR_RADIUS, LARGEST_EXPONENT, Placed};
use super::model::Loaded;
use super::ranges::Owner;
use super::schema::{Light, LightKind, Spectrum};
use crate::error::Result;
use crate::gltf;

/// The lights that stand for the punctual lights of a model; `radius` is of those that do not say their own. Where no
/// light arrives from infinity, directional ones are left out.
pub fn of_model(loaded: &Loaded, radius: f64, has_suns: bool) -> Result<Vec<Placed<'static>>> {
    let placed = |light: &gltf::Light| {
        let owner = Owner::object(&loaded.file, "light", &light.name);
        let (key, size) = if is_sun(light) { ("angular_radius_deg", ANGULAR_RADIUS) } else { ("radius", radius) };
        let size = owner.extra(light.extras.as_ref(), key)?.unwrap_or(size);
        Ok(Placed { owner, name: Some(light.name.clone()), light: extended(light, size) })
    };
    loaded.model.lights.iter().filter(|light| has_suns || !is_sun(light)).map(placed).collect()
}

/// Whether a light shines from infinity.
pub fn is_sun(light: &gltf::Light) -> bool {
    light.kind == gltf::LightKind::Directional
}

/// Narrowest cone whose edge single precision can place `[rad]`, about a degree.
const NARROWEST: f64 = 0.02;

/// What stands for `light`, with this radius `[m]`, or angular radius of a sun in degrees.
fn extended(light: &gltf::Light, radius: f64) -> Light {
    let (kind, exponent, cone) = match light.kind {
        gltf::LightKind::Point => (LightKind::Sphere, None, None),
        gltf::LightKind::Spot { inner, outer } => {
            (LightKind::Spot, Some(exponent(inner, outer)), (outer >= NARROWEST).then_some([inner, outer]))
        }
        gltf::LightKind::Directional => {
            let irradiance = Spectrum(light.color.map(|channel| f64::from(channel) * light.intensity));
            return Light {
                direction: Some(light.direction),
                irradiance: Some(irradiance),
                angular_radius_deg: Some(radius),
                ..Light::of(LightKind::Sun)
            };
        }
    };
    // What makes a radiance of 1 an intensity, of a power of the cosine r^2 (n + 1) / 2.
    let area = match (exponent, cone) {
        (Some(exponent), None) => 0.5 * (exponent + 1.0) * radius * radius,
        _ => PI * radius * radius,
    };
    let radiance = light.color.map(|channel| f64::from(channel) * light.intensity / area);
    let normal = exponent.map(|_| light.direction);
    let (center, radius, radiance) = (Some(light.position), Some(radius), Some(Spectrum(radiance)));
    Light { center, normal, radius, radiance, exponent, cone, ..Light::of(kind) }
}

/// The n with which a power of the cosine, cos^(n + 1), is about the intensity of a spot: one half midway between its
/// cone angles; 0, a plain disk with one half at 60 degrees, is the widest there is.
fn exponent(inner: f64, outer: f64) -> f64 {
    let sine = (0.5 * (inner + outer)).sin();
    // ln cos as half the logarithm of 1 - sin^2, for narrow cones.
    let power = 2.0 * 0.5_f64.ln() / (-sine * sine).ln_1p();
    (power - 1.0).clamp(0.0, LARGEST_EXPONENT)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use fogbow_kernels::emission::reference::profile;
    use fogbow_kernels::tables::lights::Emitter;
    use glam::DVec3;

    use super::super::lights::emitter;
    use super::*;

    fn light(kind: gltf::LightKind) -> gltf::Light {
        gltf::Light {
            name: "Lamp".into(),
            node: 0,
            kind,
            color: [1.0, 0.5, 0.25],
            intensity: 8.0,
            position: [1.0, 2.0, 3.0],
            direction: [0.0, 0.0, -1.0],
            extras: None,
        }
    }

    const CONES: [(f64, f64); 5] = [(0.0, FRAC_PI_4), (0.1, 0.2), (0.0, 0.05), (0.5, FRAC_PI_2), (0.0, FRAC_PI_2)];

    #[test]
    fn a_sphere_has_the_intensity_of_its_point_light() {
        for radius in [0.001, 0.01, 2.0] {
            let sphere = extended(&light(gltf::LightKind::Point), radius);
            let (center, extent) = (Some([1.0, 2.0, 3.0]), Some(radius));
            assert_eq!((sphere.kind, sphere.center, sphere.radius), (LightKind::Sphere, center, extent));
            assert_eq!((sphere.normal, sphere.exponent), (None, None));
            let sphere = emitter(&Owner::Object("bulb".into()), &sphere, DVec3::ZERO).expect("valid");
            assert!((sphere.intensity() - 14.0 / 3.0).abs() < 1e-5, "{} W/sr of {radius} m", sphere.intensity());
            // Seen from afar it is a disk of its radius.
            let intensity = sphere.radiance.map(|channel| f64::from(channel) * PI * radius * radius);
            for (found, expected) in intensity.into_iter().zip([8.0, 4.0, 2.0]) {
                assert!((found - expected).abs() < 1e-6 * expected, "{found} W/sr of {radius} m");
            }
        }
    }

    #[test]
    fn a_disk_has_the_intensity_of_its_spot_along_the_axis() {
        for (inner, outer) in CONES {
            let disk = extended(&light(gltf::LightKind::Spot { inner, outer }), 0.02);
            let owner = Owner::Object("spot".into());
            let disk = emitter(&owner, &disk, DVec3::ZERO).expect("valid");
            assert!((disk.intensity() - 14.0 / 3.0).abs() < 1e-5, "{} W/sr of {inner} to {outer}", disk.intensity());
            assert_eq!((disk.origin, disk.normal), ([1.0, 2.0, 3.0], [0.0, 0.0, -1.0]));
        }
    }

    #[test]
    fn a_disk_has_the_cone_of_its_spot() {
        let spot = |inner, outer| {
            let disk = extended(&light(gltf::LightKind::Spot { inner, outer }), 0.02);
            emitter(&Owner::Object("spot".into()), &disk, DVec3::ZERO).expect("valid")
        };
        let intensity = |disk: &Emitter, angle: f64| {
            let cosine = angle.cos();
            let towards = DVec3::new(angle.sin(), 0.0, cosine);
            disk.area() * cosine * profile(disk, DVec3::new(1.0, 2.0, 3.0), towards) * f64::from(disk.radiance[0])
        };
        let disk = spot(0.3, 0.6);
        let fall =
            |angle: f64| ((angle.cos() - 0.6_f64.cos()) / (0.3_f64.cos() - 0.6_f64.cos())).clamp(0.0, 1.0).powi(2);
        for angle in [0.0, 0.25, 0.31, 0.45, 0.59, 0.61, 1.0, 1.5] {
            let found = intensity(&disk, angle);
            assert!((found - 8.0 * fall(angle)).abs() < 1e-4, "{found} W/sr at {angle}");
        }
        // A hard edge, and a cone that is too narrow for one.
        let (hard, narrow) = (spot(0.6, 0.6), spot(0.01, 0.015));
        assert_eq!([0.59, 0.61].map(|angle| intensity(&hard, angle).round()), [8.0, 0.0]);
        assert!(narrow.window[0] == 0.0 && (intensity(&narrow, 0.0) - 8.0).abs() < 1e-3);
    }

    #[test]
    fn a_power_of_the_cosine_halves_midway_between_the_angles_of_a_cone() {
        for (inner, outer) in CONES {
            let n = exponent(inner, outer);
            let half = (0.5 * (inner + outer)).cos().powf(n + 1.0);
            assert!((half - 0.5).abs() < 1e-9, "{half} with n = {n} of {inner} to {outer}");
        }
    }

    #[test]
    fn cones_without_a_profile_of_their_own_have_the_nearest() {
        assert_eq!(exponent(1.5, FRAC_PI_2), 0.0);
        for outer in [0.01, 1e-9, 1e-300, f64::MIN_POSITIVE] {
            assert_eq!(exponent(0.0, outer), LARGEST_EXPONENT, "{outer}");
        }
    }

    #[test]
    fn a_sun_has_the_irradiance_of_its_directional_light() {
        let sun = extended(&light(gltf::LightKind::Directional), ANGULAR_RADIUS);
        assert_eq!((sun.kind, sun.direction, sun.center), (LightKind::Sun, Some([0.0, 0.0, -1.0]), None));
        assert_eq!((sun.irradiance, sun.angular_radius_deg), (Some(Spectrum([8.0, 4.0, 2.0])), Some(0.265)));
    }
}
