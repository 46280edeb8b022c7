//! Millions of rays.

use fogbow_testing::meshes;
use fogbow_testing::rays::{Departures, depart, leaks};

#[test]
fn ten_million_rays_stay_in_closed_meshes() {
    assert_eq!(leaks(&meshes::cube(), 0.9, 3_000_000, 101), 0);
    assert_eq!(leaks(&meshes::sphere(4), 0.9, 3_000_000, 102), 0);
    assert_eq!(leaks(&meshes::bumpy_sphere(6), 0.6, 4_000_000, 103), 0);
}

#[test]
fn millions_of_rays_leave_surfaces_to_the_side_they_go_to() {
    assert_eq!(depart(&meshes::cube(), 3_000_000, 104), Departures::default());
    assert_eq!(depart(&meshes::sphere(5), 3_000_000, 105), Departures::default());
}
