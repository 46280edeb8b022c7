//! cornell-fog: five sheets.

use glam::DVec3;

use crate::{
    glb::File,
    scene::{camera, lights},
    surfaces::{first, is_free, named},
};

#[test]
fn sheets_face_inward() {
    let surfaces = File::read("cornell-fog").surfaces();
    assert_eq!(surfaces.len(), 5);
    let [x, y, z] = [5.56, 5.488, 5.592];
    for (name, albedo, normal, low, high) in [
        ("ceiling", [1.0; 3], DVec3::NEG_Y, [0.0, y, 0.0], [x, y, z]),
        ("floor", [0.15; 3], DVec3::Y, [0.0, 0.0, 0.0], [x, 0.0, z]),
        ("back", [0.15; 3], DVec3::NEG_Z, [0.0, 0.0, z], [x, y, z]),
        ("left", [0.05, 0.4, 0.05], DVec3::X, [0.0, 0.0, 0.0], [0.0, y, z]),
        ("right", [0.4, 0.05, 0.05], DVec3::NEG_X, [x, 0.0, 0.0], [x, y, z]),
    ] {
        let sheet = named(&surfaces, name);
        assert_eq!((sheet.albedo, sheet.double_sided, sheet.triangles.len()), (albedo, false, 2), "{name}");
        assert!(sheet.faces(normal), "{name}");
        assert!(sheet.spans(low, high), "{name}: {:?}", sheet.bounds());
    }
}

#[test]
fn both_variants_see_the_back_and_are_lit_from_below_the_ceiling() {
    let surfaces = File::read("cornell-fog").surfaces();
    for scene in ["cornell-fog", "cornell-fog-thin"] {
        let [position, forward] = camera(scene);
        assert_eq!(first(&surfaces, position, forward).map(|hit| (hit.name, hit.front)), Some(("back", true)));
        let [light] = &lights(scene)[..] else { panic!("{scene} has one light") };
        for point in light.points() {
            let above = first(&surfaces, point, -light.normal).expect("the ceiling");
            assert!(above.name == "ceiling" && (above.distance - 0.008).abs() < 1e-6, "{above:?}");
            assert!(is_free(&surfaces, point, position), "{scene}: the front is open");
        }
    }
}
