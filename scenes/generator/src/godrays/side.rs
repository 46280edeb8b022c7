//! A side of the nave up to the sills, the one at +x.

use glam::DVec3;

use super::{
    dimensions::{
        AISLE_ROOF, ARCADE, ARCADE_SPRING, BAYS, HALF_LENGTH, HALF_WIDTH, OUTER, OUTER_WALL, PITCH, SILL, VAULT_SPRING,
        WALL,
    },
    pier,
};
use crate::{
    Mesh,
    shapes::{self, Lancet},
};

/// How deep parts reach into their neighbours, so that no light passes between them `[m]`.
pub const JOINT: f64 = 0.1;
/// Half the width of the arches between the piers `[m]`.
const ARCH_HALF_WIDTH: f64 = 1.55;
/// Radius of their arcs over half the width: low arches, so that the wall over them is less dark than they are.
const ARCH_SHARPNESS: f64 = 1.05;
/// Height of the moulding under the windows, its relief, and its depth below the sills `[m]`.
const STRING_COURSE: [f64; 3] = [0.16, 0.1, 0.12];

/// The piers; the first and the last stand half in the end walls.
pub fn piers() -> Mesh {
    let pier = pier::pier(ARCADE_SPRING);
    Mesh::union(places().map(|z| pier.clone().moved(DVec3::new(ARCADE, 0.0, z))))
}

/// The shafts from the piers up to the vault.
pub fn shafts() -> Mesh {
    let cluster = pier::cluster([ARCADE_SPRING, VAULT_SPRING]);
    Mesh::union(places().map(|z| cluster.clone().moved(DVec3::new(HALF_WIDTH - 0.04, 0.0, z))))
}

/// The wall on the piers up to the sills, with two rings around every arch, and the moulding on it.
pub fn arcade() -> Mesh {
    let arches: Vec<Lancet> = middles().map(arch).collect();
    let end = HALF_LENGTH + JOINT;
    let band = shapes::lancet_band([-end, end], SILL, &arches, WALL);
    let rings = arches.iter().flat_map(|&arch| {
        let inner = shapes::lancet_ring(arch, [-0.1, 0.12], 0.55 * WALL);
        [inner, shapes::lancet_ring(arch, [0.0, 0.2], WALL + 0.1)]
    });
    Mesh::union([standing(Mesh::union([band].into_iter().chain(rings))), string_course()])
}

/// The outer wall and the roof of the aisle.
pub fn aisle() -> Mesh {
    let [under, over] = AISLE_ROOF;
    let block = |[inner, outer]: [f64; 2], [low, high]: [f64; 2]| {
        let end = HALF_LENGTH + JOINT;
        shapes::cuboid(DVec3::new(inner, low, -end), DVec3::new(outer, high, end))
    };
    let wall = block([OUTER, OUTER + OUTER_WALL], [-JOINT, over]);
    Mesh::union([wall, block([ARCADE, OUTER + JOINT], [under, over - 0.01])])
}

/// A wall along x put where it stands.
pub fn standing(wall: Mesh) -> Mesh {
    wall.quarter_turned().moved(DVec3::X * ARCADE)
}

/// Where piers stand along the nave.
pub fn places() -> impl Iterator<Item = f64> {
    (0..=BAYS).map(|pier| f64::from(pier) * PITCH - HALF_LENGTH)
}

/// The middles of the bays.
pub fn middles() -> impl Iterator<Item = f64> {
    (0..BAYS).map(|bay| (f64::from(bay) + 0.5) * PITCH - HALF_LENGTH)
}

fn string_course() -> Mesh {
    let [height, relief, below] = STRING_COURSE;
    let top = SILL - below;
    let low = DVec3::new(HALF_WIDTH - relief, top - height, -HALF_LENGTH);
    shapes::cuboid(low, DVec3::new(ARCADE, top, HALF_LENGTH))
}

fn arch(center: f64) -> Lancet {
    Lancet { center, spring: ARCADE_SPRING, half_width: ARCH_HALF_WIDTH, sharpness: ARCH_SHARPNESS }
}
