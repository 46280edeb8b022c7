//! Meshes: read once each, then put wherever nodes want them.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::DVec3;

use super::fault::{At, Checked, entry, label};
use super::geometry::Geometry;
use super::limits::Limits;
use super::model::{Instance, Triangle};
use super::nodes::Placed;
use super::primitives::{Plan, Planner, require_primitives};
use super::schema::Mesh;
use super::vertices::Attributes;
use super::warnings::Warnings;

/// A mesh of the scene, before its values are read.
#[derive(Debug)]
struct Planned<'a> {
    index: usize,
    mesh: &'a Mesh,
    plans: Vec<Plan<'a>>,
    /// The nodes that it hangs on.
    nodes: Vec<&'a Placed<'a>>,
}

impl Planned<'_> {
    fn label(&self) -> String {
        mesh_label(self.index, self.mesh)
    }

    /// Triangles of all instances.
    fn triangles(&self) -> u64 {
        self.all_instances(self.plans.iter().map(|plan| plan.triangles))
    }

    /// Vertices of all instances; primitives with the same attributes share them.
    fn vertices(&self) -> u64 {
        let mut seen = HashSet::new();
        let distinct = self.plans.iter().filter(|plan| seen.insert(plan.attributes));
        self.all_instances(distinct.map(|plan| plan.vertices))
    }

    fn all_instances(&self, counts: impl Iterator<Item = usize>) -> u64 {
        let once = counts.fold(0u64, |sum, count| sum.saturating_add(count as u64));
        once.saturating_mul(self.nodes.len() as u64)
    }
}

fn mesh_label(index: usize, mesh: &Mesh) -> String {
    label("mesh", index, mesh.name.as_deref())
}

/// The triangles of all `placed` nodes in world space, counted from `origin`, mesh by mesh.
pub fn flatten(
    meshes: &[Mesh],
    placed: &[Placed<'_>],
    origin: DVec3,
    planner: &Planner<'_>,
    limits: Limits,
    warnings: &mut Warnings,
) -> Checked<(Geometry, Vec<Instance>)> {
    let mut all = Geometry::default();
    let mut instances = Vec::new();
    let planned = plan(meshes, placed, planner, warnings)?;
    check_size(&planned, limits)?;
    for planned in &planned {
        let mesh = read(planned, planner, warnings).at(|| planned.label())?;
        reserve(&mut all, &mesh, planned.nodes.len());
        for placed in &planned.nodes {
            let first = all.triangles.len() as u32;
            all.add_instance(&mesh, placed.world, origin).at(|| planned.label()).at(|| placed.label())?;
            let triangles = first..all.triangles.len() as u32;
            if !triangles.is_empty() {
                let (node, mesh) = (placed.index as u32, planned.mesh.name.clone());
                instances.push(Instance { node, name: name(placed, planned), mesh, triangles });
            }
        }
    }
    Ok((all, instances))
}

fn name(placed: &Placed<'_>, planned: &Planned<'_>) -> String {
    let name = placed.node.name.as_ref().or(planned.mesh.name.as_ref());
    name.cloned().unwrap_or_else(|| label("mesh", planned.index, None))
}

/// All meshes on `placed` nodes, in the order of the file.
fn plan<'a>(
    meshes: &'a [Mesh],
    placed: &'a [Placed<'a>],
    planner: &Planner<'a>,
    warnings: &mut Warnings,
) -> Checked<Vec<Planned<'a>>> {
    let mut nodes: BTreeMap<usize, Vec<&Placed<'_>>> = BTreeMap::new();
    for placed in placed {
        let Some(mesh) = placed.node.mesh else {
            continue;
        };
        entry(meshes, "mesh", mesh).at(|| placed.label())?;
        if placed.node.skin.is_some() {
            let finding = "skins are ignored; meshes keep their bind pose and, unlike in glTF, their node's transform";
            warnings.note(finding, || placed.label());
        }
        nodes.entry(mesh).or_default().push(placed);
    }
    let plan_one = |(index, nodes)| {
        let mesh: &Mesh = &meshes[index];
        let plans = plan_mesh(index, mesh, planner, warnings).at(|| mesh_label(index, mesh))?;
        Ok(Planned { index, mesh, plans, nodes })
    };
    nodes.into_iter().map(plan_one).collect()
}

fn plan_mesh<'a>(
    index: usize,
    mesh: &'a Mesh,
    planner: &Planner<'a>,
    warnings: &mut Warnings,
) -> Checked<Vec<Plan<'a>>> {
    require_primitives(mesh)?;
    let mut plans = Vec::with_capacity(mesh.primitives.len());
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let place = || format!("{}, primitive {number}", mesh_label(index, mesh));
        plans.extend(planner.plan(number, primitive, warnings, place).at(|| label("primitive", number, None))?);
    }
    Ok(plans)
}

/// Whether the scene is small enough, before memory is taken for it.
fn check_size(planned: &[Planned<'_>], limits: Limits) -> Checked<()> {
    let triangles = planned.iter().map(Planned::triangles).fold(0, u64::saturating_add);
    let vertices = planned.iter().map(Planned::vertices).fold(0, u64::saturating_add);
    limits.elements(triangles, "triangles").at(|| "scene")?;
    limits.elements(vertices, "vertices").at(|| "scene")
}

/// Makes room for `count` instances of `mesh`.
fn reserve(all: &mut Geometry, mesh: &Geometry, count: usize) {
    all.positions.reserve(count * mesh.positions.len());
    all.triangles.reserve(count * mesh.triangles.len());
}

/// The first vertices of primitives, by what they are made of: primitives often share vertices and differ in indices.
type FirstVertices = HashMap<Attributes, u32>;

/// The mesh in its own space.
fn read(planned: &Planned<'_>, planner: &Planner<'_>, warnings: &mut Warnings) -> Checked<Geometry> {
    let mut mesh = Geometry::default();
    let mut first_vertices = FirstVertices::new();
    for plan in &planned.plans {
        let place = || label("primitive", plan.index, None);
        let warn = || {
            let finding = "vertex colours outside 0 to 1 are clamped";
            warnings.note(finding, || format!("{}, {}", planned.label(), place()));
        };
        read_primitive(&mut mesh, &mut first_vertices, plan, planner, warn).at(place)?;
    }
    Ok(mesh)
}

fn read_primitive(
    mesh: &mut Geometry,
    first_vertices: &mut FirstVertices,
    plan: &Plan<'_>,
    planner: &Planner<'_>,
    warn: impl FnOnce(),
) -> Checked<()> {
    let first = match first_vertices.get(&plan.attributes) {
        Some(first) => *first,
        None => read_vertices(mesh, plan, planner, warn)?,
    };
    first_vertices.insert(plan.attributes, first);
    let indices = planner.reader.indices(plan.primitive, plan.vertices)?;
    mesh.triangles.reserve(plan.triangles);
    plan.mode.for_each_triangle(&indices, |corners| {
        let corners = corners.map(|corner| corner + first);
        mesh.triangles.push(Triangle { corners, material: plan.material });
    });
    Ok(())
}

/// Adds the vertices of `plan` to `mesh`; the index of the first of them. `warn` is called if colours are clamped.
fn read_vertices(mesh: &mut Geometry, plan: &Plan<'_>, planner: &Planner<'_>, warn: impl FnOnce()) -> Checked<u32> {
    let Planner { reader, .. } = planner;
    let (attributes, count) = (&plan.attributes, plan.vertices);
    let first = mesh.positions.len() as u32;
    let texcoords = [reader.texcoords(attributes, 0, count)?, reader.texcoords(attributes, 1, count)?];
    let colors = reader.colors(attributes, count, warn)?;
    let texcoords = texcoords.each_ref().map(Option::as_deref);
    mesh.add_vertices(&reader.positions(attributes)?, texcoords, colors.as_deref());
    Ok(first)
}
