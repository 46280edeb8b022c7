//! Transforms of nodes, in f64: a matrix, or scale, then rotation, then translation.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::fault::{Checked, Fault, require};
use super::schema::Node;
use super::warnings::Warnings;

/// How far the last row of a matrix may be from 0 0 0 1.
const AFFINE: f64 = 1e-6;
/// How far the length of a quaternion may be from 1 without a warning.
const UNIT: f64 = 1e-2;

/// The transform from `node` to its parent; nothing if it shrinks the node to a point, which hides it.
pub fn local(node: &Node, warnings: &mut Warnings, place: impl Fn() -> String) -> Checked<Option<DAffine3>> {
    let has_parts = node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
    let transform = match &node.matrix {
        Some(_) if has_parts => {
            let finding = "has a matrix and also translation, rotation or scale";
            return Err(Fault::new(finding, "leave out the matrix or the others"));
        }
        Some(matrix) => from_matrix(matrix)?,
        None => from_parts(node, warnings, &place)?,
    };
    if transform.matrix3 == DMat3::ZERO {
        warnings.note("nodes of scale 0 are left out, with all nodes below them", place);
        return Ok(None);
    }
    finite(transform)?;
    Ok(Some(transform))
}

/// Whether a transform, perhaps a composed one, still is one.
pub fn finite(transform: DAffine3) -> Checked<()> {
    require(transform.is_finite(), || "its transform is not finite", "give finite numbers that are not too large")
}

/// Whether a transform turns right hands into left ones. One that flattens them, by a scale of 0 along an axis, turns
/// none.
pub fn mirrors(transform: DAffine3) -> bool {
    box_volume(transform.matrix3).is_some_and(|volume| volume < 0.0)
}

/// The signed volume between the directions of the axes after the transform, in [-1, 1]: without their lengths, so that
/// small scales do not count as flat.
fn box_volume(matrix: DMat3) -> Option<f64> {
    let axes = [direction(matrix.x_axis)?, direction(matrix.y_axis)?, direction(matrix.z_axis)?];
    Some(axes[0].cross(axes[1]).dot(axes[2]))
}

/// The direction of a vector; none if it is zero. Squares of its components may be too small or too large for f64.
pub fn direction(vector: DVec3) -> Option<DVec3> {
    (vector / vector.abs().max_element()).try_normalize()
}

fn from_matrix(columns: &[f64; 16]) -> Checked<DAffine3> {
    let matrix = DMat4::from_cols_array(columns);
    let row = matrix.row(3);
    let finding = || format!("the last row of its matrix is {:?}", row.to_array());
    let is_affine = (row - glam::DVec4::W).abs().max_element() <= AFFINE;
    require(is_affine, finding, "give 0 0 0 1: matrices are stored column by column")?;
    Ok(DAffine3::from_mat4(matrix))
}

fn from_parts(node: &Node, warnings: &mut Warnings, place: impl Fn() -> String) -> Checked<DAffine3> {
    let scale = DVec3::from(node.scale.unwrap_or([1.0; 3]));
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = DQuat::from_xyzw(x, y, z, w);
    let length = rotation.length();
    let finding = || format!("its rotation is {:?}", [x, y, z, w]);
    require(length > 0.0 && length.is_finite(), finding, "give a quaternion of length 1")?;
    if (length - 1.0).abs() > UNIT {
        warnings.note("rotations that are not unit quaternions are normalized", place);
    }
    let translation = DVec3::from(node.translation.unwrap_or_default());
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation / length, translation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_apply_in_order() {
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let node = Node {
            translation: Some([10.0, 0.0, 0.0]),
            rotation: Some([0.0, 0.0, half, half]), // a quarter turn from x to y
            scale: Some([2.0, 3.0, 4.0]),
            ..Node::default()
        };
        let transform = local(&node, &mut Warnings::default(), String::new).expect("valid").expect("visible");
        let point = transform.transform_point3(DVec3::ONE);
        assert!((point - DVec3::new(7.0, 2.0, 4.0)).length() < 1e-12, "{point}");
        assert!(!mirrors(transform));
    }

    #[test]
    fn small_scales_keep_their_hand() {
        assert!(mirrors(DAffine3::from_scale(DVec3::new(1e-200, -1e-200, 1e-200))));
        assert!(!mirrors(DAffine3::from_scale(DVec3::new(1e-200, -1e-200, -1e-200))));
        assert!(!mirrors(DAffine3::from_scale(DVec3::new(-1.0, 0.0, 1.0))));
    }
}
