//! A scene as the stages read it.

use fogbow_kernels::PathLengths;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::tables::media::Medium;

/// Everything that the value of a sample depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The camera, its film included.
    pub camera: Camera,
    /// The medium around everything.
    pub medium: Medium,
    /// The lights, and how connections choose among them.
    pub lights: Lights,
    /// The active connection techniques.
    pub techniques: Techniques,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// Seed of all random bits.
    pub seed: u32,
}

impl Frame {
    /// Longest walk, in segments: 1 where light is never scattered.
    pub fn walk_segments(&self) -> u32 {
        if self.medium.never_scatters() { 1 } else { self.lengths.max }
    }

    /// Channels that differ: 1 where lights and medium are grey, 3 otherwise.
    pub fn channels(&self) -> usize {
        let grey = |channels: [f32; 3]| channels == [channels[0]; 3];
        let radiances = self.lights.disks().iter().map(|disk| disk.radiance);
        if grey(self.medium.albedo) && radiances.into_iter().all(grey) { 1 } else { 3 }
    }
}
