//! The camera of a scene: that of its table, or one of its model; and what positions are counted from for its sake.

use fogbow_kernels::tables::camera::Camera as Pinhole;
use glam::DVec3;

use super::document::Document;
use super::model;
use super::ranges::{LARGEST, Owner};
use super::schema::{Camera, CameraOrName, Film, Scene};
use crate::error::{Error, Result};
use crate::gltf::{self, Asset};

/// Distance from 0 up to which positions are as fine as they need be `[m]`: 0.06 mm.
const FAR: f64 = 1000.0;

/// The camera that renders a scene.
#[derive(Debug)]
pub struct Chosen<'a> {
    /// What has its values.
    pub owner: Owner<'a>,
    /// Its values.
    pub camera: Camera,
    /// Its place among the cameras of the model, if it is one of them.
    pub of_model: Option<usize>,
    /// Width over height of the images it is meant for, if it says so.
    pub aspect: Option<f64>,
}

/// The camera that `scene`, whose geometry is `asset`, asks for.
pub fn choose<'a>(scene: &Scene, document: &'a Document, asset: Option<&Asset>) -> Result<Chosen<'a>> {
    match (&scene.camera, asset) {
        (Some(CameraOrName::Table(camera)), _) => {
            let owner = Owner::Table(document, "camera".into());
            Ok(Chosen { owner, camera: *camera, of_model: None, aspect: None })
        }
        (Some(CameraOrName::Name(name)), Some(asset)) => of_model(asset, named(name, document, asset)?),
        (Some(CameraOrName::Name(name)), None) => {
            let finding = format!("camera is {name:?}, but there is no geometry to take it from");
            Err(document.error("camera", finding, "set geometry to a glTF file, or write a [camera] table"))
        }
        (None, Some(asset)) if !asset.cameras().is_empty() => of_model(asset, 0),
        (None, asset) => Err(missing(document, asset)),
    }
}

/// The error that there is no camera at all.
fn missing(document: &Document, asset: Option<&Asset>) -> Error {
    let (finding, remedy) = match asset {
        None => ("missing key `camera`".into(), "write a [camera] table, or set geometry to a glTF file with a camera"),
        Some(_) if document.is_model() => (
            "has no perspective camera".into(),
            "write a scene.toml with a [camera] table and this file as geometry, or give camera.position, \
             camera.look_at and camera.vertical_fov_deg with --set",
        ),
        Some(asset) => {
            let finding = format!("missing key `camera`, and {} has no perspective camera", asset.file());
            (finding, "write a [camera] table")
        }
    };
    document.error(if asset.is_some() { "geometry" } else { "camera" }, finding, remedy)
}

/// The place of the camera called `name`, which is the only one.
fn named(name: &str, document: &Document, asset: &Asset) -> Result<usize> {
    let (file, cameras) = (asset.file(), asset.cameras());
    let mut found = cameras.iter().enumerate().filter(|(_, camera)| camera.name == name).map(|(index, _)| index);
    let wrong = |what: &str, remedy: String| {
        Err(document.error("camera", format!("camera is {name:?}, but {file} has {what}"), remedy))
    };
    match (found.next(), found.count()) {
        (Some(index), 0) => Ok(index),
        (Some(_), others) => {
            let what = format!("{} cameras of that name", others + 1);
            wrong(&what, "give each node that has a camera a unique name in the glTF file".into())
        }
        (None, _) if cameras.is_empty() => wrong("no perspective camera", "write a [camera] table".into()),
        (None, _) => {
            let names = model::list(cameras.iter().map(|camera| camera.name.as_str()));
            wrong("no camera of that name", format!("name one of its cameras: {names}"))
        }
    }
}

/// A camera of the model as a table says it. A near plane of glTF clips what is before it, ours is where paths start:
/// it is taken from the extras alone.
fn of_model(asset: &Asset, index: usize) -> Result<Chosen<'static>> {
    let camera = &asset.cameras()[index];
    let owner = Owner::object(asset.file(), "camera", &camera.name);
    let near = owner.extra(camera.extras.as_ref(), "near")?.unwrap_or(0.0);
    Ok(Chosen { owner, camera: table(camera, near), of_model: Some(index), aspect: camera.aspect })
}

fn table(camera: &gltf::Camera, near: f64) -> Camera {
    let look_at = core::array::from_fn(|axis| camera.position[axis] + camera.forward[axis]);
    let vertical_fov_deg = camera.vertical_fov.to_degrees();
    Camera { position: camera.position, look_at, up: camera.up, vertical_fov_deg, near }
}

/// What positions are counted from while they are rendered by a camera at `position`: the camera in whole metres, or 0
/// where that is near. Single precision is finest around 0, and models of real places are often a million metres away.
fn origin(position: DVec3) -> DVec3 {
    let is_far = position.length() > FAR && position.abs().max_element() <= LARGEST;
    if is_far { position.round() } else { DVec3::ZERO }
}

impl Chosen<'_> {
    /// What positions are counted from while this camera renders them.
    pub fn origin(&self) -> DVec3 {
        origin(DVec3::from(self.camera.position))
    }

    /// Where the ray in the middle of the film starts, if the values are valid.
    pub fn start(&self) -> DVec3 {
        let [position, look_at] = [self.camera.position, self.camera.look_at].map(DVec3::from);
        position + self.camera.near * (look_at - position).normalize()
    }

    /// The pinhole in front of `film`, of valid size, counted from `origin`.
    pub fn pinhole(&self, film: &Film, origin: DVec3) -> Result<Pinhole> {
        let at = &self.owner;
        let Camera { position, look_at, up, vertical_fov_deg, near } = self.camera;
        let [position, look_at] = [at.position("position", position)?, at.position("look_at", look_at)?];
        let forward = (look_at - position).try_normalize();
        let remedy = "give a point other than the camera's position";
        let forward = forward.ok_or_else(|| at.wrong("look_at", format!("{:?}", look_at.to_array()), remedy))?;
        let upward = at.direction("up", up)?.normalize();
        let remedy = "give a direction that is not parallel to the viewing axis";
        at.require(forward.cross(upward).length() > 1e-6, "up", format!("{up:?}"), remedy)?;
        let ok = vertical_fov_deg > 0.0 && vertical_fov_deg < 180.0;
        let finding = format!("{vertical_fov_deg:?}");
        at.require(ok, "vertical_fov_deg", finding, "give an angle between 0 and 180 degrees")?;
        let ok = (0.0..=LARGEST).contains(&near);
        at.require(ok, "near", format!("{near:?}"), "give a distance from 0 to 1e9 m")?;
        Ok(Pinhole::new(position - origin, forward, upward, vertical_fov_deg.to_radians(), near, film.size))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_a_gltf_camera_is_the_same_view() {
        let perspective = gltf::Camera {
            name: "Eye".into(),
            node: 0,
            position: [1.0, 2.0, 3.0],
            forward: [0.0, 0.6, -0.8],
            up: [0.0, 0.8, 0.6],
            vertical_fov: 0.5,
            aspect: None,
            near: 0.1,
            extras: None,
        };
        let Camera { position, look_at, up, vertical_fov_deg, near } = table(&perspective, 0.25);
        assert_eq!((position, look_at, up), ([1.0, 2.0, 3.0], [1.0, 2.6, 2.2], [0.0, 0.8, 0.6]));
        assert!((vertical_fov_deg.to_radians() - 0.5).abs() < 1e-15);
        assert_eq!(near, 0.25, "the plane that clips is not the one where paths start");
    }

    #[test]
    fn only_what_is_far_away_is_moved() {
        let near = DVec3::new(600.3, -700.0, 100.0);
        assert_eq!(origin(near), DVec3::ZERO);
        assert_eq!(origin(1000.0 * near), (1000.0 * near).round());
        assert_eq!([DVec3::NAN, DVec3::MAX].map(origin), [DVec3::ZERO; 2]);
    }
}
