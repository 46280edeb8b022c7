//! A scene as the stages read it.

use std::sync::Arc;

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::nee::in_place;
use fogbow_kernels::first_flight::Aim;
use fogbow_kernels::media::Medium;
use fogbow_kernels::survival::Survival;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::tables::outlines::Outlines;
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{LONGEST_BRIDGED_PATH, PathLengths, WalkLimits};
use glam::Vec3;

use crate::film::Region;
use crate::film::aov::Aovs;

/// Starts that compete for a connection from which on it pays to ask first whether it can count at all. Measured with
/// bridges: with 16 starts a render takes a tenth to a sixth less time, with 8 a twentieth to a tenth, with 4 up to a tenth
/// more.
const MANY_STARTS: usize = 8;

/// Everything that the value of a sample depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The camera, its film included.
    pub camera: Camera,
    /// What fills space.
    pub medium: Medium,
    /// The lights, and how connections choose among them.
    pub lights: Lights,
    /// What is solid.
    pub surfaces: Arc<Surfaces>,
    /// The active connection techniques.
    pub techniques: Techniques,
    /// How far walks go, and where they connect from.
    pub walk: WalkLimits,
    /// Share of the camera's flights that are drawn towards the lights, [0, 1).
    pub aimed: f32,
    /// Contribution from which on a connection certainly counts [W/(m^2 sr)]; fainter ones play roulette. 0: none plays.
    pub roulette: f32,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// Seed of all random bits.
    pub seed: u32,
    /// Pixels whose lamps are looked at by many rays per sample, if there are any.
    pub outlines: Option<Arc<Outlines>>,
    /// What its film keeps beside radiance.
    pub aovs: Aovs,
}

impl Frame {
    /// The same view, of `size` pixels, as a small image whose longest side has at most `side`, of radiance alone.
    pub fn small(&self, [width, height]: [u32; 2], side: u32) -> (Self, Region) {
        let longest = width.max(height);
        let small = |length: u32| (u64::from(length) * u64::from(side)).div_ceil(u64::from(longest)).min(length.into());
        let size = [small(width) as u32, small(height) as u32];
        let camera = self.camera.at_size([width, height], size);
        let small = Self { camera, outlines: None, aovs: Aovs::default(), ..self.clone() };
        let small = if self.outlines.is_some() { small.with_outlines(size) } else { small };
        (small, Region::whole(size[0], size[1]))
    }

    /// The same, of `size` pixels, with many rays per sample where outlines of lamps are.
    pub fn with_outlines(self, size: [u32; 2]) -> Self {
        let outlines = Outlines::of(&self.camera, size, &self.lights).map(Arc::new);
        Self { outlines, ..self }
    }

    /// Whether extinction differs from place to place, so that flights are tracked and transmittances estimated.
    pub fn varies(&self) -> bool {
        self.medium.field().is_some()
    }

    /// Whether media emit light, which walks alone meet.
    pub fn emits(&self) -> bool {
        self.medium.glow.is_some()
    }

    /// About the largest radiance of a light or a flight [W/(m^2 sr)].
    pub fn largest_radiance(&self) -> f32 {
        self.lights.largest_radiance().max(self.medium.largest_radiance())
    }

    /// Longest walk, in segments: 1 where light is never scattered or reflected.
    pub fn walk_segments(&self) -> u32 {
        if self.stays_straight() { 1 } else { self.walk.segments.min(self.lengths.max) }
    }

    /// Whether anything is solid.
    pub fn is_solid(&self) -> bool {
        !self.surfaces.is_empty()
    }

    /// Whether connections are weighed as soon as they are drawn: see [`in_place`].
    pub fn connects_in_place(&self) -> bool {
        let Self { medium, lights, techniques, walk, lengths, .. } = self;
        in_place::suffices(medium, lights, techniques, walk, *lengths)
    }

    /// Whether connections play roulette by what they weigh at most, before anything is weighed that competes: it spares
    /// most of them that, and pays where much competes. Every start of MVNEE looks at all vertices behind it.
    pub fn plays_before_weights(&self) -> bool {
        let starts = self.techniques.most_edges().min(self.walk.starts as usize);
        self.roulette > 0.0 && (self.techniques.mvnee.is_some() || starts >= MANY_STARTS)
    }

    /// Whether nothing turns light.
    pub fn stays_straight(&self) -> bool {
        self.medium.never_scatters() && self.surfaces.is_empty()
    }

    /// The same frame whose first `starts` vertices connect; `u32::MAX` for all.
    ///
    /// Where a bridge from the first vertex can make every path, walks end with the segment after the last start: it meets
    /// the light that bridges from that vertex hardly find, the one right in front of it. That takes a world without
    /// surfaces, without media that emit, and without lights at infinity, where no bridge goes.
    pub fn with_walk(self, starts: u32, survival: impl Into<Survival>) -> Self {
        let reaches_everything =
            self.techniques.bridge.as_ref().is_some_and(|bridge| bridge.reaches_everything(self.lengths.max));
        let suffices = reaches_everything && self.surfaces.is_empty() && !self.lights.has_distant() && !self.emits();
        let segments = if suffices { starts.saturating_add(1) } else { u32::MAX };
        Self { walk: WalkLimits { segments, starts, survival: survival.into() }, ..self }
    }

    /// Whether paths may be longer than any connection.
    pub fn wanders(&self) -> bool {
        self.lengths.max > LONGEST_BRIDGED_PATH && !self.stays_straight()
    }

    /// Whether first flights are drawn towards the lights.
    pub fn aims(&self) -> bool {
        self.aimed > 0.0 && self.may_aim()
    }

    /// How first flights are drawn towards the lights.
    pub fn aim(&self) -> Aim {
        let Some([lower, upper]) = self.surfaces.geometry().bounds() else { return Aim::in_the_open(self.aimed) };
        let across = Vec3::from(upper).distance(Vec3::from(lower));
        let extinction = self.medium.extinctions().iter().sum::<f32>() / 3.0;
        Aim::across(self.aimed, extinction * across)
    }

    /// Whether first flights may be drawn towards the lights: not where media differ from place to place or emit along
    /// them, nor where no light has a place.
    pub fn may_aim(&self) -> bool {
        !self.medium.never_scatters() && !self.varies() && !self.emits() && !self.lights.lights().is_empty()
    }

    /// Channels that differ: 1 where lights, medium, its emission and surfaces are grey, 3 otherwise.
    pub fn channels(&self) -> usize {
        let grey = |channels: [f32; 3]| channels == [channels[0]; 3];
        let medium = &self.medium;
        let grey_glow = medium.glow.as_ref().is_none_or(|glow| glow.is_grey());
        let grey_medium = medium.all_albedos().iter().copied().all(grey) && !medium.is_coloured() && grey_glow;
        if grey_medium && self.lights.are_grey() && self.surfaces.are_grey() { 1 } else { 3 }
    }
}
