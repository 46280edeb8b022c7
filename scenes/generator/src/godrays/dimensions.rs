//! The numbers of the chapel, in metres, and why they are what they are.
//!
//! Everything stands around the middle of the nave and is moved by [`MIDDLE`] in the end. The camera is in the west, at
//! the left, and looks east and a little to the right; the sun is in front of it on the right, so that it looks along
//! the shafts rather than across them, and sees the dark between.

use glam::DVec3;

/// Bays along the nave.
pub const BAYS: u32 = 6;
/// Length of a bay: shafts are about a metre wide, with more than that of dark between them.
pub const PITCH: f64 = 4.2;
/// Half the length of the nave.
pub const HALF_LENGTH: f64 = 0.5 * BAYS as f64 * PITCH;
/// z of the middle of the nave: the west wall stands right behind the camera.
pub const MIDDLE: f64 = -8.4;
/// Bays in the west whose windows are filled: their shafts would pass between the camera and the others.
pub const DARK_BAYS: u32 = 2;

/// From the axis to the middles of the walls over the arcades.
pub const ARCADE: f64 = 4.2;
/// Thickness of these walls.
pub const WALL: f64 = 0.4;
/// Thickness of the walls around the windows: the sun shines along them, and thick ones would take most of its light.
pub const UPPER_WALL: f64 = 0.24;
/// Half the width between the walls.
pub const HALF_WIDTH: f64 = ARCADE - 0.5 * WALL;
/// From the axis to the outer walls of the aisles.
pub const OUTER: f64 = 7.2;
/// Thickness of outer walls and end walls.
pub const OUTER_WALL: f64 = 0.6;

/// Tops of the piers.
pub const ARCADE_SPRING: f64 = 2.9;
/// Underside and top of the roofs over the aisles: below the sills.
pub const AISLE_ROOF: [f64; 2] = [4.5, 4.7];
/// Sill of the windows: high enough for shafts to come down across the whole nave.
pub const SILL: f64 = 5.2;
/// Where the vault begins.
pub const VAULT_SPRING: f64 = 5.9;
/// Radius of the vault's arcs over half its width.
pub const VAULT_SHARPNESS: f64 = 1.25;
/// Top of everything over the nave.
pub const TOP: f64 = 11.4;

/// Middle of what stands for the sun: some 27 m from the windows, and small.
pub const SUN: DVec3 = DVec3::new(15.4, 25.3, -27.5);
/// Where the figure stands: in the light that falls through the third bright window.
pub const FIGURE: DVec3 = DVec3::new(0.1, 0.0, -9.1);
/// z of the first row of benches, number of rows, and the distance between two.
pub const BENCHES: (f64, u32, f64) = (-6.4, 7, 1.2);
