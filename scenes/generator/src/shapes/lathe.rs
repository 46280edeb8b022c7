//! Solids of revolution.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::Mesh;

/// The solid that a profile sweeps about the y axis, with `sides` flat sides. The profile runs from the lower end to
/// the upper; x is the radius, y the height. An end on the axis is a pole, any other a flat cap.
///
/// # Panics
/// If the profile is shorter than two points or touches the axis between its ends.
pub fn lathe(profile: &[DVec2], sides: u32) -> Mesh {
    let [first, inner @ .., last] = profile else { panic!("a profile has two ends") };
    assert!(inner.iter().all(|point| point.x > 0.0), "the profile touches the axis: {inner:?}");
    let mut mesh = Mesh::default();
    let rings: Vec<Ring> = profile.iter().map(|&point| Ring::new(&mut mesh, point, sides)).collect();
    for pair in rings.windows(2) {
        for side in 0..sides {
            join(&mut mesh, pair[0].edge(side), pair[1].edge(side));
        }
    }
    for side in 1..sides - 1 {
        if first.x > 0.0 {
            mesh.triangles.push([rings[0].at(0), rings[0].at(side), rings[0].at(side + 1)]);
        }
        if last.x > 0.0 {
            let ring = &rings[rings.len() - 1];
            mesh.triangles.push([ring.at(0), ring.at(side + 1), ring.at(side)]);
        }
    }
    mesh
}

/// Joins an edge of one ring with that of the ring above; an edge of a pole is a point.
fn join(mesh: &mut Mesh, [a, b]: [u32; 2], [above_a, above_b]: [u32; 2]) {
    if above_a == above_b {
        mesh.triangles.push([a, above_a, b]);
    } else if a == b {
        mesh.triangles.push([a, above_a, above_b]);
    } else {
        mesh.quad([a, above_a, above_b, b]);
    }
}

/// The vertices that one point of the profile sweeps.
struct Ring {
    start: u32,
    count: u32,
}

impl Ring {
    fn new(mesh: &mut Mesh, point: DVec2, sides: u32) -> Self {
        let start = mesh.positions.len() as u32;
        let count = if point.x == 0.0 { 1 } else { sides };
        mesh.positions.extend((0..count).map(|side| {
            let (sin, cos) = (TAU * f64::from(side) / f64::from(sides)).sin_cos();
            DVec3::new(point.x * cos, point.y, point.x * sin)
        }));
        Self { start, count }
    }

    fn at(&self, side: u32) -> u32 {
        self.start + side % self.count
    }

    fn edge(&self, side: u32) -> [u32; 2] {
        [self.at(side), self.at(side + 1)]
    }
}
