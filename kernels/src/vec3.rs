//! Vectors of R^3, one or eight at once: three components of one row or of eight.

use core::ops::{Add, Mul, Neg, Sub};

use wide::f32x8;

use crate::real::{Mask, Real};

/// Shortest length by which a direction is normalised.
const LEAST_LENGTH: f32 = 1e-30;

/// A vector of R^3, or eight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<F> {
    /// First components.
    pub x: F,
    /// Second components.
    pub y: F,
    /// Third components.
    pub z: F,
}

/// Eight vectors of R^3, one per lane.
pub type Vec3x8 = Vec3<f32x8>;

impl<F: Real> Vec3<F> {
    /// All zero.
    pub const ZERO: Self = Self { x: F::ZERO, y: F::ZERO, z: F::ZERO };

    /// From its components.
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }

    /// The same vector in every row.
    #[inline(always)]
    pub fn splat(v: [f32; 3]) -> Self {
        Self::new(F::splat(v[0]), F::splat(v[1]), F::splat(v[2]))
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, v: Self) -> F {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z * v.z))
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, v: Self) -> Self {
        Self::new(
            self.y.mul_sub(v.z, self.z * v.y),
            self.z.mul_sub(v.x, self.x * v.z),
            self.x.mul_sub(v.y, self.y * v.x),
        )
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> F {
        self.dot(self)
    }

    /// Length, and unit direction: of the zero vector that is zero.
    #[inline(always)]
    pub fn length_and_direction(self) -> (F, Self) {
        let length = self.length_squared().sqrt();
        (length, self.over(length))
    }

    /// The unit direction of a vector of this `length`: of the zero vector that is zero.
    #[inline(always)]
    pub fn over(self, length: F) -> Self {
        self * (F::ONE / length.fast_max(F::splat(LEAST_LENGTH)))
    }

    /// `self * s + v`.
    #[inline(always)]
    pub fn mul_add(self, s: F, v: Self) -> Self {
        Self::new(self.x.mul_add(s, v.x), self.y.mul_add(s, v.y), self.z.mul_add(s, v.z))
    }

    /// `v - self * s`.
    #[inline(always)]
    pub fn mul_neg_add(self, s: F, v: Self) -> Self {
        Self::new(self.x.mul_neg_add(s, v.x), self.y.mul_neg_add(s, v.y), self.z.mul_neg_add(s, v.z))
    }

    /// The component-wise choice: `a` where `mask` is set, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: F::Mask, a: Self, b: Self) -> Self {
        Self::new(mask.select(a.x, b.x), mask.select(a.y, b.y), mask.select(a.z, b.z))
    }

    /// Tangent and bitangent: two unit vectors that complete the unit vector `self` to a right-handed frame.
    ///
    /// With `s = sign(z)`, `a = -1 / (s + z)`, `b = x y a` the tangent is `(1 + s a x^2, s b, -s x)` and the bitangent
    /// `(b, s + a y^2, -y)`: branchless, and continuous but for the plane z = 0 (Duff et al., Building an Orthonormal
    /// Basis, Revisited, JCGT 2017). All azimuths are counted in this frame, from the tangent towards the bitangent.
    #[inline(always)]
    pub fn frame(self) -> (Self, Self) {
        let Self { x, y, z } = self;
        let one = F::ONE;
        let sign = one.copysign(z);
        let a = -one / (sign + z);
        let b = x * y * a;
        let tangent = Self::new((sign * x * x).mul_add(a, one), sign * b, -sign * x);
        let bitangent = Self::new(b, (y * y).mul_add(a, sign), -y);
        (tangent, bitangent)
    }
}

impl Vec3x8 {
    /// From its components as arrays of eight.
    #[inline(always)]
    pub fn from_arrays([x, y, z]: [[f32; 8]; 3]) -> Self {
        Self::new(f32x8::new(x), f32x8::new(y), f32x8::new(z))
    }

    /// The components as arrays of eight.
    #[inline(always)]
    pub fn to_arrays(self) -> [[f32; 8]; 3] {
        [self.x.to_array(), self.y.to_array(), self.z.to_array()]
    }
}

impl<F: Real> Add for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, v: Self) -> Self {
        Self::new(self.x + v.x, self.y + v.y, self.z + v.z)
    }
}

impl<F: Real> Sub for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, v: Self) -> Self {
        Self::new(self.x - v.x, self.y - v.y, self.z - v.z)
    }
}

impl<F: Real> Mul<F> for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<F: Real> Neg for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
