//! What a film keeps of its samples: a list of layers, each with a unit and channels of its own.

use super::Unit;
use crate::frame::Frame;

/// One quantity that a film keeps of every pixel; its values are finite and >= 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// What it is called.
    pub name: &'static str,
    /// Number of channels that are kept, at least 1.
    pub channels: usize,
    /// Unit of its sums.
    pub unit: Unit,
    /// Whether squares are summed as well, for standard errors.
    pub squares: bool,
    /// Names of its channels in an EXR file: `R`, `G`, `B`, or `depth.Z`. Where there are more names than channels,
    /// those left over show the last channel. Standard errors have the same names after `SE.`.
    pub planes: &'static [&'static str],
}

/// Index of radiance, the first layer of every film.
pub const RADIANCE: usize = 0;

/// All layers of an image of `frame`.
pub fn layers(frame: &Frame) -> Vec<Layer> {
    vec![Layer {
        name: "radiance", // W/(m^2 sr)
        channels: frame.channels(),
        unit: Unit::for_largest(frame.largest_radiance()),
        squares: true,
        planes: &["R", "G", "B"],
    }]
}
