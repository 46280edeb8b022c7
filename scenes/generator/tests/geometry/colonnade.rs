//! colonnade: closed solids that leave camera and lights free.

use fogbow_scenes::colonnade::dimensions::{ARCADE, GALLERY, MIDDLE};
use glam::DVec3;

use crate::{
    glb::File,
    scene::{Light, camera, folder, lights},
    surfaces::{Surface, first, hits, is_free, solids_around},
};

const SCENE: &str = "colonnade";

fn surfaces() -> Vec<Surface> {
    File::read(SCENE).surfaces()
}

/// Blue far behind, green, red.
fn three_lights() -> [Light; 3] {
    lights(SCENE).try_into().expect("three lights")
}

#[test]
fn all_is_closed_stone() {
    for surface in surfaces() {
        assert_eq!((surface.albedo, surface.double_sided), ([0.3; 3], false), "{}", surface.name);
        assert!(surface.is_closed(), "{}", surface.name);
        assert!(surface.volume() > 1.0, "{}: {} m^3", surface.name, surface.volume());
    }
}

#[test]
fn it_is_small() {
    let triangles: usize = surfaces().iter().map(|surface| surface.triangles.len()).sum();
    let bytes = std::fs::metadata(folder(SCENE).join("colonnade.glb")).expect("a file").len();
    assert!(triangles < 60_000 && bytes < 1_500_000, "{triangles} triangles, {bytes} bytes");
}

#[test]
fn sides_and_ends_are_alike() {
    for surface in surfaces() {
        let [low, high] = surface.bounds();
        assert!((low.x + high.x).abs() < 1e-5, "{}: {low} {high}", surface.name);
        assert!((low.z + high.z - 2.0 * MIDDLE).abs() < 1e-5, "{}: {low} {high}", surface.name);
    }
}

#[test]
fn the_camera_is_free() {
    let surfaces = surfaces();
    let [position, forward] = camera(SCENE);
    assert_eq!(solids_around(&surfaces, position), 0);
    // Golden spiral.
    for i in 0..500 {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / 500.0;
        let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
        let direction = DVec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin);
        let hit = first(&surfaces, position, direction);
        assert!(hit.is_none_or(|hit| hit.distance > 2.0), "{direction}: {hit:?}");
    }
    let ahead = first(&surfaces, position, forward).map_or(f64::INFINITY, |hit| hit.distance);
    assert!(ahead > 15.0, "{ahead} m along the axis");
}

#[test]
fn lights_cut_no_stone_and_shine_freely() {
    let surfaces = surfaces();
    for light in three_lights() {
        for point in light.points() {
            assert_eq!(solids_around(&surfaces, point), 0, "{light:?} at {point}");
            assert!(is_free(&surfaces, light.center, point), "{light:?}: something cuts the disk before {point}");
        }
        let free = first(&surfaces, light.center, light.normal).map_or(f64::INFINITY, |hit| hit.distance);
        assert!(free > 5.0, "{light:?}: {free} m free");
    }
}

#[test]
fn lights_at_the_sides_shine_into_the_court_through_an_arch() {
    let surfaces = surfaces();
    let [_, green, red] = three_lights();
    for light in [green, red] {
        let axis = DVec3::new(0.0, light.center.y, light.center.z);
        let seen = light.points().filter(|&point| is_free(&surfaces, point, axis)).count();
        assert!(seen >= 48, "{light:?}: {seen} of 64 points shine on the court's axis");
        assert!(light.center.x.abs() > ARCADE + 1.0 && light.center.y - light.radius > GALLERY);
        // An arch is an opening: the wall is there above it.
        let spandrel = DVec3::new(0.0, 14.0, light.center.z);
        assert!(!is_free(&surfaces, DVec3::new(light.center.x, 14.0, light.center.z), spandrel));
    }
}

#[test]
fn the_light_behind_is_seen_through_the_window() {
    let surfaces = surfaces();
    let [position, _] = camera(SCENE);
    let [blue, ..] = three_lights();
    let seen = blue.points().filter(|&point| is_free(&surfaces, point, position)).count();
    assert!((32..64).contains(&seen), "{seen} of 64 points: posts stand before some");
    let beside = blue.center + 3.0 * DVec3::X;
    assert!(!is_free(&surfaces, beside, position), "the wall is there beside the window");
}

#[test]
fn the_court_is_open_to_the_sky() {
    let surfaces = surfaces();
    let axis = DVec3::new(0.0, 10.0, MIDDLE + 1.75);
    assert_eq!(hits(&surfaces, axis, DVec3::Y).count(), 0);
    assert_eq!(first(&surfaces, axis, DVec3::NEG_Y).map(|hit| hit.name), Some("floor"));
}
