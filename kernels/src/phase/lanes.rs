//! What a phase function can be asked for eight rows.

use wide::f32x8;

use super::HenyeyGreensteinX8;
use crate::real::Real;
use crate::transcendental::sin_cos_turn;
use crate::vec3::{Vec3, Vec3x8};

/// An angle to an axis, in [0, pi].
#[derive(Clone, Copy)]
pub struct PlaneAngle {
    /// Its cosine.
    pub cosine: f32x8,
    /// Its sine, >= 0.
    pub sine: f32x8,
}

impl PlaneAngle {
    /// That of a unit `direction` to the unit vector `axis`. The sine comes from what is left of the direction across
    /// the axis; `1 - cos^2` would lose the small angles on which a forward peak depends.
    #[inline(always)]
    pub fn between(direction: Vec3x8, axis: Vec3x8) -> Self {
        let cosine = direction.dot(axis);
        Self { cosine, sine: axis.mul_neg_add(cosine, direction).length_squared().sqrt() }
    }

    /// The one of this cosine, [-1, 1] but for rounding, where small angles need not be told from 0.
    #[inline(always)]
    pub fn of_cosine(cosine: f32x8) -> Self {
        Self { cosine, sine: cosine.mul_neg_add(cosine, f32x8::ONE).fast_max(f32x8::ZERO).sqrt() }
    }
}

/// How scattering events turn directions: those of eight rows, or of one.
#[derive(Clone, Copy)]
pub struct Deflection<F = f32x8> {
    /// Cosine of the turn, [-1, 1].
    pub cosine: F,
    /// Sine of the turn, [0, 1].
    pub sine: F,
}

impl<F: Real> Deflection<F> {
    /// The unit direction `axis` turned by the deflection, at azimuth `2 pi turn` about it.
    #[inline(always)]
    pub fn apply(&self, axis: Vec3<F>, turn: F) -> Vec3<F> {
        let (sin, cos) = sin_cos_turn(turn);
        let (tangent, bitangent) = axis.frame();
        let across = bitangent.mul_add(self.sine * sin, axis * self.cosine);
        tangent.mul_add(self.sine * cos, across)
    }

    /// A right-handed frame of unit vectors, the last of which is a direction, turned by the deflection at an azimuth phi
    /// with this `(sin, cos)`: the others go along, so that walks need not find new ones at every turn.
    ///
    /// ```text
    /// e = cos(phi) t + sin(phi) b
    /// t' = cos(theta) e - sin(theta) d,   b' = cos(phi) b - sin(phi) t,   d' = cos(theta) d + sin(theta) e
    /// ```
    #[inline(always)]
    pub fn carry(&self, [tangent, bitangent, direction]: [Vec3<F>; 3], (sin, cos): (F, F)) -> [Vec3<F>; 3] {
        let towards = bitangent.mul_add(sin, tangent * cos);
        [
            direction.mul_add(-self.sine, towards * self.cosine),
            tangent.mul_add(-sin, bitangent * cos),
            towards.mul_add(self.sine, direction * self.cosine),
        ]
    }
}

/// What walks and straight connections ask of a phase function, for eight rows or one.
pub trait Turns<F: Real>: Copy {
    /// Draws a turn from a uniform number in (0, 1).
    fn turn(&self, u: F) -> Deflection<F>;

    /// One over the phase function of the turn between two directions `[sr]`.
    fn inverse_density_of(&self, incoming: Vec3<F>, outgoing: Vec3<F>) -> F;
}

impl<P: PhaseX8> Turns<f32x8> for P {
    #[inline(always)]
    fn turn(&self, u: f32x8) -> Deflection {
        self.sample(u)
    }

    #[inline(always)]
    fn inverse_density_of(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        self.inverse_density(incoming, outgoing)
    }
}

/// A phase function, prepared for eight lanes.
///
/// All directions are unit propagation directions. What bridges ask for, [`Self::lobe`] and all that follows it, has a
/// default for phase functions of any kind.
pub trait PhaseX8: Copy {
    /// Draws a turn from a uniform number in (0, 1).
    fn sample(&self, u: f32x8) -> Deflection;

    /// The same for a number u of which `above = 1 - u` is known apart, each relative to itself: what is left of a
    /// number that selected something else before.
    #[inline(always)]
    fn sample_at(&self, u: f32x8, _above: f32x8) -> Deflection {
        self.sample(u)
    }

    /// Draws a turn by less than a right angle.
    fn sample_forward(&self, u: f32x8) -> Deflection;

    /// The same as [`Self::sample_at`] for turns by less than a right angle.
    #[inline(always)]
    fn sample_forward_at(&self, u: f32x8, _above: f32x8) -> Deflection {
        self.sample_forward(u)
    }

    /// Share of such turns, (0, 1).
    fn forward_share(&self) -> f32x8;

    /// A factor of the inverse density that does not depend on the turn `[sr]`; sums take it out.
    #[inline(always)]
    fn scale(&self) -> f32x8 {
        f32x8::ONE
    }

    /// One over the phase function of the turn between two directions, over [`Self::scale`].
    fn inverse_shape(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8;

    /// One over the phase function of the turn between two directions `[sr]`.
    #[inline(always)]
    fn inverse_density(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        self.scale() * self.inverse_shape(incoming, outgoing)
    }

    /// The Henyey-Greenstein lobe of the same mean cosine: the axis of the bridges' table of counts.
    fn lobe(&self) -> HenyeyGreensteinX8;

    /// Draws the `(sine, cosine)` of the roll psi of a bridge, of which arriving and leaving direction have these
    /// angles to the axis.
    #[inline(always)]
    fn roll(&self, arriving: PlaneAngle, leaving: PlaneAngle, u: f32x8) -> (f32x8, f32x8) {
        self.lobe().roll(arriving, leaving, u)
    }

    /// `2 pi p(psi)` of the roll between two directions, which have these angles to the axis.
    #[inline(always)]
    fn roll_density(&self, directions: [Vec3x8; 2], angles: [PlaneAngle; 2]) -> f32x8 {
        self.lobe().roll_density(directions, angles)
    }

    /// `2 pi p(psi)` over the phase function, over [`Self::scale`].
    #[inline(always)]
    fn rolled_shape(&self, directions: [Vec3x8; 2], angles: [PlaneAngle; 2]) -> f32x8 {
        let [incoming, outgoing] = directions;
        self.inverse_shape(incoming, outgoing) * self.roll_density(directions, angles)
    }
}
