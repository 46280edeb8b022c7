//! A scene as the stages read it.

use std::sync::Arc;

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::media::{Media, Medium};
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{PathLengths, WalkLimits};

use crate::film::Region;

/// Everything that the value of a sample depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The camera, its film included.
    pub camera: Camera,
    /// What fills space.
    pub media: Media,
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
    /// Contribution from which on a connection is certainly traced [W/(m^2 sr)]; fainter ones play roulette. 0: all
    /// are.
    pub roulette: f32,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// Seed of all random bits.
    pub seed: u32,
}

impl Frame {
    /// The same view, of `size` pixels, as a small image whose longest side has at most `side`.
    pub fn small(&self, [width, height]: [u32; 2], side: u32) -> (Self, Region) {
        let longest = width.max(height);
        let small = |length: u32| (u64::from(length) * u64::from(side)).div_ceil(u64::from(longest)).min(length.into());
        let size = [small(width) as u32, small(height) as u32];
        let camera = self.camera.at_size([width, height], size);
        (Self { camera, ..self.clone() }, Region::whole(size[0], size[1]))
    }

    /// The medium around everything.
    pub fn medium(&self) -> &Medium {
        &self.media[Media::AROUND]
    }

    /// Whether extinction differs from place to place, so that flights are tracked and transmittances estimated.
    pub fn varies(&self) -> bool {
        self.medium().grid().is_some()
    }

    /// Longest walk, in segments: 1 where light is never scattered or reflected.
    pub fn walk_segments(&self) -> u32 {
        if self.stays_straight() { 1 } else { self.walk.segments.min(self.lengths.max) }
    }

    /// Whether anything is solid.
    pub fn is_solid(&self) -> bool {
        !self.surfaces.is_empty()
    }

    /// Whether nothing turns light.
    pub fn stays_straight(&self) -> bool {
        self.medium().never_scatters() && self.surfaces.is_empty()
    }

    /// The same frame whose first `starts` vertices connect; `u32::MAX` for all.
    ///
    /// Where a bridge from the first vertex can make every path, and that takes a world without surfaces, walks end
    /// with the segment after the last start: it meets the light that bridges from that vertex hardly find, the one
    /// right in front of it.
    pub fn with_walk(self, starts: u32, survival: f32) -> Self {
        let reaches_everything =
            self.techniques.bridge.as_ref().is_some_and(|bridge| bridge.reaches_everything(self.lengths.max));
        let suffices = reaches_everything && self.surfaces.is_empty();
        let segments = if suffices { starts.saturating_add(1) } else { u32::MAX };
        Self { walk: WalkLimits { segments, starts, survival }, ..self }
    }

    /// Whether first flights are drawn towards the lights.
    pub fn aims(&self) -> bool {
        self.aimed > 0.0 && !self.medium().never_scatters() && !self.varies()
    }

    /// Channels that differ: 1 where lights, medium and surfaces are grey, 3 otherwise.
    pub fn channels(&self) -> usize {
        let grey = |channels: [f32; 3]| channels == [channels[0]; 3];
        let radiances = self.lights.emitters().iter().map(|emitter| emitter.radiance);
        let medium = self.medium();
        let grey_medium = grey(medium.albedo) && !medium.is_coloured();
        if grey_medium && radiances.into_iter().all(grey) && self.surfaces.are_grey() { 1 } else { 3 }
    }
}
