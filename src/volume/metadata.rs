//! What a file says about its grids in words and numbers. None of it is needed to read voxels, except for half floats.

use super::input::Input;
use crate::gltf::fault::Checked;

/// What is of interest. Programs may leave out any of it.
#[derive(Clone, Debug, Default)]
pub struct Metadata {
    /// `fog volume`, `level set` or `staggered`.
    pub class: Option<String>,
    /// Whether values are saved as half floats.
    pub is_half: bool,
    /// First and last active voxel along every axis.
    pub first: Option<[i32; 3]>,
    pub last: Option<[i32; 3]>,
    /// Number of active voxels.
    pub active_voxels: Option<i64>,
}

impl Metadata {
    /// Reads entries of name, type, size and value; those that are of no interest are passed over.
    pub fn read(input: &mut Input) -> Checked<Self> {
        let mut metadata = Self::default();
        for _ in 0..input.u32()? {
            let [name, kind] = [input.text()?, input.text()?];
            let size = input.u32()?;
            let end = input.position().saturating_add(size.into());
            match (name.as_str(), kind.as_str(), size) {
                ("class", "string", _) => metadata.class = Some(input.text_of(size)?),
                ("is_saved_as_half_float", "bool", 1) => metadata.is_half = input.u8()? != 0,
                ("file_bbox_min", "vec3i", 12) => metadata.first = Some(input.coordinates()?),
                ("file_bbox_max", "vec3i", 12) => metadata.last = Some(input.coordinates()?),
                ("file_voxel_count", "int64", 8) => metadata.active_voxels = Some(input.i64()?),
                _ => {}
            }
            input.seek(end)?;
        }
        Ok(metadata)
    }
}
