//! What a phase function can be asked in f64, and the turn of a direction.

use core::f64::consts::TAU;

use glam::DVec3;

use super::HenyeyGreenstein;

/// A phase function as the twins ask it.
pub trait Phase {
    /// Its value, which is also its density: per solid angle, at a turn by `cosine` [1/sr].
    fn density(&self, cosine: f64) -> f64;

    /// The cosine of a turn for a uniform number `u`: the cosine below which a share `u` of all events falls, or, of a
    /// mixture, of the part that `u` selects.
    fn sample_cosine(&self, u: f64) -> f64;

    /// Share of the forward hemisphere, (0, 1).
    fn forward_share(&self) -> f64;

    /// The same as [`Self::sample_cosine`] for the events in the forward hemisphere alone.
    fn sample_forward_cosine(&self, u: f64) -> f64 {
        self.sample_cosine(1.0 - self.forward_share() * (1.0 - u))
    }

    /// Mean cosine of a turn, (-1, 1).
    fn mean_cosine(&self) -> f64;

    /// The Henyey-Greenstein lobe of the same mean cosine: the axis of the bridges' table of counts.
    fn lobe(&self) -> HenyeyGreenstein {
        HenyeyGreenstein { g: self.mean_cosine() as f32 }
    }

    /// Shares and mean cosines of the Henyey-Greenstein lobes by which bridges roll about their axis.
    fn roll_lobes(&self) -> Vec<(f64, f64)> {
        vec![(1.0, f64::from(self.lobe().g))]
    }
}

/// Tangent and bitangent of a unit vector; azimuths count from the first towards the second.
///
/// The convention is Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017.
pub fn frame(direction: DVec3) -> (DVec3, DVec3) {
    let DVec3 { x, y, z } = direction;
    let sign = if z.is_sign_negative() { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    (DVec3::new(1.0 + sign * a * x * x, sign * b, -sign * x), DVec3::new(b, sign + a * y * y, -y))
}

/// `direction` turned by an angle of the given cosine, at azimuth `2 pi azimuth_u` of its frame.
pub fn turn(direction: DVec3, cosine: f64, azimuth_u: f64) -> DVec3 {
    let (tangent, bitangent) = frame(direction);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (sin_azimuth, cos_azimuth) = (TAU * azimuth_u).sin_cos();
    cosine * direction + sine * (cos_azimuth * tangent + sin_azimuth * bitangent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_right_handed_and_turns_have_their_angle() {
        for d in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.3, -0.5, -0.2), DVec3::new(-1.0, 2.0, 1e-9)] {
            let d = d.normalize();
            let (tangent, bitangent) = frame(d);
            assert!((tangent.cross(bitangent) - d).length() < 1e-14 && (tangent.length() - 1.0).abs() < 1e-14);
            for (cosine, u) in [(1.0, 0.3), (-1.0, 0.1), (0.2, 0.0), (-0.7, 0.6)] {
                let turned = turn(d, cosine, u);
                assert!((turned.dot(d) - cosine).abs() < 1e-14 && (turned.length() - 1.0).abs() < 1e-14);
            }
            assert!((turn(d, 0.0, 0.25) - bitangent).length() < 1e-14);
        }
    }
}
