//! Rays meet what they should: kernel against twin, watertightness, ties, edges of all kinds, and leaving surfaces.

use fogbow_kernels::tables::geometry::{FEW, Geometry, TriangleHit};
use fogbow_kernels::trace::through::IN_CACHE;
use fogbow_kernels::trace::{self, Ray};
use fogbow_testing::both_ways::assert_same_both_ways;
use fogbow_testing::meshes::{self, Mesh, Random, point, ray};
use fogbow_testing::rays::{Departures, compare, depart, leaks, may_meet};
use fogbow_testing::tolerances::DIFFERENT_HITS;
use glam::{DMat3, DVec3};

/// Rays from around the cube from -1 to 1 in all directions, half of them bounded.
fn random_rays(count: usize, seed: u32) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let one = |i| {
        let max = if i % 2 == 0 { f64::INFINITY } else { random.uniforms()[0] };
        ray(1.5 * random.in_cube(), random.direction(), max)
    };
    (0..count).map(one).collect()
}

/// Rays along the axes, from points of a lattice of numbers that f32 has exactly.
fn axis_rays() -> Vec<Ray> {
    let mut rays = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            for i in -9..=9 {
                for j in -9..=9 {
                    let mut origin = [f64::from(i) / 8.0; 3];
                    origin[(axis + 1) % 3] = f64::from(j) / 8.0;
                    origin[axis] = -1.5 * sign;
                    let mut direction = [0.0; 3];
                    direction[axis] = sign;
                    rays.push(ray(DVec3::from(origin), DVec3::from(direction), f64::INFINITY));
                }
            }
        }
    }
    rays
}

/// Rays from random points exactly to corners and about to the middles of edges.
fn aimed_rays(mesh: &Mesh, count: usize, seed: u32) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let one = |i| {
        let corners = mesh.corners[random.index(mesh.corners.len())].map(|c| point(mesh.positions[c as usize]));
        let to = if i % 2 == 0 { corners[0] } else { (corners[0] + corners[1]) / 2.0 };
        // On a lattice, so that the direction to a lattice's corner is exact.
        let from = (16.0 * random.in_cube()).round() / 8.0;
        ray(from, to - from, f64::INFINITY)
    };
    (0..count).map(one).collect()
}

/// A name, triangles, and the rays of every kind that are sent to them.
fn variety() -> Vec<(String, Mesh)> {
    let mut meshes = vec![
        ("soup of large triangles".to_string(), meshes::soup(300, 1.0, 1)),
        ("soup of small triangles".to_string(), meshes::soup(1000, 0.1, 2)),
        ("cube".to_string(), meshes::cube()),
        ("sphere".to_string(), meshes::sphere(2)),
        ("bumpy sphere".to_string(), meshes::bumpy_sphere(3)),
        ("grid".to_string(), meshes::grid(8)),
        ("landscape".to_string(), meshes::landscape(20)),
    ];
    let upright = meshes::grid(8).map(|p| DVec3::new(p.z, p.x, p.y));
    meshes.push(("upright grids".to_string(), meshes::grid(4).and(&upright)));
    for count in 1..=17 {
        meshes.push((format!("{count} triangles"), meshes::soup(count, 1.0, 10 + count as u32)));
    }
    meshes
}

#[test]
fn kernel_and_twin_meet_the_same_triangles() {
    let (mut rays, mut decisions) = (0, 0);
    for (name, mesh) in variety() {
        let found = compare(&name, &mesh, &random_rays(3000, 5));
        assert!(found.hits > 20, "{name}: {found:?}");
        (rays, decisions) = (rays + found.rays, decisions + found.decisions);
    }
    println!("{decisions} of {rays} rays were decided differently");
    assert!(decisions as f64 <= DIFFERENT_HITS * rays as f64, "{decisions} of {rays} rays were decided differently");
}

#[test]
fn rays_far_from_everything_are_passed_by() {
    let far = meshes::sphere(2).map(|p| 0.1 * p + DVec3::X).and(&meshes::sphere(2).map(|p| 0.1 * p - DVec3::X));
    let geometry = far.geometry();
    let met = |ray: &Ray| may_meet(&geometry, ray);
    assert!(!met(&ray(DVec3::ZERO, DVec3::Z, f64::INFINITY)), "between the spheres");
    assert!(!met(&ray(DVec3::ZERO, DVec3::X, 0.85)), "ends before");
    assert!(met(&ray(DVec3::ZERO, DVec3::X, 0.95)) && met(&ray(DVec3::ZERO, -DVec3::X, 0.95)));
    assert!(!met(&ray(2.0 * DVec3::X, DVec3::X, f64::INFINITY)), "leads away");
    assert!(!may_meet(&Geometry::new(Vec::new(), Vec::new()), &ray(DVec3::ZERO, DVec3::X, 1.0)), "nothing is there");
    let roof = meshes::grid(4).map(|p| DMat3::from_rotation_x(0.7) * p).geometry();
    let normal = DMat3::from_rotation_x(0.7) * DVec3::Z;
    let met = |from: DVec3, to: DVec3| may_meet(&roof, &ray(from, to - from, 1.0));
    for to in [0.5 * DVec3::X, DVec3::ZERO, 0.5 * normal.cross(DVec3::X)] {
        assert!(!met(1e-3 * normal, to + 0.2 * normal) && !met(-1e-3 * normal, to - 0.2 * normal), "on one side");
        assert!(met(1e-3 * normal, to - 0.2 * normal), "across the plane");
    }
}

#[test]
fn with_and_without_a_tree_hits_are_the_same_bits() {
    let mut random = Random::new(21);
    for (name, mesh) in variety() {
        // Two of every triangle, as far away; others without area; and a corner of each as where a ray starts.
        let twice = mesh.clone().and(&mesh);
        let line = |i: usize| [mesh.corners[i][0], mesh.corners[i][0], mesh.corners[i][1]];
        let lines = (0..mesh.corners.len()).step_by(3).map(line);
        let corners = lines.chain(twice.corners.iter().copied()).collect();
        let geometry = Mesh { corners, ..twice }.geometry();
        let corner = |random: &mut Random| point(mesh.positions[random.index(mesh.positions.len())]);
        let mut rays = random_rays(1000, 22);
        rays.extend(axis_rays());
        rays.extend(aimed_rays(&mesh, 1000, 23));
        rays.extend((0..500).map(|_| ray(corner(&mut random), random.direction(), f64::INFINITY)));
        rays.extend((0..500).map(|_| {
            let [from, to] = [corner(&mut random), corner(&mut random)];
            ray(from, to - from, 1.0)
        }));
        assert_same_both_ways(&name, &geometry, &rays);
    }
}

/// What lies in few planes, upright and not: name and triangles.
fn flat() -> Vec<(String, Mesh)> {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let plate = |side: u32| meshes::grid(side).map(|p| turn * p);
    vec![
        ("tilted grid".into(), plate(6)),
        ("tilted and upright grids".into(), plate(4).and(&meshes::grid(4))),
        ("room".into(), meshes::room(10)),
        ("tilted room".into(), meshes::room(10).map(|p| turn * p)),
        ("tilted grid far away".into(), plate(6).map(|p| 1e-2 * p + 30.0)),
        ("roof".into(), meshes::grid(6).map(|p| DMat3::from_rotation_x(0.7) * p)),
        ("slivers".into(), meshes::grid(6).map(|p| turn * (DVec3::new(1.0, 1e-3, 1.0) * p))),
        ("small tilted room".into(), meshes::room(10).map(|p| 1e-9 * (turn * p))),
        ("large tilted room".into(), meshes::room(10).map(|p| 1e9 * (turn * p))),
    ]
}

#[test]
fn no_ray_that_crosses_a_plane_is_left_out() {
    let mut random = Random::new(25);
    for (name, mesh) in flat() {
        let geometry = mesh.geometry();
        assert!(!geometry.tree().facets.is_empty(), "{name} is not known to be flat");
        let corners = |random: &mut Random| {
            mesh.corners[random.index(mesh.corners.len())].map(|c| point(mesh.positions[c as usize]))
        };
        let mut rays = Vec::new();
        for i in 0..60_000 {
            // From next to a point of a triangle, on either side, to next to another, or on, or along the plane.
            let [a, b, c] = corners(&mut random);
            let [u, v, height, far] = random.uniforms();
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let (size, normal) = ((b - a).length(), (b - a).cross(c - a).normalize());
            let above = |log: f64| size * 10_f64.powf(-8.0 * log) * normal;
            let from = a + u * (b - a) + v * (c - a) + above(height);
            let [other, ..] = corners(&mut random);
            let to = match i % 4 {
                0 => a - above(far),
                1 => other + above(far),
                2 => from + size * random.direction(),
                _ => from + size * (b - a).normalize() - if i % 3 == 0 { DVec3::ZERO } else { above(far) },
            };
            // Or from outside of an edge, in any direction.
            let from = if i % 5 == 0 { a + u * (b - a) - 1e-5 * v * (c - a) + above(height) } else { from };
            rays.push(ray(from, to - from, if i / 4 % 4 == 0 { f64::INFINITY } else { 1.0 }));
        }
        assert_same_both_ways(&name, &geometry, &rays);
        let hits = rays.iter().filter(|ray| trace::closest(&geometry, ray).is_some()).count();
        assert!(hits > 5_000, "{name}: {hits} hits");
    }
}

#[test]
fn few_triangles_are_known_to_be_few() {
    for count in [0, 1, FEW - 1, FEW, FEW + 1] {
        let geometry = meshes::soup(count, 1.0, 24).geometry();
        let triangles = geometry.few().map(|few| few.clusters.iter().map(|cluster| cluster.triangles.len()).sum());
        assert_eq!(triangles, (count <= FEW).then_some(count));
    }
}

#[test]
fn kernel_and_twin_meet_the_same_triangles_at_any_scale() {
    for (scale, shift) in [(1e-4, 0.0), (1e4, 0.0), (1e-9, 0.0), (1e9, 0.0), (1.0, 100.0), (1e-4, 1.0)] {
        let place = |p: DVec3| scale * p + shift;
        for (name, mesh) in [("soup", meshes::soup(300, 0.7, 3)), ("bumpy sphere", meshes::bumpy_sphere(2))] {
            let rays = random_rays(2000, 6);
            let moved: Vec<_> = rays
                .iter()
                .map(|one| ray(place(point(one.origin)), point(one.direction), scale * f64::from(one.max)))
                .collect();
            let found = compare(&format!("{name}, {scale:e} times, moved by {shift}"), &mesh.map(place), &moved);
            println!("{name}, {scale:e} times, moved by {shift}: {found:?}");
            assert!(found.hits > 100, "{found:?}");
        }
    }
}

#[test]
fn rays_along_axes_and_through_corners_are_decided_as_by_the_twin_but_for_rounding() {
    for (name, mesh) in variety() {
        let along = compare(&name, &mesh, &axis_rays());
        let aimed = compare(&name, &mesh, &aimed_rays(&mesh, 1000, 7));
        println!("{name}: along axes {along:?}, aimed {aimed:?}");
    }
}

#[test]
fn rays_through_corners_edges_and_faces_of_a_grid_hit_it() {
    let geometry = meshes::grid(8).geometry();
    for i in -16..=16 {
        for j in -16..=16 {
            for (from, slope) in [(1.0, 0.0), (-1.0, 0.0), (2.0, 0.25), (-0.5, -0.5)] {
                let at = DVec3::new(f64::from(i) / 16.0, f64::from(j) / 16.0, 0.0);
                let direction = DVec3::new(slope, slope / 2.0, -1.0) * from;
                let hit = trace::closest(&geometry, &ray(at - direction, direction, f64::INFINITY));
                let hit = hit.unwrap_or_else(|| panic!("the ray to {at} along {direction} leaks"));
                assert_eq!(hit.distance, 1.0, "to {at} along {direction}");
            }
        }
    }
}

#[test]
fn rays_in_the_plane_of_a_grid_pass_it_and_hit_what_stands_on_it() {
    let wall = meshes::grid(8).map(|p| DVec3::new(0.0, p.x, p.y));
    let both = meshes::grid(8).and(&wall).geometry();
    let flat = meshes::grid(8).geometry();
    for i in -8..=8 {
        let along = ray(DVec3::new(-2.0, f64::from(i) / 8.0, 0.0), DVec3::X, f64::INFINITY);
        assert_eq!(trace::closest(&flat, &along), None);
        let hit = trace::closest(&both, &along).unwrap_or_else(|| panic!("{along:?} leaks"));
        assert!(hit.distance == 2.0 && hit.triangle >= 128, "{hit:?}");
    }
}

#[test]
fn bounds_are_exclusive() {
    let geometry = meshes::bumpy_sphere(3).geometry();
    for ray in random_rays(2000, 8) {
        let Some(hit) = trace::closest(&geometry, &Ray { max: f32::INFINITY, ..ray }) else { continue };
        let bounded = |max: f32| trace::closest(&geometry, &Ray { max, ..ray });
        assert_eq!(bounded(hit.distance), None);
        assert_eq!(bounded(hit.distance.next_up()), Some(hit));
        assert!(!trace::any(&geometry, &Ray { max: hit.distance, ..ray }));
        assert!(trace::any(&geometry, &Ray { max: hit.distance.next_up(), ..ray }));
    }
}

#[test]
fn distances_count_in_the_length_of_the_direction() {
    let geometry = meshes::soup(300, 0.7, 4).geometry();
    for ray in random_rays(2000, 9) {
        let hit = trace::closest(&geometry, &ray);
        for scale in [2_f32.powi(-30), 0.25, 2_f32.powi(30)] {
            let longer = Ray { direction: ray.direction.map(|d| d * scale), max: ray.max / scale, ..ray };
            let expected = hit.map(|hit| TriangleHit { distance: hit.distance / scale, ..hit });
            assert_eq!(trace::closest(&geometry, &longer), expected, "{ray:?}, {scale} times");
        }
    }
}

#[test]
fn the_tree_does_not_show() {
    let mesh = meshes::soup(500, 0.5, 5).and(&meshes::bumpy_sphere(2));
    let geometry = mesh.geometry();
    // Every triangle alone is a tree of one leaf.
    let alone: Vec<_> =
        (0..geometry.len()).map(|i| Geometry::new(geometry.corners(i).to_vec(), vec![[0, 1, 2]])).collect();
    for ray in random_rays(3000, 10) {
        let hits = (0..).zip(&alone).filter_map(|(i, one)| Some((i, trace::closest(one, &ray)?)));
        let hits = hits.map(|(triangle, hit)| TriangleHit { triangle, ..hit });
        let nearest = hits.reduce(|best, hit| if hit.distance < best.distance { hit } else { best });
        let found = trace::closest(&geometry, &ray);
        assert_eq!(found, nearest, "{ray:?}");
    }
}

#[test]
fn rays_that_take_turns_in_a_large_tree_hit_the_same_bits() {
    let mesh = meshes::soup(150_000, 0.03, 31).and(&meshes::bumpy_sphere(5));
    let geometry = mesh.geometry();
    let leaves = geometry.tree().leaves.rows().len();
    assert!(leaves > IN_CACHE, "{leaves} leaves");
    let mut rays = random_rays(400, 32);
    rays.extend(meshes::flights(200, 0.05, 33));
    rays.extend(aimed_rays(&mesh, 200, 34));
    assert_same_both_ways("a large tree", &geometry, &rays);
}

#[test]
fn the_first_of_many_equal_triangles_is_hit() {
    let mut mesh = Mesh { positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]], corners: vec![] };
    mesh.corners = vec![[0, 1, 2]; 100_000];
    let geometry = mesh.geometry();
    for x in -4..=4 {
        let down = ray(DVec3::new(f64::from(x) / 16.0, 0.0, 1.0), -DVec3::Z, f64::INFINITY);
        let hit = trace::closest(&geometry, &down).expect("a hit");
        assert_eq!((hit.triangle, hit.distance), (0, 1.0));
        assert!(trace::any(&geometry, &down));
    }
}

#[test]
fn triangles_without_area_and_rays_without_direction_meet_nothing() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let empty = Geometry::new(vec![], vec![]);
    let lines = Geometry::new(positions.clone(), vec![[0, 1, 2], [0, 0, 3], [1, 1, 1]]);
    assert!(empty.is_empty() && empty.bounds().is_none() && lines.len() == 3 && lines.bounds().is_none());
    assert_eq!(empty.bytes(), 0);
    let through = ray(DVec3::new(0.5, 0.0, 1.0), -DVec3::Z, f64::INFINITY);
    for geometry in [&empty, &lines] {
        assert_eq!(trace::closest(geometry, &through), None);
        assert!(!trace::any(geometry, &through));
    }
    let mixed = Geometry::new(positions, vec![[0, 1, 2], [0, 1, 3]]);
    assert_eq!(mixed.bounds(), Some([[0.0; 3], [1.0, 1.0, 0.0]]));
    assert_eq!(trace::closest(&mixed, &through).map(|hit| hit.triangle), Some(1));
    for direction in [DVec3::ZERO, DVec3::NAN] {
        let still = ray(DVec3::new(0.2, 0.2, 0.0), direction, f64::INFINITY);
        assert_eq!(trace::closest(&mixed, &still), None);
        assert!(!trace::any(&mixed, &still));
    }
}

#[test]
fn barycentrics_name_the_point_that_is_hit() {
    let geometry = meshes::soup(500, 0.5, 6).geometry();
    for ray in random_rays(3000, 11) {
        let Some(hit) = trace::closest(&geometry, &ray) else { continue };
        let [u, v] = hit.barycentric.map(f64::from);
        let [a, b, c] = geometry.corners(hit.triangle as usize).map(point);
        let at = point(ray.origin) + f64::from(hit.distance) * point(ray.direction);
        let named = (1.0 - u - v) * a + u * b + v * c;
        let cosine = (b - a).cross(c - a).normalize().dot(point(ray.direction)).abs();
        assert!(at.distance(named) < 3e-6 / cosine, "{at}, barycentrics name {named}");
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 2e-7, "{hit:?}");
    }
}

#[test]
fn closed_meshes_do_not_leak() {
    assert_eq!(leaks(&meshes::cube(), 0.9, 100_000, 1), 0);
    assert_eq!(leaks(&meshes::sphere(3), 0.9, 50_000, 2), 0);
    assert_eq!(leaks(&meshes::bumpy_sphere(5), 0.6, 100_000, 3), 0);
    let far = |p: DVec3| 1e-2 * p + DVec3::new(30.0, -20.0, 10.0);
    let geometry = meshes::bumpy_sphere(4).map(far).geometry();
    let mut random = Random::new(12);
    for _ in 0..50_000 {
        let inside = ray(far(0.5 * random.direction()), random.direction(), f64::INFINITY);
        assert!(trace::closest(&geometry, &inside).is_some(), "{inside:?} leaks");
    }
}

#[test]
fn rays_that_leave_a_surface_neither_hit_it_nor_go_through() {
    let none = Departures::default();
    assert_eq!(depart(&meshes::cube(), 100_000, 1), none);
    assert_eq!(depart(&meshes::sphere(0), 100_000, 2), none);
    assert_eq!(depart(&meshes::sphere(4), 100_000, 3), none);
    assert_eq!(depart(&meshes::sphere(2).map(|p| 1e4 * p), 50_000, 4), none);
    assert_eq!(depart(&meshes::sphere(2).map(|p| 1e-4 * p), 50_000, 5), none);
    for (size, seed) in [(1e-13, 6), (1e-15, 7)] {
        assert_eq!(depart(&meshes::cube().map(|p| size * p), 50_000, seed), none, "{size:e} m");
    }
}
