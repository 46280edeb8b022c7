//! The keys of a scene file. The comments here are what `fogbow render --help-scene` prints.

use core::fmt;

use schemars::JsonSchema;
use serde::de::{self, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A scene: one TOML file.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// A glTF file, .gltf or .glb, relative to this one: its meshes are surfaces that reflect diffusely, with their base
    /// colour (factor, texture, colours of vertices), and hide what is behind. Absent: nothing is solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "file"))]
    pub geometry: Option<String>,
    /// The pinhole camera.
    pub camera: Camera,
    /// The image.
    pub film: Film,
    /// The medium around everything, unbounded and homogeneous; omit it for vacuum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medium: Option<Medium>,
    /// A light; repeat the table for more.
    #[serde(default)]
    pub light: Vec<Light>,
    /// How to render.
    #[serde(default)]
    pub render: Render,
}

/// `[camera]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where the pinhole is `[m]`.
    pub position: [f64; 3],
    /// A point on the viewing axis `[m]`.
    pub look_at: [f64; 3],
    /// Upward in the image, made perpendicular to the viewing axis. Image right is forward x up.
    #[serde(default = "Camera::up")]
    pub up: [f64; 3],
    /// Opening angle from the lower to the upper edge of the image, in (0, 180) degrees.
    pub vertical_fov_deg: f64,
    /// Paths start on the plane at this distance from the pinhole, perpendicular to the viewing axis `[m]`, >= 0.
    #[serde(default)]
    pub near: f64,
}

impl Camera {
    fn up() -> [f64; 3] {
        [0.0, 1.0, 0.0]
    }
}

/// `[film]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Width and height in pixels. The pixel filter is a box.
    #[schemars(extend("x-format" = "[width, height]"))]
    pub size: [u32; 2],
}

/// `[medium]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Medium {
    /// Scattering coefficient [1/m], >= 0. Extinction (scattering + absorption) must be the same in all channels.
    pub scattering: Spectrum,
    /// Absorption coefficient [1/m], >= 0.
    #[serde(default)]
    pub absorption: Spectrum,
    /// Where a scattering event sends light.
    #[serde(default)]
    pub phase: Phase,
}

/// `[medium] phase`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// The phase function.
    #[serde(rename = "type")]
    pub kind: PhaseKind,
    /// Mean cosine of a scattering event, in (-1, 1); above 0 is forward.
    pub g: f64,
}

impl Default for Phase {
    fn default() -> Self {
        Self { kind: PhaseKind::HenyeyGreenstein, g: 0.0 }
    }
}

/// Phase functions.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PhaseKind {
    /// (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))
    HenyeyGreenstein,
}

/// `[[light]]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Light {
    /// The shape.
    #[serde(rename = "type")]
    pub kind: LightKind,
    /// Centre `[m]`.
    pub center: [f64; 3],
    /// Direction that the front faces, of any length but 0.
    pub normal: [f64; 3],
    /// Radius `[m]`, > 0.
    pub radius: f64,
    /// Radiance of the front [W/(m^2 sr)], >= 0; of a spot, what is focused: its front radiates
    /// radiance (exponent + 1) / (2 pi) cos^exponent of the angle to the normal.
    pub radiance: Spectrum,
    /// Of a spot, and only of a spot: how narrow it is, 0 to 10000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub exponent: Option<f64>,
}

/// Light shapes.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// A flat disk that emits from its front, alike in all directions; its back is black and opaque.
    Disk,
    /// The same, focused about its normal.
    Spot,
}

/// `[render]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Render {
    /// Connection technique, or a list of them; `path` is always among the competitors.
    pub technique: Techniques,
    /// Longest path that counts, in segments, camera and light segment included, 1 to 1024.
    pub max_segments: u32,
    /// Shortest path that counts, in segments: 1 counts all, 2 leaves out directly seen light.
    pub min_segments: u32,
    /// How bridges are rolled about their axis.
    pub roll: Roll,
    /// Longest bridge in expected segments: extinction times distance, > 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub bridge_mesc: Option<f64>,
    /// Most vertices that a bridge inserts. Absent: no limit but max_segments.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "whole number"))]
    pub bridge_vertices: Option<u32>,
    /// Vertices that connect, the first ones after the camera: "all", a number from 1 to 1024, or "auto", what a short pilot finds
    /// most efficient.
    pub starts: Starts,
    /// Probability with which a walk goes on from a vertex, 0.01 to 1, or "auto", from the same pilot.
    pub survival: NumberOrAuto,
    /// Share of the camera's flights that are drawn towards the lights, 0 to 0.99, or "auto": 0.05 with bridges
    /// and no more than 16 lights, 0 otherwise.
    pub aimed: NumberOrAuto,
    /// Contribution below which connections play roulette before they are traced [W/(m^2 sr)], >= 0; 0 for none. Pays where
    /// tracing is dear; with nothing but disks it gains nothing.
    pub roulette: f64,
    /// Longest MVNEE connection in expected segments: extinction times distance, > 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub mesc: Option<f64>,
    /// Shape of MVNEE's perturbation.
    pub perturbation: Perturbation,
    /// How a connection picks its light.
    pub light_selection: LightSelection,
    /// Samples per pixel.
    pub samples: u32,
    /// Seed of all random numbers, 0 to 2^32 - 1.
    pub seed: u32,
}

impl Default for Render {
    fn default() -> Self {
        Self {
            technique: Techniques(vec![Technique::Bridge]),
            max_segments: 32,
            min_segments: 1,
            roll: Roll::Aligned,
            bridge_mesc: None,
            bridge_vertices: None,
            starts: Starts::Auto,
            survival: NumberOrAuto(None),
            aimed: NumberOrAuto(None),
            roulette: 0.0,
            mesc: None,
            perturbation: Perturbation::Ggx,
            light_selection: LightSelection::IntensityDistance,
            samples: 64,
            seed: 1,
        }
    }
}

/// Connection techniques.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Technique {
    /// None: light is found only where a path meets it.
    Path,
    /// Next event estimation: one straight connection from every vertex.
    Nee,
    /// Multiple-vertex next event estimation: connections through the medium.
    Mvnee,
    /// Once-more next event estimation: connections through exactly one inserted vertex; a companion of nee.
    Omnee,
    /// Bridges: connections shaped by a random walk.
    Bridge,
}

/// Rolls of a bridge.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Roll {
    /// Towards the phase function of the start.
    Aligned,
    /// All angles alike.
    Uniform,
}

/// How many vertices connect.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Eq)]
#[schemars(with = "u32", extend("x-format" = "number, \"all\" or \"auto\""))]
pub enum Starts {
    /// What a pilot finds.
    Auto,
    /// Every vertex.
    All,
    /// So many.
    First(u32),
}

/// A number; `None` where the program chooses.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq)]
#[schemars(with = "f64", extend("x-format" = "number or \"auto\""))]
pub struct NumberOrAuto(pub Option<f64>);

/// Shapes of MVNEE's perturbation.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Perturbation {
    /// Heavy tails.
    Ggx,
    /// Normal distribution.
    Gaussian,
}

/// Rules by which a connection picks its light.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightSelection {
    /// All alike.
    Uniform,
    /// By intensity.
    Intensity,
    /// By intensity over distance.
    IntensityDistance,
}

/// One technique or a list of them.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[schemars(with = "Vec<Technique>", extend("x-format" = "name, or a list of names"))]
pub struct Techniques(pub Vec<Technique>);

impl<'de> Deserialize<'de> for Starts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Count;
        impl Visitor<'_> for Count {
            type Value = Starts;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 1 to 1024, \"all\" or \"auto\"")
            }

            fn visit_i64<E: de::Error>(self, count: i64) -> Result<Starts, E> {
                u32::try_from(count).map(Starts::First).map_err(|_| E::invalid_value(Unexpected::Signed(count), &self))
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<Starts, E> {
                match word {
                    "auto" => Ok(Starts::Auto),
                    "all" => Ok(Starts::All),
                    _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
                }
            }
        }
        deserializer.deserialize_any(Count)
    }
}

impl Serialize for Starts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::All => serializer.serialize_str("all"),
            Self::First(count) => serializer.serialize_u32(*count),
        }
    }
}

impl<'de> Deserialize<'de> for NumberOrAuto {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Number;
        impl Visitor<'_> for Number {
            type Value = NumberOrAuto;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or \"auto\"")
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<NumberOrAuto, E> {
                Ok(NumberOrAuto(Some(number)))
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<NumberOrAuto, E> {
                self.visit_f64(number as f64)
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<NumberOrAuto, E> {
                if word == "auto" {
                    Ok(NumberOrAuto(None))
                } else {
                    Err(E::invalid_value(Unexpected::Str(word), &self))
                }
            }
        }
        deserializer.deserialize_any(Number)
    }
}

impl Serialize for NumberOrAuto {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Some(number) => serializer.serialize_f64(number),
            None => serializer.serialize_str("auto"),
        }
    }
}

/// A number for all channels, or [red, green, blue].
#[derive(Clone, Copy, Debug, Default, JsonSchema, PartialEq, Serialize)]
#[schemars(with = "f64", extend("x-format" = "number, or [red, green, blue]"))]
pub struct Spectrum(pub [f64; 3]);

impl fmt::Display for Spectrum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let grey = self.0.iter().all(|channel| channel.to_bits() == self.0[0].to_bits());
        if grey { write!(f, "{:?}", self.0[0]) } else { write!(f, "{:?}", self.0) }
    }
}

impl<'de> Deserialize<'de> for Spectrum {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Channels;
        impl<'de> Visitor<'de> for Channels {
            type Value = Spectrum;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of three, [red, green, blue]")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Spectrum, E> {
                Ok(Spectrum([value; 3]))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Spectrum, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Spectrum, A::Error> {
                let mut channels = [0.0; 3];
                for (index, channel) in channels.iter_mut().enumerate() {
                    *channel = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(index, &self))?;
                }
                match seq.next_element::<f64>()? {
                    None => Ok(Spectrum(channels)),
                    Some(_) => Err(de::Error::invalid_length(4, &self)),
                }
            }
        }
        deserializer.deserialize_any(Channels)
    }
}

impl<'de> Deserialize<'de> for Techniques {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Names;
        impl<'de> Visitor<'de> for Names {
            type Value = Techniques;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a technique or a list of names")
            }

            fn visit_str<E: de::Error>(self, names: &str) -> Result<Techniques, E> {
                let technique = |name: &str| Technique::deserialize(de::value::StrDeserializer::new(name.trim()));
                names.split(',').map(technique).collect::<Result<_, _>>().map(Techniques)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Techniques, A::Error> {
                let mut techniques = Vec::new();
                while let Some(technique) = seq.next_element()? {
                    techniques.push(technique);
                }
                Ok(Techniques(techniques))
            }
        }
        deserializer.deserialize_any(Names)
    }
}
