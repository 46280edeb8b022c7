//! The keys of a scene file. The comments here are what `fogbow render --help-scene` prints.

mod values;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use values::{CameraOrName, NumberOrAuto, Spectrum, Starts, Techniques};

/// A scene: one TOML file.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// A glTF file, .gltf or .glb, relative to this one. Its meshes are surfaces that reflect diffusely, with their base
    /// colour (factor, texture, colours of vertices), and hide what is behind. Those with an emissive material shine, every
    /// triangle in the mean of its texture. Its point and spot lights shine beside those of this file. Absent: nothing is
    /// solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "file"))]
    pub geometry: Option<String>,
    /// Radius of what stands for the point lights (spheres) and spot lights (disks) of geometry `[m]`, > 0; a number
    /// "radius" in the extras of a light (not of its node) is its own. Their intensities are read as W/sr, per channel,
    /// where glTF has candela; their ranges are not read. A spot's intensity falls between its cone angles as glTF
    /// recommends.
    #[serde(default = "Scene::punctual_radius")]
    pub punctual_radius: f64,
    /// The pinhole camera; or, before the first table, camera = "name": the camera of geometry whose node is called
    /// so (or itself, where the node has no name), with near from its extras, or else 0. Absent: the first camera of geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraOrName>,
    /// The image. Absent: 512 rows, and columns by the aspect ratio of the glTF camera, or else 512.
    #[serde(default)]
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

impl Scene {
    fn punctual_radius() -> f64 {
        0.01
    }
}

/// `[camera]`
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
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
    #[serde(default = "Film::square")]
    #[schemars(extend("x-format" = "[width, height]"))]
    pub size: [u32; 2],
    /// Exposure of PNG images in stops, -100 to 100: radiance is doubled by each before it is shown. Or "auto": the middle of
    /// the whole image, the mean of its logarithms, becomes middle grey. EXR images hold radiance, whatever is said here.
    #[serde(default)]
    pub exposure: NumberOrAuto,
}

impl Film {
    /// Rows of images whose size nobody has given.
    const ROWS: u32 = 512;

    /// The film of a camera for images of width over height `aspect`.
    pub fn of_aspect(aspect: f64) -> Self {
        let columns = (aspect * f64::from(Self::ROWS)).round().max(1.0);
        Self { size: [columns as u32, Self::ROWS], exposure: NumberOrAuto::default() }
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
    /// Scattering coefficient [1/m], >= 0. Extinction (scattering + absorption) must be the same in all channels.
    #[serde(default)]
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
    #[serde(rename = "type", default)]
    pub kind: PhaseKind,
    /// Mean cosine of a scattering event, from -0.9999 to 0.9999; above 0 is forward.
    pub g: f64,
}

impl Default for Phase {
    fn default() -> Self {
        Self { kind: PhaseKind::HenyeyGreenstein, g: 0.0 }
    }
}

/// Phase functions.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PhaseKind {
    /// (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))
    #[default]
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
    /// Of a disk or spot: direction that the front faces, of any length but 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub normal: Option<[f64; 3]>,
    /// Radius `[m]`, > 0.
    pub radius: f64,
    /// Radiance of the surface or front [W/(m^2 sr)], >= 0; of a spot, what is focused: its front radiates
    /// radiance (exponent + 1) / (2 pi) cos^exponent of the angle to the normal.
    pub radiance: Spectrum,
    /// Of a spot, and only of a spot: how narrow it is, 0 to 10000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub exponent: Option<f64>,
    /// Inner and outer angle of a spot of a model `[rad]`, which has the intensity of its cone instead of a power of the cosine.
    #[serde(skip)]
    pub cone: Option<[f64; 2]>,
}

/// Light shapes.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// A flat disk that emits from its front, alike in all directions; its back is black and opaque.
    Disk,
    /// The same, focused about its normal.
    Spot,
    /// A sphere that emits from all of its surface, alike in all directions.
    Sphere,
}

impl LightKind {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Disk => "disk",
            Self::Spot => "spot",
            Self::Sphere => "sphere",
        }
    }
}

/// `[render]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Render {
    /// Connection technique, or a list of them; `path` is always among the competitors.
    pub technique: Techniques,
    /// Longest path that counts, in segments, camera and light segment included, 1 to 1024.
    #[serde(deserialize_with = "values::whole::<1, 1024, _>")]
    pub max_segments: u32,
    /// Shortest path that counts, in segments, 1 to max_segments: 1 counts all, 2 leaves out directly seen light.
    #[serde(deserialize_with = "values::whole::<1, 1024, _>")]
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
    /// Vertices that connect, the first ones after the camera or the last surface: "all", a number from 1 to 1024, or "auto", what a
    /// short pilot finds most efficient.
    pub starts: Starts,
    /// Probability with which a walk goes on from a vertex, 0.01 to 1, or "auto", from the same pilot.
    pub survival: NumberOrAuto,
    /// Share of the camera's flights that are drawn towards the lights, 0 to 0.99, or "auto": 0.05 with bridges
    /// and no more than 16 lights, 0 otherwise and with geometry.
    pub aimed: NumberOrAuto,
    /// Contribution below which connections play roulette before they are traced [W/(m^2 sr)], >= 0; 0 for none; or "auto":
    /// with geometry the mean of the image if the same pilot finds that more efficient, otherwise 0.
    pub roulette: NumberOrAuto,
    /// Longest MVNEE connection in expected segments: extinction times distance, > 0. Absent: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub mesc: Option<f64>,
    /// Shape of MVNEE's perturbation.
    pub perturbation: Perturbation,
    /// What joins a vertex of the path with the one that lis makes from the light; the settings of bridges, or mesc and
    /// perturbation, hold for it.
    pub lis: LisShape,
    /// How a connection picks its light.
    pub light_selection: LightSelection,
    /// Samples per pixel, 1 to 2147483648.
    #[serde(deserialize_with = "values::whole::<1, 0x8000_0000, _>")]
    pub samples: u32,
    /// Seed of all random numbers, 0 to 4294967295.
    #[serde(deserialize_with = "values::whole::<0, { u32::MAX }, _>")]
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
            roulette: NumberOrAuto(None),
            mesc: None,
            perturbation: Perturbation::Ggx,
            lis: LisShape::Bridge,
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
    /// Light importance sampling: connections that end at a vertex made from the light, for spotlights.
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
    /// Towards the phase function of the start.
    Aligned,
    /// All angles alike.
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

/// Shapes of the connections of light importance sampling.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LisShape {
    /// A bridge.
    Bridge,
    /// Multiple-vertex next event estimation, as published.
    Mvnee,
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
