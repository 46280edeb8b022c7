//! What positions are counted from while they are rendered: single precision is finest around 0, and models of real places
//! are often a million metres away from it.

use glam::DVec3;

use super::ranges::LARGEST;
use super::schema::{CameraOrName, Scene};

/// Distance from 0 up to which positions are as fine as they need be `[m]`: 0.06 mm.
const FAR: f64 = 1000.0;

/// For a scene that is looked at from `camera`: the camera in whole metres, or 0 where that is near, or nowhere.
pub fn around(camera: DVec3) -> DVec3 {
    let is_far = camera.length() > FAR && camera.abs().max_element() <= LARGEST;
    if is_far { camera.round() } else { DVec3::ZERO }
}

/// For `scene`, whose model has its first camera at `of_model`.
pub fn of_scene(scene: &Scene, of_model: Option<DVec3>) -> DVec3 {
    let own = match &scene.camera {
        Some(CameraOrName::Table(camera)) => Some(DVec3::from(camera.position)),
        _ => None,
    };
    own.or(of_model).map_or(DVec3::ZERO, around)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_far_away_is_moved() {
        let near = DVec3::new(600.3, -700.0, 100.0);
        assert_eq!(around(near), DVec3::ZERO);
        assert_eq!(around(1000.0 * near), (1000.0 * near).round());
        assert_eq!([DVec3::NAN, DVec3::MAX].map(around), [DVec3::ZERO; 2]);
    }
}
