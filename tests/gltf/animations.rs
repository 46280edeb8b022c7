//! Animations: where they put nodes at a time, and what is said of malformed ones.

use fogbow::gltf::{self, Model};
use serde_json::{Value, json};

use super::support::{Builder, F32, I16, TRIANGLE, corners, float_bytes, near, warnings};

/// A triangle on node 1, below node 0; a camera on node 2.
fn still() -> Builder {
    let mut file = Builder::new();
    let mesh = file.triangle(TRIANGLE);
    file.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }));
    file.json["nodes"] = json!([{ "name": "Arm", "children": [1] }, { "mesh": mesh }, { "camera": 0 }]);
    file
}

/// Adds an animation of one property: keyframes at `times`, and an accessor of what is there.
fn animate(file: &mut Builder, node: usize, path: &str, interpolation: &str, times: &[f32], output: usize) {
    let input = file.floats(&times.iter().map(|time| [*time]).collect::<Vec<_>>());
    let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
    let channel = json!({ "sampler": 0, "target": { "node": node, "path": path } });
    file.add("animations", json!({ "samplers": [sampler], "channels": [channel] }));
}

/// An animation of every property, with every interpolation, for tests that break it.
pub fn moving() -> Builder {
    let mut file = still();
    let output = file.floats(&[[0.0_f32, 0.0, 0.0], [4.0, 0.0, -2.0]]);
    animate(&mut file, 0, "translation", "LINEAR", &[1.0, 3.0], output);
    // From no turn to a quarter turn from x to y.
    let quarter: Vec<u8> = [0_i16, 0, 0, i16::MAX, 0, 0, 23170, 23170].iter().flat_map(|x| x.to_le_bytes()).collect();
    let output = file.normalized(I16, "VEC4", 2, &quarter);
    animate(&mut file, 1, "rotation", "LINEAR", &[0.0, 2.0], output);
    let output = file.floats(&[[1.0_f32; 3], [2.0; 3]]);
    animate(&mut file, 1, "scale", "STEP", &[0.0, 2.0], output);
    let rest = [0.0_f32; 3];
    let output = file.floats(&[rest, rest, rest, rest, [0.0, 1.0, 0.0], rest]);
    animate(&mut file, 2, "translation", "CUBICSPLINE", &[0.0, 4.0], output);
    file
}

fn at(file: &Builder, time: f64) -> Model {
    gltf::parse_at("test.glb", &file.glb(), None, time).unwrap_or_else(|error| panic!("{error}\n{}", file.json))
}

/// The same file without animations, with these nodes.
fn baked(file: &Builder, nodes: &[(usize, &str, Value)]) -> Model {
    let mut file = Builder { json: file.json.clone(), binary: file.binary.clone() };
    file.json.as_object_mut().expect("an object").remove("animations");
    for (node, property, value) in nodes {
        file.json["nodes"][node][property] = value.clone();
    }
    file.model()
}

#[test]
fn a_moment_is_the_same_model_as_a_file_with_these_transforms() {
    let file = moving();
    let half = f64::from(23170_i16) / f64::from(i16::MAX);
    let half = f64::from(half as f32);
    for (time, arm, turn, scale, eye) in [
        (0.0, json!([0, 0, 0]), json!([0, 0, 0, 1]), json!([1, 1, 1]), json!([0, 0, 0])),
        (2.0, json!([2, 0, -1]), json!([0, 0, half, half]), json!([2, 2, 2]), json!([0, 0.5, 0])),
        (2.5, json!([3, 0, -1.5]), json!([0, 0, half, half]), json!([2, 2, 2]), json!([0, 0.68359375, 0])),
        (9.0, json!([4, 0, -2]), json!([0, 0, half, half]), json!([2, 2, 2]), json!([0, 1, 0])),
    ] {
        let nodes = [(0, "translation", arm), (1, "rotation", turn), (1, "scale", scale), (2, "translation", eye)];
        let mut still = baked(&file, &nodes);
        still.animations.clone_from(&at(&file, time).animations);
        assert_eq!(at(&file, time), still, "at {time} s");
    }
    // Half way of a quarter turn: (1, 0, 0) is at 45 degrees, below an arm that has not moved yet.
    let turned = corners(&at(&file, 1.0))[0][1];
    assert!(near(turned, [0.5_f32.sqrt(), 0.5_f32.sqrt(), 0.0]), "{turned:?}");
}

#[test]
fn without_a_time_nodes_stay_where_they_are() {
    let file = moving();
    let model = file.model();
    assert_eq!(corners(&model), corners(&still().model()));
    assert_eq!(
        warnings(&model),
        ["animation 0: animations play only with --frames; without it, nodes stay where the file puts them"]
    );
    assert_eq!(warnings(&at(&file, 1.0)), [""; 0]);
}

#[test]
fn what_does_not_move_is_told() {
    let mut file = moving();
    let targets = [json!({ "node": 1, "path": "weights" }), json!({ "path": "pointer" }), json!({ "path": "scale" })];
    let channels = targets.map(|target| json!({ "sampler": 0, "target": target }));
    file.json["animations"][0]["name"] = json!("Walk");
    file.json["animations"][0]["channels"].as_array_mut().expect("a list").extend(channels);
    let again = file.floats(&[[7.0_f32, 0.0, 0.0]]);
    animate(&mut file, 0, "translation", "STEP", &[0.0], again);
    let model = at(&file, 0.0);
    let expected = [
        "animation 0 \"Walk\", channel 1: morph targets do not move; meshes keep their shape",
        "animation 0 \"Walk\", channel 2, \"pointer\": only nodes move",
        "node 0 \"Arm\", translation: is moved by several animations, of which the last in the file counts",
    ];
    assert_eq!(warnings(&model), expected);
    assert_eq!(corners(&model)[0][0], [7.0, 0.0, 0.0]);
    assert_eq!(warnings(&at(&still(), 1.0)), ["animations: there are none: all frames are alike"]);
}

#[test]
fn malformed_animations_are_refused() {
    let nan = float_bytes(&[[0.0_f32], [f32::NAN]]);
    let mut with_nan = moving();
    let not_a_time = with_nan.accessor(F32, "SCALAR", 2, &nan);
    let equal = with_nan.floats(&[[1.0_f32], [1.0]]);
    let endless = with_nan.add("accessors", json!({ "componentType": F32, "type": "SCALAR", "count": u32::MAX }));
    let not_a_place = with_nan.accessor(F32, "VEC3", 2, &float_bytes(&[[0.0; 3], [0.0, f32::INFINITY, 0.0]]));
    let opposite = with_nan.floats(&[[0.0_f32; 4], [0.0, 0.0, 0.0, 1.0]]);
    let channel = "animation 0, channel 0";
    let once = json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } });
    let twice = json!([once, once]);
    let cases = [
        (
            "/animations/0/channels/0/sampler",
            json!(1),
            format!("{channel}: refers to sampler 1, but the last one is 0\n"),
        ),
        (
            "/animations/0/channels/0/target/node",
            json!(3),
            format!("{channel}: refers to node 3, but the last one is 2\n"),
        ),
        (
            "/animations/0/channels",
            twice,
            "animation 0, channel 1: moves translation of node 0, as another channel".into(),
        ),
        (
            "/nodes/0/matrix",
            json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            format!("{channel}: moves node 0 \"Arm\", which has a matrix\n"),
        ),
        (
            "/animations/0/samplers/0/interpolation",
            json!("CUBIC"),
            format!("{channel}, sampler 0: its interpolation is \"CUBIC\"\n"),
        ),
        (
            "/animations/0/samplers/0/interpolation",
            json!("CUBICSPLINE"),
            format!("{channel}, sampler 0, output: has 2 values for 2 keyframes\n"),
        ),
        ("/animations/0/samplers/0/input", json!(99), format!("{channel}, sampler 0, input: refers to accessor 99,")),
        (
            "/animations/0/samplers/0/input",
            json!(0),
            format!("{channel}, sampler 0, input, accessor 0: is VEC3 of FLOAT\n"),
        ),
        (
            "/animations/0/samplers/0/input",
            json!(not_a_time),
            format!("{channel}, sampler 0, input: its time 1 is NaN, after 0\n"),
        ),
        (
            "/animations/0/samplers/0/input",
            json!(equal),
            format!("{channel}, sampler 0, input: its time 1 is 1, after 1\n"),
        ),
        (
            "/animations/0/samplers/0/input",
            json!(endless),
            format!("{channel}, sampler 0, input: has 4294967295 keyframes\n"),
        ),
        (
            "/animations/0/samplers/0/output",
            json!(not_a_place),
            format!("{channel}, sampler 0, output: has a value that is not finite\n"),
        ),
        (
            "/animations/1/samplers/0/output",
            json!(opposite),
            "animation 1, channel 0: turns node 1 by no rotation at 0.5 s\n".into(),
        ),
        (
            "/animations/1/samplers/0/output",
            json!(0),
            "animation 1, channel 0, sampler 0, output, accessor 0: is VEC3 of FLOAT\n".into(),
        ),
    ];
    for (pointer, value, expected) in cases {
        let mut file = Builder { json: with_nan.json.clone(), binary: with_nan.binary.clone() };
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        file.json.pointer_mut(parent).expect("a parent")[key] = value;
        let error = gltf::parse_at("test.glb", &file.glb(), None, 0.5).expect_err(pointer).to_string();
        assert!(error.starts_with(&format!("error: test.glb: {expected}")), "{error}\nexpected\n{expected}");
        assert!(error.contains("\n  help: "), "{error}");
    }
}
