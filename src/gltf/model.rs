//! What a glTF file says, as plain data in world space.

use crate::warning::Warning;
use core::ops::Range;
use std::path::PathBuf;

use serde_json::Value;

use fogbow_kernels::tables::textures::{Image, Texture, TextureRef};

/// A model: the triangles, materials, cameras and lights of one scene.
///
/// Coordinates are in metres, right-handed, in world space. Every list of vertices is empty or has an entry for each of
/// [`Self::positions`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// What the positions are counted from `[m]`; cameras and lights are where they are.
    pub origin: [f64; 3],
    /// Positions of the vertices `[m]`; finite.
    pub positions: Vec<[f32; 3]>,
    /// Texture coordinates of set 0 and set 1, u to the right and v downward in the image; (0, 0) where a mesh has
    /// none. Empty if no texture is in that set.
    pub texcoords: [Vec<[f32; 2]>; 2],
    /// Linear factors of the base colour, in [0, 1]; white where a mesh has none. Empty if no mesh has any.
    pub colors: Vec<[f32; 3]>,
    /// Triangles, those of an instance one after the other. Some may have no area.
    pub triangles: Vec<Triangle>,
    /// Which triangles come from which node.
    pub instances: Vec<Instance>,
    /// Names of nodes with meshes, and of these, that are left out because a scale of 0 hides them.
    pub hidden: Vec<String>,
    /// Materials, in the order of the file; the default material is last where a mesh has no material.
    pub materials: Vec<Material>,
    /// The textures that materials refer to.
    pub textures: Vec<Texture>,
    /// The images that textures refer to.
    pub images: Vec<Image>,
    /// Perspective cameras.
    pub cameras: Vec<Camera>,
    /// Punctual lights.
    pub lights: Vec<Light>,
    /// What moves with time.
    pub animations: Vec<Animated>,
    /// What the file says beyond glTF.
    pub extras: Extras,
    /// What was passed over, a line each.
    pub warnings: Vec<Warning>,
    /// The files beside the model that its buffers and images are in, also those that are not read.
    pub files: Vec<PathBuf>,
}

/// A triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices of its vertices, counterclockwise as seen from its front, in mirrored instances too.
    pub corners: [u32; 3],
    /// Index of its material.
    pub material: u32,
}

/// The triangles of a mesh where a node puts it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instance {
    /// Index of the node in the file.
    pub node: u32,
    /// The node's name, or else the mesh's, or else `mesh 0` with its index.
    pub name: String,
    /// The mesh's name, if it has one.
    pub mesh: Option<String>,
    /// Its triangles in [`Model::triangles`]; one or more.
    pub triangles: Range<u32>,
}

/// How a surface looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name, if it has one; names need not differ.
    pub name: Option<String>,
    /// Base colour, linear, in [0, 1]; multiplies the texture and the colours of vertices.
    pub base_color: [f32; 3],
    /// Texture of the base colour.
    pub base_color_texture: Option<TextureRef>,
    /// Whether the back is seen too.
    pub double_sided: bool,
    /// Emission, linear, finite and >= 0: emissive factor times emissive strength; multiplies the texture.
    pub emission: [f32; 3],
    /// Texture of the emission.
    pub emissive_texture: Option<TextureRef>,
    /// What the file says beyond glTF.
    pub extras: Option<Value>,
}

impl Default for Material {
    /// The material of meshes that have none: white, one-sided.
    fn default() -> Self {
        Self {
            name: None,
            base_color: [1.0; 3],
            base_color_texture: None,
            double_sided: false,
            emission: [0.0; 3],
            emissive_texture: None,
            extras: None,
        }
    }
}

/// A perspective camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The node's name, or else the camera's, or else `camera 0` with its index.
    pub name: String,
    /// Index of its node in the file.
    pub node: u32,
    /// Where the pinhole is `[m]`.
    pub position: [f64; 3],
    /// Direction of the viewing axis, of length 1.
    pub forward: [f64; 3],
    /// Upward in the image, of length 1 and perpendicular to `forward`.
    pub up: [f64; 3],
    /// Opening angle from the lower to the upper edge of the image, in (0, pi) `[rad]`.
    pub vertical_fov: f64,
    /// Width over height, if the file says so; > 0.
    pub aspect: Option<f64>,
    /// Distance of the near plane `[m]`, > 0. The scale of nodes does not apply to it.
    pub near: f64,
    /// What the file says beyond glTF.
    pub extras: Option<Value>,
}

/// A light without extent.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The node's name, or else the light's, or else `light 0` with its index.
    pub name: String,
    /// Index of its node in the file.
    pub node: u32,
    /// What it is.
    pub kind: LightKind,
    /// Linear colour, finite and >= 0; multiplies the intensity.
    pub color: [f32; 3],
    /// As in the file, >= 0: candela for points and spots, lux for directional lights. The scale of nodes does not
    /// apply.
    pub intensity: f64,
    /// Where it is `[m]`; of no meaning for directional lights.
    pub position: [f64; 3],
    /// Where spots and directional lights shine, of length 1; of no meaning for points.
    pub direction: [f64; 3],
    /// What the file says beyond glTF.
    pub extras: Option<Value>,
}

/// Kinds of lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Shines in all directions.
    Point,
    /// Shines in a cone. The angles are from its axis `[rad]`, 0 <= inner < outer <= pi / 2: full intensity up to the
    /// inner one, none from the outer one on.
    Spot {
        /// Where the light begins to fall off.
        inner: f64,
        /// Where it ends.
        outer: f64,
    },
    /// Shines in one direction, from infinitely far away.
    Directional,
}

/// An animation, as far as it is a description.
#[derive(Clone, Debug, PartialEq)]
pub struct Animated {
    /// `animation 0 "Walk"`, or `animation 0` if it has no name.
    pub name: String,
    /// Time of its last keyframe `[s]`; none if that cannot be read, or there is none.
    pub duration: Option<f64>,
    /// Names of the perspective cameras that it moves, with their node or one above.
    pub cameras: Vec<String>,
    /// The other nodes that it moves, each as `node 0 "Wall"`. What is below them moves with them.
    pub nodes: Vec<String>,
}

/// Values beyond glTF, for whoever put them into the file. Those of materials, cameras and lights are with them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// Those of the scene.
    pub scene: Option<Value>,
    /// Those of the nodes that have any.
    pub nodes: Vec<NodeExtras>,
}

/// Values beyond glTF of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeExtras {
    /// Index of the node in the file; instances, cameras and lights have it too.
    pub node: u32,
    /// The node's name, if it has one.
    pub name: Option<String>,
    /// The values.
    pub extras: Value,
}
