//! The ground under a fire: a ring of stones around timbers that are laid crosswise.

use core::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::{Material, Mesh, Model, Object, shapes};

/// How far the ground reaches from the fire along x and z `[m]`.
pub const REACH: f64 = 12.0;
/// Stones around the fire.
pub const STONES: u32 = 15;
/// Radius of the ring of stones `[m]`.
pub const RING: f64 = 0.82;
/// Bands and sides of a stone.
const STONE: [u32; 2] = [10, 16];
/// Length and thickness of the timbers `[m]`.
const TIMBER: [f64; 2] = [1.15, 0.1];
/// Half the distance between two timbers side by side `[m]`.
const APART: f64 = 0.2;

/// The model.
pub fn model() -> Model {
    let ground = Mesh::parallelogram(DVec3::new(-REACH, 0.0, -REACH), DVec3::Z * 2.0 * REACH, DVec3::X * 2.0 * REACH);
    Model {
        name: "smoke-fire",
        objects: vec![
            Object::new("ground", Material::new("earth", [0.22, 0.17, 0.13]), ground),
            Object::new("stones", Material::grey("stone", 0.3), Mesh::union((0..STONES).map(stone))),
            Object::new("timbers", Material::new("charred", [0.06, 0.045, 0.04]), timbers()),
        ],
    }
}

/// Number `i` of the ring, sunk into the ground by a third.
fn stone(i: u32) -> Mesh {
    // No two are alike: shares that follow the golden section.
    let share = |factor: f64| (f64::from(i) * factor).fract();
    let [bands, sides] = STONE;
    let profile: Vec<DVec2> = (0..=bands)
        .map(|k| {
            let (sin, cos) = (PI * f64::from(k) / f64::from(bands)).sin_cos();
            DVec2::new(if k % bands == 0 { 0.0 } else { sin }, -cos)
        })
        .collect();
    let size = 0.1 + 0.05 * share(0.618);
    let shape = DVec3::new(1.1 + 0.35 * share(0.38), 0.8 + 0.3 * share(0.73), 1.0);
    let angle = TAU * f64::from(i) / f64::from(STONES);
    let place = DVec3::new((RING + 0.06 * share(0.27)) * angle.sin(), 0.45 * size, RING * angle.cos());
    shapes::lathe(&profile, sides).stretched(size * shape).turned(angle + share(0.19)).moved(place)
}

/// Three layers, each across the one below.
fn timbers() -> Mesh {
    let [length, thickness] = TIMBER;
    let layer = |layer: u32| {
        let low = f64::from(layer) * thickness;
        let timber = |side: f64| {
            let half = DVec3::new(length / 2.0 - 0.08 * f64::from(layer), thickness / 2.0, thickness / 2.0);
            let center = DVec3::new(0.0, low + thickness / 2.0, side * APART);
            shapes::cuboid(center - half, center + half).turned(0.06 * side + 0.04 * f64::from(layer))
        };
        let pair = Mesh::union([timber(-1.0), timber(1.0)]);
        (if layer % 2 == 1 { pair.quarter_turned() } else { pair }).turned(0.35)
    };
    Mesh::union((0..3).map(layer))
}
