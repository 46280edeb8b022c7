//! The vault: in every bay two pointed barrels that cross, and ribs under their edges.

use glam::{DVec2, DVec3};

use super::{
    dimensions::{HALF_WIDTH, PITCH, TOP, VAULT_SHARPNESS, VAULT_SPRING},
    side::{middles, places},
};
use crate::{
    Mesh,
    shapes::{self, Lancet},
};

/// How deep the vault reaches into walls and ribs into the vault `[m]`.
const JOINT: f64 = 0.12;
/// Flat pieces from a wall to the crown.
const PIECES: u32 = 10;
/// How far the ribs between bays and those across bays hang below the vault, and their thickness `[m]`.
const RIBS: [[f64; 2]; 2] = [[0.2, 0.4], [0.13, 0.16]];

/// Height of a barrel over its spring, `share` of the way from its crown to its foot, for half a width of 1.
fn rise(share: f64) -> f64 {
    let beside = VAULT_SHARPNESS - 1.0 + share;
    (VAULT_SHARPNESS * VAULT_SHARPNESS - beside * beside).max(0.0).sqrt()
}

/// Half the width and half the length of a bay as the vault fills it.
fn half() -> DVec2 {
    DVec2::new(HALF_WIDTH + JOINT, 0.5 * PITCH)
}

/// The underside of the vault over a bay, at -1 to 1 of its half width and half length.
fn underside(at: DVec2) -> DVec3 {
    let place = at * half();
    DVec3::new(place.x, VAULT_SPRING + half().x * rise(at.abs().min_element()), place.y)
}

/// The vault over all bays.
pub fn webs() -> Mesh {
    let bay = bay();
    Mesh::union(middles().map(|z| bay.clone().moved(DVec3::Z * z)))
}

/// The ribs: pointed arches between bays, and two across each.
pub fn ribs() -> Mesh {
    let [[hang, thickness], _] = RIBS;
    let lancet = Lancet { center: 0.0, spring: VAULT_SPRING, half_width: half().x, sharpness: VAULT_SHARPNESS };
    let between = shapes::lancet_ring(lancet, [-hang, 0.0], thickness);
    let across = Mesh::union([diagonal(1.0), diagonal(-1.0)]);
    let between = places().map(|z| between.clone().moved(DVec3::Z * z));
    Mesh::union(between.chain(middles().map(|z| across.clone().moved(DVec3::Z * z))))
}

/// The rib along one diagonal of a bay, from the wall at -x to that at +x.
fn diagonal(side: f64) -> Mesh {
    let [_, [hang, thickness]] = RIBS;
    let count = 2 * PIECES;
    let chain = |above: f64| -> Vec<DVec2> {
        (0..=count)
            .map(|i| {
                let share = 2.0 * f64::from(i) / f64::from(count) - 1.0;
                let point = underside(DVec2::splat(share));
                DVec2::new(share * half().length(), point.y + above)
            })
            .collect()
    };
    shapes::wall(&chain(-hang), &chain(JOINT), thickness).turned(-side * half().y.atan2(half().x))
}

/// The solid between the underside over one bay and a flat top. Cells are cut along the diagonals, where the barrels
/// meet.
fn bay() -> Mesh {
    let count = 2 * PIECES;
    let share = |i: u32| 2.0 * f64::from(i) / f64::from(count) - 1.0;
    let index = |i: u32, j: u32| i * (count + 1) + j;
    let positions =
        (0..=count).flat_map(|i| (0..=count).map(move |j| underside(DVec2::new(share(i), share(j))))).collect();
    let mut mesh = Mesh { positions, triangles: vec![] };
    for i in 0..count {
        for j in 0..count {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            let towards_corner = (i < PIECES) == (j < PIECES);
            mesh.quad(if towards_corner { [a, b, c, d] } else { [b, c, d, a] });
        }
    }
    let side = |from: fn(u32, u32) -> [u32; 2]| (0..count).map(move |i| from(i, count));
    let rim: Vec<u32> = side(|i, _| [i, 0])
        .chain(side(|i, count| [count, i]))
        .chain(side(|i, count| [count - i, count]))
        .chain(side(|i, count| [0, count - i]))
        .map(|[i, j]| index(i, j))
        .collect();
    cover(&mut mesh, &rim);
    mesh
}

/// Closes a mesh from its rim upward.
fn cover(mesh: &mut Mesh, rim: &[u32]) {
    let first = mesh.positions.len() as u32;
    let count = rim.len() as u32;
    for &index in rim {
        mesh.positions.push(mesh.positions[index as usize].with_y(TOP));
    }
    mesh.positions.push(DVec3::Y * TOP);
    for i in 0..count {
        let next = (i + 1) % count;
        mesh.quad([rim[next as usize], rim[i as usize], first + i, first + next]);
        mesh.triangles.push([first + next, first + i, first + count]);
    }
}
