//! Affine maps between the world, cells, and what a volume's shape and voxels count in.

use glam::{DAffine3, DMat3, DVec3};
use wide::f32x8;

use crate::vec3::Vec3x8;

/// An affine map: three rows, rounded to f32, for kernels and twins alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map([[f32; 4]; 3]);

impl Map {
    /// A map as kernels apply it.
    pub fn new(map: &DAffine3) -> Self {
        let columns = map.matrix3.to_cols_array_2d();
        let moved = map.translation.to_array();
        Self([0, 1, 2].map(|row| [columns[0][row], columns[1][row], columns[2][row], moved[row]].map(|x| x as f32)))
    }

    /// Hands the map to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        self.0.as_flattened().iter().for_each(|entry| digest(&entry.to_le_bytes()));
    }

    /// Where points are.
    #[inline(always)]
    pub fn points(&self, at: Vec3x8) -> Vec3x8 {
        self.apply(at, 1.0)
    }

    /// Where directions go.
    #[inline(always)]
    pub fn directions(&self, way: Vec3x8) -> Vec3x8 {
        self.apply(way, 0.0)
    }

    #[inline(always)]
    fn apply(&self, v: Vec3x8, homogeneous: f32) -> Vec3x8 {
        let [x, y, z] = self.0.map(|[a, b, c, d]| {
            let [a, b, c, d] = [a, b, c, d * homogeneous].map(f32x8::splat);
            a.mul_add(v.x, b.mul_add(v.y, c.mul_add(v.z, d)))
        });
        Vec3x8::new(x, y, z)
    }

    /// Most by which a step of length 1 moves along one axis.
    pub fn steepest(&self) -> f64 {
        let rows = self.0.map(|[a, b, c, _]| DVec3::new(f64::from(a), f64::from(b), f64::from(c)).length());
        rows.into_iter().fold(0.0, f64::max)
    }

    /// Longest step that moves by 1 along one axis and not along the others.
    pub fn longest(&self) -> f64 {
        let inverse = from_rows(&self.0.map(|row| row.map(f64::from))).matrix3.inverse();
        [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max)
    }

    /// Where a point is, for twins.
    pub fn point(&self, at: DVec3) -> DVec3 {
        DVec3::from(self.0.map(|row| {
            let [a, b, c, d] = row.map(f64::from);
            a * at.x + b * at.y + c * at.z + d
        }))
    }

    /// Where a direction goes, for twins.
    pub fn direction(&self, way: DVec3) -> DVec3 {
        self.point(way) - self.point(DVec3::ZERO)
    }
}

/// The map of these rows.
pub fn from_rows(rows: &[[f64; 4]; 3]) -> DAffine3 {
    let matrix = DMat3::from_cols_array_2d(&[0, 1, 2].map(|column| [0, 1, 2].map(|row: usize| rows[row][column])));
    DAffine3 { matrix3: matrix, translation: DVec3::from([0, 1, 2].map(|row: usize| rows[row][3])) }
}

/// The axis-aligned box around the image of a box.
pub fn image(map: &DAffine3, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let corner =
        |i: u32| DVec3::from([0, 1, 2].map(|axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] }));
    let corners = (0..8).map(|i| map.transform_point3(corner(i)));
    corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}
