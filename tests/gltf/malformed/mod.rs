//! Malformed files: each is refused with the object, the finding and a remedy.

mod accessors;
mod containers;
mod images;
mod objects;
mod sizes;

use serde_json::Value;

use super::support::{Builder, everything};

/// [`everything`] with `value` at `pointer`; its parent is made if it does not exist.
fn changed(pointer: &str, value: Value) -> Builder {
    let mut file = everything();
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    let parent = file.json.pointer_mut(parent).unwrap_or_else(|| panic!("{pointer} has no parent"));
    match parent {
        Value::Array(list) => list[key.parse::<usize>().expect("an index")] = value,
        other => other[key] = value,
    }
    file
}

/// Each case: where, what stands there, and what the error says, place and finding.
fn refuse(cases: &[(&str, Value, &str)]) {
    for (pointer, value, expected) in cases {
        let error = changed(pointer, value.clone()).error();
        let says = format!("error: test.glb: {expected}");
        assert!(error.starts_with(&says), "{pointer} = {value}\n{error}\nexpected\n{says}");
        let (_, remedy) = error.split_once("\n  help: ").expect("a remedy");
        assert!(remedy.len() > 10, "{error}");
        assert!(["a accessor", "a image", "an mesh"].iter().all(|wrong| !remedy.contains(wrong)), "{error}");
    }
}

#[test]
fn everything_is_right() {
    let model = everything().model();
    assert_eq!((model.triangles.len(), model.cameras.len(), model.lights.len()), (8, 1, 1));
    assert_eq!((model.images.len(), model.textures.len(), model.materials.len()), (2, 2, 2));
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
}
