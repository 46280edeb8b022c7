//! Lights as connections in a straight line see them: any, or one disk, of which everything is the same in all rows and
//! settled once.

use wide::{f32x8, u32x8};

use super::{selection, simd};
use crate::lanes::LANES;
use crate::tables::lights::{Emitter, Lights, Shape};
use crate::transcendental::sin_cos_turn;
use crate::vec3x8::Vec3x8;

/// Lights of which none is at infinity.
pub(crate) trait LightsX8: Copy {
    /// Eight emitters.
    type Emitters: Copy + Default;

    /// Their indices.
    fn indices(self, emitters: &Self::Emitters) -> u32x8;

    /// Those of lights that are chosen from `start` with the normalisation `sum`, by a uniform number and the `words`.
    fn choose(self, start: Vec3x8, sum: f32x8, choice: f32x8, words: impl FnOnce() -> u32x8) -> Self::Emitters;
    /// Points on them for two uniform numbers, uniform in area.
    fn point(self, emitters: &Self::Emitters, u: f32x8, v: f32x8) -> Vec3x8;
    /// [`Lights::cosine`].
    fn cosine(self, emitters: &Self::Emitters, point: Vec3x8, direction: Vec3x8) -> f32x8;
    /// p_A, where their light was chosen (area measure) [1/m^2].
    fn density(self, emitters: &Self::Emitters) -> f32x8;
    /// P_l, with which their lights are chosen from `start` with the normalisation `sum`.
    fn probability(self, emitters: &Self::Emitters, start: Vec3x8, sum: f32x8) -> f32x8;
    /// [`Lights::profile`].
    fn profile(self, emitters: &Self::Emitters, cosine: f32x8) -> f32x8;
    /// Radiance in one channel [W/(m^2 sr)].
    fn radiance(self, emitters: &Self::Emitters, channel: usize) -> f32x8;
}

impl LightsX8 for &Lights {
    type Emitters = [u32; LANES];

    #[inline(always)]
    fn indices(self, emitters: &[u32; LANES]) -> u32x8 {
        u32x8::new(*emitters)
    }

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
    fn radiance(self, emitters: &[u32; LANES], channel: usize) -> f32x8 {
        self.gather(emitters, |emitter| emitter.radiance[channel])
    }
}

/// A disk with one side that shines alike in all directions, and nothing else.
#[derive(Clone, Copy)]
pub(crate) struct OneDisk {
    center: Vec3x8,
    /// Tangent and bitangent.
    axes: [Vec3x8; 2],
    normal: Vec3x8,
    radius: f32x8,
    density: f32x8,
    radiance: [f32x8; 3],
}

impl OneDisk {
    /// That of `lights`, if this is all that there is.
    pub fn of(lights: &Lights) -> Option<Self> {
        let [disk] = lights.emitters() else { return None };
        let Emitter { shape, origin, tangent, bitangent, normal, radius, density, radiance, .. } = *disk;
        let is_plain = shape == Shape::Disk && !lights.focused && !lights.double_sided;
        is_plain.then(|| Self {
            center: Vec3x8::splat(origin),
            axes: [tangent, bitangent].map(Vec3x8::splat),
            normal: Vec3x8::splat(normal),
            radius: f32x8::splat(radius),
            density: f32x8::splat(density),
            radiance: radiance.map(f32x8::splat),
        })
    }
}

impl LightsX8 for OneDisk {
    type Emitters = ();

    #[inline(always)]
    fn indices(self, (): &()) -> u32x8 {
        u32x8::splat(0)
    }

    #[inline(always)]
    fn choose(self, _: Vec3x8, _: f32x8, _: f32x8, _: impl FnOnce() -> u32x8) {}

    #[inline(always)]
    fn point(self, (): &(), u: f32x8, v: f32x8) -> Vec3x8 {
        let [tangent, bitangent] = self.axes;
        let (sin, cos) = sin_cos_turn(v);
        let r = self.radius * u.sqrt();
        tangent.mul_add(r * cos, bitangent.mul_add(r * sin, self.center))
    }

    #[inline(always)]
    fn cosine(self, (): &(), _: Vec3x8, direction: Vec3x8) -> f32x8 {
        -direction.dot(self.normal)
    }

    #[inline(always)]
    fn density(self, (): &()) -> f32x8 {
        self.density
    }

    #[inline(always)]
    fn probability(self, (): &(), _: Vec3x8, _: f32x8) -> f32x8 {
        f32x8::ONE
    }

    #[inline(always)]
    fn profile(self, (): &(), _: f32x8) -> f32x8 {
        f32x8::ONE
    }

    #[inline(always)]
    fn radiance(self, (): &(), channel: usize) -> f32x8 {
        self.radiance[channel]
    }
}
