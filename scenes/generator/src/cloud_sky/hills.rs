//! Hills, finer near the camera: rings around it, cut into sectors, from left to right of what it sees.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{EYE, GROUNDS};
use crate::{Mesh, smooth};

/// Distance of the first and the last ring from the camera `[m]`.
const RINGS: [f64; 2] = [350.0, 16_000.0];
/// Rings, and sectors between the two ends of each.
const COUNT: [u32; 2] = [150, 120];
/// Half of the angle that the sectors fill, about -z.
const HALF_ANGLE: f64 = 0.09 * TAU;
/// Mean height of the valley `[m]`.
const VALLEY: f64 = -435.0;
/// Waves of the hills: how far it is from one to the next, and how high they are, `[m]`.
const WAVES: [[f64; 2]; 3] = [[950.0, 52.0], [410.0, 22.0], [170.0, 5.0]];
/// The ridges at the horizon: the same, and from where to where they rise `[m]`.
const RIDGES: ([f64; 2], [f64; 2]) = ([2900.0, 420.0], [4500.0, 10_000.0]);
/// About how wide a field is `[m]`.
const FIELD: f64 = 170.0;

/// The hills, ground by ground.
pub fn meshes() -> [Mesh; GROUNDS.len()] {
    let [rings, sectors] = COUNT;
    let whole: Vec<DVec3> =
        (0..=rings).flat_map(|ring| (0..=sectors).map(move |sector| vertex(ring, sector))).collect();
    let mut meshes: [Mesh; GROUNDS.len()] = Default::default();
    let mut places = meshes.each_ref().map(|_| vec![None; whole.len()]);
    for ring in 0..rings {
        for sector in 0..sectors {
            let first = (ring * (sectors + 1) + sector) as usize;
            let corners = [first, first + 1, first + sectors as usize + 2, first + sectors as usize + 1];
            let middle = corners.iter().map(|corner| whole[*corner]).sum::<DVec3>() / 4.0;
            let ground = ground(DVec2::new(middle.x, middle.z));
            let (mesh, places) = (&mut meshes[ground], &mut places[ground]);
            let quad = corners.map(|corner| {
                *places[corner].get_or_insert_with(|| {
                    mesh.positions.push(whole[corner]);
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.quad(quad);
        }
    }
    meshes
}

/// A vertex of the hills; rings are farther apart the farther away they are.
fn vertex(ring: u32, sector: u32) -> DVec3 {
    let [rings, sectors] = COUNT.map(f64::from);
    let distance = RINGS[0] * (RINGS[1] / RINGS[0]).powf(f64::from(ring) / rings);
    let angle = HALF_ANGLE * (2.0 * f64::from(sector) / sectors - 1.0);
    let at = DVec2::new(EYE.x, EYE.z) + distance * DVec2::new(angle.sin(), -angle.cos());
    DVec3::new(at.x, height(at, distance), at.y)
}

/// Height of the ground `[m]`, so far from the camera.
fn height(at: DVec2, distance: f64) -> f64 {
    let hills: f64 = WAVES.iter().enumerate().map(|(i, [wide, high])| high * noise(at / *wide, i as u32)).sum();
    let ([wide, high], [begin, end]) = RIDGES;
    let ridge = 1.0 - noise(at / wide, 7).abs();
    VALLEY + hills + high * ridge * ridge * smooth((distance - begin) / (end - begin))
}

/// What grows at a place: that of the nearest field. Fields lie about on a grid.
fn ground(at: DVec2) -> usize {
    let cell = (at / FIELD).floor();
    let neighbours = (0..9).map(|i| cell + DVec2::new(f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0));
    let middle = |cell: DVec2| FIELD * (cell + DVec2::new(hashed(cell, 11), hashed(cell, 12)));
    let nearest = neighbours.min_by(|a, b| middle(*a).distance(at).total_cmp(&middle(*b).distance(at)));
    // As much grass as all the rest, and woods here and there.
    match hashed(nearest.expect("nine fields"), 13) {
        ..0.5 => 0,
        ..0.68 => 1,
        ..0.88 => 2,
        _ => 3,
    }
}

/// Smooth noise from -1 to 1 on a grid of edge 1.
fn noise(at: DVec2, seed: u32) -> f64 {
    let cell = at.floor();
    let [x, y] = (at - cell).to_array().map(smooth);
    let corner = |dx: f64, dy: f64| 2.0 * hashed(cell + DVec2::new(dx, dy), seed) - 1.0;
    let low = corner(0.0, 0.0) * (1.0 - x) + corner(1.0, 0.0) * x;
    let high = corner(0.0, 1.0) * (1.0 - x) + corner(1.0, 1.0) * x;
    low * (1.0 - y) + high * y
}

/// A number in [0, 1) for every cell of a grid.
fn hashed(cell: DVec2, seed: u32) -> f64 {
    let [x, y] = cell.to_array().map(|index| index as i32 as u32);
    let mut word = x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ seed.wrapping_mul(0x9e37_79b9);
    for factor in [0x7feb_352d, 0x846c_a68b] {
        word = (word ^ word >> 16).wrapping_mul(factor);
    }
    f64::from(word ^ word >> 16) / 4_294_967_296.0
}
