//! The keys of a scene file. The comments here are what `fogbow render --help-scene` prints.

mod environment;
mod light;
mod names;
mod phase;
mod values;
mod volume;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use environment::Environment;
pub use light::{Light, LightKind};
pub use names::{AovList, Techniques};
pub use phase::{Phase, PhaseKind};
pub use values::{CameraOrName, NumberOrAuto, OneOrTwo, Segments, Spectrum, Starts};
pub use volume::{Grid, Interpolation, Shape, ShapeKind, Volume};

/// Most segments of a path.
pub const MOST_SEGMENTS: u32 = fogbow_kernels::LONGEST_PATH;
/// Most samples per pixel.
pub const MOST_SAMPLES: u32 = 1 << 31;
/// Pixels of the largest film, and of its longest side: it takes 12 GiB.
pub const LARGEST_FILM: u32 = 1 << 27;

/// A scene: one TOML file.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// A glTF file, .gltf or .glb, relative to this one. Its meshes are opaque surfaces that reflect diffusely with
    /// their base colour (factor, texture and vertex colours). Meshes with an emissive material are lights; each
    /// triangle emits the mean of its texture. Point, spot and directional lights of the file are added to those of the
    /// scene. Absent: no surfaces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "file"))]
    pub geometry: Option<String>,
    /// Radius `[m]`, > 0, of the spheres and disks that stand for the point and spot lights of geometry. A number
    /// "radius" in the extras of a light (not of its node) overrides it for that light. Intensities are read as W/sr
    /// per channel, where glTF has candela; ranges are ignored. A spot's intensity falls off between its cone angles as
    /// glTF recommends. Directional lights are suns, whose lux are read as W/m^2; a number "angular_radius_deg" in their
    /// extras replaces 0.265.
    #[serde(default = "Scene::punctual_radius")]
    pub punctual_radius: f64,
    /// The pinhole camera. To use a camera of geometry instead, write camera = "name" before the first table: the name
    /// of its node, or its own name if the node has none. Its near is then the one in its extras, or else 0. Absent:
    /// the first camera of geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraOrName>,
    /// The image. Absent: 512 rows; as many columns as the aspect ratio of the glTF camera asks for, or else 512.
    #[serde(default)]
    pub film: Film,
    /// The medium around everything, volumes included, unbounded and homogeneous. Absent: vacuum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medium: Option<Medium>,
    /// A medium with bounds: a cloud, smoke, a block of milk. It has a shape, a grid, or both, or an emission_grid.
    /// Repeat the table for each one, up to 32. Around them is medium, or vacuum. Each has an albedo and a phase function
    /// of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub volume: Vec<Volume>,
    /// The sky: what is seen beyond everything else. It does not go with a medium around everything, which lets nothing
    /// through from infinity, but with volumes. Absent: black.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub environment: Option<Environment>,
    /// A light; repeat the table for each one.
    #[serde(default)]
    pub light: Vec<Light>,
    /// How to render.
    #[serde(default)]
    pub render: Render,
}

impl Scene {
    /// Whether a medium is around everything that lets nothing through from infinity; presets are resolved.
    pub fn has_endless_medium(&self) -> bool {
        self.medium.as_ref().is_some_and(|medium| {
            let coefficients = [medium.scattering, medium.absorption];
            coefficients.iter().any(|coefficient| coefficient.0 != [0.0; 3])
        })
    }

    fn punctual_radius() -> f64 {
        0.01
    }
}

/// `[camera]`
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Position of the pinhole `[m]`.
    #[serde(deserialize_with = "values::entries")]
    pub position: [f64; 3],
    /// A point on the viewing axis `[m]`.
    #[serde(deserialize_with = "values::entries")]
    pub look_at: [f64; 3],
    /// The up direction in the image, made perpendicular to the viewing axis. Image right is forward x up.
    #[serde(default = "Camera::up", deserialize_with = "values::entries")]
    pub up: [f64; 3],
    /// Angle of view from the lower to the upper edge of the image, in degrees, above 0 and below 180.
    pub vertical_fov_deg: f64,
    /// Distance `[m]`, >= 0, from the pinhole to the plane on which paths start, perpendicular to the viewing axis.
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
    #[serde(default = "Film::square", deserialize_with = "values::sides")]
    #[schemars(extend("x-format" = "[width, height]"))]
    pub size: [u32; 2],
    /// Exposure of PNG images in stops, -100 to 100; each stop doubles the radiance that is shown. With "auto" the
    /// log-average luminance of the whole image becomes middle grey. EXR images hold unexposed radiance in any case.
    #[serde(default)]
    pub exposure: NumberOrAuto,
    /// Layers that EXR images have beside radiance, or a list of them. Absent: none.
    #[serde(default, skip_serializing_if = "AovList::is_empty")]
    pub aov: AovList,
}

impl Film {
    /// Rows of images whose size nobody has given.
    const ROWS: u32 = 512;

    /// The film of a camera for images of width over height `aspect`.
    pub fn of_aspect(aspect: f64) -> Self {
        let columns = (aspect * f64::from(Self::ROWS)).round().max(1.0);
        Self { size: [columns as u32, Self::ROWS], exposure: NumberOrAuto::default(), aov: AovList::default() }
    }

    fn square() -> [u32; 2] {
        Self::default().size
    }
}

impl Default for Film {
    fn default() -> Self {
        Self::of_aspect(1.0)
    }
}

/// `[medium]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Medium {
    /// A medium by name, instead of scattering and absorption: "milk", "skim_milk", "sea_water", "skin", "wax" and
    /// others, which fogbow presets lists with their coefficients and sources. It has a phase function of its own,
    /// which phase replaces if it is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "name"))]
    pub preset: Option<String>,
    /// Scattering coefficient [1/m], >= 0. Extinction (scattering + absorption) may differ between channels; one that
    /// is clearer than a millionth of the densest is given that much.
    #[serde(default)]
    pub scattering: Spectrum,
    /// Absorption coefficient [1/m], >= 0.
    #[serde(default)]
    pub absorption: Spectrum,
    /// What the medium emits by itself [W/(m^3 sr)], >= 0: radiance per metre. It needs extinction in every channel
    /// that emits.
    #[serde(default, skip_serializing_if = "Spectrum::is_black")]
    #[schemars(extend("default" = 0.0))]
    pub emission: Spectrum,
    /// How a scattering event redirects light.
    #[serde(default, deserialize_with = "phase::table_or_name")]
    pub phase: Phase,
}

/// `[render]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Render {
    /// Connection technique, or a list of them; `path` is always active as well. Absent: bridge, or nee where all media
    /// are volumes, since most bridges would leave them.
    pub technique: Techniques,
    /// Longest path that counts, in segments, including the camera and light segments: 1 to 65536, or "auto", where
    /// no number of segments ends a path. It then ends with a probability that a short pilot render chooses, and in
    /// any case after 65536 segments. Beyond 1024 connections insert at most 30 vertices, bridges as many as
    /// bridge_vertices, if that is given.
    pub max_segments: Segments,
    /// Shortest path that counts, in segments, 1 to max_segments: 1 counts all, 2 leaves out directly visible light.
    #[serde(deserialize_with = "values::whole::<1, { MOST_SEGMENTS }, _>")]
    pub min_segments: u32,
    /// How bridges are rolled about their axis: aligned with the phase function at their start, which also chooses
    /// their walk and which end of it comes first, or uniformly.
    pub roll: Roll,
    /// Longest bridge, in expected segments (extinction times distance, in the clearest channel, or in the mean of
    /// channels where media differ in colour), > 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub bridge_mesc: Option<f64>,
    /// Largest number of vertices that a bridge inserts. Absent: limited only by max_segments, or 30 where that is
    /// "auto" or above 1024.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "whole number"))]
    pub bridge_vertices: Option<u32>,
    /// How many vertices connect, counted from the camera or the last surface: "all", a number from 1 to 1024, or
    /// "auto", the number that a short pilot render finds most efficient; all where max_segments is "auto" or above
    /// 1024.
    pub starts: Starts,
    /// Probability that a walk continues from a vertex, 0.01 to 1, or "auto", chosen by the same pilot; where
    /// max_segments is "auto" or above 1024 it then depends on how far the walk has come.
    pub survival: NumberOrAuto,
    /// Fraction of the camera's flights that are aimed at the lights, 0 to 0.99, or "auto": 0.05 for bridges with at
    /// most 16 lights, otherwise 0. Where there are volumes or media emit, none are.
    pub aimed: NumberOrAuto,
    /// Contribution [W/(m^2 sr)], >= 0, below which connections play Russian roulette before they are traced; 0 turns
    /// it off. "auto" is a quarter of the mean of the image if there is geometry, a volume or MVNEE, and the same pilot
    /// finds that more efficient, otherwise 0.
    pub roulette: NumberOrAuto,
    /// Longest MVNEE connection, in expected segments (extinction times distance, in the clearest channel, or in the
    /// mean of channels where media differ in colour), > 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub mesc: Option<f64>,
    /// Shape of MVNEE's perturbation.
    pub perturbation: Perturbation,
    /// How MVNEE spreads its seeds in volumes; without any, both are the same.
    pub seeds: Seeds,
    /// What joins a vertex of the path to the one that lis makes from the light. The settings for bridges, or mesc,
    /// perturbation and seeds, apply to it.
    pub lis: LisConnector,
    /// How a connection picks its light. Lights at infinity, the sky and suns, have connections of their own.
    pub light_selection: LightSelection,
    /// Samples per pixel, 1 to 2147483648.
    #[serde(deserialize_with = "values::whole::<1, { MOST_SAMPLES }, _>")]
    pub samples: u32,
    /// Seed for all random numbers, 0 to 4294967295.
    #[serde(deserialize_with = "values::whole::<0, { u32::MAX }, _>")]
    pub seed: u32,
}

impl Default for Render {
    fn default() -> Self {
        Self {
            technique: Techniques(vec![Technique::Bridge]),
            max_segments: Segments::Auto,
            min_segments: 1,
            roll: Roll::Aligned,
            bridge_mesc: None,
            bridge_vertices: None,
            starts: Starts::Auto,
            survival: NumberOrAuto(None),
            aimed: NumberOrAuto(None),
            roulette: NumberOrAuto(None),
            mesc: None,
            perturbation: Perturbation::Ggx,
            seeds: Seeds::Coarse,
            lis: LisConnector::Bridge,
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
    /// No connections: light is found only where a path hits it.
    Path,
    /// Next event estimation: one straight connection from every vertex.
    Nee,
    /// Multiple-vertex next event estimation: connections through a chain of scattering events.
    Mvnee,
    /// Once-more next event estimation: connections through exactly one inserted vertex; use it together with nee.
    Omnee,
    /// Bridges: connections shaped by a random walk.
    Bridge,
    /// Light importance sampling: connections that end at a vertex made from the light; for spotlights.
    Lis,
}

impl Technique {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Nee => "nee",
            Self::Mvnee => "mvnee",
            Self::Omnee => "omnee",
            Self::Bridge => "bridge",
            Self::Lis => "lis",
        }
    }
}

/// Rolls of a bridge.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Roll {
    /// Towards the angles that the phase function at the start favours.
    Aligned,
    /// All angles equally likely.
    Uniform,
}

/// Shapes of MVNEE's perturbation.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Perturbation {
    /// Heavy tails.
    Ggx,
    /// Normal distribution.
    Gaussian,
}

/// Ways to spread MVNEE's seeds where extinction differs from place to place.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Seeds {
    /// By flights through the mean extinctions of cells.
    Coarse,
    /// The first one likewise, all others as if extinction went on as it is there: cheaper, and worse where it does not.
    Fast,
}

/// Shapes of the connections of light importance sampling.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LisConnector {
    /// A bridge.
    Bridge,
    /// Multiple-vertex next event estimation, as published.
    Mvnee,
}

/// Rules by which a connection picks its light.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightSelection {
    /// All lights equally likely.
    Uniform,
    /// In proportion to intensity; of lights at infinity, to what they send through a sphere.
    Intensity,
    /// In proportion to intensity over distance; of lights at infinity as above.
    IntensityDistance,
}
