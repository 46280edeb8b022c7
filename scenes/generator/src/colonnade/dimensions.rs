//! The numbers of the colonnade, in metres, and why they are what they are.
//!
//! Camera and lights are given: the camera is 10 m up and looks 14 degrees further up, two lights stand 7 m to the
//! sides, 11 m up, at z = -4 and z = 3, and one is far behind. All else follows: the upper storey is where the camera
//! looks, its arches stand in front of the lights at the sides, and the tall window stands in front of the one behind.

/// Bays along each side.
pub const BAYS: u32 = 8;
/// Length of a bay: the lights at the sides are two bays apart, so that each stands in the middle of one.
pub const PITCH: f64 = 3.5;
/// Half the length of the court.
pub const HALF_LENGTH: f64 = 0.5 * BAYS as f64 * PITCH;
/// z of the middle of the court: puts the lights into the middles of bays, the camera 3.25 m before the wall behind it
/// and 24.75 m before the window.
pub const MIDDLE: f64 = -2.25;

/// From the court's axis to that of the columns: leaves a court of 7 m, so that arches come into view 6 m before the
/// camera, little more than a mean free path of the fog, and stand 3 m before the lights at the sides.
pub const ARCADE: f64 = 3.85;
/// Thickness of the walls on the columns.
pub const ARCADE_THICKNESS: f64 = 0.7;
/// From the axis to the inner face of the outer wall: the lights at the sides have 2 m behind them.
pub const OUTER: f64 = 9.1;
/// Thickness of outer walls and end walls.
pub const OUTER_THICKNESS: f64 = 0.8;

/// Top of the gallery's floor: 2.8 m below the camera.
pub const GALLERY: f64 = 7.2;
/// Thickness of the gallery's floor.
pub const GALLERY_THICKNESS: f64 = 0.6;
/// Top of the parapet between the upper columns: 1.5 m below the lights' lower edge.
pub const PARAPET: f64 = 8.0;
/// Underside of the roof over the galleries; the court is open to the sky.
pub const ROOF: f64 = 14.6;
/// Top of the roof.
pub const ROOF_TOP: f64 = 15.2;
/// Top of the end walls' middle parts.
pub const GABLE: f64 = 16.8;

/// Radius of the arches of the arcades: leaves piers of 0.8 m.
pub const ARCH_RADIUS: f64 = 1.35;
/// Radius of the arches across the galleries.
pub const GALLERY_ARCH_RADIUS: f64 = 2.0;
/// Inner radius of the arches across the court, which rise from the upper columns: they are what the fog leaves of the
/// court's depth above the walls.
pub const COURT_ARCH_RADIUS: f64 = 3.3;
/// Spring of the lower storey's arches.
pub const LOWER_SPRING: f64 = 4.6;
/// Spring of the upper storey's arches: above the lights' middles, so that arches frame whole lights.
pub const UPPER_SPRING: f64 = 11.6;

/// Radius of the lower storey's columns at the foot of the shaft.
pub const LOWER_COLUMN_RADIUS: f64 = 0.34;
/// Radius of the upper storey's columns at the foot of the shaft.
pub const UPPER_COLUMN_RADIUS: f64 = 0.28;
/// Sides of a column.
pub const COLUMN_SIDES: u32 = 16;
