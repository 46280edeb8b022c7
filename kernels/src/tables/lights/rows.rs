//! What kernels ask of emitters, in rows of eight numbers: the rows of eight emitters are loaded whole and transposed,
//! not picked one by one.
//!
//! ```text
//! place:    origin x y z,   radius,       normal x y z,                curvature
//! axes:     tangent x y z,  -,            bitangent x y z,             -
//! choice:   centre of its light x y z,    density, share of its light, -, -, -
//! ```

use wide::f32x8;

use super::{Emitter, Light, Lights};
use crate::lanes::LANES;
use crate::vec3::Vec3x8;

/// The rows of one emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    place: f32x8,
    axes: f32x8,
    choice: f32x8,
}

/// Where emitters are and what they face, as [`Emitter`] has it.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// Centres or first corners `[m]`.
    pub origin: Vec3x8,
    /// Radii `[m]`; 0 of triangles.
    pub radius: f32x8,
    /// Unit normals; zero of spheres.
    pub normal: Vec3x8,
    /// One over the radii of spheres [1/m]; 0 of all else.
    pub curvature: f32x8,
}

/// What emitters are chosen by.
#[derive(Clone, Copy, Debug)]
pub struct Choices {
    /// Centres of their lights `[m]`.
    pub center: Vec3x8,
    /// Densities of their points where their lights were chosen (area measure) [1/m^2].
    pub density: f32x8,
    /// [Shares](Light::share) of their lights.
    pub share: f32x8,
}

impl Row {
    /// Those of an emitter and of the light that it is part of; at infinity it is part of none.
    pub fn new(emitter: &Emitter, light: Option<&Light>) -> Self {
        let Emitter { origin: [x, y, z], normal: [u, v, w], radius, curvature, density, .. } = *emitter;
        let ([a, b, c], [d, e, f]) = (emitter.tangent, emitter.bitangent);
        let ([k, l, m], share) = light.map_or(([0.0; 3], 0.0), |light| (light.center, light.share));
        Self {
            place: f32x8::new([x, y, z, radius, u, v, w, curvature]),
            axes: f32x8::new([a, b, c, 0.0, d, e, f, 0.0]),
            choice: f32x8::new([k, l, m, density, share, 0.0, 0.0, 0.0]),
        }
    }
}

impl Lights {
    /// One row of eight emitters, transposed.
    #[inline(always)]
    fn columns(&self, emitters: &[u32; LANES], row: impl Fn(&Row) -> f32x8) -> [f32x8; LANES] {
        match self.rows.as_slice() {
            [only] => row(only).to_array().map(f32x8::splat),
            all => f32x8::transpose(emitters.map(|emitter| row(&all[emitter as usize]))),
        }
    }

    /// Where emitters are and what they face.
    #[inline(always)]
    pub fn places(&self, emitters: &[u32; LANES]) -> Places {
        let [x, y, z, radius, u, v, w, curvature] = self.columns(emitters, |row| row.place);
        Places { origin: Vec3x8::new(x, y, z), radius, normal: Vec3x8::new(u, v, w), curvature }
    }

    /// First and second axes of emitters.
    #[inline(always)]
    pub fn axes(&self, emitters: &[u32; LANES]) -> [Vec3x8; 2] {
        let [a, b, c, _, d, e, f, _] = self.columns(emitters, |row| row.axes);
        [Vec3x8::new(a, b, c), Vec3x8::new(d, e, f)]
    }

    /// What emitters are chosen by.
    #[inline(always)]
    pub fn choices(&self, emitters: &[u32; LANES]) -> Choices {
        let [x, y, z, density, share, ..] = self.columns(emitters, |row| row.choice);
        Choices { center: Vec3x8::new(x, y, z), density, share }
    }
}
