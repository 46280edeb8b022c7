//! Closed meshes of the scene's glTF file that bound volumes.
//!
//! A boundary is no surface: light passes it as if nothing were there, so that its triangles leave the model.

mod open;
mod thickness;

use fogbow_kernels::media::closed_mesh::{ClosedMesh, OpenMesh};
use glam::DVec3;

use super::document::Document;
use super::model::{Loaded, list};
use crate::error::{Error, Result};
use crate::gltf::{Instance, Model, label, quoted};

/// Most triangles of a boundary: its columns hold about seven copies of each.
const MOST_TRIANGLES: usize = 1 << 28;

/// A triangle's corners `[m]`.
type Corners = [[f32; 3]; 3];

/// A boundary that a volume has.
#[derive(Clone, Debug)]
pub struct Wanted<'a> {
    /// The key that names it: `volume[0].shape.name`.
    pub path: String,
    /// Its name: that of nodes, or of their mesh. All nodes that are called so are parts of it.
    pub name: &'a str,
}

/// The boundaries that are `wanted`, in their order, with positions counted from where those of `loaded` are. Their
/// triangles are taken out of `loaded`. Volumes may share one. There is none where a scale of 0 hides all that has the
/// name, as it may in some frames of an animation.
///
/// # Errors
/// If there is no geometry, nothing in it has the name, or what has it is not closed, has no inside, or shines.
pub fn take(
    loaded: Option<&mut Loaded>,
    document: &Document,
    wanted: &[Wanted<'_>],
) -> Result<Vec<Option<ClosedMesh>>> {
    let Some(first) = wanted.first() else { return Ok(Vec::new()) };
    let loaded = loaded.ok_or_else(|| no_geometry(document, first))?;
    let of_file = |wanted: &Wanted<'_>, error| document.error_of_file(&wanted.path, error);
    let one = |wanted: &Wanted<'_>| match parts(loaded, wanted)[..] {
        [] if loaded.model.hidden.iter().any(|name| name == wanted.name) => Ok(None),
        [] => Err(unknown(loaded, document, wanted)),
        ref parts => boundary(loaded, parts).map(Some).map_err(|error| of_file(wanted, error)),
    };
    let boundaries = wanted.iter().map(one).collect::<Result<_>>()?;
    remove(&mut loaded.model, |instance| wanted.iter().any(|wanted| is_called(instance, wanted.name)));
    Ok(boundaries)
}

fn is_called(instance: &Instance, name: &str) -> bool {
    instance.name == name || instance.mesh.as_deref() == Some(name)
}

/// All nodes that are called like the boundary.
fn parts<'a>(loaded: &'a Loaded, wanted: &Wanted<'_>) -> Vec<&'a Instance> {
    loaded.model.instances.iter().filter(|instance| is_called(instance, wanted.name)).collect()
}

/// The union of `parts`.
fn boundary(loaded: &Loaded, parts: &[&Instance]) -> Result<ClosedMesh> {
    let count = parts.iter().map(|part| part.triangles.len()).sum::<usize>();
    let finding = || format!("has {count} triangles, more than the limit of {MOST_TRIANGLES} for what bounds a volume");
    let too_many = || Error::failure(place(loaded, parts[0]), finding(), "give it fewer triangles");
    (count <= MOST_TRIANGLES).then_some(()).ok_or_else(too_many)?;
    let mut triangles = Vec::with_capacity(count);
    for part in parts {
        refuse_emission(loaded, part)?;
        let corners = corners(&loaded.model, part);
        ClosedMesh::check(&corners).map_err(|open| not_closed(loaded, part, &corners, &open))?;
        let flat = || without_inside(loaded, part, "has no inside: it is a sheet without thickness");
        thickness::has_inside(&corners).then_some(()).ok_or_else(flat)?;
        triangles.extend(outward(corners));
    }
    Ok(ClosedMesh::new(&triangles).expect("what has closed parts is closed"))
}

fn corners(model: &Model, instance: &Instance) -> Vec<Corners> {
    let range = instance.triangles.start as usize..instance.triangles.end as usize;
    let position = |corner: u32| model.positions[corner as usize];
    model.triangles[range].iter().map(|triangle| triangle.corners.map(position)).collect()
}

/// The same surface with its outside outside, so that parts that overlap do not cancel.
fn outward(part: Vec<Corners>) -> impl Iterator<Item = Corners> {
    let middle = DVec3::from(part[0][0].map(f64::from));
    let volume = |corners: &Corners| {
        let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)) - middle);
        a.dot(b.cross(c))
    };
    let is_inverted = part.iter().map(volume).sum::<f64>() < 0.0;
    part.into_iter().map(move |[a, b, c]| if is_inverted { [a, c, b] } else { [a, b, c] })
}

/// Takes the triangles of some instances out of a model.
fn remove(model: &mut Model, is_removed: impl Fn(&Instance) -> bool) {
    let mut left = Vec::new();
    model.instances.retain_mut(|instance| {
        let range = instance.triangles.start as usize..instance.triangles.end as usize;
        let stays = !is_removed(instance);
        if stays {
            let first = left.len() as u32;
            left.extend_from_slice(&model.triangles[range]);
            instance.triangles = first..left.len() as u32;
        }
        stays
    });
    model.triangles = left;
}

fn no_geometry(document: &Document, wanted: &Wanted<'_>) -> Error {
    let finding = format!("{} is {}, but the scene has no geometry", wanted.path, quoted(wanted.name));
    document.error(&wanted.path, finding, "set geometry to the path of a glTF file that has the mesh")
}

fn unknown(loaded: &Loaded, document: &Document, wanted: &Wanted<'_>) -> Error {
    let finding = format!("{} is {}, but {} has no such mesh", wanted.path, quoted(wanted.name), loaded.file);
    let mut names: Vec<&str> = Vec::new();
    for instance in &loaded.model.instances {
        for name in [instance.name.as_str()].into_iter().chain(instance.mesh.as_deref()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    let remedy = match names.is_empty() {
        true => "give the name of a mesh; the file has none".into(),
        false => format!("give one of its names: {}", list(names.into_iter())),
    };
    document.error(&wanted.path, finding, remedy)
}

/// A boundary that shines would be a light without a surface.
fn refuse_emission(loaded: &Loaded, instance: &Instance) -> Result<()> {
    let range = instance.triangles.start as usize..instance.triangles.end as usize;
    let materials = loaded.model.triangles[range].iter().map(|triangle| triangle.material as usize);
    let shines = |material: &usize| loaded.model.materials[*material].emission != [0.0; 3];
    materials.clone().find(shines).map_or(Ok(()), |material| {
        let name = label("material", material, loaded.model.materials[material].name.as_deref());
        let finding = format!("bounds a volume and shines, with {name}; a boundary is no surface");
        Err(Error::failure(place(loaded, instance), finding, "give it a material without emission"))
    })
}

fn not_closed(loaded: &Loaded, instance: &Instance, triangles: &[Corners], open: &OpenMesh) -> Error {
    let OpenMesh::Edges(edges) = open else {
        return without_inside(loaded, instance, "none of its triangles has an area");
    };
    let open::Diagnosis { finding, remedy } = open::diagnosis(triangles, edges, loaded.model.origin);
    Error::failure(place(loaded, instance), format!("bounds a volume, but {finding}"), remedy)
}

fn without_inside(loaded: &Loaded, instance: &Instance, finding: &str) -> Error {
    let remedy = "give it some thickness, and no scale of 0, or leave the volume out";
    Error::failure(place(loaded, instance), format!("bounds a volume, but {finding}"), remedy)
}

fn place(loaded: &Loaded, instance: &Instance) -> String {
    format!("{}: {}", loaded.file, label("node", instance.node as usize, Some(&instance.name)))
}

#[cfg(test)]
mod tests;
