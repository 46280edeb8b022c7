//! The hierarchy of nodes: which nodes the scene has, and where each of them is in the world.

use glam::{DAffine3, DVec3};

use super::fault::{At, Checked, Fault, entry, label, require};
use super::schema::{Node, Root, Scene};
use super::transforms;
use super::warnings::Warnings;

/// Where a node of the scene is.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The node's index in the file.
    pub index: usize,
    /// From the node to the world.
    pub world: DAffine3,
}

/// A node of the scene, and where it is.
#[derive(Debug)]
pub struct Placed<'a> {
    /// Its index in the file.
    pub index: usize,
    pub node: &'a Node,
    /// From the node to the world.
    pub world: DAffine3,
}

impl Placed<'_> {
    /// Where it looks or shines: along its -z axis, unless that is flattened.
    pub fn forward(&self) -> Checked<DVec3> {
        let remedy = "give it a scale above 0 along z";
        transforms::direction(-self.world.matrix3.z_axis)
            .ok_or_else(|| Fault::new("its transform flattens its z axis, which should give its direction", remedy))
    }

    /// What it is called in messages.
    pub fn label(&self) -> String {
        node_label(self.index, self.node)
    }
}

/// What node `index` is called in messages.
pub fn node_label(index: usize, node: &Node) -> String {
    label("node", index, node.name.as_deref())
}

/// The scene to read: the default one, or else the first.
pub fn scene(root: &Root) -> Checked<Option<&Scene>> {
    match root.scene {
        Some(index) => entry(&root.scenes, "scene", index).map(Some),
        None => Ok(root.scenes.first()),
    }
}

/// The nodes of `root` that are at `places`.
pub fn placed<'a>(root: &'a Root, places: &[Place]) -> Vec<Placed<'a>> {
    places.iter().map(|&Place { index, world }| Placed { index, node: &root.nodes[index], world }).collect()
}

/// Where all nodes of the scene are, or of the file if it has no scenes, parents before their children.
pub fn places(root: &Root, warnings: &mut Warnings) -> Checked<Vec<Place>> {
    let parents = parents(&root.nodes)?;
    refuse_cycles(&root.nodes, &parents)?;
    let mut places = Vec::new();
    // Hierarchies may be deeper than any call stack: what is still to visit is a list.
    let mut open: Vec<(usize, DAffine3)> = Vec::new();
    let roots = roots(root, &parents)?;
    open.extend(roots.into_iter().rev().map(|index| (index, DAffine3::IDENTITY)));
    while let Some((index, parent)) = open.pop() {
        let node = &root.nodes[index];
        let label = || node_label(index, node);
        let Some(local) = transforms::local(node, warnings, label).at(label)? else {
            continue;
        };
        let world = parent * local;
        transforms::finite(world).at(label)?;
        places.push(Place { index, world });
        open.extend(node.children.iter().rev().map(|child| (*child, world)));
    }
    Ok(places)
}

/// Names of the nodes of the scene with meshes that are at none of the `places`, as a scale of 0 hides them, and of these
/// meshes.
pub fn hidden(root: &Root, places: &[Place]) -> Checked<Vec<String>> {
    let mut is_placed = vec![false; root.nodes.len()];
    places.iter().for_each(|place| is_placed[place.index] = true);
    let (mut names, mut open) = (Vec::new(), roots(root, &parents(&root.nodes)?)?);
    while let Some(index) = open.pop() {
        let node = &root.nodes[index];
        if let (false, Some(mesh)) = (is_placed[index], node.mesh) {
            let mesh = entry(&root.meshes, "mesh", mesh).at(|| node_label(index, node))?;
            names.extend([&node.name, &mesh.name].into_iter().flatten().cloned());
        }
        open.extend(&node.children);
    }
    Ok(names)
}

/// The parent of every node.
fn parents(nodes: &[Node]) -> Checked<Vec<Option<usize>>> {
    let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in &node.children {
            let label = || node_label(index, node);
            entry(nodes, "node", *child).at(|| "children").at(label)?;
            if let Some(other) = parents[*child].replace(index) {
                let finding = format!("is a child of node {other} and of node {index}");
                let remedy = "list each node only once, as the child of one node";
                return Err(Fault::new(finding, remedy).at(node_label(*child, &nodes[*child])));
            }
        }
    }
    Ok(parents)
}

/// Every node has at most one parent, so what cannot be reached from nodes without parents goes round in circles.
fn refuse_cycles(nodes: &[Node], parents: &[Option<usize>]) -> Checked<()> {
    let mut reached = vec![false; nodes.len()];
    let mut open: Vec<usize> = (0..nodes.len()).filter(|index| parents[*index].is_none()).collect();
    while let Some(index) = open.pop() {
        reached[index] = true;
        open.extend(&nodes[index].children);
    }
    match reached.iter().position(|reached| !reached) {
        None => Ok(()),
        Some(index) => {
            let fault = Fault::new("is in or below a cycle of the hierarchy", "remove the cycle from the children");
            Err(fault.at(node_label(index, &nodes[index])))
        }
    }
}

/// The nodes that the scene lists, or all without a parent if there are no scenes.
fn roots(root: &Root, parents: &[Option<usize>]) -> Checked<Vec<usize>> {
    let Some(scene) = scene(root)? else {
        return Ok((0..parents.len()).filter(|index| parents[*index].is_none()).collect());
    };
    let place = || label("scene", root.scene.unwrap_or(0), None);
    let mut listed = vec![false; parents.len()];
    for index in &scene.nodes {
        entry(&root.nodes, "node", *index).at(place)?;
        let finding = || format!("lists node {index}, which is a child of another node");
        require(parents[*index].is_none(), finding, "list only the topmost nodes").at(place)?;
        let twice = core::mem::replace(&mut listed[*index], true);
        require(!twice, || format!("lists node {index} twice"), "list each node only once").at(place)?;
    }
    Ok(scene.nodes.clone())
}
