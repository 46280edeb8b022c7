//! What vertices are counted from: the camera that renders, whichever of the file's cameras that is.

use fogbow::scene::{self, LoadedScene, document::Override};
use glam::DVec3;
use serde_json::json;

use super::support::Builder;

/// Where the far camera is: single precision has steps of 6 cm to 0.5 m there.
const FAR: [f64; 3] = [1_000_000.25, -2_000_000.5, 4_000_000.125];
/// A triangle before that camera, counted from there.
const CORNERS: [[f32; 3]; 3] = [[0.03, -0.07, -1.1], [0.13, -0.02, -1.3], [0.01, 0.09, -1.2]];

/// A file whose first camera, "Near", is at 0; "Far" has a triangle and a lamp before it.
fn model() -> Builder {
    let mut file = Builder::new();
    let mesh = file.triangle(CORNERS);
    file.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 3, "extras": { "radius": 0.1 } }] } });
    let lamp = json!({ "KHR_lights_punctual": { "light": 0 } });
    let [x, y, z] = FAR;
    file.json["nodes"] = json!([
        { "name": "Near", "camera": 0 },
        { "name": "Far", "camera": 0, "mesh": mesh, "translation": FAR },
        { "name": "Lamp", "extensions": lamp, "translation": [x, y + 2.0, z] },
    ]);
    file
}

/// The model as a scene by itself, and as the geometry of one, with this camera.
fn loaded(file: &Builder, camera: &str) -> [LoadedScene; 2] {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("a file");
    write("model.glb", &file.glb());
    write("scene.toml", format!("geometry = \"model.glb\"\n{camera}\n").as_bytes());
    let load = |name: &str, changes| scene::load(&folder.path().join(name), changes);
    let flag = Override::parse(camera).expect("a key and a value");
    [load("model.glb", vec![flag]), load("scene.toml", vec![])].map(|loaded| loaded.unwrap_or_else(|e| panic!("{e}")))
}

/// Largest distance between the vertices of `scene` as they are rendered and where they are before the far camera.
fn error(scene: &LoadedScene) -> f64 {
    let rendered = scene.frame.surfaces.geometry().corners(0).map(|x| DVec3::from(x.map(f64::from)));
    // Exact in f64: the origin has whole metres, the camera a few binary digits more.
    let from_camera = rendered.map(|x| x + (DVec3::from(scene.origin) - DVec3::from(FAR)));
    let expected = CORNERS.map(|x| DVec3::from(x.map(f64::from)));
    from_camera.iter().zip(expected).map(|(x, expected)| x.distance(expected)).fold(0.0, f64::max)
}

#[test]
fn vertices_are_precise_before_the_camera_that_is_chosen() {
    let [x, y, z] = FAR;
    let table =
        format!("camera = {{ position = {FAR:?}, look_at = [{x:?}, {y:?}, {:?}], vertical_fov_deg = 50 }}", z - 1.0);
    for camera in ["camera = \"Far\"", &table] {
        for scene in loaded(&model(), camera) {
            assert_eq!(scene.camera.position, FAR, "{camera}");
            assert_eq!(scene.origin, FAR.map(f64::round), "{camera}");
            assert!(error(&scene) < 1e-6, "{camera}: {} m", error(&scene));
            let eye = scene.frame.camera.position;
            assert!(eye.iter().all(|x| x.abs() <= 0.5), "{camera}: the camera is at {eye:?}");
        }
    }
}

#[test]
fn nothing_is_moved_before_a_camera_near_0() {
    for camera in ["camera = \"Near\"", "camera = { position = [0, 0, 1], look_at = [0, 0, 0], vertical_fov_deg = 50 }"]
    {
        for scene in loaded(&model(), camera) {
            assert_eq!(scene.origin, [0.0; 3], "{camera}");
        }
    }
}
