//! wax: a candle on a table.

use core::f64::consts::PI;

use glam::DVec3;

use crate::{
    glb::File,
    surfaces::{Surface, first, named, solids_around},
};

fn surfaces() -> Vec<Surface> {
    File::read("wax").surfaces()
}

#[test]
fn the_candle_is_closed() {
    let surfaces = surfaces();
    let candle = named(&surfaces, "Candle.inside");
    assert!(candle.is_closed());
    assert_eq!(candle.triangles.len(), 96 * 2 * 48);
    assert!(named(&surfaces, "wick").is_closed());
}

#[test]
fn the_candle_is_1_m_tall_and_stands_in_the_table() {
    let surfaces = surfaces();
    let candle = named(&surfaces, "Candle.inside");
    let [low, high] = candle.bounds();
    assert!((low.y + 0.02).abs() < 1e-6 && (high.y - 1.0).abs() < 0.03, "{low} to {high}");
    assert!((low - high).abs().max_element() < 1.05 && low.x < -0.35 && high.x > 0.35, "{low} to {high}");
    let cylinder = PI * 0.35 * 0.35 * 0.97;
    assert!((candle.volume() / cylinder - 1.0).abs() < 0.1, "{} of {cylinder} m^3", candle.volume());
}

#[test]
fn the_inside_is_inside() {
    let candle = [surfaces().pop().expect("the candle is last")];
    let points = [([0.0, 0.5, 0.0], 1), ([0.3, 0.1, 0.0], 1), ([0.0, 0.98, 0.0], 0), ([0.5, 0.5, 0.0], 0)];
    for (at, expected) in points {
        assert_eq!(solids_around(&candle, DVec3::from(at)), expected, "{at:?}");
    }
}

#[test]
fn no_side_of_the_candle_is_folded() {
    let surfaces = surfaces();
    let candle = named(&surfaces, "Candle.inside");
    for ([a, b, c], area) in candle.corners().zip(candle.areas()) {
        let middle = (a + b + c) / 3.0;
        let outward = if middle.y < 0.9 { middle.with_y(0.0) } else { middle - DVec3::Y * 0.6 };
        let outward = if middle.y < 0.0 && area.x.hypot(area.z) < 1e-9 { DVec3::NEG_Y } else { outward };
        assert!(area.dot(outward) > 0.0, "a triangle at {middle} that faces {area}");
    }
}

#[test]
fn the_wick_stands_in_the_bowl() {
    let surfaces = surfaces();
    let hit = first(&surfaces, DVec3::Y * 1.2, DVec3::NEG_Y).expect("the wick, from within the flame");
    assert!(hit.name == "wick" && hit.front, "{hit:?}");
    let hit = first(&surfaces, DVec3::new(0.05, 3.0, 0.0), DVec3::NEG_Y).expect("the bowl");
    assert!(hit.name == "Candle.inside" && hit.front, "{hit:?}");
}

#[test]
fn table_and_wall_face_the_candle() {
    let surfaces = surfaces();
    let (table, wall) = (named(&surfaces, "table"), named(&surfaces, "wall"));
    assert!(table.faces(DVec3::Y) && table.spans([-5.0, 0.0, -2.5], [5.0, 0.0, 5.0]));
    assert!(wall.faces(DVec3::Z) && wall.spans([-5.0, 0.0, -2.5], [5.0, 5.0, -2.5]));
    for surface in &surfaces {
        assert_eq!(surface.emission == [0.0; 3], surface.name != "flame", "{}", surface.name);
        assert!(!surface.double_sided, "{}", surface.name);
    }
}

#[test]
fn the_flame_is_a_drop_around_the_end_of_the_wick() {
    let surfaces = surfaces();
    let flame = named(&surfaces, "flame");
    assert!(flame.is_closed());
    assert_eq!(flame.triangles.len(), 20 * 2 * 13);
    assert!(flame.emission.iter().zip([150.0, 80.0, 27.0]).all(|(found, expected)| (found - expected).abs() < 1e-9));
    let [low, high] = flame.bounds();
    assert!((low - DVec3::new(-0.046, 1.03, -0.046)).abs().max_element() < 1e-3, "{low}");
    assert!((high - DVec3::new(0.046, 1.28, 0.046)).abs().max_element() < 1e-3, "{high}");
    // Of a drop whose radius is as c - c^3 at the share c^2 of its height it is 9/16 pi r^2 h.
    let drop = 9.0 / 16.0 * PI * 0.046_f64.powi(2) * 0.25;
    assert!((flame.volume() / drop - 1.0).abs() < 0.05, "{} of {drop} m^3", flame.volume());
    let flame: Vec<_> = surfaces.into_iter().filter(|surface| surface.name == "flame").collect();
    for (height, expected) in [(1.02, 0), (1.06, 1), (1.2, 1), (1.29, 0)] {
        assert_eq!(solids_around(&flame, DVec3::Y * height), expected, "{height} m, and the wick ends at 1.06 m");
    }
}
