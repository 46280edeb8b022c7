//! The round window of the east wall.

use core::f64::consts::TAU;

use glam::DVec2;

use crate::{
    Mesh,
    shapes::{self, Circle},
};

/// The opening `[m]`.
pub const ROSE: Circle = Circle { center: DVec2::new(0.0, 7.4), radius: 1.6 };
/// Number of petals.
const PETALS: u32 = 12;
/// Radius of the ring in the middle `[m]`.
const HUB: f64 = 0.3;
/// Half the width of a spoke `[m]`.
const SPOKE: f64 = 0.03;
/// Radius of the ring at the end of a petal, and the distance of its middle from that of the rose `[m]`.
const EYE: [f64; 2] = [0.24, 1.21];

/// The stones in it: two rings, spokes between them, and a small ring at the end of every petal.
pub fn rose() -> Mesh {
    let [radius, away] = EYE;
    let ring = |radius: f64, width: f64, thickness: f64, sides: u32| {
        shapes::circle_ring(Circle { radius, ..ROSE }, width, thickness, sides)
    };
    let eyes = (0..PETALS).map(|i| {
        let center = ROSE.center + away * direction(f64::from(i) + 0.5);
        shapes::circle_ring(Circle { center, radius }, 0.06, 0.2, 12)
    });
    let spokes = (0..PETALS).map(|i| spoke(direction(f64::from(i))));
    let rings = [ring(HUB, 0.08, 0.22, 20), ring(ROSE.radius - 0.1, 0.15, 0.3, 36)];
    Mesh::union(rings.into_iter().chain(spokes).chain(eyes))
}

/// A bar outward from the middle ring.
fn spoke(direction: DVec2) -> Mesh {
    let corner = |along: f64, across: f64| ROSE.center + along * direction + across * SPOKE * direction.perp();
    let [inner, outer] = [HUB + 0.05, ROSE.radius - 0.05];
    // Chains run from left to right, whichever way the spoke points.
    let chains = if direction.x < 0.0 {
        [[corner(outer, 1.0), corner(inner, 1.0)], [corner(outer, -1.0), corner(inner, -1.0)]]
    } else {
        [[corner(inner, -1.0), corner(outer, -1.0)], [corner(inner, 1.0), corner(outer, 1.0)]]
    };
    shapes::wall(&chains[0], &chains[1], 0.18)
}

/// A direction, `petals` from the first.
fn direction(petals: f64) -> DVec2 {
    DVec2::from_angle(TAU * petals / f64::from(PETALS))
}
