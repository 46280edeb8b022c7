//! godrays: a closed chapel that the sun enters through four windows.

use fogbow_scenes::godrays::dimensions::{ARCADE, FIGURE, MIDDLE, PITCH, SILL, SUN};
use glam::DVec3;

use crate::{
    glb::File,
    scene::{camera, folder, lights},
    surfaces::{Surface, first, is_free, named, solids_around},
};

const SCENE: &str = "godrays";
/// The sheets; all else is solid.
const PANES: [&str; 2] = ["northern sky", "eastern sky"];
/// Height of a window's middle `[m]`.
const WINDOW: f64 = 6.6;

fn surfaces() -> Vec<Surface> {
    File::read(SCENE).surfaces()
}

/// What is solid.
fn solids() -> Vec<Surface> {
    surfaces().into_iter().filter(|surface| !PANES.contains(&surface.name.as_str())).collect()
}

/// Whether nothing is between a point and the sun.
fn is_sunny(surfaces: &[Surface], point: DVec3) -> bool {
    is_free(surfaces, point, SUN)
}

/// z of the middles of all bays, from east to west.
fn bays() -> impl Iterator<Item = f64> {
    (0..6).map(|bay| MIDDLE + (f64::from(bay) - 2.5) * PITCH)
}

/// Points all over the chapel.
fn everywhere() -> impl Iterator<Item = DVec3> {
    let x = |i: u32| -7.0 + 14.0 * (f64::from(i) + 0.5) / 24.0;
    let z = |i: u32| -20.9 + 25.0 * (f64::from(i) + 0.5) / 40.0;
    [0.01, 1.7, 4.0, 7.0].into_iter().flat_map(move |y| (0..960).map(move |i| DVec3::new(x(i % 24), y, z(i / 24))))
}

/// Where sunlight that passes a point is at another height.
fn at_height(height: f64, through: DVec3) -> DVec3 {
    SUN.lerp(through, (SUN.y - height) / (SUN.y - through.y))
}

#[test]
fn all_but_the_panes_is_closed() {
    for surface in solids() {
        assert!(surface.is_closed() && !surface.double_sided, "{}", surface.name);
        assert!(surface.volume() > 0.2, "{}: {} m^3", surface.name, surface.volume());
        assert!(surface.albedo.iter().all(|&albedo| albedo <= 0.3), "{}: {:?}", surface.name, surface.albedo);
        assert_eq!(surface.emission, [0.0; 3], "{}", surface.name);
    }
}

#[test]
fn panes_shine_into_the_chapel() {
    let surfaces = surfaces();
    for (name, normal, emission, count, area) in [
        ("northern sky", DVec3::X, [0.075, 0.125, 0.205], 6, 56.6),
        ("eastern sky", DVec3::Z, [0.22, 0.38, 0.7], 4, 18.8),
    ] {
        let panes = named(&surfaces, name);
        assert_eq!((panes.albedo, panes.emission, panes.double_sided), ([0.0; 3], emission, false), "{name}");
        assert_eq!(panes.triangles.len(), 2 * count, "{name}");
        assert!(panes.faces(normal), "{name}");
        assert!((panes.area() - area).abs() < 0.05, "{name}: {} m^2", panes.area());
    }
}

#[test]
fn it_is_small() {
    let triangles: usize = surfaces().iter().map(|surface| surface.triangles.len()).sum();
    let bytes = std::fs::metadata(folder(SCENE).join("godrays.glb")).expect("a file").len();
    assert_eq!(triangles, 56_614);
    assert!(bytes < 750_000, "{bytes} bytes");
}

#[test]
fn the_nave_is_as_large_as_described() {
    let surfaces = surfaces();
    for (name, from, direction, distance) in [
        ("arcades", DVec3::new(0.0, 4.8, -6.3), DVec3::X, 4.0),
        ("arcades", DVec3::new(0.0, 4.8, -6.3), DVec3::NEG_X, 4.0),
        ("end walls", DVec3::new(0.0, 1.9, -8.4), DVec3::Z, 12.6),
        ("end walls", DVec3::new(0.0, 1.9, -8.4), DVec3::NEG_Z, 12.6),
        ("vault", DVec3::new(0.0, 0.0, -7.5), DVec3::Y, 10.95),
        ("aisles", DVec3::new(0.0, 2.0, -6.3), DVec3::X, 7.2),
    ] {
        let hit = first(&surfaces, from, direction).expect("the chapel is closed");
        assert!(hit.name == name && (hit.distance - distance).abs() < 0.01, "{name}: {hit:?}");
    }
    let height = |name: &str| named(&surfaces, name).bounds().map(|corner| corner.y);
    let near = |heights: [f64; 2], expected: [f64; 2]| (0..2).all(|i| (heights[i] - expected[i]).abs() < 1e-5);
    assert!(near(height("piers"), [0.0, 2.9]), "{:?}", height("piers"));
    assert!(near(height("vault"), [5.9, 11.4]), "{:?}", height("vault"));
    assert!(near(height("benches"), [0.0, 0.46]), "{:?}", height("benches"));
}

#[test]
fn the_camera_is_free_and_out_of_the_sun() {
    let surfaces = surfaces();
    let [position, forward] = camera(SCENE);
    assert_eq!(solids_around(&solids(), position), 0);
    assert!(!is_sunny(&surfaces, position));
    let ahead = first(&surfaces, position, forward).map_or(f64::INFINITY, |hit| hit.distance);
    assert!(ahead > 15.0, "{ahead} m along the axis");
    // The whole figure, and the sill of the nearest bright window.
    for point in [FIGURE + 0.1 * DVec3::Y, FIGURE + 1.85 * DVec3::Y, DVec3::new(ARCADE - 0.3, SILL + 0.2, -6.3)] {
        let hit = first(&surfaces, position, point - position);
        assert!(hit.is_none_or(|hit| hit.name == "figure" || hit.distance > 0.99), "{point}: {hit:?}");
    }
}

#[test]
fn the_sun_is_three_free_disks_side_by_side() {
    let solids = solids();
    let suns = lights(SCENE);
    assert_eq!(suns.len(), 3);
    let middle = suns.iter().map(|sun| sun.center).sum::<DVec3>() / 3.0;
    assert!((middle - SUN).length() < 1e-3, "{middle}");
    for (i, sun) in suns.iter().enumerate() {
        assert!(sun.points().all(|point| solids_around(&solids, point) == 0), "{sun:?}");
        for other in &suns[..i] {
            let apart = (sun.center - other.center).length() / (sun.radius + other.radius);
            assert!((1.0..1.05).contains(&apart), "{sun:?}, {other:?}");
            assert_eq!(sun.normal, other.normal);
        }
    }
    let distance = (DVec3::new(ARCADE, WINDOW, MIDDLE) - SUN).length();
    assert!((26.0..30.0).contains(&distance), "{distance} m");
    let width = 4.0 * suns[0].radius / distance;
    assert!((0.4..0.6).contains(&width.to_degrees()), "{} degrees", width.to_degrees());
}

#[test]
fn the_sun_shines_through_the_four_eastern_windows() {
    let surfaces = surfaces();
    for (bay, z) in bays().enumerate() {
        // West of the post, between the iron bars: the east wall shades the other half of the last window.
        let through = DVec3::new(ARCADE, WINDOW, z + 0.6);
        let patch = at_height(0.6, through);
        assert_eq!(is_sunny(&surfaces, patch), bay < 4, "bay {bay}: {patch}");
        assert!(
            !is_sunny(&surfaces, at_height(0.6, through + 1.5 * DVec3::Z)),
            "bay {bay}: the wall beside the window"
        );
        assert!(patch.x.abs() < ARCADE, "bay {bay}: in the nave, not at {patch}");
    }
}

#[test]
fn the_figure_stands_in_the_light() {
    let others: Vec<Surface> = surfaces().into_iter().filter(|surface| surface.name != "figure").collect();
    let heights = (0..18).map(|i| 0.05 + 0.1 * f64::from(i));
    let sunny = heights.filter(|&height| is_sunny(&others, FIGURE + height * DVec3::Y)).count();
    assert!(sunny >= 12, "{sunny} of 18 points from its feet to its head");
}

#[test]
fn the_sun_shines_nowhere_else() {
    let surfaces = surfaces();
    let mut sunny = 0;
    for point in everywhere().filter(|point| point.x < ARCADE - 0.2 && is_sunny(&surfaces, *point)) {
        let through = point.lerp(SUN, (ARCADE - point.x) / (SUN.x - point.x));
        let window = bays().take(4).any(|z| (through.z - z).abs() < 1.25) && (SILL..8.8).contains(&through.y);
        assert!(window, "{point} through {through}");
        sunny += 1;
    }
    assert!(sunny > 80, "{sunny} of 3840 points in the sun");
    // The hood lets out nothing sideways.
    for direction in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        assert_eq!(first(&surfaces, SUN, direction).map(|hit| hit.name), Some("hood"), "{direction}");
    }
}

#[test]
fn the_sky_fills_the_windows_that_the_camera_sees() {
    let surfaces = surfaces();
    let [position, _] = camera(SCENE);
    for (x, y) in [(-1.4, 3.0), (0.1, 3.0), (1.6, 3.0), (0.0, 7.4), (0.05, 8.6), (-1.2, 7.4)] {
        let beyond = DVec3::new(x, y, -22.0);
        let hit = first(&surfaces, position, beyond - position).expect("a pane or stone");
        assert!(["eastern sky", "tracery"].contains(&hit.name), "({x}, {y}): {hit:?}");
    }
    let north = first(&surfaces, position, DVec3::new(-ARCADE, 7.2, -6.9) - position).expect("a pane");
    assert_eq!((north.name, north.front), ("northern sky", true));
}
