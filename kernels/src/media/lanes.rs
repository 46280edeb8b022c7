//! What stages ask of a medium, for eight rows.

use wide::{f32x8, u32x8};

use crate::vec3x8::Vec3x8;

/// A medium before it is known which channel counts for each row.
pub trait MediumLanes: Copy {
    /// The medium in one channel per row.
    type Channel: MediumX8;

    /// Whether extinction differs between channels.
    const COLOURED: bool;

    /// The medium in the channel of every row, which is asked for only where that matters.
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> Self::Channel;

    /// Extinction per channel, over that of any one of them: the same everywhere.
    fn hues(&self) -> [f32; 3];
}

/// A medium in one channel per row.
pub trait MediumX8: Copy {
    /// Free flight that a share `rest` of all flights outlasts, in (0, 1] `[m]`; endless in vacuum.
    fn flight(self, rest: f32x8) -> f32x8;

    /// Optical depth of the straight segment from `from` to `to`, of this `length` `[m]`.
    fn optical_depth(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8;

    /// Optical depth of a way through vertices of a path, of which the length is `arc` `[m]`.
    fn optical_depth_along(self, arc: f32x8) -> f32x8;

    /// Extinction at a point [1/m].
    fn extinction(self, at: Vec3x8) -> f32x8;

    /// `(tau / L)^N / M` [1/m] of a way of N `edges`, of length L = `arc` `[m]` and optical depth tau = `depth`, with M
    /// the product of the extinctions at its N - 1 inner vertices: in a homogeneous medium the extinction itself.
    fn crowding(self, edges: usize, arc: f32x8, depth: f32x8) -> f32x8;
}
