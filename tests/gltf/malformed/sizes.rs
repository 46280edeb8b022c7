//! Small files that claim to be large.

use serde_json::json;

use super::super::support::{Builder, F32};

#[test]
fn files_that_claim_to_be_huge() {
    let zeros = |count: u64| {
        let mut file = Builder::new();
        let positions = file.add("accessors", json!({ "componentType": F32, "type": "VEC3", "count": count }));
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions }, "mode": 5 }));
        file.place(mesh);
        file
    };
    for count in [100_000_000, u64::MAX] {
        let error = zeros(count).error();
        assert!(error.starts_with("error: test.glb: scene: has ") && error.contains("use fewer instances"), "{error}");
    }
    let mut file = zeros(100_000);
    for _ in 0..2000 {
        file.place(0);
    }
    let error = file.error();
    assert!(error.starts_with("error: test.glb: scene: has 200095998 triangles with all instances"), "{error}");
}
