//! What a file holds: named objects of named materials.

use crate::Mesh;

/// The geometry of a scene.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name of the scene and its files.
    pub name: &'static str,
    /// What stands in it.
    pub objects: Vec<Object>,
}

impl Model {
    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.objects.iter().map(|object| object.mesh.triangles.len()).sum()
    }
}

/// A mesh of one material.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name of the object.
    pub name: &'static str,
    /// Its surface.
    pub material: Material,
    /// Its shape.
    pub mesh: Mesh,
}

impl Object {
    /// An object.
    pub fn new(name: &'static str, material: Material, mesh: Mesh) -> Self {
        Self { name, material, mesh }
    }
}

/// A Lambert surface, black and opaque from behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name of the material; equal names are equal materials.
    pub name: &'static str,
    /// Share of the light that is reflected, linear RGB.
    pub albedo: [f64; 3],
    /// Radiance of the front, linear RGB `[W/(m^2 sr)]`.
    pub emission: [f64; 3],
}

impl Material {
    /// A material of any colour.
    pub const fn new(name: &'static str, albedo: [f64; 3]) -> Self {
        Self { name, albedo, emission: [0.0; 3] }
    }

    /// A material that shines and reflects nothing.
    pub const fn shining(name: &'static str, emission: [f64; 3]) -> Self {
        Self { name, albedo: [0.0; 3], emission }
    }

    /// A material that reflects all colours alike.
    pub const fn grey(name: &'static str, albedo: f64) -> Self {
        Self::new(name, [albedo; 3])
    }
}
