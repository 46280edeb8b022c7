//! What a scene's geometry holds, for whoever asks.

use super::model::Loaded;
use super::schema;

/// A light of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the glTF file that it comes from.
    pub name: Option<String>,
    /// Its values; those of a sphere or disk of the same intensity, if it is a punctual light of glTF.
    pub values: schema::Light,
}

/// Cameras and meshes of a glTF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// Names of the perspective cameras.
    pub cameras: Vec<String>,
    /// Which of them renders the scene, if one does.
    pub camera: Option<usize>,
    /// Names of the placed meshes, and their numbers of triangles.
    pub meshes: Vec<(String, usize)>,
}

impl Contents {
    /// Those of a model, one of whose cameras may be the scene's.
    pub fn of(loaded: &Loaded, camera: Option<usize>) -> Self {
        let model = &loaded.model;
        let cameras = model.cameras.iter().map(|camera| camera.name.clone()).collect();
        let meshes = model.instances.iter().map(|mesh| (mesh.name.clone(), mesh.triangles.len())).collect();
        Self { cameras, camera, meshes }
    }
}
