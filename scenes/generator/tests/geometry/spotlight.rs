//! spotlight: a sphere before black walls.

use glam::DVec3;

use crate::{
    glb::File,
    scene::{camera, lights},
    surfaces::{first, named},
};

const CENTER: DVec3 = DVec3::new(0.8, 0.8, 4.0);
const RADIUS: f64 = 0.38;

#[test]
fn the_sphere_is_round_and_closed() {
    let surfaces = File::read("spotlight").surfaces();
    let sphere = named(&surfaces, "sphere");
    assert_eq!((sphere.albedo, sphere.triangles.len()), ([1.0, 0.1, 0.1], 720));
    assert!(sphere.positions.iter().all(|position| ((*position - CENTER).length() - RADIUS).abs() < 1e-6));
    assert!(sphere.is_closed());
    for ([a, b, c], area) in sphere.corners().zip(sphere.areas()) {
        assert!(area.normalize().dot(((a + b + c) / 3.0 - CENTER).normalize()) > 0.98, "facing outward");
    }
    let ball = 4.0 / 3.0 * core::f64::consts::PI * RADIUS.powi(3);
    assert!(sphere.volume() < ball && sphere.volume() > 0.97 * ball, "{} of {ball} m^3", sphere.volume());
}

#[test]
fn ground_and_walls_face_the_camera() {
    let surfaces = File::read("spotlight").surfaces();
    for (name, albedo, normal, low, high) in [
        ("ground", [0.2, 0.2, 0.8], DVec3::Y, [-50.0, -2.0, -50.0], [50.0, -2.0, 50.0]),
        ("back", [0.0; 3], DVec3::NEG_Z, [-4.0, -2.0, 8.0], [50.0, 50.0, 8.0]),
        ("left", [0.0; 3], DVec3::X, [-4.0, -2.0, -50.0], [-4.0, 50.0, 8.0]),
    ] {
        let sheet = named(&surfaces, name);
        assert_eq!((sheet.albedo, sheet.double_sided, sheet.triangles.len()), (albedo, false, 2), "{name}");
        assert!(sheet.faces(normal), "{name}");
        assert!(sheet.spans(low, high), "{name}: {:?}", sheet.bounds());
    }
}

#[test]
fn the_beam_falls_on_the_sphere() {
    let surfaces = File::read("spotlight").surfaces();
    let [light] = &lights("spotlight")[..] else { panic!("one light") };
    let hit = first(&surfaces, light.center, light.normal).expect("the sphere");
    assert!(hit.name == "sphere" && hit.front && hit.distance > 5.0, "{hit:?}");
}

#[test]
fn the_camera_sees_the_wall_past_the_sphere() {
    let surfaces = File::read("spotlight").surfaces();
    let [position, forward] = camera("spotlight");
    let hit = first(&surfaces, position, forward).expect("the wall");
    assert!(hit.name == "back" && (hit.distance - 10.0).abs() < 1e-6, "{hit:?}");
}
