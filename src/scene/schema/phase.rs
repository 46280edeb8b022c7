//! `[medium] phase`.

use core::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::OneOrTwo;

/// `[medium] phase`: a table, or the name of a phase function without parameters.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// The phase function.
    #[serde(rename = "type", default)]
    pub kind: PhaseKind,
    /// Mean cosine of the scattering angle, from -0.9999 to 0.9999; above 0 is forward scattering. For
    /// henyey_greenstein (0 unless given), draine, and two_lobe, which has a list of two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub g: Option<OneOrTwo>,
    /// For two_lobe only: share of the first lobe, from 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub weight: Option<f64>,
    /// For draine only: weight of the squared cosine, from 0 to 1000; 0 is henyey_greenstein, 1 Cornette-Shanks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub alpha: Option<f64>,
    /// For droplets only: diameter of the droplets in micrometres, from 5 to 50; fog and clouds have 10 to 30.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub diameter_um: Option<f64>,
    /// For tabulated only: a CSV file with rows of cosine and value, in ascending order from -1 to 1; relative to the
    /// scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

/// Phase functions.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PhaseKind {
    /// (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))
    #[default]
    HenyeyGreenstein,
    /// All directions alike.
    Isotropic,
    /// Particles much smaller than the wavelength: 3 (1 + cos^2) / (16 pi)
    Rayleigh,
    /// Two Henyey-Greenstein lobes.
    TwoLobe,
    /// Henyey-Greenstein times (1 + alpha cos^2), normalised.
    Draine,
    /// Water droplets of one diameter, as in fog and clouds.
    Droplets,
    /// Values from a file, linear in the cosine in between, normalised.
    Tabulated,
}

impl PhaseKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::HenyeyGreenstein,
        Self::Isotropic,
        Self::Rayleigh,
        Self::TwoLobe,
        Self::Draine,
        Self::Droplets,
        Self::Tabulated,
    ];

    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::HenyeyGreenstein => "henyey_greenstein",
            Self::Isotropic => "isotropic",
            Self::Rayleigh => "rayleigh",
            Self::TwoLobe => "two_lobe",
            Self::Draine => "draine",
            Self::Droplets => "droplets",
            Self::Tabulated => "tabulated",
        }
    }
}

/// Reads a table of a phase function, or the name of one.
pub fn table_or_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Phase, D::Error> {
    struct TableOrName;
    impl<'de> Visitor<'de> for TableOrName {
        type Value = Phase;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table with a type, or the name of a phase function")
        }

        fn visit_str<E: de::Error>(self, name: &str) -> Result<Phase, E> {
            let kind = PhaseKind::ALL.into_iter().find(|kind| kind.name() == name);
            let kind = kind.ok_or_else(|| E::unknown_variant(name, &PHASE_NAMES))?;
            Ok(Phase { kind, ..Phase::default() })
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Phase, A::Error> {
            Phase::deserialize(MapAccessDeserializer::new(map))
        }
    }
    deserializer.deserialize_any(TableOrName)
}

/// Names of all phase functions.
const PHASE_NAMES: [&str; PhaseKind::ALL.len()] =
    ["henyey_greenstein", "isotropic", "rayleigh", "two_lobe", "draine", "droplets", "tabulated"];
