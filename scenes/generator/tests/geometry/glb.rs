//! A strict reader of the files.

use glam::DVec3;
use serde_json::Value;

use crate::{scene::folder, surfaces::Surface};

/// A file, taken apart.
pub struct File {
    /// The first chunk.
    pub json: Value,
    /// The second chunk.
    pub bytes: Vec<u8>,
}

impl File {
    /// The file of a scene.
    pub fn read(name: &str) -> Self {
        let file = std::fs::read(folder(name).join(format!("{name}.glb"))).expect("a readable file");
        assert_eq!(&file[..4], b"glTF");
        assert_eq!(word(&file, 4), 2, "version");
        assert_eq!(word(&file, 8), file.len(), "length");
        let json = chunk(&file, 12, *b"JSON");
        let bytes = chunk(&file, 20 + json.len(), *b"BIN\0");
        assert_eq!(28 + json.len() + bytes.len(), file.len(), "nothing follows");
        Self { json: serde_json::from_slice(json).expect("JSON"), bytes: bytes.to_vec() }
    }

    /// All objects.
    pub fn surfaces(&self) -> Vec<Surface> {
        let nodes = self.json["nodes"].as_array().expect("nodes");
        nodes.iter().map(|node| self.surface(node)).collect()
    }

    fn surface(&self, node: &Value) -> Surface {
        let mesh = &self.json["meshes"][index(&node["mesh"])];
        let primitive = &mesh["primitives"][0];
        let material = &self.json["materials"][index(&primitive["material"])];
        let surface = &material["pbrMetallicRoughness"];
        assert_eq!((&surface["metallicFactor"], &surface["roughnessFactor"]), (&0.0.into(), &1.0.into()));
        assert_eq!(surface["baseColorFactor"][3], 1.0);
        let positions = self.positions(index(&primitive["attributes"]["POSITION"]));
        let indices = self.indices(index(&primitive["indices"]));
        assert!(indices.iter().all(|&index| index < positions.len()));
        let (triangles, rest) = indices.as_chunks();
        assert!(rest.is_empty());
        Surface {
            name: node["name"].as_str().expect("a name").to_owned(),
            albedo: [0, 1, 2].map(|i| surface["baseColorFactor"][i].as_f64().expect("a number")),
            emission: self.emission(material),
            double_sided: material["doubleSided"].as_bool().expect("a flag"),
            positions,
            triangles: triangles.to_vec(),
        }
    }

    /// The radiance of a material. Its factor is at most 1; an extension, which the file names, multiplies it.
    fn emission(&self, material: &Value) -> [f64; 3] {
        const STRENGTH: &str = "KHR_materials_emissive_strength";
        let factor = [0, 1, 2].map(|i| material["emissiveFactor"][i].as_f64().unwrap_or(0.0));
        assert!(factor.iter().all(|channel| (0.0..=1.0).contains(channel)), "{factor:?}");
        let strength = material["extensions"][STRENGTH]["emissiveStrength"].as_f64();
        assert!(strength.is_none() || self.json["extensionsUsed"][0] == STRENGTH);
        factor.map(|channel| channel * strength.unwrap_or(1.0))
    }

    fn positions(&self, accessor: usize) -> Vec<DVec3> {
        assert_eq!(self.json["accessors"][accessor]["componentType"], 5126);
        let numbers: Vec<f64> = self.elements(accessor, "VEC3", 34962, f32::from_le_bytes).map(f64::from).collect();
        numbers.as_chunks().0.iter().copied().map(DVec3::from_array).collect()
    }

    fn indices(&self, accessor: usize) -> Vec<usize> {
        match self.json["accessors"][accessor]["componentType"].as_u64() {
            Some(5123) => self.elements(accessor, "SCALAR", 34963, u16::from_le_bytes).map(usize::from).collect(),
            Some(5125) => {
                self.elements(accessor, "SCALAR", 34963, u32::from_le_bytes).map(|index| index as usize).collect()
            }
            other => panic!("indices of type {other:?}"),
        }
    }

    /// The components of an accessor, read by `decode`.
    fn elements<const N: usize, T>(
        &self,
        accessor: usize,
        kind: &str,
        target: usize,
        decode: fn([u8; N]) -> T,
    ) -> impl Iterator<Item = T> {
        let accessor = &self.json["accessors"][accessor];
        let view = &self.json["bufferViews"][index(&accessor["bufferView"])];
        let (offset, length) = (index(&view["byteOffset"]), index(&view["byteLength"]));
        assert_eq!(accessor["type"], kind);
        assert_eq!(index(&view["target"]), target);
        assert_eq!(offset % 4, 0, "aligned");
        let components = if kind == "VEC3" { 3 } else { 1 };
        assert_eq!(index(&accessor["count"]) * components * N, length, "the view holds its elements");
        self.bytes[offset..offset + length].as_chunks::<N>().0.iter().copied().map(decode)
    }
}

/// A number of things.
pub fn index(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is not a whole number")) as usize
}

fn chunk(file: &[u8], start: usize, kind: [u8; 4]) -> &[u8] {
    let length = word(file, start);
    assert_eq!(length % 4, 0, "chunks are whole words");
    assert_eq!(file[start + 4..start + 8], kind);
    &file[start + 8..start + 8 + length]
}

fn word(file: &[u8], start: usize) -> usize {
    let bytes = file[start..start + 4].try_into().expect("four bytes");
    u32::from_le_bytes(bytes) as usize
}
