mod shapes;

use glam::DVec3;
use wide::f32x8;

use self::shapes::*;
use super::*;
use crate::lanes;
use crate::random::{uniform, words};
use crate::vec3::Vec3x8;

/// Rounding of the surface's place.
const ROUNDING: f64 = 1e-6;

fn mesh(triangles: Triangles) -> ClosedMesh {
    ClosedMesh::new(&triangles).expect("a closed mesh")
}

fn contains(mesh: &ClosedMesh, at: [f32; 3]) -> bool {
    lanes::bits(mesh.contains(Vec3x8::splat(at))) == lanes::ALL
}

fn real(at: [f32; 3]) -> DVec3 {
    DVec3::from(at.map(f64::from))
}

/// A random point within 1.1 of the origin along each axis.
fn point(index: u32) -> [f32; 3] {
    let words = words(index, 1, 2, 3);
    [0, 1, 2].map(|axis| (1.1 * (2.0 * uniform(words[axis]) - 1.0)) as f32)
}

/// A random point of the lattice of eighths.
fn lattice_point(index: u32) -> [f32; 3] {
    point(index).map(|x| (8.0 * x).round() / 8.0)
}

/// Whether kernel and twin agree about a point, or about one that is next to it.
fn agrees(mesh: &ClosedMesh, at: [f32; 3]) -> bool {
    let found = contains(mesh, at);
    let is_found = |offset: DVec3| mesh.contains_reference(real(at) + offset) == found;
    let corner = |index: usize| DVec3::from([0, 1, 2].map(|axis| [-1.0, 1.0][index >> axis & 1]));
    is_found(DVec3::ZERO) || (0..8).map(corner).any(|corner| is_found(ROUNDING * corner))
}

/// Several shapes, regular and irregular ones, as they are, turned and inside out.
fn variety() -> Vec<Triangles> {
    let two = [cuboid([-0.5; 3], [0.25; 3]), cuboid([-0.25; 3], [0.5, 0.75, 0.5])].concat();
    let hollow = [sphere(2), inverted(cuboid([-0.25; 3], [0.25; 3]))].concat();
    let shapes = [cuboid([-0.5; 3], [0.75; 3]), tetrahedron(), sphere(3), torus(16, 8), bumpy(3), two, hollow];
    shapes.into_iter().flat_map(|shape| [turned(shape.clone()), inverted(turned(shape.clone())), shape]).collect()
}

#[test]
fn a_cube_holds_what_is_between_its_faces() {
    let cube = mesh(cuboid([-0.5; 3], [0.5; 3]));
    assert_eq!(cube.bounds(), [[-0.5; 3], [0.5; 3]]);
    for index in 0..10_000 {
        let at = point(index);
        assert_eq!(contains(&cube, at), at.iter().all(|x| x.abs() < 0.5), "{at:?}");
    }
}

#[test]
fn round_shapes_are_those_of_their_equations() {
    let (ball, ring) = (mesh(sphere(5)), mesh(torus(128, 64)));
    let mut near = 0;
    for index in 0..20_000 {
        let at = point(index);
        let [x, y, z] = at.map(f64::from);
        let depths = [1.0 - real(at).length(), TORUS[1] - ((x.hypot(y) - TORUS[0]).hypot(z))];
        for (mesh, depth) in [&ball, &ring].into_iter().zip(depths) {
            // Sides are below the surface by less than this.
            let is_near = depth.abs() < 2e-3;
            assert!(is_near || contains(mesh, at) == (depth > 0.0), "{at:?} at a depth of {depth}");
            near += u32::from(is_near);
        }
    }
    assert!(near < 400, "{near} points near the surface");
}

#[test]
fn kernel_and_twin_agree() {
    for triangles in variety() {
        let mesh = mesh(triangles);
        for index in 0..5_000 {
            assert!(agrees(&mesh, point(index)), "{:?}", point(index));
        }
    }
}

/// Corners, edges and planes of unturned shapes are on this lattice, and rays meet them exactly.
#[test]
fn points_above_and_below_corners_and_edges_are_nothing_special() {
    for triangles in variety() {
        let corners: Vec<[f32; 3]> = triangles.as_flattened().to_vec();
        let mesh = mesh(triangles);
        for index in 0..1_000 {
            let [a, b, c] = [0, 1, 2].map(|corner| corners[(3 * index + corner) % corners.len()]);
            let (at, share) = (point(index as u32), lattice_point(index as u32)[0]);
            let on_edge = [0, 1, 2].map(|axis| a[axis] + share * (b[axis] - a[axis]));
            let on_side = [0, 1, 2].map(|axis| on_edge[axis] + 0.375 * (c[axis] - on_edge[axis]));
            for (mut above, axis) in [a, on_edge, on_side].into_iter().flat_map(|on| (0..3).map(move |axis| (on, axis)))
            {
                above[axis] = at[axis];
                assert!(agrees(&mesh, above), "{above:?}");
            }
            assert!(agrees(&mesh, lattice_point(index as u32)), "{:?}", lattice_point(index as u32));
        }
    }
}

#[test]
fn small_meshes_far_away_are_watertight() {
    for (scale, offset) in [(0.1, 1000.0), (1e-3, 1000.0), (1e6, 0.0), (1e-6, 0.0)] {
        let middle = DVec3::new(offset, -offset, 0.5 * offset);
        let mesh = mesh(moved(turned(bumpy(3)), |at| scale * at + middle));
        let rounding = 1e-6 * scale + 4e-8 * offset;
        for at in (0..2_000).map(|index| (scale * real(point(index)) + middle).as_vec3().to_array()) {
            let found = contains(&mesh, at);
            let corner = |index: usize| DVec3::from([0, 1, 2].map(|axis| [-1.0, 1.0][index >> axis & 1]));
            let mut near = (0..8).map(corner).chain([DVec3::ZERO]);
            let is_found = near.any(|offset| mesh.contains_reference(real(at) + rounding * offset) == found);
            assert!(is_found, "{at:?} at a scale of {scale}");
        }
    }
}

/// What is left and right of a plane on which corners lie, as close as numbers are.
#[test]
fn next_to_the_axis_of_a_sphere_nothing_is_missed() {
    let ball = mesh(sphere(4));
    for ulps in -40..=40 {
        for (u, v) in [(0, 1), (1, 2), (2, 0)] {
            let mut at = [0.0; 3];
            (at[u], at[v]) = (ulps as f32 * f32::MIN_POSITIVE, ulps as f32 * 1e-8);
            assert!(contains(&ball, at), "{at:?}");
        }
    }
}

#[test]
fn parts_are_united_and_hollows_are_outside() {
    let nested = mesh([cuboid([-1.0; 3], [1.0; 3]), cuboid([-0.5; 3], [0.5; 3])].concat());
    let hollow = mesh([cuboid([-1.0; 3], [1.0; 3]), inverted(cuboid([-0.5; 3], [0.5; 3]))].concat());
    let across = mesh([cuboid([-1.0; 3], [0.5; 3]), cuboid([-0.5; 3], [1.0; 3])].concat());
    let points = [[0.0; 3], [0.75; 3], [-0.75; 3], [0.75, -0.75, 0.75]];
    for (mesh, expected) in
        [(nested, [true; 4]), (hollow, [false, true, true, true]), (across, [true, true, true, false])]
    {
        assert_eq!(points.map(|at| contains(&mesh, at)), expected);
    }
}

#[test]
fn outsides_may_be_insides() {
    for triangles in variety() {
        let (mesh, inverted) = (mesh(triangles.clone()), mesh(inverted(triangles)));
        for at in (0..2_000).map(point) {
            assert_eq!(contains(&mesh, at), contains(&inverted, at), "{at:?}");
        }
    }
}

#[test]
fn lanes_do_not_know_each_other() {
    let mesh = mesh(bumpy(3));
    for batch in 0..500 {
        let points: [[f32; 3]; 8] = core::array::from_fn(|lane| point(8 * batch + lane as u32));
        let component = |axis: usize, shift: usize| f32x8::new(core::array::from_fn(|i| points[(i + shift) % 8][axis]));
        let alone = points.map(|at| contains(&mesh, at));
        for shift in 0..8 {
            let at = Vec3x8::new(component(0, shift), component(1, shift), component(2, shift));
            let found = lanes::bits(mesh.contains(at));
            let expected = (0..8).map(|lane| u32::from(alone[(lane + shift) % 8]) << lane).sum::<u32>();
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn points_that_are_nowhere_are_outside() {
    let ball = mesh(sphere(2));
    for x in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, 1.000_1] {
        for axis in 0..3 {
            let mut at = [0.0; 3];
            at[axis] = x;
            assert!(!contains(&ball, at), "{at:?}");
        }
    }
}

#[test]
fn open_edges_are_listed() {
    let mut triangles = cuboid([0.0; 3], [1.0; 3]);
    let missing = triangles.pop().expect("twelve triangles");
    let Err(OpenMesh::Edges(open)) = ClosedMesh::new(&triangles) else { panic!("an open mesh") };
    assert_eq!(open.len(), 3);
    for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (missing[from], missing[to])) {
        let is_found = open.iter().any(|edge| match (edge.there, edge.back) {
            (1, 0) => edge.ends == [to, from],
            (0, 1) => edge.ends == [from, to],
            _ => false,
        });
        assert!(is_found, "{from:?} to {to:?} in {open:?}");
    }
}

#[test]
fn a_side_that_faces_the_other_way_is_open() {
    let mut triangles = cuboid([0.0; 3], [1.0; 3]);
    triangles[3].swap(0, 1);
    let Err(OpenMesh::Edges(open)) = ClosedMesh::new(&triangles) else { panic!("an open mesh") };
    assert_eq!(open.len(), 3);
    assert!(open.iter().all(|edge| matches!([edge.there, edge.back], [2, 0] | [0, 2])), "{open:?}");
}

#[test]
fn edges_and_points_are_no_triangles() {
    let thin = [[0.0; 3], [1.0, 0.0, 0.0], [-0.0; 3]];
    assert_eq!(ClosedMesh::new(&[]), Err(OpenMesh::Empty));
    assert_eq!(ClosedMesh::new(&[thin, [[2.0; 3]; 3]]), Err(OpenMesh::Empty));
    let mut triangles = cuboid([0.0; 3], [1.0; 3]);
    triangles.push(thin);
    assert_eq!(ClosedMesh::new(&triangles), ClosedMesh::new(&cuboid([-0.0; 3], [1.0; 3])));
}

/// A sheet of two sides has no inside, however few columns it has.
#[test]
fn a_sheet_is_empty() {
    let [sheet, needle] = [[1.0, 1.0, 0.0], [1.0, 0.0, 0.0]].map(|size| {
        let flat = moved(sphere(2), |at| at * DVec3::from(size));
        ClosedMesh::new(&flat).map(|mesh| (0..500).any(|index| contains(&mesh, lattice_point(index))))
    });
    assert_eq!(sheet, Ok(false));
    assert!(needle != Ok(true));
}

#[test]
fn boxes_are_full_or_empty_only_if_all_of_their_points_are() {
    let mut count = [0; 3];
    for triangles in variety() {
        let mesh = mesh(triangles);
        for index in 0..1_500 {
            let (middle, size) = (point(index), point(index + 1_000_000)[0].powi(4) * 0.3);
            let [low, high] = [-size, size].map(|size| middle.map(|x| x + size));
            let fill = mesh.fills(low, high);
            count[fill as usize] += 1;
            for inner in (0..20).map(|i| point(20 * index + i + 2_000_000)) {
                let at = [0, 1, 2].map(|axis| (middle[axis] + size * inner[axis]).clamp(low[axis], high[axis]));
                let found = contains(&mesh, at);
                let is_possible = match fill {
                    Fill::Inside => found,
                    Fill::Outside => !found,
                    Fill::Part => true,
                };
                assert!(is_possible, "{at:?} in {low:?} to {high:?}, {fill:?}");
            }
        }
    }
    assert!(count.iter().all(|count| *count > 1_000), "{count:?}");
}

#[test]
fn boxes_are_parts_only_near_the_surface() {
    let ball = mesh(sphere(4));
    let side = 0.02_f32;
    for index in 0..5_000 {
        let low = point(index);
        let high = low.map(|x| x + side);
        let middle = real(low) + 0.5 * f64::from(side);
        let depth = 1.0 - middle.length();
        // Half a diagonal, and how far sides are below the sphere.
        let is_near = depth.abs() < 0.867 * f64::from(side) + 0.005;
        let expected = if depth > 0.0 { Fill::Inside } else { Fill::Outside };
        let found = ball.fills(low, high);
        assert!(found == expected || is_near, "{low:?}: {found:?}, {depth} below the surface");
    }
    assert_eq!(ball.fills([-9.0; 3], [9.0; 3]), Fill::Part);
    assert_eq!(ball.fills([2.0; 3], [9.0; 3]), Fill::Outside);
    assert_eq!(ball.fills([-f32::INFINITY; 3], [f32::INFINITY; 3]), Fill::Part);
}

#[test]
fn the_digest_tells_surfaces_apart() {
    let digest = |triangles: Triangles| {
        let mut bytes = Vec::new();
        mesh(triangles).digest(&mut |part| bytes.extend_from_slice(part));
        bytes
    };
    assert_eq!(digest(sphere(1)), digest(sphere(1)));
    assert_ne!(digest(sphere(1)), digest(inverted(sphere(1))));
    assert_ne!(digest(sphere(1)), digest(bumpy(1)));
    assert_eq!(digest(bumpy(0)).len(), 8 * 36);
}
