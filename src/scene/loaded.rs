//! A scene that was read: its keys, what its geometry holds, its frame, and the hash that names it.

use std::path::PathBuf;

use super::filling::Filling;
use super::schema::{self, AovList, Camera, CameraOrName, NumberOrAuto, Scene, Starts};
use crate::film::aov::{Aov, Aovs};
use crate::frame::Frame;
use crate::gltf::{Animated, Model};
use crate::pilot::Choices;
use crate::warning::Warning;

/// A scene that was read and found valid.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// What it is called: its folder's or file's name.
    pub name: String,
    /// The files that it was read from: its own, that of its phase function's table, that of its geometry, and those
    /// that the geometry refers to.
    pub files: Vec<PathBuf>,
    /// What they contain, but for what the keys say: a line for every file, the hash of its content and its name. Empty
    /// for scenes from memory.
    pub file_hashes: String,
    /// All keys, overrides and defaults included.
    pub scene: Scene,
    /// Its camera, wherever that comes from.
    pub camera: Camera,
    /// Its lights: those of `scene`, then those of its geometry.
    pub lights: Vec<Light>,
    /// What else its geometry holds.
    pub contents: Contents,
    /// What its volumes hold, in their order; none where there is nothing.
    pub fillings: Vec<Option<Filling>>,
    /// The same as the stages read it.
    pub frame: Frame,
    /// What is not rendered, or not as it is written.
    pub warnings: Vec<Warning>,
    /// What positions in `frame` are counted from `[m]`: 0, unless the camera is far away from there.
    pub origin: [f64; 3],
}

/// A light of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the glTF file that it comes from.
    pub name: Option<String>,
    /// Its values; those of a sphere or disk of the same intensity, if it is a punctual light of glTF.
    pub values: schema::Light,
}

/// Cameras, meshes and animations of a glTF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// Names of the perspective cameras.
    pub cameras: Vec<String>,
    /// Which of them renders the scene, if one does.
    pub camera: Option<usize>,
    /// Names of the placed meshes, and their numbers of triangles.
    pub meshes: Vec<(String, usize)>,
    /// Its animations.
    pub animations: Vec<Animated>,
}

impl Contents {
    /// Those of `model`, of whose cameras `camera` is the scene's.
    pub fn of(model: &Model, camera: Option<usize>) -> Self {
        let cameras = model.cameras.iter().map(|camera| camera.name.clone()).collect();
        let meshes = model.instances.iter().map(|mesh| (mesh.name.clone(), mesh.triangles.len())).collect();
        Self { cameras, camera, meshes, animations: model.animations.clone() }
    }
}

impl LoadedScene {
    /// A hash of everything that the value of a sample depends on: scenes with the same hash have the same samples.
    pub fn hash(&self) -> String {
        let mut scene = self.scene.clone();
        scene.render.samples = 0;
        (scene.film.exposure, scene.film.aov) = (NumberOrAuto::default(), AovList::default());
        // What is taken from the geometry's file counts, not what it is called there.
        scene.geometry = None;
        scene.punctual_radius = 0.0;
        scene.camera = Some(CameraOrName::Table(self.camera));
        if let Some(image) = scene.environment.as_mut().and_then(|environment| environment.image.as_mut()) {
            image.clear();
        }
        for volume in &mut scene.volume {
            volume.name = None;
            if let Some(shape) = &mut volume.shape {
                shape.name = None;
            }
            for grid in [&mut volume.grid, &mut volume.emission_grid].into_iter().flatten() {
                (grid.file, grid.name) = (String::new(), None);
            }
        }
        scene.light = self.lights.iter().map(|light| light.values.clone()).collect();
        let canonical = serde_json::to_vec(&scene).expect("a scene is made of numbers and names");
        let mut hasher = blake3::Hasher::new();
        hasher.update(&canonical);
        hasher.update(self.origin.map(f64::to_le_bytes).as_flattened());
        let mut digest = |bytes: &[u8]| {
            hasher.update(bytes);
        };
        self.frame.surfaces.digest(&mut digest);
        self.frame.lights.digest(&mut digest);
        for phase in self.frame.medium.all_phases() {
            phase.digest(&mut digest);
        }
        if let Some(field) = self.frame.medium.field() {
            field.digest(&mut digest);
        }
        if let Some(glow) = &self.frame.medium.glow {
            glow.digest(&mut digest);
        }
        hasher.finalize().to_hex()[..32].to_string()
    }

    /// The same with these layers of images beside those that it has anyway.
    #[must_use]
    pub fn with_aovs(mut self, more: &[Aov]) -> Self {
        let aovs = Aovs::of(&[self.frame.aovs.list(), more].concat());
        self.scene.film.aov = AovList(aovs.list().to_vec());
        self.frame.aovs = aovs;
        self
    }

    /// What the scene leaves to the pilot.
    pub fn choices(&self) -> Choices {
        let render = &self.scene.render;
        let (survival, roulette) = (render.survival.0.is_none(), render.roulette.0.is_none());
        Choices { starts: render.starts == Starts::Auto, survival, roulette }
    }

    /// All keys as TOML, overrides and defaults included.
    pub fn to_toml(&self) -> String {
        toml::to_string(&self.scene).expect("a scene is a table of tables")
    }
}
