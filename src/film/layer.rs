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

    /// The layers of `forms`, if these are those of a film: radiance and what follows it.
    pub fn layers(forms: &[Self]) -> Option<Vec<Layer>> {
        let layers: Option<Vec<_>> = forms.iter().map(Self::layer).collect();
        let places = forms.iter().map(|form| known().iter().position(|layer| layer.name == form.name));
        let is_film = places.clone().next() == Some(Some(RADIANCE)) && places.is_sorted_by(|a, b| a < b);
        layers.filter(|_| is_film)
    }

    /// The layer, if there is such a one.
    fn layer(&self) -> Option<Layer> {
        let layer = known().into_iter().find(|layer| layer.name == self.name)?;
        let fits = (1..=layer.channels).contains(&self.channels) && layer.squares == self.squares;
        // Those of f32.
        let fits = fits && (-126..=129).contains(&self.exponent);
        fits.then(|| Layer { channels: self.channels, unit: Unit::for_exponent(self.exponent), ..layer })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_read_as_they_were_written_and_others_are_refused() {
        let [radiance] = known();
        let grey = Layer { channels: 1, unit: Unit::for_largest(300.0), ..radiance };
        for layer in [radiance, grey] {
            assert_eq!(LayerForm::layers(&[LayerForm::of(&layer)]), Some(vec![layer]));
        }
        let form = LayerForm::of(&radiance);
        for wrong in [
            vec![],
            vec![form.clone(), form.clone()],
            vec![LayerForm { channels: 0, ..form.clone() }],
            vec![LayerForm { channels: 4, ..form.clone() }],
            vec![LayerForm { squares: false, ..form.clone() }],
            vec![LayerForm { exponent: i32::MAX, ..form.clone() }],
            vec![LayerForm { name: "depth".into(), ..form }],
        ] {
            assert_eq!(LayerForm::layers(&wrong), None, "{wrong:?}");
        }
    }
}
