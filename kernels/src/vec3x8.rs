//! Eight vectors at once: three batches of components.

use core::ops::{Add, Mul, Neg, Sub};

use wide::f32x8;

/// Shortest length by which a direction is normalised.
const LEAST_LENGTH: f32 = 1e-30;

/// Eight vectors of R^3, one per lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3x8 {
    /// First components.
    pub x: f32x8,
    /// Second components.
    pub y: f32x8,
    /// Third components.
    pub z: f32x8,
}

impl Vec3x8 {
    /// All zero.
    pub const ZERO: Self = Self { x: f32x8::ZERO, y: f32x8::ZERO, z: f32x8::ZERO };

    /// From its components.
    #[inline(always)]
    pub fn new(x: f32x8, y: f32x8, z: f32x8) -> Self {
        Self { x, y, z }
    }

    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(v: [f32; 3]) -> Self {
        Self::new(f32x8::splat(v[0]), f32x8::splat(v[1]), f32x8::splat(v[2]))
    }

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

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, v: Self) -> f32x8 {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z * v.z))
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> f32x8 {
        self.dot(self)
    }

    /// Length, and unit direction: of the zero vector that is zero.
    #[inline(always)]
    pub fn length_and_direction(self) -> (f32x8, Self) {
        let length = self.length_squared().sqrt();
        (length, self.over(length))
    }

    /// The unit direction of a vector of this `length`: of the zero vector that is zero.
    #[inline(always)]
    pub fn over(self, length: f32x8) -> Self {
        self * (f32x8::ONE / length.fast_max(f32x8::splat(LEAST_LENGTH)))
    }

    /// `self * s + v`.
    #[inline(always)]
    pub fn mul_add(self, s: f32x8, v: Self) -> Self {
        Self::new(self.x.mul_add(s, v.x), self.y.mul_add(s, v.y), self.z.mul_add(s, v.z))
    }

    /// `v - self * s`.
    #[inline(always)]
    pub fn mul_neg_add(self, s: f32x8, v: Self) -> Self {
        Self::new(self.x.mul_neg_add(s, v.x), self.y.mul_neg_add(s, v.y), self.z.mul_neg_add(s, v.z))
    }

    /// The component-wise choice: `a` where `mask` is set, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: f32x8, a: Self, b: Self) -> Self {
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
        let one = f32x8::ONE;
        let sign = one.copysign(z);
        let a = -one / (sign + z);
        let b = x * y * a;
        let tangent = Self::new((sign * x * x).mul_add(a, one), sign * b, -sign * x);
        let bitangent = Self::new(b, (y * y).mul_add(a, sign), -y);
        (tangent, bitangent)
    }
}

impl Add for Vec3x8 {
    type Output = Self;
    #[inline(always)]
    fn add(self, v: Self) -> Self {
        Self::new(self.x + v.x, self.y + v.y, self.z + v.z)
    }
}

impl Sub for Vec3x8 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, v: Self) -> Self {
        Self::new(self.x - v.x, self.y - v.y, self.z - v.z)
    }
}

impl Mul<f32x8> for Vec3x8 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f32x8) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl Neg for Vec3x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
