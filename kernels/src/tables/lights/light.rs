//! What a connection chooses, and how likely it does.

use core::ops::Range;

use super::alias::AliasTable;
use super::{Emitter, Selection, Shape, meshes};

/// What a connection chooses: a disk, a sphere, a group of these, or a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its emitters: a range of [`Lights::emitters`](super::Lights::emitters).
    pub emitters: Range<u32>,
    /// Centre of a ball that holds it `[m]`.
    pub center: [f32; 3],
    /// Radius of that ball `[m]`.
    pub radius: f32,
    /// What its probability is proportional to; the sum over all lights is one. Probabilities are the shares
    /// themselves, or share over distance, normalised, under [`Selection::IntensityDistance`].
    pub share: f32,
    /// What it has of the intensity of all; the sum over all lights is one.
    pub intensity: f32,
    /// The choice among several emitters.
    alias: AliasTable,
}

impl Light {
    /// The light of these emitters, the first of which has the index `first`, and which are chosen in proportion to
    /// `weights`; shares are yet to be found.
    pub(super) fn new(emitters: &[Emitter], first: u32, weights: &[f64]) -> Self {
        let (center, radius) = meshes::bounds(emitters);
        Self {
            emitters: first..first + emitters.len() as u32,
            center: center.as_vec3().to_array(),
            radius: radius as f32,
            share: 0.0,
            intensity: 0.0,
            alias: if emitters.len() > 1 { AliasTable::new(weights) } else { AliasTable::default() },
        }
    }

    /// One of its emitters for a random word.
    #[inline(always)]
    pub fn choose(&self, word: u32) -> u32 {
        if self.emitters.len() < 2 { self.emitters.start } else { self.emitters.start + self.alias.choose(word) }
    }

    fn of<'a>(&self, emitters: &'a [Emitter]) -> &'a [Emitter] {
        &emitters[self.emitters.start as usize..self.emitters.end as usize]
    }

    /// How many lights it stands for: a group of disks and spheres for all of them, a mesh for one.
    fn stands_for(&self, emitters: &[Emitter]) -> f64 {
        let meshes = self.of(emitters).iter().any(|emitter| emitter.shape == Shape::Triangle);
        if meshes { 1.0 } else { self.emitters.len() as f64 }
    }
}

/// What the choice of an emitter among those of its light is proportional to: of a group of disks and spheres under
/// the uniform rule, all alike.
pub(super) fn weight(emitter: &Emitter, selection: Selection) -> f64 {
    match (selection, emitter.shape) {
        (Selection::Uniform, Shape::Disk | Shape::Sphere) => 1.0,
        _ => meshes::weight(emitter),
    }
}

/// Fills the shares of all lights, and gives the rule that is in force: with one light, or none that shines, every rule is
/// the uniform one, and the cheapest.
pub(super) fn share_out(lights: &mut [Light], emitters: &[Emitter], selection: Selection) -> Selection {
    let intensity = |light: &Light| light.of(emitters).iter().map(Emitter::intensity).sum::<f64>();
    let intensities: Vec<f64> = lights.iter().map(intensity).collect();
    let total: f64 = intensities.iter().sum();
    let count: f64 = lights.iter().map(|light| light.stands_for(emitters)).sum();
    let selection = if lights.len() < 2 || total <= 0.0 { Selection::Uniform } else { selection };
    for (light, intensity) in lights.iter_mut().zip(intensities) {
        let uniform = light.stands_for(emitters) / count;
        light.intensity = if total > 0.0 { intensity / total } else { uniform } as f32;
        light.share = if selection == Selection::Uniform { uniform as f32 } else { light.intensity };
    }
    selection
}
