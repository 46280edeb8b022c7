//! Animations: where nodes are at a time. All animations of a file play together.

mod about;
mod curve;

use std::collections::BTreeMap;

use super::accessors::Accessors;
use super::element_format::{Component, Shape};
use super::fault::{At, Checked, Fault, entry, label, quoted, require};
use super::nodes::node_label;
use super::schema::{Animation, AnimationSampler, Channel, Node};
use super::warnings::Warnings;
pub use about::about;
use curve::{Curve, Interpolation};

/// Keyframes of the longest curve that is read.
const MOST_KEYFRAMES: usize = 1 << 22;

/// A property of nodes that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Property {
    Translation,
    Rotation,
    Scale,
}

impl Property {
    fn name(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::Scale => "scale",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        [Self::Translation, Self::Rotation, Self::Scale].into_iter().find(|property| property.name() == name)
    }
}

/// What a node has instead of what the file gives it.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    node: usize,
    value: Value,
}

#[derive(Clone, Copy, Debug)]
enum Value {
    Translation([f64; 3]),
    Rotation([f64; 4]),
    Scale([f64; 3]),
}

impl Change {
    /// Makes it in `nodes`, all nodes of the file.
    pub fn apply(self, nodes: &mut [Node]) {
        let node = &mut nodes[self.node];
        match self.value {
            Value::Translation(translation) => node.translation = Some(translation),
            Value::Rotation(rotation) => node.rotation = Some(rotation),
            Value::Scale(scale) => node.scale = Some(scale),
        }
    }
}

/// What `animations` change in `nodes` at `time` `[s]`, each property of a node once; before its first keyframe and
/// after its last one a curve stays where it is there.
pub fn changes(
    animations: &[Animation],
    nodes: &[Node],
    accessors: Accessors<'_>,
    time: f64,
    warnings: &mut Warnings,
) -> Checked<Vec<Change>> {
    if animations.is_empty() {
        warnings.note("there are none: all frames are alike", || "animations");
    }
    let mut changes: BTreeMap<(usize, Property), (usize, Change)> = BTreeMap::new();
    for (index, animation) in animations.iter().enumerate() {
        let animation_label = || label("animation", index, animation.name.as_deref());
        for (number, channel) in animation.channels.iter().enumerate() {
            let place = || format!("{}, channel {number}", animation_label());
            let Some((node, property)) = target(channel, nodes, warnings, place).at(place)? else { continue };
            let change = change(animation, channel, (node, property), nodes, accessors, time).at(place)?;
            let Some((other, _)) = changes.insert((node, property), (index, change)) else { continue };
            let finding = || format!("moves {} of node {node}, as another channel does", property.name());
            require(other != index, finding, "give each property of a node one channel").at(place)?;
            let several = "is moved by several animations, of which the last in the file counts";
            warnings.note(several, || format!("{}, {}", node_label(node, &nodes[node]), property.name()));
        }
    }
    Ok(changes.into_values().map(|(_, change)| change).collect())
}

/// What `channel` moves; nothing if that is not a node's place.
fn target(
    channel: &Channel,
    nodes: &[Node],
    warnings: &mut Warnings,
    place: impl Fn() -> String,
) -> Checked<Option<(usize, Property)>> {
    let Some(property) = Property::from_name(&channel.target.path) else {
        match channel.target.path.as_str() {
            "weights" => warnings.note("morph targets do not move; meshes keep their shape", place),
            path => warnings.note("only nodes move", || format!("{}, {}", place(), quoted(path))),
        }
        return Ok(None);
    };
    let Some(index) = channel.target.node else { return Ok(None) };
    let node = entry(nodes, "node", index)?;
    let finding = || format!("moves {}, which has a matrix", node_label(index, node));
    require(node.matrix.is_none(), finding, "give the node translation, rotation and scale instead of a matrix")?;
    Ok(Some((index, property)))
}

fn change(
    animation: &Animation,
    channel: &Channel,
    (node, property): (usize, Property),
    nodes: &[Node],
    accessors: Accessors<'_>,
    time: f64,
) -> Checked<Change> {
    let sampler = entry(&animation.samplers, "sampler", channel.sampler)?;
    let in_sampler = || label("sampler", channel.sampler, None);
    let value = match property {
        Property::Translation => Value::Translation(vector(sampler, accessors).at(in_sampler)?.at(time)),
        Property::Scale => Value::Scale(vector(sampler, accessors).at(in_sampler)?.at(time)),
        Property::Rotation => {
            let rotation = rotation(sampler, accessors).at(in_sampler)?.rotation_at(time);
            let finding = || format!("turns {} by no rotation at {time} s", node_label(node, &nodes[node]));
            Value::Rotation(rotation.ok_or_else(|| Fault::new(finding(), "give quaternions of length 1"))?)
        }
    };
    Ok(Change { node, value })
}

fn vector(sampler: &AnimationSampler, accessors: Accessors<'_>) -> Checked<Curve<3>> {
    let is_vector = |shape, component, _| shape == Shape::Vec3 && component == Component::F32;
    curve(sampler, accessors, is_vector, "VEC3 of FLOAT")
}

fn rotation(sampler: &AnimationSampler, accessors: Accessors<'_>) -> Checked<Curve<4>> {
    let is_rotation = |shape, component, is_normalized| {
        shape == Shape::Vec4 && (component == Component::F32 || (component != Component::U32 && is_normalized))
    };
    curve(sampler, accessors, is_rotation, "VEC4 of FLOAT, or of normalized integers")
}

/// The curve of `sampler`, whose values are of a format that `is_fit`.
fn curve<const N: usize>(
    sampler: &AnimationSampler,
    accessors: Accessors<'_>,
    is_fit: impl Fn(Shape, Component, bool) -> bool,
    expected: &str,
) -> Checked<Curve<N>> {
    let interpolation = interpolation(sampler)?;
    let is_time =
        |format: super::element_format::Format| (format.shape, format.component) == (Shape::Scalar, Component::F32);
    let input = accessors.elements(sampler.input, is_time, "SCALAR of FLOAT").at(|| "input")?;
    let finding = || format!("has {} keyframes", input.count);
    require(input.count <= MOST_KEYFRAMES, finding, "give at most 4194304").at(|| "input")?;
    let fits = |format: super::element_format::Format| is_fit(format.shape, format.component, format.normalized);
    let output = accessors.elements(sampler.output, fits, expected).at(|| "output")?;
    let per_keyframe = interpolation.values_per_keyframe();
    let finding = || format!("has {} values for {} keyframes", output.count, input.count);
    let remedy = "give one value per keyframe, or three with CUBICSPLINE";
    require(output.count == per_keyframe * input.count, finding, remedy).at(|| "output")?;
    let times: Vec<f64> = input.vectors::<1>().at(|| "input")?.into_iter().map(|[time]| time.into()).collect();
    for (index, pair) in times.windows(2).enumerate() {
        let finding = || format!("its time {} is {}, after {}", index + 1, pair[1], pair[0]);
        require(pair[0] < pair[1], finding, "give times that increase").at(|| "input")?;
    }
    let is_finite = times.iter().all(|time| time.is_finite());
    require(is_finite, || "has a time that is not finite", "give finite times in seconds").at(|| "input")?;
    let values: Vec<[f64; N]> =
        output.vectors::<N>().at(|| "output")?.into_iter().map(|value| value.map(f64::from)).collect();
    let is_finite = values.as_flattened().iter().all(|value| value.is_finite());
    require(is_finite, || "has a value that is not finite", "give finite numbers").at(|| "output")?;
    Ok(Curve { times, values, interpolation })
}

fn interpolation(sampler: &AnimationSampler) -> Checked<Interpolation> {
    match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Ok(Interpolation::Linear),
        Some("STEP") => Ok(Interpolation::Step),
        Some("CUBICSPLINE") => Ok(Interpolation::CubicSpline),
        Some(other) => {
            let finding = format!("its interpolation is {}", quoted(other));
            Err(Fault::new(finding, "give LINEAR, STEP or CUBICSPLINE"))
        }
    }
}
