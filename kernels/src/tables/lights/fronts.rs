//! Lights that cannot hide each other: disks in a wall, on a ceiling, or on the outside of something convex.
//!
//! ```text
//! a disk of centre c, radius R and normal n reaches   h(m) = c . m + R |n x m|   along a unit vector m
//! the front of a disk is clear if no disk reaches beyond its plane:   h_j(n) <= c . n for all j
//! ```
//!
//! 1. A segment from in front of a disk to a point of it stays in front of its plane. Where its front is clear, that is
//!    where no disk is.
//! 2. Disks of one normal have one h, so that a wall of them takes one pass. More than [`MOST_NORMALS`] are not looked at.

use glam::DVec3;

use super::{Emitter, Shape};

/// Most normals that disks are asked along.
const MOST_NORMALS: usize = 64;

/// How far beyond a plane disks may reach that are meant to lie in it, in terms of the largest coordinate: what single
/// precision makes of a place.
const FLAT: f64 = 4.0 * f32::EPSILON as f64;

/// Whether `emitters` are disks with clear fronts, or one light alone.
pub(super) fn are_clear(emitters: &[Emitter]) -> bool {
    if emitters.len() < 2 {
        return true;
    }
    if emitters.iter().any(|emitter| emitter.shape != Shape::Disk || emitter.double_sided) {
        return false;
    }
    let mut normals = Vec::new();
    for emitter in emitters {
        if !normals.contains(&emitter.normal) {
            normals.push(emitter.normal);
        }
        if normals.len() > MOST_NORMALS {
            return false;
        }
    }
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let largest = emitters.iter().map(|disk| vector(disk.origin).abs().max_element()).fold(0.0, f64::max);
    normals.into_iter().all(|normal| {
        let along = vector(normal);
        let across =
            |disk: &Emitter| if disk.normal == normal { 0.0 } else { vector(disk.normal).cross(along).length() };
        let reach = |disk: &Emitter| vector(disk.origin).dot(along) + f64::from(disk.radius) * across(disk);
        let most = emitters.iter().map(reach).fold(f64::NEG_INFINITY, f64::max) - largest * FLAT;
        emitters.iter().filter(|disk| disk.normal == normal).all(|disk| most <= vector(disk.origin).dot(along))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disk(center: [f64; 3], normal: [f64; 3], radius: f64) -> Emitter {
        Emitter::disk(DVec3::from(center), DVec3::from(normal), radius, [1.0; 3])
    }

    /// Disks of a tilted wall.
    fn wall() -> Vec<Emitter> {
        let (u, v, n) = (DVec3::new(2.0, 1.0, 0.0), DVec3::new(1.0, -2.0, 5.0), [1.0, -2.0, -1.0]);
        let place = |i: u32| DVec3::new(1e3, 7.0, -3.0) + f64::from(i % 7) * u + f64::from(i / 7) * v;
        (0..49).map(|i| disk(place(i).to_array(), n, 0.5)).collect()
    }

    #[test]
    fn disks_of_a_wall_are_clear() {
        assert!(are_clear(&wall()));
        let behind = disk([1000.0 - 5.0, 17.0, 2.0], [0.3, 0.2, 0.5], 1.0);
        let before = disk([1000.0 + 5.0, -3.0, -8.0], [1.0, -2.0, -1.0], 1.0);
        assert!(!are_clear(&[wall(), vec![behind]].concat()), "it looks at the wall from behind");
        assert!(!are_clear(&[wall(), vec![before]].concat()), "it is in front of the wall");
    }

    #[test]
    fn disks_on_the_outside_of_a_box_are_clear_and_those_on_its_inside_are_not() {
        let sides = |sign: f64| {
            let side = |i: usize| {
                let out = DVec3::AXES[i % 3] * if i < 3 { 1.0 } else { -1.0 };
                disk(out.to_array(), (sign * out).to_array(), 0.9)
            };
            (0..6).map(side).collect::<Vec<_>>()
        };
        assert!(are_clear(&sides(1.0)));
        assert!(!are_clear(&sides(-1.0)));
    }

    #[test]
    fn a_disk_that_cuts_a_plane_is_not_clear() {
        let upright = |radius: f64| disk([0.0, 0.0, -1.0], [1.0, 0.0, 0.0], radius);
        let level = disk([2.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5);
        assert!(!are_clear(&[level, upright(1.1)]));
        assert!(!are_clear(&[level, upright(0.9)]), "the level one is partly in front of the upright one");
        assert!(are_clear(&[disk([-2.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5), upright(0.9)]));
    }

    #[test]
    fn spheres_and_what_is_at_infinity_are_clear_alone() {
        let sphere = |x: f64| Emitter::sphere(DVec3::new(x, 0.0, 0.0), 0.5, [1.0; 3]);
        assert!(are_clear(&[sphere(0.0)]));
        assert!(!are_clear(&[sphere(0.0), sphere(3.0)]));
        assert!(!are_clear(&[disk([0.0; 3], [0.0, 0.0, 1.0], 1.0), Emitter::distant([1.0; 3])]));
    }

    #[test]
    fn many_normals_are_not_looked_at() {
        let fan = |i: u32| {
            let angle = f64::from(i) * 0.05;
            disk([angle.cos(), angle.sin(), 0.0], [angle.cos(), angle.sin(), 0.0], 1e-3)
        };
        assert!(are_clear(&(0..64).map(fan).collect::<Vec<_>>()));
        assert!(!are_clear(&(0..65).map(fan).collect::<Vec<_>>()));
    }
}
