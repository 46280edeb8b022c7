//! Paths on a plane, and as a table.

use core::fmt::Write;

use glam::DVec3;

use super::{Found, outlines};
use crate::frame::Frame;
use crate::plot::Panel;

/// `paths` on the plane that contains the point that they leave from, the direction in which they do, and `target`: the
/// way to the target runs to the right, the direction upwards.
pub fn panel(frame: &Frame, title: String, found: &Found, target: DVec3, colour: [u8; 3]) -> Panel {
    let start = found.paths.first().and_then(|path| path.vertices.get(..2));
    let (origin, direction) = start.map_or((DVec3::ZERO, DVec3::Y), |two| (two[0], two[1] - two[0]));
    let right = (target - origin).normalize_or(DVec3::X);
    let across = |v: DVec3| {
        let part = v - v.dot(right) * right;
        // What is left of a vector along the way is rounding.
        (part.length() > 1e-6).then(|| (part - part.dot(right) * right).normalize())
    };
    // Any plane will do where paths leave straight for the target.
    let up = across(direction.normalize_or_zero()).or_else(|| across(DVec3::Y)).or_else(|| across(DVec3::X));
    let up = up.unwrap_or(DVec3::Y);
    let flat = |points: &[DVec3]| -> Vec<[f64; 2]> {
        points.iter().map(|point| [(*point - origin).dot(right), (*point - origin).dot(up)]).collect()
    };
    Panel {
        title,
        paths: found.paths.iter().map(|path| flat(&path.vertices)).collect(),
        lights: outlines(frame).iter().map(|outline| flat(outline)).collect(),
        colour,
        arrow: arrow(direction, right, up),
        is_cut: false,
    }
}

/// The direction as it is seen on the plane; nothing if it points out of it.
fn arrow(direction: DVec3, right: DVec3, up: DVec3) -> Option<[f64; 2]> {
    let seen = [direction.dot(right), direction.dot(up)];
    let length = seen[0].hypot(seen[1]);
    (length > 1e-6).then(|| seen.map(|part| part / length))
}

/// All vertices, one per line: number of the path, number of the vertex, who made it, position in metres, counted from
/// `origin`.
pub fn csv(found: &Found, origin: [f64; 3]) -> String {
    let mut text = String::from("path,vertex,made_by,x,y,z\n");
    for (path, chain) in found.paths.iter().enumerate() {
        for (index, vertex) in chain.vertices.iter().enumerate() {
            let maker = if index < chain.walked { "walk" } else { "connection" };
            let [x, y, z] = (*vertex + DVec3::from(origin)).to_array();
            let _ = writeln!(text, "{path},{index},{maker},{x},{y},{z}");
        }
    }
    text
}
