//! What a file says about a grid.

use glam::{DAffine3, DMat3, DVec3};

use super::archive::Entry;
use super::grid::obstacle;

/// Cosine between edges up to which they are at right angles.
const STRAIGHT: f64 = 1e-6;

/// What a file says about one of its grids, before any voxel is read. Programs may leave out counts and bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSummary {
    /// What the file calls it. Of grids that share a name, OpenVDB's number follows: `density[1]`.
    pub name: String,
    /// The type of its values: `float` for densities; `int32`, `vec3s` and others cannot be read.
    pub value_type: String,
    /// What values mean: `fog volume`, `level set`, `staggered` or `unknown`.
    pub class: String,
    /// How values are packed: `none`, `zip`, `blosc`, and `active values` if inactive ones are left out.
    pub compression: String,
    /// Whether values are saved as half floats.
    pub is_half: bool,
    /// Index coordinates of the first and the last active voxel along every axis; none if there are no voxels.
    pub index_bounds: Option<[[i32; 3]; 2]>,
    /// How many voxels are active, in leaves and in constant regions.
    pub active_voxels: Option<u64>,
    /// OpenVDB's name for the kind of its transform, for example `UniformScaleMap`.
    pub transform: String,
    /// World metres of index coordinates; none if the transform cannot be used.
    pub index_to_world: Option<DAffine3>,
    /// Why the grid cannot be read, as far as that is known before its voxels are; none if it can.
    pub obstacle: Option<String>,
}

impl GridSummary {
    /// What the file says about `entry`.
    pub(super) fn of(entry: &Entry) -> Self {
        let metadata = &entry.metadata;
        let bounds = metadata.first.zip(metadata.last).map(|(first, last)| [first, last]);
        Self {
            name: entry.name.clone(),
            value_type: entry.value_type().into(),
            class: metadata.class.clone().unwrap_or_else(|| "unknown".into()),
            compression: compression(entry.compression),
            is_half: entry.is_half,
            index_bounds: bounds.filter(|[first, last]| (0..3).all(|axis| first[axis] <= last[axis])),
            active_voxels: metadata.active_voxels.and_then(|count| count.try_into().ok()),
            transform: entry.map.name.clone(),
            index_to_world: entry.map.affine().ok(),
            obstacle: obstacle(entry).map(|fault| fault.finding().into()),
        }
    }

    /// Bits of the value of a voxel, in memory; none if values of this type are not known.
    pub fn bits_per_voxel(&self) -> Option<u64> {
        Some(match self.value_type.as_str() {
            "bool" | "mask" => 1,
            "float" | "int32" => 32,
            "double" | "int64" => 64,
            "vec3s" | "vec3i" => 96,
            "vec3d" => 192,
            _ => return None,
        })
    }

    /// Lengths of a voxel's edges `[m]`.
    pub fn voxel_size(&self) -> Option<[f64; 3]> {
        let matrix = self.index_to_world?.matrix3;
        Some([matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::length))
    }

    /// How its voxels lie where their edges are not along the axes of the world: `turned`, or `sheared` where these are at
    /// no right angles, either.
    pub fn slant(&self) -> Option<&'static str> {
        slant(self.index_to_world?.matrix3)
    }

    /// The smallest box `[m]` around all active voxels, each of which reaches half an edge beyond its centre: smallest
    /// and largest coordinates.
    pub fn world_bounds(&self) -> Option<[[f64; 3]; 2]> {
        let (bounds, map) = (self.index_bounds?, self.index_to_world?);
        let [first, last] = bounds.map(|corner| DVec3::from(corner.map(f64::from)));
        let [first, last] = [first - 0.5, last + 0.5];
        let corners = (0..8).map(|corner| {
            let choose = |axis: usize| if corner >> axis & 1 == 0 { first[axis] } else { last[axis] };
            map.transform_point3(DVec3::new(choose(0), choose(1), choose(2)))
        });
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let around = corners.fold(none, |[min, max], corner| [min.min(corner), max.max(corner)]);
        Some(around.map(|corner| corner.to_array()))
    }
}

/// Words for the bits of a compression, as OpenVDB has them.
fn compression(bits: u32) -> String {
    let words = [(1, "zip"), (4, "blosc"), (2, "active values")];
    let words: Vec<_> = words.into_iter().filter(|(bit, _)| bits & bit != 0).map(|(_, word)| word).collect();
    if words.is_empty() { "none".into() } else { words.join(" + ") }
}

/// [`GridSummary::slant`] of the edges of a voxel.
fn slant(matrix: DMat3) -> Option<&'static str> {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::normalize_or_zero);
    let is_sheared = [x.dot(y), y.dot(z), z.dot(x)].iter().any(|cosine| cosine.abs() > STRAIGHT);
    let is_turned = [x, y, z].iter().any(|edge| edge.abs().max_element() < 1.0 - STRAIGHT);
    if is_sheared { Some("sheared") } else { is_turned.then_some("turned") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_lie_along_the_axes_or_aslant() {
        let scaled = |turn: DMat3| slant(turn * DMat3::from_diagonal(DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!(scaled(DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(1.0)), Some("turned"));
        assert_eq!(scaled(DMat3::from_rotation_z(-core::f64::consts::FRAC_PI_2)), None);
        assert_eq!(scaled(DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0))), None);
        assert_eq!(scaled(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.2, 0.0, 1.0))), Some("sheared"));
    }
}
