//! Layers that can be asked for beside radiance: arbitrary output variables, as compositors call them.

use fogbow_kernels::columns::parts::LENGTH_CLASSES;
use fogbow_kernels::connect::Technique;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::frame::Frame;

/// Something that a render keeps beside radiance.
#[derive(Clone, Copy, Debug, Deserialize, Eq, JsonSchema, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Aov {
    /// Distance of the first collision from the camera, along its axis.
    Depth,
    /// Normal of the surface of the first collision; zero in media.
    Normal,
    /// Albedo of the surface or medium of the first collision.
    Albedo,
    /// What media leave of light from the first surface, or from infinity.
    Transmittance,
    /// Radiance by the technique that found it; they add up to the image.
    Technique,
    /// Radiance by the number of segments of its paths; they add up to the image.
    Length,
}

impl Aov {
    /// All of them, in the order of a film's layers.
    pub const ALL: [Self; 6] =
        [Self::Depth, Self::Normal, Self::Albedo, Self::Transmittance, Self::Technique, Self::Length];

    /// Its name in scenes, flags and headers.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Albedo => "albedo",
            Self::Transmittance => "transmittance",
            Self::Technique => "technique",
            Self::Length => "length",
        }
    }
}

/// A set of them.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Aovs(Vec<Aov>);

impl Aovs {
    /// Those of a list, in any order, also more than once.
    pub fn of(list: &[Aov]) -> Self {
        Self(Aov::ALL.into_iter().filter(|aov| list.contains(aov)).collect())
    }

    /// They, in the order of a film's layers.
    pub fn list(&self) -> &[Aov] {
        &self.0
    }

    /// Whether `aov` is among them.
    pub fn has(&self, aov: Aov) -> bool {
        self.0.contains(&aov)
    }

    /// Whether one of them is about what the camera sees first.
    pub fn see(&self) -> bool {
        self.0.iter().any(|aov| matches!(aov, Aov::Depth | Aov::Normal | Aov::Albedo | Aov::Transmittance))
    }
}

/// `depth,normal`, or `none`.
impl core::fmt::Display for Aovs {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let names: Vec<_> = self.0.iter().map(|aov| aov.name()).collect();
        f.write_str(if names.is_empty() { "none" } else { "" })?;
        f.write_str(&names.join(","))
    }
}

/// How light was found, by whatever made its path.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Origin {
    /// The camera saw a lamp, the sky or a sun.
    View,
    /// A scattered or reflected path met a light.
    Path,
    /// A medium emitted it along a flight.
    Emission,
    /// A connection. Those to the sky and to suns are of next event estimation.
    Connection(Technique),
}

impl Origin {
    /// The layers of radiance by technique, in their order.
    pub const ALL: [Self; 3 + Technique::ALL.len()] = [
        Self::View,
        Self::Path,
        Self::Emission,
        Self::Connection(Technique::Nee),
        Self::Connection(Technique::Mvnee),
        Self::Connection(Technique::Omnee),
        Self::Connection(Technique::Bridge),
        Self::Connection(Technique::Lis),
    ];

    /// Those that light of `frame` may have.
    pub fn of(frame: &Frame) -> Vec<Self> {
        let techniques = &frame.techniques;
        let is_active = |technique: Technique| {
            let reaches_far = technique == Technique::Nee && techniques.any() && frame.lights.has_distant();
            technique.row(techniques).is_some() || reaches_far
        };
        let may_be = |origin: &Self| match origin {
            Self::View | Self::Path => true,
            Self::Emission => frame.emits(),
            Self::Connection(technique) => is_active(*technique),
        };
        Self::ALL.into_iter().filter(may_be).collect()
    }
}

/// Parts of the radiance that add up to it: layers of the film one after the other.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Split {
    /// By [`Origin`].
    Technique,
    /// By the class of the number of segments.
    Length,
}

/// Number of layers of radiance by length.
pub const LENGTHS: usize = LENGTH_CLASSES;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_has_an_order_of_its_own() {
        let aovs = Aovs::of(&[Aov::Length, Aov::Depth, Aov::Length]);
        assert_eq!((aovs.list(), aovs.to_string().as_str()), ([Aov::Depth, Aov::Length].as_slice(), "depth,length"));
        assert_eq!(Aovs::default().to_string(), "none");
        assert!(aovs.see() && !Aovs::of(&[Aov::Technique, Aov::Length]).see());
    }

    #[test]
    fn every_technique_is_an_origin() {
        let connections = Technique::ALL.map(Origin::Connection);
        assert!(connections.iter().all(|origin| Origin::ALL.contains(origin)));
    }
}
