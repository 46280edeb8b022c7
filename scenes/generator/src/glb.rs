//! Binary glTF 2.0: a header, a chunk of JSON, a chunk of numbers.

use std::io;

use serde::Serialize;

use crate::{Material, Mesh, Model, Object};

/// Component types, as glTF numbers them.
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;
/// Targets of buffer views, as glTF numbers them.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// The extension with which materials shine by more than 1.
const STRENGTH: &str = "KHR_materials_emissive_strength";

/// The file that holds `model`.
///
/// # Errors
/// If the JSON cannot be written.
pub fn encode(model: &Model) -> io::Result<Vec<u8>> {
    let mut writer = Writer::default();
    for object in &model.objects {
        writer.object(object);
    }
    let json = serde_json::to_vec(&writer.root(model.name))?;
    let mut file = Vec::new();
    let length = 12 + 8 + json.len().next_multiple_of(4) + 8 + writer.bytes.len();
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(u32::try_from(length).expect("a file is smaller than 4 GiB").to_le_bytes());
    chunk(&mut file, *b"JSON", &json, b' ');
    chunk(&mut file, *b"BIN\0", &writer.bytes, 0);
    Ok(file)
}

/// Adds a chunk, filled up to a multiple of 4 bytes.
fn chunk(file: &mut Vec<u8>, kind: [u8; 4], data: &[u8], fill: u8) {
    let length = data.len().next_multiple_of(4);
    file.extend((length as u32).to_le_bytes());
    file.extend(kind);
    file.extend(data);
    file.extend(core::iter::repeat_n(fill, length - data.len()));
}

/// What the chunks hold, as it grows.
#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    views: Vec<BufferView>,
    accessors: Vec<Accessor>,
    materials: Vec<Material>,
    meshes: Vec<MeshEntry>,
    nodes: Vec<Node>,
}

impl Writer {
    fn object(&mut self, object: &Object) {
        let attributes = Attributes { position: self.positions(&object.mesh) };
        let indices = self.indices(&object.mesh);
        let primitive = Primitive { attributes, indices, material: self.material(object.material) };
        self.nodes.push(Node { name: object.name, mesh: self.meshes.len() });
        self.meshes.push(MeshEntry { name: object.name, primitives: [primitive] });
    }

    fn positions(&mut self, mesh: &Mesh) -> usize {
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|position| position.as_vec3().to_array()).collect();
        // Bounds as the very numbers that the file holds, which every digit of an f64 can tell.
        let bound = |pick: fn(f32, f32) -> f32| {
            let extreme = |axis: usize| positions.iter().map(|position| position[axis]).reduce(pick);
            Some([0, 1, 2].map(|axis| extreme(axis).map_or(0.0, f64::from)))
        };
        let [min, max] = [bound(f32::min), bound(f32::max)];
        let bytes = positions.as_flattened().iter().flat_map(|x| x.to_le_bytes());
        let buffer_view = self.view(bytes, VERTICES);
        self.accessor(Accessor { buffer_view, component_type: F32, count: positions.len(), kind: "VEC3", min, max })
    }

    fn indices(&mut self, mesh: &Mesh) -> usize {
        let indices = mesh.triangles.as_flattened().iter();
        let count = indices.len();
        // The largest index of a type is reserved.
        let (buffer_view, component_type) = if mesh.positions.len() <= usize::from(u16::MAX) {
            (self.view(indices.flat_map(|&index| (index as u16).to_le_bytes()), INDICES), U16)
        } else {
            (self.view(indices.flat_map(|&index| index.to_le_bytes()), INDICES), U32)
        };
        self.accessor(Accessor { buffer_view, component_type, count, kind: "SCALAR", min: None, max: None })
    }

    /// Adds bytes to the buffer, so that what comes next starts at a multiple of 4.
    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: u32) -> usize {
        let byte_offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(BufferView { buffer: 0, byte_offset, byte_length: self.bytes.len() - byte_offset, target });
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Accessor) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn material(&mut self, material: Material) -> usize {
        let known = self.materials.iter().position(|other| other.name == material.name);
        known.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        })
    }

    fn root(&self, name: &'static str) -> Root<'_> {
        Root {
            asset: Asset { version: "2.0", generator: "fogbow-scenes" },
            extensions_used: self.materials.iter().any(|material| strength(material) > 1.0).then_some([STRENGTH]),
            scene: 0,
            scenes: [SceneEntry { name, nodes: (0..self.nodes.len()).collect() }],
            nodes: &self.nodes,
            meshes: &self.meshes,
            materials: self.materials.iter().copied().map(MaterialEntry::from).collect(),
            accessors: &self.accessors,
            buffer_views: &self.views,
            buffers: [Buffer { byte_length: self.bytes.len() }],
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Root<'a> {
    asset: Asset,
    #[serde(skip_serializing_if = "Option::is_none")]
    extensions_used: Option<[&'static str; 1]>,
    scene: usize,
    scenes: [SceneEntry; 1],
    nodes: &'a [Node],
    meshes: &'a [MeshEntry],
    materials: Vec<MaterialEntry>,
    accessors: &'a [Accessor],
    buffer_views: &'a [BufferView],
    buffers: [Buffer; 1],
}

#[derive(Serialize)]
struct Asset {
    version: &'static str,
    generator: &'static str,
}

#[derive(Serialize)]
struct SceneEntry {
    name: &'static str,
    nodes: Vec<usize>,
}

#[derive(Serialize)]
struct Node {
    name: &'static str,
    mesh: usize,
}

#[derive(Serialize)]
struct MeshEntry {
    name: &'static str,
    primitives: [Primitive; 1],
}

#[derive(Serialize)]
struct Primitive {
    attributes: Attributes,
    indices: usize,
    material: usize,
}

#[derive(Serialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct MaterialEntry {
    name: &'static str,
    pbr_metallic_roughness: Surface,
    #[serde(skip_serializing_if = "Option::is_none")]
    emissive_factor: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extensions: Option<Extensions>,
    double_sided: bool,
}

#[derive(Serialize)]
struct Extensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    emissive_strength: EmissiveStrength,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct EmissiveStrength {
    emissive_strength: f64,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Surface {
    base_color_factor: [f64; 4],
    metallic_factor: f64,
    roughness_factor: f64,
}

impl From<Material> for MaterialEntry {
    fn from(material: Material) -> Self {
        let Material { name, albedo: [red, green, blue], emission } = material;
        let base_color_factor = [red, green, blue, 1.0];
        let surface = Surface { base_color_factor, metallic_factor: 0.0, roughness_factor: 1.0 };
        let strength = strength(&material);
        let emissive_factor = (emission != [0.0; 3]).then_some(emission.map(|channel| channel / strength));
        let emissive_strength = EmissiveStrength { emissive_strength: strength };
        let extensions = (strength > 1.0).then_some(Extensions { emissive_strength });
        Self { name, pbr_metallic_roughness: surface, emissive_factor, extensions, double_sided: false }
    }
}

/// What the factor of a material's emission is multiplied by, which is at most 1 by itself.
fn strength(material: &Material) -> f64 {
    material.emission.into_iter().fold(1.0, f64::max)
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<[f64; 3]>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    target: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    byte_length: usize,
}
