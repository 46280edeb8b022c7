//! Mouldings along the court side of the wall at +x.

use glam::DVec3;

use super::dimensions::{ARCADE, ARCADE_THICKNESS, GALLERY, GALLERY_THICKNESS, HALF_LENGTH, ROOF, ROOF_TOP};
use crate::{Mesh, shapes};

/// Side of a dentil and the distance between the middles of two `[m]`.
const DENTIL: [f64; 2] = [0.16, 0.35];

/// The moulding in front of the gallery's floor.
pub fn string_course() -> Mesh {
    let bottom = GALLERY - GALLERY_THICKNESS;
    Mesh::union([course([bottom, GALLERY - 0.3], 0.06), course([GALLERY - 0.3, GALLERY - 0.02], 0.14)])
}

/// The cornice in front of the roof: a band, dentils, and two courses that overhang them.
pub fn cornice() -> Mesh {
    let [band, dentils, overhang, edge] = [ROOF - 0.3, ROOF, ROOF + DENTIL[0], ROOF_TOP - 0.2];
    Mesh::union([
        course([band, dentils], 0.06),
        course([dentils, overhang], 0.08),
        dentil_row(dentils, 0.08),
        course([overhang, edge], 0.34),
        course([edge, ROOF_TOP], 0.46),
    ])
}

/// A block along the whole wall that stands out by `relief`.
fn course([bottom, top]: [f64; 2], relief: f64) -> Mesh {
    shapes::cuboid(DVec3::new(face() - relief, bottom, -HALF_LENGTH), DVec3::new(ARCADE, top, HALF_LENGTH))
}

/// Small blocks in a row, on a course that stands out by `relief`.
fn dentil_row(bottom: f64, relief: f64) -> Mesh {
    let [side, step] = DENTIL;
    let count = (2.0 * HALF_LENGTH / step) as u32;
    let high = DVec3::new(face(), bottom + side, 0.5 * side);
    let dentil = shapes::cuboid(DVec3::new(face() - relief - side, bottom, -0.5 * side), high);
    let place = |i: u32| (f64::from(i) + 0.5) * step - HALF_LENGTH;
    Mesh::union((0..count).map(|i| dentil.clone().moved(DVec3::Z * place(i))))
}

/// The court face of the wall.
fn face() -> f64 {
    ARCADE - 0.5 * ARCADE_THICKNESS
}
