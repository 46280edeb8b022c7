//! Cameras and lights: where they are and where they look.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use fogbow::gltf::LightKind;
use serde_json::{Value, json};

use super::support::{Builder, warnings};

const HALF: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Whether all numbers are the same up to rounding.
fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12)
}

#[test]
fn cameras_look_along_minus_z() {
    let mut file = Builder::new();
    let perspective = json!({ "yfov": 0.8, "znear": 0.5, "zfar": 10, "aspectRatio": 1.5 });
    file.json["cameras"] = json!([
        { "type": "perspective", "perspective": perspective, "name": "lens" },
        { "type": "perspective", "perspective": { "yfov": 1, "znear": 1 }, "extras": { "near": 2 } },
    ]);
    file.json["nodes"] = json!([
        { "camera": 1 },
        { "translation": [1, 2, 3], "rotation": [0, HALF, 0, HALF], "scale": [2, 2, 2], "children": [2] },
        { "camera": 0, "translation": [0, 0, 1], "rotation": [0, 0, HALF, HALF], "scale": [1, 3, 0.5] },
    ]);
    let model = file.model();
    let [plain, turned] = model.cameras.as_slice() else { panic!("{:?}", model.cameras) };
    assert_eq!((plain.name.as_str(), plain.node, plain.aspect), ("camera 1", 0, None));
    assert!(near(plain.position, [0.0; 3]) && near(plain.forward, [0.0, 0.0, -1.0]) && near(plain.up, [0.0, 1.0, 0.0]));
    // The parent turns z to x, and the camera rolls y to -x, which the parent turns to z.
    assert!(near(turned.position, [3.0, 2.0, 3.0]), "{turned:?}");
    assert!(near(turned.forward, [-1.0, 0.0, 0.0]) && near(turned.up, [0.0, 0.0, 1.0]), "{turned:?}");
    assert_eq!((turned.vertical_fov, turned.near, turned.aspect), (0.8, 0.5, Some(1.5)));
    assert_eq!((turned.name.as_str(), turned.node), ("lens", 2));
    assert_eq!((&plain.extras, &turned.extras), (&Some(json!({ "near": 2 })), &None));
}

#[test]
fn sheared_cameras_have_a_perpendicular_up() {
    let mut file = Builder::new();
    file.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }]);
    // y leans toward z, and everything is mirrored in x.
    file.json["nodes"] = json!([{ "camera": 0, "matrix": [-1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 2, 0, 0, 0, 0, 1] }]);
    let model = file.model();
    let camera = &model.cameras[0];
    assert!(near(camera.forward, [0.0, 0.0, -1.0]) && near(camera.up, [0.0, 1.0, 0.0]), "{camera:?}");
    assert_eq!(warnings(&model), ["node 0: mirrored cameras render images that are not mirrored"]);
}

#[test]
fn orthographic_cameras_are_left_out() {
    let mut file = Builder::new();
    let orthographic = json!({ "xmag": 1, "ymag": 1, "znear": 0, "zfar": 1 });
    file.json["cameras"] = json!([{ "type": "orthographic", "orthographic": orthographic, "name": "plan" }]);
    file.json["nodes"] = json!([{ "camera": 0 }]);
    let model = file.model();
    assert!(model.cameras.is_empty());
    assert_eq!(warnings(&model), ["camera 0 \"plan\": orthographic cameras are left out"]);
}

#[test]
fn lights_shine_along_minus_z() {
    let mut file = Builder::new();
    let lights = json!([
        { "type": "point", "name": "bulb", "extras": { "radius": 0.03 } },
        { "type": "spot", "color": [1, 0.5, 0], "intensity": 7.5, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.2 } },
        { "type": "spot", "spot": {}, "range": 3 },
        { "type": "directional", "intensity": 0 },
    ]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    let hang = |light: usize| json!({ "KHR_lights_punctual": { "light": light } });
    file.json["nodes"] = json!([
        { "extensions": hang(0), "translation": [1, 2, 3], "scale": [5, 5, 5] },
        { "extensions": hang(1), "rotation": [-HALF, 0, 0, HALF], "name": "lamp" }, // a quarter turn from z to y
        { "extensions": hang(2) },
        { "extensions": hang(3) },
    ]);
    let model = file.model();
    let kinds: Vec<_> = model.lights.iter().map(|light| light.kind).collect();
    let [narrow, wide] = [(0.1, 0.2), (0.0, FRAC_PI_4)].map(|(inner, outer)| LightKind::Spot { inner, outer });
    assert_eq!(kinds, [LightKind::Point, narrow, wide, LightKind::Directional]);
    let names: Vec<_> = model.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["bulb", "lamp", "light 2", "light 3"]);
    let [point, spot, ..] = model.lights.as_slice() else { panic!("{:?}", model.lights) };
    assert!(near(point.position, [1.0, 2.0, 3.0]));
    assert_eq!((point.color, point.intensity), ([1.0; 3], 1.0));
    assert_eq!((&point.extras, &spot.extras), (&Some(json!({ "radius": 0.03 })), &None));
    assert!(near(spot.direction, [0.0, -1.0, 0.0]), "{spot:?}");
    assert_eq!((spot.color, spot.intensity, spot.node), ([1.0, 0.5, 0.0], 7.5, 1));
    assert_eq!(warnings(&model), ["light 2: ranges are ignored; light reaches any distance"]);
}

#[test]
fn a_cone_may_be_half_a_sphere() {
    let spot = json!({ "outerConeAngle": 1.570_796_4 }); // pi / 2 as exporters round it
    assert_eq!(cone(spot), LightKind::Spot { inner: 0.0, outer: FRAC_PI_2 });
}

#[test]
fn a_cone_may_have_a_hard_edge() {
    for (angle, read) in [(0.3, 0.3), (1.570_796_4, FRAC_PI_2)] {
        let spot = json!({ "innerConeAngle": angle, "outerConeAngle": angle });
        assert_eq!(cone(spot), LightKind::Spot { inner: read, outer: read });
    }
}

/// What a light with this spot is.
fn cone(spot: Value) -> LightKind {
    let mut file = Builder::new();
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "spot": spot }] } });
    file.json["nodes"] = json!([{ "extensions": { "KHR_lights_punctual": { "light": 0 } } }]);
    file.model().lights[0].kind
}
