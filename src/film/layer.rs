//! What a film keeps of its samples: a list of layers, each with a unit and channels of its own.

use serde::{Deserialize, Serialize};

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

/// The layers that there are, with channels and units that depend on the scene.
fn known() -> [Layer; 1] {
    [Layer {
        name: "radiance", // W/(m^2 sr)
        channels: 3,
        unit: Unit::for_exponent(0),
        squares: true,
        planes: &["R", "G", "B"],
    }]
}

/// All layers of an image of `frame`.
pub fn layers(frame: &Frame) -> Vec<Layer> {
    let [radiance] = known();
    vec![Layer { channels: frame.channels(), unit: Unit::for_largest(frame.largest_radiance()), ..radiance }]
}

/// What a file says of a layer, so that its sums can be read again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerForm {
    name: String,
    channels: usize,
    exponent: i32,
    squares: bool,
}

impl LayerForm {
    /// That of `layer`.
    pub fn of(layer: &Layer) -> Self {
        let Layer { name, channels, unit, squares, .. } = layer;
        Self { name: (*name).into(), channels: *channels, exponent: unit.exponent(), squares: *squares }
    }

    /// The layer, if there is such a one.
    pub fn layer(&self) -> Option<Layer> {
        let layer = known().into_iter().find(|layer| layer.name == self.name)?;
        let fits = (1..=layer.channels).contains(&self.channels) && layer.squares == self.squares;
        // Those of f32.
        let fits = fits && (-126..=129).contains(&self.exponent);
        fits.then(|| Layer { channels: self.channels, unit: Unit::for_exponent(self.exponent), ..layer })
    }
}
