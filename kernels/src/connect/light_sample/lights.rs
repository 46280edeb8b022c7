//! Lights as connections in a straight line see them: any, or one disk, of which everything is the same in all rows and
//! settled once.

use wide::{f32x8, u32x8};

use super::{selection, simd};
use crate::lanes::LANES;
use crate::real::Real;
use crate::tables::lights::{Emitter, Lights, Shape};
use crate::transcendental::sin_cos_turn;
use crate::vec3::{Vec3, Vec3x8};

/// Lights of which none is at infinity, for one row or eight.
pub(crate) trait LightsIn<F: Real>: Copy {
    /// One emitter, or eight.
    type Emitters: Copy + Default;

    /// Those of lights that are chosen from `start` with the normalisation `sum`, by a uniform number and the `words`.
    fn choose(self, start: Vec3<F>, sum: F, choice: F, words: impl FnOnce() -> F::Word) -> Self::Emitters;
    /// Points on them for two uniform numbers, uniform in area.
    fn point(self, emitters: &Self::Emitters, u: F, v: F) -> Vec3<F>;
    /// [`Lights::cosine`].
    fn cosine(self, emitters: &Self::Emitters, point: Vec3<F>, direction: Vec3<F>) -> F;
    /// p_A, where their light was chosen (area measure) [1/m^2].
    fn density(self, emitters: &Self::Emitters) -> F;
    /// P_l, with which their lights are chosen from `start` with the normalisation `sum`.
    fn probability(self, emitters: &Self::Emitters, start: Vec3<F>, sum: F) -> F;
    /// [`Lights::profile`].
    fn profile(self, emitters: &Self::Emitters, cosine: F) -> F;
    /// Indices of the emitters of eight rows, of which these are number `i` and on.
    fn indices(self, emitters: &[Self::Emitters], i: usize) -> u32x8;
    /// Radiance of the emitters of eight rows, of which these are number `i` and on, in one channel [W/(m^2 sr)].
    fn radiance(self, emitters: &[Self::Emitters], i: usize, channel: usize) -> f32x8;
}

impl LightsIn<f32x8> for &Lights {
    type Emitters = [u32; LANES];

    #[inline(always)]
    fn choose(self, start: Vec3x8, sum: f32x8, choice: f32x8, words: impl FnOnce() -> u32x8) -> [u32; LANES] {
        let light = selection::choose(self, start, sum, choice).to_array();
        if !self.groups {
            return light;
        }
        let words = words().to_array();
        core::array::from_fn(|i| self.choose_emitter(light[i], words[i]))
    }

    #[inline(always)]
    fn point(self, emitters: &[u32; LANES], u: f32x8, v: f32x8) -> Vec3x8 {
        simd::point_on(self, emitters, u, v)
    }

    #[inline(always)]
    fn cosine(self, emitters: &[u32; LANES], point: Vec3x8, direction: Vec3x8) -> f32x8 {
        Lights::cosine(self, emitters, point, direction)
    }

    #[inline(always)]
    fn density(self, emitters: &[u32; LANES]) -> f32x8 {
        self.choices(emitters).density
    }

    #[inline(always)]
    fn probability(self, emitters: &[u32; LANES], start: Vec3x8, sum: f32x8) -> f32x8 {
        selection::probability(self, &self.choices(emitters), start, sum)
    }

    #[inline(always)]
    fn profile(self, emitters: &[u32; LANES], cosine: f32x8) -> f32x8 {
        Lights::profile(self, emitters, cosine)
    }

    #[inline(always)]
    fn indices(self, emitters: &[[u32; LANES]], i: usize) -> u32x8 {
        u32x8::new(emitters[i / LANES])
    }

    #[inline(always)]
    fn radiance(self, emitters: &[[u32; LANES]], i: usize, channel: usize) -> f32x8 {
        self.gather(&emitters[i / LANES], |emitter| emitter.radiance[channel])
    }
}

/// A disk with one side that shines alike in all directions, and nothing else.
#[derive(Clone, Copy)]
pub(crate) struct OneDisk<F> {
    center: Vec3<F>,
    /// Tangent and bitangent.
    axes: [Vec3<F>; 2],
    normal: Vec3<F>,
    radius: F,
    density: F,
    radiance: [f32; 3],
}

impl<F: Real> OneDisk<F> {
    /// That of `lights`, if this is all that there is.
    pub fn of(lights: &Lights) -> Option<Self> {
        let [disk] = lights.emitters() else { return None };
        let Emitter { shape, origin, tangent, bitangent, normal, radius, density, radiance, .. } = *disk;
        let is_plain = shape == Shape::Disk && !lights.focused && !lights.double_sided;
        is_plain.then(|| Self {
            center: Vec3::splat(origin),
            axes: [tangent, bitangent].map(Vec3::splat),
            normal: Vec3::splat(normal),
            radius: F::splat(radius),
            density: F::splat(density),
            radiance,
        })
    }
}

impl<F: Real> LightsIn<F> for OneDisk<F> {
    type Emitters = ();

    #[inline(always)]
    fn choose(self, _: Vec3<F>, _: F, _: F, _: impl FnOnce() -> F::Word) {}

    #[inline(always)]
    fn point(self, (): &(), u: F, v: F) -> Vec3<F> {
        let [tangent, bitangent] = self.axes;
        let (sin, cos) = sin_cos_turn(v);
        let r = self.radius * u.sqrt();
        tangent.mul_add(r * cos, bitangent.mul_add(r * sin, self.center))
    }

    #[inline(always)]
    fn cosine(self, (): &(), _: Vec3<F>, direction: Vec3<F>) -> F {
        -direction.dot(self.normal)
    }

    #[inline(always)]
    fn density(self, (): &()) -> F {
        self.density
    }

    #[inline(always)]
    fn probability(self, (): &(), _: Vec3<F>, _: F) -> F {
        F::ONE
    }

    #[inline(always)]
    fn profile(self, (): &(), _: F) -> F {
        F::ONE
    }

    #[inline(always)]
    fn indices(self, _: &[()], _: usize) -> u32x8 {
        u32x8::splat(0)
    }

    #[inline(always)]
    fn radiance(self, _: &[()], _: usize, channel: usize) -> f32x8 {
        f32x8::splat(self.radiance[channel])
    }
}
