//! glTF files made in the test that reads them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fogbow::error::Result;
use fogbow::gltf::{self, Model};
use serde_json::{Value, json};

/// Component types.
pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// Corners of a triangle with its front towards +z.
pub const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A file with one buffer, whose objects are added one by one.
pub struct Builder {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl Builder {
    pub fn new() -> Self {
        Self { json: json!({ "asset": { "version": "2.0" } }), binary: Vec::new() }
    }

    /// Adds an object to the list `kind`; its index.
    pub fn add(&mut self, kind: &str, object: Value) -> usize {
        if self.json[kind].is_null() {
            self.json[kind] = json!([]);
        }
        let list = self.json[kind].as_array_mut().expect("a list");
        list.push(object);
        list.len() - 1
    }

    /// Adds bytes to the buffer, and a view of them.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        self.binary.extend_from_slice(bytes);
        self.add("bufferViews", view)
    }

    /// Adds an accessor with a view of its own for `bytes`.
    pub fn accessor(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessor = json!({ "bufferView": view, "componentType": component, "type": shape, "count": count });
        self.add("accessors", accessor)
    }

    /// The same of fractions made of integers.
    pub fn normalized(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let accessor = self.accessor(component, shape, count, bytes);
        self.json["accessors"][accessor]["normalized"] = json!(true);
        accessor
    }

    /// Adds an accessor of vectors.
    pub fn floats<const N: usize>(&mut self, vectors: &[[f32; N]]) -> usize {
        let shape = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N];
        self.accessor(F32, shape, vectors.len(), &float_bytes(vectors))
    }

    /// Adds an accessor of 16-bit indices.
    pub fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.accessor(U16, "SCALAR", indices.len(), &bytes)
    }

    /// Adds a mesh of one primitive.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.add("meshes", json!({ "primitives": [primitive] }))
    }

    /// Adds a mesh of one triangle with these corners.
    pub fn triangle(&mut self, corners: [[f32; 3]; 3]) -> usize {
        let positions = self.floats(&corners);
        self.mesh(json!({ "attributes": { "POSITION": positions } }))
    }

    /// Adds a node with this mesh.
    pub fn place(&mut self, mesh: usize) -> usize {
        self.add("nodes", json!({ "mesh": mesh }))
    }

    /// Adds an image in the buffer, and a texture of it with the default sampler.
    pub fn texture(&mut self, image: &[u8]) -> usize {
        let view = self.view(image);
        let media_type = if image.starts_with(b"\xff") { "image/jpeg" } else { "image/png" };
        let source = self.add("images", json!({ "bufferView": view, "mimeType": media_type }));
        self.add("textures", json!({ "source": source }))
    }

    /// The JSON with the buffer as a data URI.
    pub fn embedded(&self) -> Value {
        let mut json = self.json.clone();
        if !self.binary.is_empty() {
            let uri = data_uri("application/octet-stream", &self.binary);
            json["buffers"] = json!([{ "uri": uri, "byteLength": self.binary.len() }]);
        }
        json
    }

    /// The file as JSON with a data URI.
    pub fn gltf(&self) -> Vec<u8> {
        self.embedded().to_string().into_bytes()
    }

    /// The file as a binary container.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if !self.binary.is_empty() {
            json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        glb(json.to_string().as_bytes(), &self.binary)
    }

    pub fn load(&self) -> Result<Model> {
        gltf::parse("test.glb", &self.glb(), None)
    }

    /// The model of a file that is right.
    pub fn model(&self) -> Model {
        self.load().unwrap_or_else(|error| panic!("{error}\n{}", self.json))
    }

    /// What is said about a file that is wrong.
    pub fn error(&self) -> String {
        self.load().err().unwrap_or_else(|| panic!("accepted: {}", self.json)).to_string()
    }
}

/// The warnings of a model, without the name of its file.
pub fn warnings(model: &Model) -> Vec<String> {
    let line = |warning: &fogbow::warning::Warning| warning.to_string().replacen("test.glb: ", "", 1);
    model.warnings.iter().map(line).collect()
}

/// A binary container of `json` and `binary`.
pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut chunks = chunk(b"JSON", json, b' ');
    chunks.extend(chunk(b"BIN\0", binary, 0));
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((12 + chunks.len() as u32).to_le_bytes());
    file.extend(chunks);
    file
}

fn chunk(kind: &[u8; 4], content: &[u8], padding: u8) -> Vec<u8> {
    let length = content.len().next_multiple_of(4);
    let mut chunk = (length as u32).to_le_bytes().to_vec();
    chunk.extend(kind);
    chunk.extend(content);
    chunk.resize(8 + length, padding);
    chunk
}

pub fn data_uri(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", STANDARD.encode(bytes))
}

pub fn float_bytes<const N: usize>(vectors: &[[f32; N]]) -> Vec<u8> {
    vectors.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

/// A PNG file.
pub fn png(width: u32, height: u32, color: png::ColorType, depth: png::BitDepth, rows: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().expect("a header").write_image_data(rows).expect("all rows");
    bytes
}

/// A PNG file of red, green and blue bytes.
pub fn rgb(width: u32, height: u32, texels: &[[u8; 3]]) -> Vec<u8> {
    png(width, height, png::ColorType::Rgb, png::BitDepth::Eight, texels.as_flattened())
}

/// Corners of all triangles, as positions.
pub fn corners(model: &Model) -> Vec<[[f32; 3]; 3]> {
    let position = |corner: u32| model.positions[corner as usize];
    model.triangles.iter().map(|triangle| triangle.corners.map(position)).collect()
}

/// The normal of a triangle, of the side that its corners run round counterclockwise.
pub fn normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = [a, b, c].map(glam::Vec3::from);
    (b - a).cross(c - a).normalize().to_array()
}

/// Whether all numbers are the same up to rounding.
pub fn near<const N: usize>(a: [f32; N], b: [f32; N]) -> bool {
    a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5)
}

/// A file with an object of every kind that is read, for tests that break it.
pub fn everything() -> Builder {
    let mut file = Builder::new();
    let texture = file.texture(&rgb(2, 2, &[[0, 64, 255], [255; 3], [128, 0, 0], [0; 3]]));
    let photograph = file.texture(&super::textures::jpeg(super::textures::JPEGS[0].0));
    file.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648 }]);
    file.json["textures"][texture]["sampler"] = json!(0);
    let transform = json!({ "offset": [0.5, 0.25], "rotation": 0.3, "scale": [2, 4] });
    let info = json!({ "index": texture, "extensions": { "KHR_texture_transform": transform } });
    file.json["materials"] = json!([{
        "name": "Paint",
        "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorFactor": [0.1, 0.5, 0.9, 1], "baseColorTexture": info },
        "emissiveFactor": [1, 0.5, 0],
        "emissiveTexture": { "index": photograph },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 30 } },
    }]);
    let positions = file.floats(&[TRIANGLE[0], TRIANGLE[1], TRIANGLE[2], [1.0, 1.0, 0.0]]);
    let texcoords = file.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    let colors = file.normalized(U8, "VEC4", 4, &[255; 16]);
    let indices = file.indices(&[0, 1, 2, 2, 1, 3]);
    let [places, values] = [file.view(&[1, 3]), file.view(&float_bytes(&[[2.0, 0.0, 0.0], [2.0, 1.0, 0.0]]))];
    let moved = file.floats(&[TRIANGLE[0], TRIANGLE[1], TRIANGLE[2], [1.0, 1.0, 0.0]]);
    file.json["accessors"][moved]["sparse"] = json!({
        "count": 2,
        "indices": { "bufferView": places, "componentType": U8 },
        "values": { "bufferView": values },
    });
    let attributes = json!({ "POSITION": positions, "TEXCOORD_0": texcoords, "COLOR_0": colors });
    let primitives = json!([
        { "attributes": attributes, "indices": indices, "material": 0 },
        { "attributes": { "POSITION": moved }, "mode": 5 },
    ]);
    file.json["meshes"] = json!([{ "name": "Wall", "primitives": primitives }]);
    file.json["cameras"] = json!([{ "name": "Eye", "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5 } }]);
    let spot = json!({ "innerConeAngle": 0.1, "outerConeAngle": 0.5 });
    let light = json!({ "name": "Lamp", "type": "spot", "spot": spot, "color": [1, 1, 1], "intensity": 3 });
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
    file.json["nodes"] = json!([
        { "name": "Root", "children": [1, 2], "rotation": [0, 0, 0, 1] },
        { "mesh": 0, "scale": [1, 1, -1] },
        { "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },
    ]);
    file.json["scenes"] = json!([{ "nodes": [0, 3] }]);
    file.json["extensionsUsed"] =
        json!(["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_texture_transform"]);
    file
}

/// Accessors of [`everything`].
pub const POSITIONS: usize = 0;
pub const TEXCOORDS: usize = 1;
pub const COLORS: usize = 2;
pub const INDICES: usize = 3;
pub const MOVED: usize = 4;
