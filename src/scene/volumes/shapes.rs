//! Shapes of volumes: balls, boxes and meshes, from their keys.

use fogbow_kernels::media::field::Shape;
use glam::DVec3;

use super::Volume;
use crate::error::Result;
use crate::scene::ranges::LARGEST;
use crate::scene::schema::{self, ShapeKind};

/// Shortest edge of a box, and smallest radius of a sphere `[m]`.
const SMALLEST_EDGE: f64 = 1e-6;
/// What to do about the radius of a sphere.
const A_RADIUS: &str = "give a radius from 1e-6 to 1e9 m";

impl Volume<'_> {
    /// The shape of these keys; none if it is a mesh that a scale of 0 hides.
    pub(super) fn shape(&self, shape: &schema::Shape, origin: DVec3) -> Result<Option<Shape>> {
        let schema::Shape { kind, min, max, center, radius, name } = shape;
        let given = [
            ("min", min.is_some(), kind == &ShapeKind::Box, "give the corner with the smallest coordinates, [x, y, z]"),
            ("max", max.is_some(), kind == &ShapeKind::Box, "give the corner with the largest coordinates, [x, y, z]"),
            ("center", center.is_some(), kind == &ShapeKind::Sphere, "give the position of its centre, [x, y, z]"),
            ("radius", radius.is_some(), kind == &ShapeKind::Sphere, A_RADIUS),
            ("name", name.is_some(), kind == &ShapeKind::Mesh, "give the name of a closed mesh of the geometry"),
        ];
        for (key, given, wanted, remedy) in given {
            let (what, remedy) = if wanted { ("missing", remedy) } else { ("given", "leave it out") };
            let finding = format!("{what}: the shape is a {}", kind.name());
            self.require(given == wanted, &format!("shape.{key}"), finding, remedy)?;
        }
        let remedy = "give three finite coordinates from -1e9 to 1e9 m";
        for (key, point) in [("shape.min", min), ("shape.max", max), ("shape.center", center)] {
            let ok = point.is_none_or(|point| point.iter().all(|x| x.abs() <= LARGEST));
            self.require(ok, key, format!("{:?}", point.unwrap_or_default()), remedy)?;
        }
        Ok(Some(match kind {
            ShapeKind::Box => self.block(min.unwrap_or_default(), max.unwrap_or_default(), origin)?,
            ShapeKind::Sphere => {
                let radius = radius.unwrap_or_default();
                let ok = (SMALLEST_EDGE..=LARGEST).contains(&radius);
                self.require(ok, "shape.radius", format!("{radius:?}"), A_RADIUS)?;
                Shape::Sphere { center: DVec3::from(center.unwrap_or_default()) - origin, radius }
            }
            ShapeKind::Mesh => return Ok(self.boundary.clone().map(Shape::Mesh)),
        }))
    }

    /// A box.
    fn block(&self, min: [f64; 3], max: [f64; 3], origin: DVec3) -> Result<Shape> {
        let ok = (0..3).all(|axis| max[axis] - min[axis] >= SMALLEST_EDGE);
        let remedy = "make each of its coordinates larger than that of min by 1e-6 m or more";
        self.require(ok, "shape.max", format!("{max:?}, where min is {min:?}"), remedy)?;
        Ok(Shape::block([min, max].map(|corner| (DVec3::from(corner) - origin).to_array())))
    }
}
