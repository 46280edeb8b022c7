//! Punctual lights (KHR_lights_punctual): they shine along -z of their node.

use core::f64::consts::FRAC_PI_2;

use super::fault::{At, Checked, Fault, entry, label, quoted, require};
use super::model::{Light, LightKind};
use super::nodes::Placed;
use super::schema::{self, Root};
use super::warnings::Warnings;

/// The lights on `placed` nodes.
pub fn read(root: &Root, placed: &[Placed<'_>], warnings: &mut Warnings) -> Checked<Vec<Light>> {
    let lights = root.extensions.lights.as_ref().map_or(&[][..], |extension| &extension.lights);
    let mut found = Vec::new();
    for placed in placed {
        let Some(of_node) = &placed.node.extensions.light else {
            continue;
        };
        let index = of_node.light;
        let light = entry(lights, "light", index).at(|| placed.label())?;
        let label = || label("light", index, light.name.as_deref());
        if light.range.is_some() {
            warnings.note("ranges are ignored; light reaches any distance", label);
        }
        let name = placed.node.name.as_ref().or(light.name.as_ref());
        let name = name.cloned().unwrap_or_else(|| format!("light {index}"));
        found.push(place(light, name, placed).at(label)?);
    }
    Ok(found)
}

fn place(light: &schema::Light, name: String, placed: &Placed<'_>) -> Checked<Light> {
    let color = light.color.map(|channel| channel as f32);
    let ok = color.iter().all(|channel| *channel >= 0.0 && channel.is_finite());
    require(ok, || format!("its color is {:?}", light.color), "give finite numbers of 0 or more")?;
    let finding = || format!("its intensity is {:?}", light.intensity);
    require(light.intensity >= 0.0, finding, "give an intensity of 0 or more")?;
    let kind = kind(light)?;
    // A point light shines everywhere.
    let direction = match kind {
        LightKind::Point => [0.0, 0.0, -1.0],
        LightKind::Directional | LightKind::Spot { .. } => placed.forward().at(|| placed.label())?.to_array(),
    };
    Ok(Light {
        name,
        node: placed.index as u32,
        kind,
        color,
        intensity: light.intensity,
        position: placed.world.translation.to_array(),
        direction,
        extras: light.extras.clone(),
    })
}

fn kind(light: &schema::Light) -> Checked<LightKind> {
    match light.kind.as_str() {
        "point" => Ok(LightKind::Point),
        "directional" => Ok(LightKind::Directional),
        "spot" => {
            let remedy = "give the light a spot object; its innerConeAngle and outerConeAngle are optional";
            let spot = light.spot.as_ref().ok_or_else(|| Fault::new("has no spot", remedy))?;
            let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
            let finding = || format!("its cone is from {inner:?} to {outer:?}");
            // Equal angles are a hard edge.
            let ok = 0.0 <= inner && inner <= outer && 0.0 < outer && outer <= FRAC_PI_2 + 1e-6;
            require(ok, finding, "give angles with 0 <= inner <= outer <= pi / 2 and 0 < outer, in radians")?;
            Ok(LightKind::Spot { inner: inner.min(FRAC_PI_2), outer: outer.min(FRAC_PI_2) })
        }
        other => Err(Fault::new(format!("has type {}", quoted(other)), "give \"point\", \"spot\" or \"directional\"")),
    }
}
