//! smoke-fire: the ground under a fire.

use crate::{
    glb::File,
    scene::camera,
    surfaces::{first, named},
};

#[test]
fn stones_and_timbers_are_closed_and_stand_on_the_ground() {
    let surfaces = File::read("smoke-fire").surfaces();
    for (name, [low, high]) in [("stones", [-0.1, 0.3]), ("timbers", [0.0, 0.3])] {
        let solid = named(&surfaces, name);
        assert!(solid.is_closed(), "{name}");
        let [lowest, highest] = solid.bounds();
        assert!(lowest.y >= low - 1e-6 && highest.y <= high + 1e-6, "{name}: {lowest} to {highest}");
        assert!((lowest - highest).abs().max_element() < 2.2, "{name}: {lowest} to {highest}");
    }
    let ground = named(&surfaces, "ground");
    assert!(ground.faces(glam::DVec3::Y) && ground.spans([-12.0, 0.0, -12.0], [12.0, 0.0, 12.0]));
}

#[test]
fn the_camera_looks_over_the_stones() {
    let surfaces = File::read("smoke-fire").surfaces();
    let [position, forward] = camera("smoke-fire");
    assert!(first(&surfaces, position, forward).is_none(), "nothing solid where the smoke is");
}
