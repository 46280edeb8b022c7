//! Loading a large model: a grid of 384,400 textured vertices and 766,322 triangles, 17 MB as one .glb file.
//!
//! ```text
//! cargo bench --bench gltf
//! ```

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fogbow::gltf;
use serde_json::{Value, json};

/// Vertices along an edge of the grid.
const SIDE: u32 = 620;

/// Rotated, scaled and mirrored, so that every vertex and every triangle takes part.
fn grid() -> Vec<u8> {
    let vertices = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [x, y].map(|at| at as f32 / SIDE as f32)));
    let height = |[x, y]: [f32; 2]| (20.0 * x).sin() * (20.0 * y).cos();
    let positions: Vec<u8> =
        vertices.clone().flat_map(|[x, y]| [x, y, height([x, y])]).flat_map(f32::to_le_bytes).collect();
    let texcoords: Vec<u8> = vertices.flatten().flat_map(f32::to_le_bytes).collect();
    let quad = |x: u32, y: u32| {
        let corner = y * SIDE + x;
        [corner, corner + 1, corner + SIDE, corner + 1, corner + SIDE + 1, corner + SIDE]
    };
    let indices = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).flat_map(move |x| quad(x, y)));
    let indices: Vec<u8> = indices.flat_map(u32::to_le_bytes).collect();
    container(&json(positions.len(), texcoords.len(), indices.len()), &[positions, texcoords, indices].concat())
}

fn json(positions: usize, texcoords: usize, indices: usize) -> Value {
    let view = |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let accessor = |view: usize, component: u32, shape: &str, count: usize| json!({ "bufferView": view, "componentType": component, "type": shape, "count": count });
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1 });
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": positions + texcoords + indices }],
        "bufferViews": [view(0, positions), view(positions, texcoords), view(positions + texcoords, indices)],
        "accessors": [
            accessor(0, 5126, "VEC3", positions / 12),
            accessor(1, 5126, "VEC2", texcoords / 8),
            accessor(2, 5125, "SCALAR", indices / 4),
        ],
        "images": [{ "uri": format!("data:image/png;base64,{DOT}") }],
        "textures": [{ "source": 0 }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": 2, "material": 0 }] }],
        "nodes": [{ "mesh": 0, "rotation": [0.5, 0.5, 0.5, 0.5], "scale": [10, 10, -2] }],
    })
}

/// An image of one texel.
const DOT: &str = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGM4sWUBAARkAh2NzDMBAAAAAElFTkSuQmCC";

fn container(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let number = |number: usize| (number as u32).to_le_bytes();
    [
        b"glTF\x02\0\0\0",
        &number(length)[..],
        &number(json.len()),
        b"JSON",
        &json,
        &number(binary.len()),
        b"BIN\0",
        binary,
    ]
    .concat()
}

fn load(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("grid.glb");
    let bytes = grid();
    std::fs::write(&path, &bytes).expect("a file");
    let mut group = c.benchmark_group("gltf");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("load", |bench| bench.iter(|| gltf::load(&path).expect("a valid file")));
    group.finish();
}

criterion_group!(benches, load);
criterion_main!(benches);
