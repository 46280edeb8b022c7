//! What a film keeps of its samples: a list of layers, each with a unit and channels of its own.

use serde::{Deserialize, Serialize};

use super::Unit;
use super::aov::{Aov, LENGTHS, Origin, Split};
use crate::frame::Frame;

/// One quantity that a film keeps of every pixel; its values are finite, and >= 0 unless it is [`Kind::Signed`].
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
    /// What its sums say of a pixel.
    pub kind: Kind,
    /// Names of its channels in an EXR file: `R`, `G`, `B`, or `depth.Z`. Where there are more names than channels,
    /// those left over show the last channel. Standard errors have the same names after `SE.`.
    pub planes: &'static [&'static str],
}

/// What the sums of a layer say of a pixel.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    /// Means over all samples.
    Mean,
    /// The same of values in [-1, 1]: sums are of the values plus 1.
    Signed,
    /// The last channel is the share of samples that have values, the others are means over those; 0 if there are none.
    OfSome,
    /// Means of a part of the radiance: in every sample, those of a split add up to the radiance exactly.
    Part(Split),
}

impl Kind {
    /// What is added to values before they are summed.
    pub fn offset(self) -> f32 {
        if self == Self::Signed { 1.0 } else { 0.0 }
    }
}

/// Index of radiance, the first layer of every film.
pub const RADIANCE: usize = 0;

/// Two to the power of this is above the depths `[m]` of which sums are exact to 10^-12 m; larger ones are, too, to
/// 2^-40 m, until the sum of a pixel is above 10^16 m.
const DEPTH_EXPONENT: i32 = 8;

/// Names of red, green and blue of a layer.
macro_rules! rgb {
    ($name:literal) => {
        &[concat!($name, ".R"), concat!($name, ".G"), concat!($name, ".B")]
    };
}

/// A layer of the radiance by technique or by length.
macro_rules! part {
    ($split:ident, $name:literal) => {
        Layer { name: $name, kind: Kind::Part(Split::$split), planes: rgb!($name), ..COLOUR }
    };
}

/// Three channels, means of numbers up to 1.
const COLOUR: Layer =
    Layer { name: "", channels: 3, unit: Unit::for_exponent(0), squares: false, kind: Kind::Mean, planes: &[] };

/// Most layers that a film has.
pub const MOST_LAYERS: usize = 5 + Origin::ALL.len() + LENGTHS;

/// The layers that there are; channels and units may depend on the scene.
const KNOWN: [Layer; MOST_LAYERS] = [
    // W/(m^2 sr)
    Layer { name: "radiance", squares: true, planes: &["R", "G", "B"], ..COLOUR },
    // m, along the camera's axis; and the share of samples that have a depth
    Layer {
        name: "depth",
        channels: 2,
        unit: Unit::for_exponent(DEPTH_EXPONENT),
        kind: Kind::OfSome,
        planes: &["depth.Z", "depth.A"],
        ..COLOUR
    },
    Layer { name: "normal", kind: Kind::Signed, planes: &["normal.X", "normal.Y", "normal.Z"], ..COLOUR },
    Layer { name: "albedo", planes: rgb!("albedo"), ..COLOUR },
    Layer { name: "transmittance", planes: rgb!("transmittance"), ..COLOUR },
    // W/(m^2 sr), in the order of Origin::ALL
    part!(Technique, "technique_view"),
    part!(Technique, "technique_path"),
    part!(Technique, "technique_emission"),
    part!(Technique, "technique_nee"),
    part!(Technique, "technique_mvnee"),
    part!(Technique, "technique_omnee"),
    part!(Technique, "technique_bridge"),
    part!(Technique, "technique_lis"),
    // W/(m^2 sr), in the order of classes
    part!(Length, "length_1"),
    part!(Length, "length_2"),
    part!(Length, "length_3_to_4"),
    part!(Length, "length_5_to_8"),
    part!(Length, "length_9_up"),
];

/// The layers that `aov` stands for in an image of `frame`, as [`KNOWN`] has them.
fn known_of(aov: Aov, frame: &Frame) -> Vec<Layer> {
    const TECHNIQUES: usize = 5;
    match aov {
        Aov::Depth | Aov::Normal | Aov::Albedo | Aov::Transmittance => {
            KNOWN.into_iter().filter(|layer| layer.name == aov.name()).collect()
        }
        Aov::Technique => {
            let place =
                |origin| TECHNIQUES + Origin::ALL.iter().position(|other| *other == origin).expect("all of them");
            Origin::of(frame).into_iter().map(|origin| KNOWN[place(origin)]).collect()
        }
        Aov::Length => KNOWN[TECHNIQUES + Origin::ALL.len()..].to_vec(),
    }
}

/// All layers of an image of `frame`.
pub fn layers(frame: &Frame) -> Vec<Layer> {
    let (channels, unit) = (frame.channels(), Unit::for_largest(frame.largest_radiance()));
    let others = frame.aovs.list().iter().flat_map(|aov| known_of(*aov, frame));
    let fitting = |layer: Layer| match (layer.kind, layer.name) {
        (Kind::Part(_), _) | (_, "radiance") => Layer { channels, unit, ..layer },
        (Kind::Mean, _) => Layer { channels, ..layer },
        _ => layer,
    };
    core::iter::once(KNOWN[RADIANCE]).chain(others).map(fitting).collect()
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
        let places = forms.iter().map(|form| KNOWN.iter().position(|layer| layer.name == form.name));
        let is_film = places.clone().next() == Some(Some(RADIANCE)) && places.is_sorted_by(|a, b| a < b);
        layers.filter(|_| is_film)
    }

    /// The layer, if there is such a one.
    fn layer(&self) -> Option<Layer> {
        let layer = KNOWN.into_iter().find(|layer| layer.name == self.name)?;
        let fits = match layer.kind {
            Kind::Mean | Kind::Part(_) => (1..=layer.channels).contains(&self.channels),
            Kind::Signed | Kind::OfSome => self.channels == layer.channels,
        };
        // Those of f32.
        let fits = fits && layer.squares == self.squares && (-126..=129).contains(&self.exponent);
        fits.then(|| Layer { channels: self.channels, unit: Unit::for_exponent(self.exponent), ..layer })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_read_as_they_were_written_and_others_are_refused() {
        let radiance = KNOWN[RADIANCE];
        let grey = Layer { channels: 1, unit: Unit::for_largest(300.0), ..radiance };
        for layer in [radiance, grey] {
            assert_eq!(LayerForm::layers(&[LayerForm::of(&layer)]), Some(vec![layer]));
        }
        assert_eq!(LayerForm::layers(&KNOWN.map(|layer| LayerForm::of(&layer))), Some(KNOWN.to_vec()));
        let [form, depth] = [0, 1].map(|index: usize| LayerForm::of(&KNOWN[index]));
        for wrong in [
            vec![],
            vec![form.clone(), form.clone()],
            vec![LayerForm { channels: 0, ..form.clone() }],
            vec![LayerForm { channels: 4, ..form.clone() }],
            vec![LayerForm { squares: false, ..form.clone() }],
            vec![LayerForm { exponent: i32::MAX, ..form.clone() }],
            vec![depth.clone()],
            vec![form.clone(), LayerForm { channels: 1, ..depth }],
            vec![LayerForm { name: "colour".into(), ..form }],
        ] {
            assert_eq!(LayerForm::layers(&wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn names_of_layers_are_words_that_all_programs_take() {
        // Letters, digits and underscores, a letter first: Nuke's rule for layers and channels, the strictest.
        let is_word = |word: &str| {
            word.starts_with(|c: char| c.is_ascii_alphabetic())
                && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        };
        for layer in &KNOWN[1..] {
            for plane in layer.planes {
                let (name, channel) = plane.split_once('.').expect("a layer and a channel");
                assert!(name == layer.name && is_word(name) && is_word(channel), "{plane}");
            }
        }
    }
}
