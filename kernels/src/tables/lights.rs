//! Lights: one-sided disks, alike in all directions or focused, and the rule by which a connection picks one.

use core::f64::consts::PI;

use wide::f32x8;

use crate::columns::LANES;
use crate::transcendental::{exp, neg_ln};
use crate::vec3x8::Vec3x8;

/// A one-sided disk that emits from its front; its back is black and opaque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Centre `[m]`.
    pub center: [f32; 3],
    /// Unit normal of the front.
    pub normal: [f32; 3],
    /// Unit vector in the disk's plane.
    pub tangent: [f32; 3],
    /// Unit vector in the disk's plane, perpendicular to the tangent.
    pub bitangent: [f32; 3],
    /// Radius `[m]`, > 0.
    pub radius: f32,
    /// Emitted radiance per channel [W/(m^2 sr)], >= 0; the same over the area, and over all angles where there is no
    /// exponent.
    pub radiance: [f32; 3],
    /// n of a spotlight, whose radiance at the angle theta to the normal is `scale cos^n theta` times `radiance`; 0 if it is
    /// the same in all directions.
    pub exponent: f32,
    /// `(n + 1) / (2 pi)` of a spotlight, otherwise 1.
    pub scale: f32,
}

impl Disk {
    /// A disk around `center` that faces `normal`, a vector of any length but zero.
    pub fn new(center: glam::DVec3, normal: glam::DVec3, radius: f64, radiance: [f64; 3]) -> Self {
        let normal = normal.normalize();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let f32s = |v: glam::DVec3| v.as_vec3().to_array();
        Self {
            center: f32s(center),
            normal: f32s(normal),
            tangent: f32s(tangent),
            bitangent: f32s(bitangent),
            radius: radius as f32,
            radiance: radiance.map(|channel| channel as f32),
            exponent: 0.0,
            scale: 1.0,
        }
    }

    /// The same disk as a spotlight of `exponent` >= 0.
    pub fn focused(self, exponent: f64) -> Self {
        Self { exponent: exponent as f32, scale: ((exponent + 1.0) / (2.0 * PI)) as f32, ..self }
    }

    /// Intensity along the normal, mean over the channels [W/sr].
    pub fn intensity(&self) -> f64 {
        let mean = self.radiance.iter().map(|channel| f64::from(*channel)).sum::<f64>() / 3.0;
        PI * f64::from(self.radius).powi(2) * mean * f64::from(self.scale)
    }
}

/// How a connection picks its light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// All lights alike.
    Uniform,
    /// In proportion to intensity.
    Intensity,
    /// In proportion to intensity over the distance from the start to the light's centre (Weber et al. 2017, Eq. 8).
    IntensityDistance,
}

/// Distances to a light's centre are not taken below this `[m]`, so that a start at the very centre has a finite share.
pub const LEAST_SELECTION_DISTANCE: f32 = 1e-9;

/// All lights of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Lights {
    disks: Vec<Disk>,
    shares: Vec<f32>,
    intensities: Vec<f32>,
    selection: Selection,
    focused: bool,
}

impl Lights {
    /// A table of `disks` among which connections choose by `selection`.
    pub fn new(disks: Vec<Disk>, selection: Selection) -> Self {
        // With one light, or none that shines, every rule is the uniform one, and the cheapest.
        let total: f64 = disks.iter().map(Disk::intensity).sum();
        let selection = if disks.len() < 2 || total <= 0.0 { Selection::Uniform } else { selection };
        let shares = match selection {
            Selection::Uniform => vec![1.0 / disks.len() as f32; disks.len()],
            _ => disks.iter().map(|disk| (disk.intensity() / total) as f32).collect(),
        };
        let share = |disk: &Disk| if total > 0.0 { disk.intensity() / total } else { 1.0 / disks.len() as f64 };
        let intensities = disks.iter().map(|disk| share(disk) as f32).collect();
        let focused = disks.iter().any(|disk| (disk.exponent, disk.scale) != (0.0, 1.0));
        Self { disks, shares, intensities, selection, focused }
    }

    /// The disks; a light's index is its place here.
    pub fn disks(&self) -> &[Disk] {
        &self.disks
    }

    /// What each light's probability is proportional to; sums to one. Probabilities are the shares themselves, or
    /// share over distance, normalised, under [`Selection::IntensityDistance`].
    pub fn shares(&self) -> &[f32] {
        &self.shares
    }

    /// What each light has of the intensity of all; sums to one.
    pub fn intensities(&self) -> &[f32] {
        &self.intensities
    }

    /// The rule in force: uniform where the others come to the same.
    pub fn selection(&self) -> Selection {
        self.selection
    }

    /// Whether probabilities depend on the start, so that a vertex's `light_sum` is defined.
    pub fn selection_depends_on_start(&self) -> bool {
        self.selection == Selection::IntensityDistance
    }

    /// Radiance of the lights that `lights` names at the angles of these cosines, over their `radiance`.
    #[inline(always)]
    pub fn profile(&self, lights: &[u32; LANES], cosine: f32x8) -> f32x8 {
        if !self.focused {
            return f32x8::ONE;
        }
        let exponent = self.gather(lights, |disk| disk.exponent);
        let scale = self.gather(lights, |disk| disk.scale);
        scale * exp(-exponent * neg_ln(cosine.fast_max(f32x8::splat(f32::MIN_POSITIVE))))
    }

    /// One value of the disks that `lights` names, for eight rows.
    #[inline(always)]
    pub fn gather(&self, lights: &[u32; LANES], value: impl Fn(&Disk) -> f32) -> f32x8 {
        match self.disks.as_slice() {
            [only] => f32x8::splat(value(only)),
            disks => f32x8::new(lights.map(|light| value(&disks[light as usize]))),
        }
    }

    /// One vector of the disks that `lights` names, for eight rows.
    #[inline(always)]
    pub fn gather3(&self, lights: &[u32; LANES], value: impl Fn(&Disk) -> [f32; 3]) -> Vec3x8 {
        let component = |axis: usize| self.gather(lights, |disk| value(disk)[axis]);
        Vec3x8::new(component(0), component(1), component(2))
    }

    /// The selection shares of the lights that `lights` names, for eight rows.
    #[inline(always)]
    pub fn gather_shares(&self, lights: &[u32; LANES]) -> f32x8 {
        match self.shares.as_slice() {
            [only] => f32x8::splat(*only),
            shares => f32x8::new(lights.map(|light| shares[light as usize])),
        }
    }
}
