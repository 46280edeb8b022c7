//! Reflection, by hand.

use bumpalo::Bump;

use super::*;
use crate::columns::Spectrum;
use crate::columns::paths::{LastSurfaceColumns, Path, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{Flight, FlightTable, SurfaceHitQueue};
use crate::lanes::LaneSet;
use crate::tables::geometry::Geometry;
use crate::tables::surfaces::{Material, Paint};

/// At the height 2, its front above.
const LEVEL: [[f32; 3]; 3] = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [0.0, 4.0, 2.0]];
const TILTED: [[f32; 3]; 3] = [[1.0, 0.5, -3.0], [-2.0, 7.0, 0.25], [5.0, 1.5, 9.0]];

const NORMALS: [DVec3; 5] =
    [DVec3::Z, DVec3::NEG_Z, DVec3::NEG_X, DVec3::new(0.6, 0.0, -0.8), DVec3::new(2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0)];

/// Centres of the cells of a grid over both random numbers.
fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
    let center = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    (0..n).flat_map(move |i| (0..n).map(move |j| [center(i), center(j)]))
}

/// The mean of a function of the reflected directions.
fn mean(normal: DVec3, of: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let n = 400;
    grid(n).map(|u| of(reflect(normal, u))).sum::<DVec3>() / f64::from(n * n)
}

#[test]
fn directions_have_the_moments_of_the_cosine() {
    for normal in NORMALS {
        // Mean of the cosine: integral of 2 c^2 over (0, 1). Mean of its square: of 2 c^3.
        let first = mean(normal, |direction| direction);
        assert!((first - 2.0 / 3.0 * normal).length() < 1e-4, "{first} around {normal}");
        let second = mean(normal, |direction| direction.dot(normal) * direction);
        assert!((second - 0.5 * normal).length() < 1e-4, "{second} around {normal}");
    }
}

#[test]
fn a_share_of_the_squared_sine_is_within_every_angle() {
    let n = 200;
    for angle in [0.2_f64, 0.7, 1.0, 1.5] {
        let within = grid(n).filter(|u| reflect(NORMALS[4], *u).dot(NORMALS[4]) > angle.cos()).count();
        let share = within as f64 / f64::from(n * n);
        assert!((share - angle.sin().powi(2)).abs() < 1.0 / f64::from(n), "{share} within {angle}");
    }
}

#[test]
fn directions_are_unit_vectors_on_the_side_of_the_normal() {
    let extremes = [0, 1 << 31, u32::MAX].map(random::uniform);
    for normal in NORMALS {
        for u in extremes.into_iter().flat_map(|first| extremes.map(|second| [first, second])) {
            let direction = reflect(normal, u);
            assert!((direction.length() - 1.0).abs() < 1e-12 && direction.dot(normal) > 0.0, "{direction}");
        }
    }
}

#[test]
fn azimuths_count_from_the_tangent_to_the_bitangent() {
    for normal in NORMALS {
        let (tangent, bitangent) = phase::frame(normal);
        for u in grid(8) {
            let direction = reflect(normal, u);
            let azimuth = core::f64::consts::TAU * u[1];
            let expected = u[0].sqrt() * azimuth.cos() * tangent + u[0].sqrt() * azimuth.sin() * bitangent;
            let cosine = direction.dot(normal);
            assert!((cosine * cosine - (1.0 - u[0])).abs() < 1e-12);
            assert!((direction - cosine * normal - expected).length() < 1e-12, "{direction} around {normal}");
        }
    }
}

#[test]
fn normals_point_to_where_the_path_came_from() {
    assert_eq!(side(LEVEL, DVec3::NEG_Z), DVec3::Z);
    assert_eq!(side(LEVEL, DVec3::Z), DVec3::NEG_Z);
    for direction in NORMALS {
        let [a, b, c] = corners(TILTED);
        let normal = side(TILTED, direction);
        assert!((normal.length() - 1.0).abs() < 1e-14 && normal.dot(direction) < 0.0);
        assert!(normal.dot(b - a).abs() < 1e-12 && normal.dot(c - a).abs() < 1e-12);
        let turned = [TILTED[0], TILTED[2], TILTED[1]];
        assert!((side(turned, direction) - normal).length() < 1e-14, "the winding has a say");
    }
}

#[test]
fn points_are_means_of_the_corners() {
    let [a, b, c] = corners(TILTED);
    assert_eq!([point(TILTED, [0.0, 0.0]), point(TILTED, [1.0, 0.0]), point(TILTED, [0.0, 1.0])], [a, b, c]);
    assert!((point(TILTED, [0.25, 0.5]) - (0.25 * a + 0.25 * b + 0.5 * c)).length() < 1e-14);
}

#[test]
fn clearances_are_units_of_rounding_of_the_coordinates_along_the_normal() {
    let nine = 9.0 / (2.0_f64.powi(24) - 9.0) * (1.0 + 2.0_f64.powi(-20));
    for weights in [[0.0, 0.0], [1.0, 0.0], [0.25, 0.5]] {
        let level = clearance(LEVEL, weights, DVec3::Z);
        assert!((level / (2.0 * nine) - 1.0).abs() < 1e-12, "{level:e}");
        assert_eq!(clearance(LEVEL.map(|[x, y, _]| [x, y, 0.0]), weights, DVec3::Z), 0.0);
    }
    // |b0 A| + |b1 B| + |b2 C| = (3, 2.625, 5.3125), whatever the signs.
    let normal = DVec3::new(2.0, -3.0, 6.0) / 7.0;
    let expected = nine * (2.0 * 3.25 + 3.0 * 2.625 + 6.0 * 5.3125) / 7.0;
    assert!((clearance(TILTED, [0.25, 0.5], normal) / expected - 1.0).abs() < 1e-12);
    // Weights of a sum beyond 1 by rounding leave nothing to the first corner.
    let beyond = clearance(TILTED, [0.5, 0.5 + 1e-7], normal);
    assert!((beyond / clearance(TILTED, [0.5, 0.5], normal) - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_kept_in_f32_is_strictly_on_the_side_of_the_normal() {
    for triangle in [LEVEL, TILTED, TILTED.map(|corner| corner.map(|x| 1e-3 * x + 1e5))] {
        let first = corners(triangle)[0];
        for (direction, weights) in NORMALS.into_iter().flat_map(|d| grid(10).map(move |weights| (d, weights))) {
            let normal = side(triangle, direction);
            let position = point(triangle, weights) + clearance(triangle, weights, normal) * normal;
            let kept = DVec3::from(round_along(position, normal).map(f64::from));
            assert!((kept - first).dot(normal) > 0.0, "{kept} of {triangle:?}");
        }
    }
    assert_eq!(round_along(DVec3::ONE, DVec3::Z), [1.0, 1.0, 1.0 + f32::EPSILON]);
    assert_eq!(round_along(DVec3::ONE, DVec3::NEG_X), [1.0 - f32::EPSILON / 2.0, 1.0, 1.0]);
}

/// Triangle 0 reflects on its front, 1 on both sides, 2 nowhere; all lie on [`LEVEL`].
fn surfaces() -> Surfaces {
    let geometry = Geometry::new(LEVEL.to_vec(), vec![[0, 1, 2]; 3]);
    let albedo = [0.5, 0.25, 0.0];
    let materials = [(albedo, false), (albedo, true), ([0.0; 3], true)];
    Surfaces::new(geometry, materials.map(|(albedo, both)| Material::plain(albedo, both)).to_vec(), vec![0, 1, 2])
}

fn hit(lane: u32, triangle: u32) -> SurfaceHit {
    SurfaceHit { lane, triangle, distance: 1.5, second: 0.25, third: 0.5 }
}

#[test]
fn backs_of_one_sided_surfaces_and_zero_albedos_are_black() {
    let black = |triangle, direction| is_black(&surfaces(), hit(0, triangle), direction);
    assert_eq!([0, 1, 2].map(|triangle| black(triangle, DVec3::NEG_Z)), [false, false, true], "from the front");
    assert_eq!([0, 1, 2].map(|triangle| black(triangle, DVec3::Z)), [true, false, true], "from the back");
}

#[test]
fn what_is_painted_black_is_black() {
    let colors = vec![[0.0; 3], [0.0; 3], [1.0; 3]];
    let painted = surfaces().painted(Paint { colors, ..Paint::default() });
    assert!(!is_black(&painted, hit(0, 0), DVec3::NEG_Z));
    assert_eq!(albedo(&painted, hit(0, 0)), [0.25, 0.125, 0.0]);
    assert!(is_black(&painted, SurfaceHit { second: 0.75, third: 0.0, ..hit(0, 0) }, DVec3::NEG_Z));
}

const CLOCK: u32 = 7;
const BIRTH: u32 = CLOCK - 2;
const BEFORE: LastSurface = LastSurface { depth: 1, normal: [1.0, 0.0, 0.0] };
const THROUGHPUT: [f32; 3] = [0.5, 1.0, 1.0];

/// What the stage leaves of a path.
#[derive(Clone, Copy, Debug)]
struct Left {
    next: Vertex,
    leaving: [f32; 3],
    last_surface: LastSurface,
    throughput: [f32; 3],
    live: bool,
}

/// Runs the stage on eight lanes of paths that arrive straight down, or up in odd lanes, from vertices of arc 10.
fn after(channels: usize, births: [u32; 8], listed: &[SurfaceHit]) -> [Left; 8] {
    let arena = Bump::new();
    let mut paths = PathColumns::new_in(&arena, 8);
    let mut live = LaneSet::new_in(&arena, 8);
    let mut last_surface = LastSurfaceColumns::new_in(&arena, 8);
    let mut throughput = Spectrum::new_in(&arena, 8, channels);
    let [mut vertex, mut next] = [(); 2].map(|()| VertexColumns::new_in(&arena, 8));
    let [mut ray, mut next_ray] = [(); 2].map(|()| RayColumns::new_in(&arena, 8));
    let mut flights = FlightTable::new_in(&arena, 8);
    let mut surface_hits = SurfaceHitQueue::new_in(&arena, 8);
    for (lane, birth) in births.into_iter().enumerate() {
        let down = if lane % 2 == 0 { -1.0 } else { 1.0 };
        paths.set_row(lane, Path { pixel: 3, sample: 4, birth });
        live.insert(lane);
        last_surface.set_row(lane, BEFORE);
        throughput.set_row(lane, THROUGHPUT);
        vertex.set_row(lane, Vertex { position: [1.0, 2.0, 2.0 - 1.5 * down], arc: 10.0 });
        ray.direction.set_row(lane, [0.0, 0.0, down]);
        flights.set_row(lane, Flight { flight: 9.0, cosine: 1 << 30, azimuth: 1 << 29 });
    }
    listed.iter().for_each(|hit| surface_hits.push(*hit));
    let columns = Columns {
        surfaces: &surfaces(),
        surface_hits: &surface_hits,
        paths: &paths,
        flights: &flights,
        live: &mut live,
        last_surface: &mut last_surface,
        vertex: &vertex,
        next: &mut next,
        ray: &ray,
        next_ray: &mut next_ray,
        throughput: &mut throughput,
    };
    run(Step { seed: 0, clock: CLOCK }, columns);
    core::array::from_fn(|lane| Left {
        next: next.row(lane),
        leaving: next_ray.direction.row(lane),
        last_surface: last_surface.row(lane),
        throughput: throughput.row(lane),
        live: live.contains(lane),
    })
}

#[test]
fn listed_paths_go_on_from_the_surface() {
    let [front, _, _, back, ..] = after(3, [BIRTH; 8], &[hit(0, 0), hit(3, 1)]);
    for (left, above) in [(front, 1.0), (back, -1.0)] {
        assert!(left.live);
        assert_eq!(left.last_surface, LastSurface { depth: 3, normal: [0.0, 0.0, above] });
        assert_eq!((left.throughput, left.next.arc), ([0.25, 0.25, 0.0], 11.5));
        let position = left.next.position;
        let off = (position[2] - 2.0) * above;
        assert!(position[..2] == [1.0, 2.0] && off > 0.0 && off < 2e-6, "{left:?}");
        // Words of a quarter and an eighth, but for half a cell: cosine sqrt(3/4), azimuth 45 degrees.
        let [x, y, z] = left.leaving;
        assert!((z * above - 0.75_f32.sqrt()).abs() < 1e-6, "{left:?}");
        assert!((x - 0.125_f32.sqrt()).abs() < 1e-6 && (y * above - 0.125_f32.sqrt()).abs() < 1e-6, "{left:?}");
    }
}

#[test]
fn paths_end_on_black_and_others_are_left_alone() {
    let left = after(3, [BIRTH; 8], &[hit(1, 0), hit(2, 0), hit(4, 2), hit(5, 1)]);
    assert_eq!(left.map(|left| left.live), [true, false, true, true, false, true, true, true]);
    for lane in [0, 3, 6, 7] {
        let Left { next, leaving, last_surface, throughput, .. } = left[lane];
        assert_eq!((last_surface, throughput), (BEFORE, THROUGHPUT));
        assert_eq!((next.position, next.arc, leaving), ([0.0; 3], 0.0, [0.0; 3]));
    }
}

#[test]
fn arcs_count_from_the_first_vertex_after_the_camera() {
    let births = core::array::from_fn(|lane| CLOCK - lane as u32);
    let left = after(3, births, &[0, 1, 2].map(|lane| hit(lane, 1)));
    let found = [0, 1, 2].map(|lane: usize| (left[lane].next.arc, left[lane].last_surface.depth));
    assert_eq!(found, [(0.0, 1), (11.5, 2), (11.5, 3)]);
}

#[test]
fn a_grey_path_takes_the_first_channel_of_the_albedo() {
    assert_eq!(after(1, [BIRTH; 8], &[hit(0, 0)])[0].throughput, [0.25; 3]);
}
