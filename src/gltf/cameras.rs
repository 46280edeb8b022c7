//! Cameras: they look along -z of their node, y upward.

use core::f64::consts::PI;

use super::fault::{At, Checked, Fault, entry, label, quoted, require};
use super::model::Camera;
use super::nodes::Placed;
use super::schema::{self, Perspective};
use super::transforms;
use super::warnings::Warnings;

/// The perspective cameras on `placed` nodes.
pub fn read(cameras: &[schema::Camera], placed: &[Placed<'_>], warnings: &mut Warnings) -> Checked<Vec<Camera>> {
    let mut found = Vec::new();
    for placed in placed {
        let Some(index) = placed.node.camera else {
            continue;
        };
        let camera = entry(cameras, "camera", index).at(|| placed.label())?;
        let perspective = perspective(camera).at(|| label("camera", index, camera.name.as_deref()))?;
        let Some(perspective) = perspective else {
            warnings.note("orthographic cameras are left out", || label("camera", index, camera.name.as_deref()));
            continue;
        };
        if transforms::mirrors(placed.world) {
            warnings.note("mirrored cameras render images that are not mirrored", || placed.label());
        }
        let name = placed.node.name.as_ref().or(camera.name.as_ref());
        let name = name.cloned().unwrap_or_else(|| label("camera", index, None));
        found.push(Camera { extras: camera.extras.clone(), ..look(name, placed, perspective)? });
    }
    Ok(found)
}

/// The checked lens of `camera`; none if it is orthographic.
fn perspective(camera: &schema::Camera) -> Checked<Option<&Perspective>> {
    match camera.kind.as_str() {
        "perspective" => {}
        "orthographic" => return Ok(None),
        other => {
            return Err(Fault::new(format!("has type {}", quoted(other)), "give \"perspective\" or \"orthographic\""));
        }
    }
    let Some(lens) = &camera.perspective else {
        return Err(Fault::new("has no perspective", "give the camera a perspective with yfov and znear"));
    };
    let Perspective { yfov, znear, aspect_ratio } = lens;
    let remedy = "give an angle above 0 and below pi, in radians";
    require(*yfov > 0.0 && *yfov < PI, || format!("its yfov is {yfov:?}"), remedy)?;
    require(*znear > 0.0, || format!("its znear is {znear:?}"), "give a distance above 0")?;
    let aspect = aspect_ratio.unwrap_or(1.0);
    require(aspect > 0.0, || format!("its aspectRatio is {aspect:?}"), "give a ratio above 0, or leave it out")?;
    Ok(Some(lens))
}

fn look(name: String, placed: &Placed<'_>, lens: &Perspective) -> Checked<Camera> {
    let forward = placed.forward().at(|| placed.label())?;
    // Stretched nodes may lean the y axis toward the viewing axis; flattened ones may leave nothing of it.
    let upward = transforms::direction(placed.world.matrix3.y_axis).map(|y| y.reject_from_normalized(forward));
    let up = upward.and_then(transforms::direction).unwrap_or(forward.any_orthonormal_vector());
    Ok(Camera {
        name,
        node: placed.index as u32,
        position: placed.world.translation.to_array(),
        forward: forward.to_array(),
        up: up.to_array(),
        vertical_fov: lens.yfov,
        aspect: lens.aspect_ratio,
        near: lens.znear,
        extras: None,
    })
}
