//! What the animations of a file are called, how long they take, and what they move.

use super::super::accessors::Accessors;
use super::super::element_format::{Component, Format, Shape};
use super::super::fault::{Checked, label};
use super::super::model::{Animated, Camera};
use super::super::nodes::node_label;
use super::super::schema::{Animation, AnimationSampler, Node, Root};
use super::super::warnings::Warnings;
use super::target;

/// Those of `root`, whose cameras are these. What cannot be played is for those to say who play it: here it has no
/// duration, or moves nothing.
pub fn about(root: &Root, cameras: &[Camera], accessors: Accessors<'_>) -> Vec<Animated> {
    let all = root.animations.iter().enumerate();
    all.map(|(index, animation)| {
        let targets = targets(animation, &root.nodes);
        let moved = moved(&targets, &root.nodes);
        let is_camera = |node: usize| cameras.iter().any(|camera| camera.node as usize == node);
        let end = |sampler: &AnimationSampler| end(sampler, accessors).ok();
        let ends: Option<Vec<f64>> = animation.samplers.iter().map(end).collect();
        Animated {
            name: label("animation", index, animation.name.as_deref()),
            duration: ends.and_then(|ends| ends.into_iter().reduce(f64::max)),
            cameras: cameras
                .iter()
                .filter(|camera| moved[camera.node as usize])
                .map(|camera| camera.name.clone())
                .collect(),
            nodes: targets
                .into_iter()
                .filter(|node| !is_camera(*node))
                .map(|node| node_label(node, &root.nodes[node]))
                .collect(),
        }
    })
    .collect()
}

/// The nodes that `animation` names, each once.
fn targets(animation: &Animation, nodes: &[Node]) -> Vec<usize> {
    let mut warnings = Warnings::default();
    let found =
        animation.channels.iter().filter_map(|channel| target(channel, nodes, &mut warnings, String::new).ok()?);
    let mut found: Vec<_> = found.map(|(node, _)| node).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Which nodes move with `targets`: these, and all below them.
fn moved(targets: &[usize], nodes: &[Node]) -> Vec<bool> {
    let (mut moved, mut open) = (vec![false; nodes.len()], targets.to_vec());
    while let Some(index) = open.pop() {
        if !core::mem::replace(&mut moved[index], true) {
            open.extend(&nodes[index].children);
        }
    }
    moved
}

/// The time of the last keyframe `[s]`.
fn end(sampler: &AnimationSampler, accessors: Accessors<'_>) -> Checked<f64> {
    let is_time = |format: Format| (format.shape, format.component) == (Shape::Scalar, Component::F32);
    let times = accessors.elements(sampler.input, is_time, "SCALAR of FLOAT")?.vectors::<1>()?;
    Ok(times.into_iter().map(|[time]| f64::from(time)).fold(0.0, f64::max))
}
