//! Lights at infinity: what shines from directions instead of points.

use core::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::{Panorama, Selection};

/// Where the points of lights at infinity are: so many metres from where they are looked at. That is beyond all that
/// scenes may hold, and its square is still f32.
pub const FAR: f32 = 1e10;

/// Something that shines from infinity, as a scene has it.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// The same radiance from all directions [W/(m^2 sr)].
    Sky([f64; 3]),
    /// The radiance of an image.
    Panorama(Arc<Panorama>),
    /// A disk in the sky.
    Sun {
        /// Where it shines to: a vector of any length but zero.
        direction: DVec3,
        /// Irradiance of a plane that faces it [W/m^2].
        irradiance: [f64; 3],
        /// Angle from its centre to its rim, (0, pi / 2) `[rad]`.
        angular_radius: f64,
    },
}

/// A light at infinity: a cap of the sphere of directions about an axis, all of it for the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Distant {
    /// Unit vector to its centre.
    pub axis: [f32; 3],
    /// A unit vector across.
    pub tangent: [f32; 3],
    /// Another one: axis, tangent and bitangent are right-angled.
    pub bitangent: [f32; 3],
    /// Share of the sphere that the cap covers, the squared sine of half of its angular radius: 1 for all of it. Small
    /// caps have no cosine in f32, but they have this.
    pub cap: f32,
    /// Probability that a connection chooses it; the sum over all lights at infinity is one.
    pub share: f32,
    /// Integral of its radiance over all directions, mean over the channels [W/m^2].
    pub flux: f64,
    /// Its radiance by direction, if it is not the same all over the cap.
    pub panorama: Option<Arc<Panorama>>,
}

impl Source {
    /// Its radiance [W/(m^2 sr)]: of an image, the largest in any channel.
    ///
    /// A sun of radiance L that reaches from the axis to the angle theta has the irradiance `pi L sin^2 theta`.
    pub fn radiance(&self) -> [f64; 3] {
        match self {
            Self::Sky(radiance) => *radiance,
            Self::Panorama(image) => [f64::from(image.largest()); 3],
            Self::Sun { irradiance, angular_radius, .. } => {
                irradiance.map(|channel| channel / (PI * angular_radius.sin().powi(2)))
            }
        }
    }

    /// The integral of its radiance over all directions, mean over the channels [W/m^2]: its flux through a sphere is
    /// that times the area of a disk of the same radius.
    pub fn flux(&self) -> f64 {
        let mean = |channels: [f64; 3]| channels.iter().sum::<f64>() / 3.0;
        match self {
            Self::Sky(radiance) => 4.0 * PI * mean(*radiance),
            Self::Panorama(image) => image.flux(),
            Self::Sun { angular_radius, .. } => mean(self.radiance()) * 4.0 * PI * cap(*angular_radius),
        }
    }

    fn placed(&self, share: f64) -> Distant {
        let (axis, cap, panorama) = match self {
            Self::Sky(_) => (DVec3::Y, 1.0, None),
            Self::Panorama(image) => (DVec3::Y, 1.0, Some(image.clone())),
            Self::Sun { direction, angular_radius, .. } => (-direction.normalize(), cap(*angular_radius), None),
        };
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        let [axis, tangent, bitangent] = [axis, tangent, bitangent].map(|v| v.as_vec3().to_array());
        Distant { axis, tangent, bitangent, cap: cap as f32, share: share as f32, flux: self.flux(), panorama }
    }
}

/// Share of the sphere within `angle` of an axis.
fn cap(angle: f64) -> f64 {
    (0.5 * angle).sin().powi(2)
}

/// The lights of `sources`, of which connections choose one by `selection`: all alike, or in proportion to flux, as
/// nothing is nearer to one of them than to another.
pub(super) fn place(sources: &[Source], selection: Selection) -> Vec<Distant> {
    let fluxes: Vec<f64> = sources.iter().map(Source::flux).collect();
    let total: f64 = fluxes.iter().sum();
    let even = selection == Selection::Uniform || total <= 0.0;
    let share = |flux: f64| if even { 1.0 / sources.len() as f64 } else { flux / total };
    sources.iter().zip(fluxes).map(|(source, flux)| source.placed(share(flux))).collect()
}

impl Distant {
    /// Angle from its centre to its rim `[rad]`.
    pub fn angular_radius(&self) -> f64 {
        2.0 * f64::from(self.cap).sqrt().asin()
    }

    /// Shows all that makes it up to `digest`, in pieces.
    pub(super) fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(&self.axis));
        digest(&self.cap.to_le_bytes());
        if let Some(panorama) = &self.panorama {
            panorama.digest(digest);
        }
    }

    /// Solid angle that it covers `[sr]`.
    pub fn solid_angle(&self) -> f64 {
        2.0 * TAU * f64::from(self.cap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(degrees: f64) -> Source {
        let (direction, irradiance) = (DVec3::new(0.0, -2.0, 0.0), [3.0, 6.0, 9.0]);
        Source::Sun { direction, irradiance, angular_radius: degrees.to_radians() }
    }

    #[test]
    fn irradiance_is_the_integral_of_radiance_times_cosine() {
        for degrees in [0.001, 0.265, 5.0, 60.0, 89.0] {
            let radiance = sun(degrees).radiance()[1];
            let rings = 100_000;
            let angle = degrees.to_radians();
            let ring = |i: u32| {
                let theta = (f64::from(i) + 0.5) / f64::from(rings) * angle;
                TAU * theta.sin() * theta.cos() * angle / f64::from(rings)
            };
            let irradiance = radiance * (0..rings).map(ring).sum::<f64>();
            assert!((irradiance / 6.0 - 1.0).abs() < 1e-6, "{degrees} degrees: {irradiance}");
        }
    }

    #[test]
    fn small_suns_keep_the_digits_of_their_angle() {
        for degrees in [0.001, 0.265, 45.0] {
            let placed = place(&[sun(degrees)], Selection::Uniform);
            assert!((placed[0].angular_radius().to_degrees() / degrees - 1.0).abs() < 1e-6);
            assert_eq!((placed[0].axis, placed[0].share), ([0.0, 1.0, 0.0], 1.0));
        }
    }

    #[test]
    fn lights_at_infinity_are_chosen_by_flux_or_alike() {
        let sources = [Source::Sky([1.0; 3]), sun(0.265)];
        let shares = |selection: Selection| place(&sources, selection).iter().map(|x| x.share).collect::<Vec<_>>();
        assert_eq!(shares(Selection::Uniform), [0.5; 2]);
        // What a small sun sends through a sphere is its irradiance times the area of a disk.
        let sky = 4.0 * PI / (4.0 * PI + 6.0);
        for selection in [Selection::Intensity, Selection::IntensityDistance] {
            assert!((f64::from(shares(selection)[0]) - sky).abs() < 1e-4, "{selection:?}");
        }
        let dark = [Source::Sky([0.0; 3]), Source::Sky([0.0; 3])];
        assert!(place(&dark, Selection::Intensity).iter().all(|light| light.share == 0.5));
    }
}
