//! What media emit by themselves: flames, hot gas.
//!
//! ```text
//! e(x) = emission of whatever medium x is in, times the density of that volume's emission grid at x, if it has one
//! ```
//!
//! Emission is a radiance per metre [W/(m^3 sr)]. It needs no extinction.

use glam::DVec3;
use wide::{f32x8, u32x8};

use super::field::reference::part_in_box;
use super::field::{Field, Map, Voxels, within};
use super::spectral::CHANNELS;
use crate::lanes;
use crate::vec3::Vec3x8;

/// Edges of voxels of an emission grid between two points at which it is asked, about.
const VOXELS_APART: f64 = 2.0;

/// Emission of all media of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Glow {
    /// That of what is around all volumes, or everywhere [W/(m^3 sr)].
    around: [f32; CHANNELS],
    /// That of the volumes of a field, in their order.
    volumes: Vec<Placed>,
    /// Points at which flights ask for it within the volumes [1/m].
    rate: f32,
    /// Corners of the box around all that emits `[m]`, unless what is around the volumes does.
    bounds: Option<[[f32; 3]; 2]>,
}

/// Emission of a volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Where the density is 1, per channel [W/(m^3 sr)], each finite and >= 0.
    pub emission: [f32; CHANNELS],
    /// Densities; 1 everywhere without.
    pub voxels: Option<Voxels>,
}

impl Source {
    /// No emission.
    pub const NONE: Self = Self { emission: [0.0; CHANNELS], voxels: None };

    /// The same emission everywhere in the volume.
    pub const fn constant(emission: [f32; CHANNELS]) -> Self {
        Self { emission, voxels: None }
    }

    /// Largest emission of a channel anywhere [W/(m^3 sr)].
    fn largest(&self) -> f32 {
        let [low, high] = self.voxels.as_ref().map_or([DVec3::ZERO; 2], Voxels::bounds);
        let densest = self.voxels.as_ref().map_or(1.0, |voxels| voxels.extent(low, high).most);
        densest * largest(self.emission)
    }
}

/// A source, and where its voxels are in the world.
#[derive(Clone, Debug, PartialEq)]
struct Placed {
    source: Source,
    to_voxels: Option<Map>,
}

impl Glow {
    /// The same `emission` everywhere [W/(m^3 sr)], per channel.
    pub const fn everywhere(emission: [f32; CHANNELS]) -> Self {
        Self { around: emission, volumes: Vec::new(), rate: 0.0, bounds: None }
    }

    /// The emission of the volumes of `field`, in their order, and of what is `around` them.
    pub fn of_field(field: &Field, around: [f32; CHANNELS], sources: Vec<Source>) -> Self {
        let edges =
            sources.iter().filter_map(|source| source.voxels.as_ref()).map(|voxels| VOXELS_APART * voxels.edge());
        let apart = edges.fold(field.cell_edge(), f64::min);
        let glowing = field.volume_bounds().zip(&sources).filter(|(_, source)| largest(source.emission) > 0.0);
        let boxes = glowing.map(|([low, high], source)| match source.voxels.as_ref().map(Voxels::bounds) {
            Some([first, last]) => [low.max(first), high.min(last)],
            None => [low, high],
        });
        let hull = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or([DVec3::ZERO; 2]);
        let bounds = (largest(around) == 0.0).then(|| hull.map(|corner| corner.as_vec3().to_array()));
        let place = |source: Source| {
            let to_voxels = source.voxels.as_ref().map(|voxels| Map::new(&voxels.to_own()));
            Placed { source, to_voxels }
        };
        Self { around, volumes: sources.into_iter().map(place).collect(), rate: (1.0 / apart) as f32, bounds }
    }

    /// The part of rays of unit `direction` up to `length` within the volumes of `field` and, if nothing around them
    /// emits, the box around those that do `[m]`; empty where the second is not larger.
    #[inline(always)]
    pub fn part(&self, field: &Field, origin: Vec3x8, direction: Vec3x8, length: f32x8) -> [f32x8; 2] {
        let [enter, exit] = field.part(origin, direction, length);
        let Some([low, high]) = self.bounds else { return [enter, exit] };
        let [first, last] = within(origin, direction, low, high, length);
        [enter.fast_max(first), exit.fast_min(last)]
    }

    /// The same of one ray, for twins; none if it is empty.
    pub fn part_of_ray(&self, field: &Field, origin: DVec3, direction: DVec3, length: f64) -> Option<(f64, f64)> {
        let cells = field.part_within(field.cells_of(origin), field.cells_along(direction), [0.0; 2], length)?;
        let Some(bounds) = self.bounds else { return Some(cells) };
        let corners = bounds.map(|corner| DVec3::from(corner.map(f64::from)));
        let own = part_in_box(corners, origin, direction, length)?;
        let (enter, exit) = (cells.0.max(own.0), cells.1.min(own.1));
        (enter < exit).then_some((enter, exit))
    }

    /// Emission of what is around all volumes [W/(m^3 sr)].
    #[inline(always)]
    pub fn around(&self) -> [f32; CHANNELS] {
        self.around
    }

    /// Points at which flights ask for it within the volumes [1/m].
    #[inline(always)]
    pub fn rate(&self) -> f32 {
        self.rate
    }

    /// The voxels of all emission grids.
    pub fn voxels(&self) -> impl Iterator<Item = &Voxels> {
        self.volumes.iter().filter_map(|volume| volume.source.voxels.as_ref())
    }

    /// Whether all of it is grey.
    pub fn is_grey(&self) -> bool {
        let grey = |[r, g, b]: [f32; CHANNELS]| r == g && g == b;
        grey(self.around) && self.volumes.iter().all(|volume| grey(volume.source.emission))
    }

    /// About the largest radiance that a flight can meet, where one without volumes goes as far as `mean_free_path` `[m]`
    /// and volumes have this `extent` `[m]` [W/(m^2 sr)].
    pub fn largest_radiance(&self, mean_free_path: f32, extent: f32) -> f32 {
        let around = largest(self.around);
        let brightest = self.volumes.iter().map(|volume| volume.source.largest()).fold(0.0, f32::max);
        brightest * extent + if around > 0.0 { around * mean_free_path } else { 0.0 }
    }

    /// Emission per channel at points of the world, where what is there has the numbers `who`: 0 for what is around, or
    /// that of the volume, from 1 on [W/(m^3 sr)].
    #[inline(always)]
    pub fn at(&self, who: u32x8, at: Vec3x8) -> [f32x8; CHANNELS] {
        let mut emission = self.around.map(f32x8::splat);
        for (number, Placed { source, to_voxels }) in (1..).zip(&self.volumes) {
            let here = lanes::as_mask(who.simd_eq(u32x8::splat(number)));
            if !here.any() {
                continue;
            }
            let density = match (&source.voxels, to_voxels) {
                (Some(voxels), Some(map)) => voxels.density(map.points(at)),
                _ => f32x8::ONE,
            };
            for (emission, source) in emission.iter_mut().zip(source.emission) {
                *emission = here.select(density * f32x8::splat(source), *emission);
            }
        }
        emission
    }

    /// The same at one point, for twins.
    pub fn at_point(&self, who: u32, at: DVec3) -> [f64; CHANNELS] {
        let Some(Placed { source, to_voxels }) = who.checked_sub(1).map(|index| &self.volumes[index as usize]) else {
            return self.around.map(f64::from);
        };
        let density = match (&source.voxels, to_voxels) {
            (Some(voxels), Some(map)) => voxels.density_at(map.point(at)),
            _ => 1.0,
        };
        source.emission.map(|emission| f64::from(emission) * density)
    }

    /// Hands everything that emission depends on to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        let mut numbers = |numbers: &[f32]| numbers.iter().for_each(|x| digest(&x.to_le_bytes()));
        numbers(&self.around);
        self.volumes.iter().for_each(|volume| numbers(&volume.source.emission));
        for voxels in self.volumes.iter().map(|volume| &volume.source.voxels) {
            digest(&[u8::from(voxels.is_some())]);
            if let Some(voxels) = voxels {
                voxels.digest(digest);
            }
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.volumes.iter().filter_map(|volume| volume.source.voxels.as_ref()).map(Voxels::bytes).sum()
    }
}

fn largest(channels: [f32; CHANNELS]) -> f32 {
    channels.into_iter().fold(0.0, f32::max)
}
