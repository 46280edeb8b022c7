//! Media: what fills space, of a kind that is asked and not known.
//!
//! Stages match on the kind once, outside their loops, with [`with_medium!`](crate::with_medium), and run a kernel that
//! is generic over [`MediumX8`]: how far flights go, how thick a segment is, how dense a point. A new kind is its
//! folder, a row of [`Kind`] and one of [`with_medium!`](crate::with_medium).
//!
//! Extinction may differ between channels. A path's flights are drawn for one of them, its *hero*, and weights count
//! all of them: see [`spectral`].

pub mod closed_mesh;
pub mod field;
pub mod glow;
pub mod homogeneous;
mod lanes;
pub mod phases;
pub mod reference;
pub mod spectral;

use std::sync::Arc;

use glam::DVec3;
use wide::f32x8;

use self::field::reference::FieldTwin;
use crate::phase::PhaseFunction;
use crate::phase::reference::Phase;
use crate::vec3::Vec3x8;
pub use field::Field;
pub use glow::Glow;
pub use homogeneous::Homogeneous;
pub use lanes::{AxisX8, Crowding, Even, LEAST_EVENT, MediumLanes, MediumX8, log_event};
pub use phases::{Phases, PhasesX8};

/// What fills space.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// How dense it is, and where.
    pub kind: Kind,
    /// Single-scattering albedo mu_s / mu_t per channel, in [0, 1]: 0 in vacuum. Where volumes differ, that of most of
    /// what scatters, which only choices go by that change no mean.
    pub albedo: [f32; 3],
    /// Albedos per channel of what is around all volumes and of the volumes of a field, if they differ.
    pub albedos: Option<Arc<[[f32; 3]]>>,
    /// What it emits by itself, if anything.
    pub glow: Option<Arc<Glow>>,
    /// Where a scattering event sends light; where phase functions differ, what stands for all of them in connections and
    /// weights.
    pub phase: PhaseFunction,
    /// Phase functions of what is around all volumes and of the volumes of a field, if they differ.
    pub phases: Option<Arc<Phases>>,
}

/// How a medium's extinction is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// The same everywhere.
    Homogeneous(Homogeneous),
    /// Other ones in other places.
    Field(Arc<Field>),
}

impl Medium {
    /// A homogeneous medium of grey `extinction` [1/m], >= 0.
    pub const fn homogeneous(extinction: f32, albedo: [f32; 3], phase: PhaseFunction) -> Self {
        Self {
            kind: Kind::Homogeneous(Homogeneous::grey(extinction)),
            albedo,
            albedos: None,
            glow: None,
            phase,
            phases: None,
        }
    }

    /// A homogeneous medium of this `extinction` per channel [1/m], each >= 0.
    pub fn coloured(extinction: [f32; 3], albedo: [f32; 3], phase: PhaseFunction) -> Self {
        Self {
            kind: Kind::Homogeneous(Homogeneous::coloured(extinction)),
            albedo,
            albedos: None,
            glow: None,
            phase,
            phases: None,
        }
    }

    /// A medium of the extinction of `field` and one albedo.
    pub fn of_field(field: Field, albedo: [f32; 3], phase: PhaseFunction) -> Self {
        Self { kind: Kind::Field(Arc::new(field)), albedo, albedos: None, glow: None, phase, phases: None }
    }

    /// The same with these albedos around all volumes and in the volumes, if they differ.
    pub fn with_albedos(self, albedos: &[[f32; 3]]) -> Self {
        let differ = albedos.iter().any(|albedo| *albedo != self.albedo);
        Self { albedos: differ.then(|| albedos.into()), ..self }
    }

    /// The same with these phase functions around all volumes and in the volumes, if they differ.
    pub fn with_phases(self, all: &[PhaseFunction]) -> Self {
        let phases = Phases::new(all);
        match phases.distinct() {
            [] => self,
            [phase] => Self { phase: phase.clone(), phases: None, ..self },
            _ => Self { phase: phases.stand_in(), phases: Some(Arc::new(phases)), ..self },
        }
    }

    /// The same that emits light by itself.
    pub fn with_glow(self, glow: Glow) -> Self {
        Self { glow: Some(Arc::new(glow)), ..self }
    }

    /// Nothing.
    pub const fn vacuum() -> Self {
        Self::homogeneous(0.0, [0.0; 3], PhaseFunction::isotropic())
    }

    /// As the twins ask it, in one channel.
    pub fn twin(&self, channel: usize) -> reference::Twin<'_> {
        let phase = self.phase.twin();
        match &self.kind {
            Kind::Homogeneous(_) => reference::Twin::Homogeneous(self.homogeneous_twin(channel)),
            Kind::Field(field) => {
                let (field, hue) = field.channel(channel);
                reference::Twin::Field(FieldTwin { field, hue: f64::from(hue), phase })
            }
        }
    }

    /// As the twins of connections ask it that are made for a hero: in its channel or, where channels are
    /// [apart](field::Apart), as their mean.
    pub fn twin_of_connections(&self, hero: usize) -> reference::Twin<'_> {
        let apart = self.field().is_some_and(|field| field.apart().is_some());
        if apart { self.own_twin() } else { self.twin(hero) }
    }

    /// As twins ask it in a channel of which the others are multiples or, where channels are apart, as their mean.
    pub fn own_twin(&self) -> reference::Twin<'_> {
        match &self.kind {
            Kind::Homogeneous(_) => self.twin(0),
            Kind::Field(field) => reference::Twin::Field(FieldTwin { field, hue: 1.0, phase: self.phase.twin() }),
        }
    }

    /// As twins ask it that add up one of the running sums of paths.
    pub fn twin_of_sum(&self, sum: usize) -> reference::Twin<'_> {
        match &self.kind {
            Kind::Homogeneous(_) => self.own_twin(),
            Kind::Field(field) => {
                reference::Twin::Field(FieldTwin { field: field.of_sum(sum), hue: 1.0, phase: self.phase.twin() })
            }
        }
    }

    /// As the twins of stages ask it that only homogeneous media have, in one channel.
    ///
    /// # Panics
    /// If it is not homogeneous.
    pub fn homogeneous_twin(&self, channel: usize) -> reference::Homogeneous<'_> {
        match &self.kind {
            Kind::Homogeneous(medium) => {
                reference::Homogeneous { extinction: f64::from(medium.extinction[channel]), phase: self.phase.twin() }
            }
            Kind::Field(_) => unreachable!("a field is not homogeneous"),
        }
    }

    /// Its field, if it has one: flights are tracked there, and transmittances estimated.
    pub fn field(&self) -> Option<&Field> {
        match &self.kind {
            Kind::Homogeneous(_) => None,
            Kind::Field(field) => Some(field),
        }
    }

    /// Bytes that its volumes take, their densities and emission; what several share is counted once.
    pub fn bytes(&self) -> usize {
        let Some(field) = self.field() else { return 0 };
        let glowing = self.glow.iter().flat_map(|glow| glow.voxels());
        field::bytes_of(field.voxels().chain(glowing)) + field.bytes_besides_voxels()
    }

    /// What is left of light after `events` scattering events, per channel, where all have the same albedo.
    pub fn albedos(&self, events: usize) -> [f32; 3] {
        self.albedo.map(|albedo| albedo.powi(events as i32))
    }

    /// All albedos that there are, per channel.
    pub fn all_albedos(&self) -> &[[f32; 3]] {
        self.albedos.as_deref().unwrap_or(core::slice::from_ref(&self.albedo))
    }

    /// Where albedos are asked for place by place.
    pub fn albedos_by_place(&self) -> Option<AlbedosX8<'_>> {
        Some(AlbedosX8 { field: self.field()?, albedos: self.albedos.as_deref()? })
    }

    /// Where phase functions are asked for place by place.
    pub fn phases_by_place(&self) -> Option<PhasesX8<'_>> {
        Some(PhasesX8 { field: self.field()?, phases: self.phases.as_deref()? })
    }

    /// Phase function at a point, for twins.
    pub fn phase_at(&self, at: DVec3) -> &dyn Phase {
        let by_place = self.field().zip(self.phases.as_deref());
        by_place.map_or(&self.phase, |(field, phases)| phases.at(field, at)).twin()
    }

    /// Phase function of what is around all volumes, or of all there is.
    pub fn phase_around(&self) -> &PhaseFunction {
        self.phases.as_deref().map_or(&self.phase, Phases::around)
    }

    /// All phase functions that there are.
    pub fn all_phases(&self) -> &[PhaseFunction] {
        self.phases.as_deref().map_or(core::slice::from_ref(&self.phase), Phases::distinct)
    }

    /// Albedo at a point, per channel, for twins.
    pub fn albedo_at(&self, at: DVec3) -> [f64; 3] {
        let albedo = match (self.field(), &self.albedos) {
            (Some(field), Some(albedos)) => albedos[field.here(field.cells_of(at)).0 as usize],
            _ => self.albedo,
        };
        albedo.map(f64::from)
    }

    /// Largest extinction anywhere, per channel [1/m].
    pub fn extinctions(&self) -> [f32; 3] {
        match &self.kind {
            Kind::Homogeneous(medium) => medium.extinction,
            Kind::Field(field) => field.largest(),
        }
    }

    /// Largest extinction anywhere, in any channel [1/m].
    pub fn largest_extinction(&self) -> f32 {
        self.extinctions().into_iter().fold(0.0, f32::max)
    }

    /// Longest mean free path of a channel `[m]`, in which limits on distances count: what they leave out would be
    /// missed most where light goes far. Infinite in a field, where limits are on optical depths.
    pub fn mean_free_path(&self) -> f64 {
        match &self.kind {
            Kind::Homogeneous(medium) => 1.0 / f64::from(medium.extinction.into_iter().fold(f32::INFINITY, f32::min)),
            Kind::Field(_) => f64::INFINITY,
        }
    }

    /// A limit on expected segments as one on optical depths: infinite where it is one on distances.
    pub fn longest_depth(&self, expected_segments: f64) -> f32 {
        if self.field().is_some() { expected_segments as f32 } else { f32::INFINITY }
    }

    /// About the largest radiance that a flight meets of what it emits [W/(m^2 sr)].
    pub fn largest_radiance(&self) -> f32 {
        let Some(glow) = &self.glow else { return 0.0 };
        let longest = match &self.kind {
            Kind::Homogeneous(_) => self.mean_free_path() as f32,
            Kind::Field(field) => 1.0 / (field.around() * field.clearest()),
        };
        glow.largest_radiance(longest, self.field().map_or(0.0, Field::extent) as f32)
    }

    /// Whether extinction differs between channels.
    pub fn is_coloured(&self) -> bool {
        match &self.kind {
            Kind::Homogeneous(medium) => !medium.is_grey(),
            Kind::Field(field) => !field.is_grey(),
        }
    }

    /// Whether no path has more than its camera segment: light is never scattered.
    pub fn never_scatters(&self) -> bool {
        self.largest_extinction() == 0.0 || self.all_albedos().iter().all(|albedo| *albedo == [0.0; 3])
    }
}

/// Albedos that differ between the volumes of a field.
#[derive(Clone, Copy)]
pub struct AlbedosX8<'a> {
    field: &'a Field,
    /// Of what is around, and of the volumes.
    albedos: &'a [[f32; 3]],
}

impl AlbedosX8<'_> {
    /// Those at eight points, per channel.
    #[inline(never)]
    pub fn at(self, at: Vec3x8) -> [f32x8; 3] {
        let who = self.field.who(at).to_array();
        [0, 1, 2].map(|c| f32x8::new(who.map(|who| self.albedos[who as usize][c])))
    }
}

/// Runs `$body` with `$lanes` as the [`MediumLanes`] of a [`Medium`]: twice per kind in the program, for grey and for
/// coloured extinction; one of them at a time. A large kernel should be `inline(never)`: all of its kinds in one function
/// take compilers minutes, and are no faster.
#[macro_export]
macro_rules! with_medium {
    ($medium:expr, |$lanes:ident| $body:expr) => {
        match &$medium.kind {
            $crate::media::Kind::Field(field) if field.is_grey() => {
                let $lanes = $crate::media::field::FieldLanes::new(field);
                $body
            }
            $crate::media::Kind::Field(field) => {
                let $lanes = $crate::media::field::ColouredFieldLanes::new(field);
                $body
            }
            $crate::media::Kind::Homogeneous(_) => $crate::with_homogeneous!($medium, |$lanes| $body),
        }
    };
}

/// The same for stages that only homogeneous media have.
#[macro_export]
macro_rules! with_homogeneous {
    ($medium:expr, |$lanes:ident| $body:expr) => {
        match &$medium.kind {
            $crate::media::Kind::Homogeneous(medium) if medium.is_grey() => {
                let $lanes = $crate::media::homogeneous::GreyLanes::new(medium);
                $body
            }
            $crate::media::Kind::Homogeneous(medium) => {
                let $lanes = $crate::media::homogeneous::ColouredLanes::new(medium);
                $body
            }
            $crate::media::Kind::Field(_) => unreachable!("a field is not homogeneous"),
        }
    };
}
