//! Primitives: what they are made of, and how lists, strips and fans become triangles.

use super::document::{DRACO, remedy};
use super::fault::{At, Checked, Fault, entry, quoted, require};
use super::schema::{self, Primitive};
use super::vertices::{Attributes, Reader};
use super::warnings::Warnings;

/// How a primitive joins its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    List,
    Strip,
    Fan,
}

/// A primitive of triangles.
#[derive(Debug)]
pub struct Plan<'a> {
    /// Its index in the mesh.
    pub index: usize,
    pub primitive: &'a Primitive,
    pub mode: Mode,
    pub attributes: Attributes,
    /// Index of its material; as many as there are stands for the default material.
    pub material: u32,
    /// The number of its vertices.
    pub vertices: usize,
    /// The number of its triangles.
    pub triangles: usize,
}

/// Sets of texture coordinates that a material uses.
pub type UsedSets = [bool; 2];

/// What plans are made from.
#[derive(Debug)]
pub struct Planner<'a> {
    pub reader: Reader<'a>,
    pub materials: &'a [schema::Material],
    /// The sets of each material.
    pub used_sets: Vec<UsedSets>,
}

impl<'a> Planner<'a> {
    /// The plan for `primitive`, the `index`th of its mesh; none if it has no triangles.
    pub fn plan(
        &self,
        index: usize,
        primitive: &'a Primitive,
        warnings: &mut Warnings,
        place: impl Fn() -> String,
    ) -> Checked<Option<Plan<'a>>> {
        let Some(mode) = mode(primitive)? else {
            warnings.note("points and lines are left out", place);
            return Ok(None);
        };
        if !primitive.targets.is_empty() {
            warnings.note("morph targets are ignored; meshes keep their base shape", &place);
        }
        let (material, used) = self.material(primitive)?;
        let attributes = attributes(primitive, used)?;
        self.require_data(primitive, &attributes)?;
        if used.iter().zip(&attributes.texcoords).any(|(used, texcoords)| *used && texcoords.is_none()) {
            let finding = "texture coordinates for a texture of the material are missing; (0, 0) is used";
            warnings.note(finding, &place);
        }
        let vertices = self.reader.position_elements(&attributes)?.count;
        let corners = self.reader.index_elements(primitive)?.map_or(vertices, |indices| indices.count);
        let triangles = mode.triangles(corners);
        if mode.corners(triangles) != corners {
            warnings.note("vertices that do not complete a triangle are left out", place);
        }
        Ok(Some(Plan { index, primitive, mode, attributes, material, vertices, triangles }))
    }

    /// Whether positions stand in the file as they are: those of accessors without data, otherwise zeros, may be
    /// compressed.
    fn require_data(&self, primitive: &Primitive, attributes: &Attributes) -> Checked<()> {
        let positions = self.reader.accessors.accessors.get(attributes.positions);
        let absent = positions.is_some_and(|accessor| accessor.buffer_view.is_none() && accessor.sparse.is_none());
        let finding = || format!("its positions are only in {}, which is not supported", quoted(DRACO));
        require(!absent || !primitive.extensions.contains_key(DRACO), finding, remedy(DRACO))
    }

    /// The index of the material and the sets of texture coordinates that it uses.
    fn material(&self, primitive: &Primitive) -> Checked<(u32, UsedSets)> {
        let Some(material) = primitive.material else {
            return Ok((self.materials.len() as u32, UsedSets::default()));
        };
        entry(self.materials, "material", material)?;
        Ok((material as u32, self.used_sets[material]))
    }
}

fn mode(primitive: &Primitive) -> Checked<Option<Mode>> {
    match primitive.mode {
        None | Some(4) => Ok(Some(Mode::List)),
        Some(5) => Ok(Some(Mode::Strip)),
        Some(6) => Ok(Some(Mode::Fan)),
        Some(0..=3) => Ok(None),
        Some(other) => Err(Fault::new(format!("its mode is {other}"), "give a mode from 0 to 6; 4 is triangles")),
    }
}

fn attributes(primitive: &Primitive, used: UsedSets) -> Checked<Attributes> {
    let attribute = |name: &str| primitive.attributes.get(name).copied();
    let Some(positions) = attribute("POSITION") else {
        return Err(Fault::new("has no POSITION", "give every primitive a POSITION attribute"));
    };
    let texcoords = [attribute("TEXCOORD_0").filter(|_| used[0]), attribute("TEXCOORD_1").filter(|_| used[1])];
    Ok(Attributes { positions, texcoords, colors: attribute("COLOR_0") })
}

impl Mode {
    /// Whole triangles of `corners` vertices.
    fn triangles(self, corners: usize) -> usize {
        match self {
            Self::List => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// Vertices that `triangles` triangles take.
    fn corners(self, triangles: usize) -> usize {
        match self {
            _ if triangles == 0 => 0,
            Self::List => 3 * triangles,
            Self::Strip | Self::Fan => triangles + 2,
        }
    }

    /// Calls `each` with the corners of all triangles of `indices`, in the order of the glTF specification.
    pub fn for_each_triangle(self, indices: &[u32], mut each: impl FnMut([u32; 3])) {
        match self {
            Self::List => indices.as_chunks().0.iter().for_each(|corners| each(*corners)),
            // Every other triangle of a strip runs the other way; two corners change places to make up for it.
            Self::Strip => indices.windows(3).enumerate().for_each(|(index, corners)| match index % 2 {
                0 => each([corners[0], corners[1], corners[2]]),
                _ => each([corners[0], corners[2], corners[1]]),
            }),
            Self::Fan => {
                let first = indices.first().copied().unwrap_or(0);
                indices.windows(2).skip(1).for_each(|edge| each([edge[0], edge[1], first]));
            }
        }
    }
}

/// Whether the mesh has primitives at all.
pub fn require_primitives(mesh: &schema::Mesh) -> Checked<()> {
    require(!mesh.primitives.is_empty(), || "is empty", "give the mesh at least one primitive").at(|| "primitives")
}
