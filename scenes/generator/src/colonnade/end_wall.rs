//! The wall at the far end of the court, at +z. The other is the same after half a turn.

use glam::DVec3;

use super::{
    dimensions::{ARCADE, GABLE, GALLERY, HALF_LENGTH, LOWER_SPRING, OUTER, OUTER_THICKNESS, ROOF_TOP, UPPER_SPRING},
    storey::ring,
};
use crate::{
    Mesh,
    shapes::{self, Arch},
};

/// The tall window of the court.
const WINDOW: Arch = Arch { center: 0.0, spring: 12.4, radius: 2.2 };
/// The door below it.
const DOOR: Arch = Arch { center: 0.0, spring: LOWER_SPRING, radius: 1.6 };
/// Radius of the windows at the ends of the galleries `[m]`.
const SIDE_RADIUS: f64 = 1.5;
/// Half the widths of the posts that divide the tall window `[m]`.
const MULLION_HALF_WIDTHS: [f64; 2] = [0.09, 0.12];

/// The wall: a middle part as wide as the court, and lower parts at the ends of the galleries.
pub fn end_wall() -> Mesh {
    let edge = OUTER + OUTER_THICKNESS;
    let side = 0.5 * (ARCADE + OUTER);
    let side_window = |center| Arch { center, spring: UPPER_SPRING, radius: SIDE_RADIUS };
    let side_door = |center| Arch { center, spring: LOWER_SPRING, radius: SIDE_RADIUS };
    Mesh::union([
        pierced([-ARCADE, ARCADE], [0.0, GALLERY], DOOR),
        pierced([-ARCADE, ARCADE], [GALLERY, GABLE], WINDOW),
        pierced([-edge, -ARCADE], [0.0, GALLERY], side_door(-side)),
        pierced([-edge, -ARCADE], [GALLERY, ROOF_TOP], side_window(-side)),
        pierced([ARCADE, edge], [0.0, GALLERY], side_door(side)),
        pierced([ARCADE, edge], [GALLERY, ROOF_TOP], side_window(side)),
        mullions(),
    ])
    .moved(DVec3::Z * (HALF_LENGTH + 0.5 * OUTER_THICKNESS))
}

/// A part of the wall with one arched opening down to its foot: two piers, the band above them, and a ring.
fn pierced([left, right]: [f64; 2], [bottom, top]: [f64; 2], arch: Arch) -> Mesh {
    let half = 0.5 * OUTER_THICKNESS;
    let pier = |from: f64, to: f64| shapes::cuboid(DVec3::new(from, bottom, -half), DVec3::new(to, arch.spring, half));
    Mesh::union([
        pier(left, arch.center - arch.radius),
        pier(arch.center + arch.radius, right),
        shapes::arch_band([left, right], top, &[arch], OUTER_THICKNESS),
        ring(arch, OUTER_THICKNESS),
    ])
}

/// Two posts in the tall window.
fn mullions() -> Mesh {
    let [width, depth] = MULLION_HALF_WIDTHS;
    let place = WINDOW.radius / 3.0;
    let top = WINDOW.spring + (WINDOW.radius.powi(2) - place.powi(2)).sqrt();
    let post = shapes::cuboid(DVec3::new(-width, GALLERY, -depth), DVec3::new(width, top, depth));
    Mesh::union([-place, place].map(|x| post.clone().moved(DVec3::X * x)))
}
