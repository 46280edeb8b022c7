//! Vertices and triangles: of a mesh in its own space, or of all in world space.

use glam::{DAffine3, DVec3, Vec3};

use super::fault::{Checked, Fault};
use super::model::Triangle;
use super::transforms;

/// Vertices and the triangles between them. Texture coordinates and colours are there for all vertices or for none.
#[derive(Debug, Default)]
pub struct Geometry {
    pub positions: Vec<[f32; 3]>,
    pub texcoords: [Vec<[f32; 2]>; 2],
    pub colors: Vec<[f32; 3]>,
    pub triangles: Vec<Triangle>,
}

/// Largest coordinate in world space `[m]`: squares of distances stay far inside f32.
pub const LARGEST_COORDINATE: f64 = 1e9;
/// Texture coordinates of vertices that have none.
const NO_TEXCOORDS: [f32; 2] = [0.0; 2];
/// Colour of vertices that have none.
const WHITE: [f32; 3] = [1.0; 3];

impl Geometry {
    /// Adds vertices with their attributes; who has none gets the default as soon as another has some.
    pub fn add_vertices(
        &mut self,
        positions: &[[f32; 3]],
        texcoords: [Option<&[[f32; 2]]>; 2],
        colors: Option<&[[f32; 3]]>,
    ) {
        let before = self.positions.len();
        self.positions.extend_from_slice(positions);
        let after = self.positions.len();
        for (all, added) in self.texcoords.iter_mut().zip(texcoords) {
            extend(all, added, before, after, NO_TEXCOORDS);
        }
        extend(&mut self.colors, colors, before, after, WHITE);
    }

    /// Adds `mesh` transformed by `world` and counted from `origin`. Mirrors turn the winding round, so that the front
    /// stays the front.
    pub fn add_instance(&mut self, mesh: &Self, world: DAffine3, origin: DVec3) -> Checked<()> {
        let world = DAffine3 { translation: world.translation - origin, ..world };
        let first = self.positions.len();
        let texcoords = [0, 1].map(|set| some(&mesh.texcoords[set]));
        self.add_vertices(&mesh.positions, texcoords, some(&mesh.colors));
        for position in &mut self.positions[first..] {
            *position = world.transform_point3(Vec3::from(*position).as_dvec3()).as_vec3().to_array();
        }
        let moved = &self.positions[first..];
        let near = |position: &[f32; 3]| position.iter().all(|x| f64::from(x.abs()) <= LARGEST_COORDINATE);
        if let Some(vertex) = moved.iter().position(|position| !near(position)) {
            let finding = format!("puts vertex {:?} at {:?}", mesh.positions[vertex], moved[vertex]);
            return Err(Fault::new(finding, "give smaller positions or transforms: coordinates may be at most 1e9 m"));
        }
        let mirrored = transforms::mirrors(world);
        self.triangles.extend(mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.corners.map(|corner| corner + first as u32);
            Triangle { corners: if mirrored { [a, c, b] } else { [a, b, c] }, ..*triangle }
        }));
        Ok(())
    }
}

fn some<T>(values: &[T]) -> Option<&[T]> {
    (!values.is_empty()).then_some(values)
}

/// Adds `added` to the values of the first `before` vertices; `after` is how many vertices there are then.
fn extend<T: Copy>(all: &mut Vec<T>, added: Option<&[T]>, before: usize, after: usize, default: T) {
    match added {
        Some(added) => {
            all.resize(before, default);
            all.extend_from_slice(added);
        }
        None if all.is_empty() => {}
        None => all.resize(after, default),
    }
}
