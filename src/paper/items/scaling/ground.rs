//! Hilly ground of any number of triangles, as a glTF file.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;
use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// Where it is: from and to along x and z, and its height `[m]`.
const X: [f64; 2] = [-12.0, 12.0];
const Z: [f64; 2] = [-4.0, 20.0];
const HEIGHT: f64 = -2.0;

/// Squares along a side, for what is measured.
pub const SIDES: [u32; 5] = [2, 8, 32, 128, 384];

/// Triangles of ground of `side` squares by as many.
pub fn triangles(side: u32) -> u32 {
    2 * side * side
}

/// A file that is there until it is dropped.
///
/// # Errors
/// If it cannot be written.
pub fn write(side: u32) -> Result<NamedTempFile> {
    let fails = |error: std::io::Error| {
        let remedy = "free some room in the folder for temporary files, or name another one in TMPDIR";
        Error::failure("paper scaling", format!("ground cannot be written: {error}"), remedy)
    };
    let file = tempfile::Builder::new().prefix("fogbow-").suffix(".gltf").tempfile().map_err(fails)?;
    std::fs::write(file.path(), gltf(side)).map_err(fails)?;
    Ok(file)
}

fn gltf(side: u32) -> String {
    let vertices: Vec<[f32; 3]> = (0..=side).flat_map(|j| (0..=side).map(move |i| vertex(side, i, j))).collect();
    let corner = |i: u32, j: u32| j * (side + 1) + i;
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [a, d, b, b, d, c]
    };
    let indices: Vec<u32> = (0..side).flat_map(|j| (0..side).flat_map(move |i| square(i, j))).collect();
    let positions = vertices.iter().flatten().flat_map(|place| place.to_le_bytes());
    let bytes: Vec<u8> = positions.chain(indices.iter().flat_map(|index| index.to_le_bytes())).collect();
    let (start, end) = (12 * vertices.len(), bytes.len());
    let ends = |pick: fn(f32, f32) -> f32| {
        vertices.iter().fold(vertices[0], |ends, vertex| [0, 1, 2].map(|axis| pick(ends[axis], vertex[axis])))
    };
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{
            "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices.len(), "type": "VEC3",
              "min": ends(f32::min), "max": ends(f32::max) },
            { "bufferView": 1, "componentType": 5125, "count": indices.len(), "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": start },
            { "buffer": 0, "byteOffset": start, "byteLength": end - start },
        ],
        "buffers": [{
            "byteLength": end,
            "uri": format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes)),
        }],
    })
    .to_string()
}

fn vertex(side: u32, i: u32, j: u32) -> [f32; 3] {
    let along = |[from, to]: [f64; 2], k: u32| from + (to - from) * f64::from(k) / f64::from(side);
    let (x, z) = (along(X, i), along(Z, j));
    [x, HEIGHT + 0.5 * (1.3 * x).sin() * (0.9 * z).cos(), z].map(|place| place as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_has_as_many_triangles_as_it_says() {
        let text = gltf(8);
        let file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(file["accessors"][1]["count"], 3 * triangles(8));
        assert_eq!(file["accessors"][0]["count"], 81);
        assert_eq!(file["buffers"][0]["byteLength"], 81 * 12 + 12 * triangles(8));
    }
}
