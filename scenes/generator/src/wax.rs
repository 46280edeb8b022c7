//! A candle on a table. The scene is ten times as large as life: the candle stands 1 m tall.

use core::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};

use crate::{Material, Mesh, Model, Object, shapes, smooth};

/// Radius of the candle's body, without what runs down it `[m]`.
pub const RADIUS: f64 = 0.35;
/// How far the candle's foot is below the table's top, so that no gap is between them `[m]`.
pub const SUNK: f64 = 0.02;
/// Height of the middle of the rim's rounding, where the body ends `[m]`.
const BODY: f64 = 0.95;
/// Radius of the rim's rounding `[m]`.
const RIM: f64 = 0.03;
/// Slope at which the bowl meets the rim.
const SLOPE: f64 = 0.5;
/// Bands of the body, the rim and the bowl.
const BANDS: [u32; 3] = [32, 6, 9];
/// Sides of the candle around its axis.
const SIDES: u32 = 96;
/// The wick: radius, lower and upper end `[m]`.
pub const WICK: [f64; 3] = [0.012, 0.8, 1.06];
/// The flame: where its lower end is, how tall it is, and its largest radius `[m]`.
const FLAME: [f64; 3] = [1.03, 0.25, 0.046];
/// Bands and sides of the flame.
const FLAME_PARTS: [u32; 2] = [14, 20];
/// How far table and wall reach from the middle to the sides, and the table to the front `[m]`.
pub const REACH: f64 = 5.0;
/// z of the wall behind the candle `[m]`.
pub const WALL: f64 = -2.5;

/// Wax that ran over the rim and set.
struct Drip {
    /// Where around the axis, in turns.
    turn: f64,
    /// Height at which it ends `[m]`.
    end: f64,
    /// Half of its width `[m]`.
    width: f64,
    /// How thick it is `[m]`.
    thickness: f64,
}

const DRIPS: [Drip; 7] = [
    Drip { turn: 0.03, end: 0.62, width: 0.045, thickness: 0.035 },
    Drip { turn: 0.14, end: 0.3, width: 0.05, thickness: 0.04 },
    Drip { turn: 0.23, end: 0.5, width: 0.06, thickness: 0.04 },
    Drip { turn: 0.31, end: 0.74, width: 0.04, thickness: 0.03 },
    Drip { turn: 0.48, end: 0.41, width: 0.05, thickness: 0.04 },
    Drip { turn: 0.66, end: 0.2, width: 0.05, thickness: 0.035 },
    Drip { turn: 0.83, end: 0.58, width: 0.055, thickness: 0.04 },
];

/// The model. What is in the candle is a medium; its surface is named for that.
pub fn model() -> Model {
    let [radius, low, high] = WICK;
    let wick = shapes::lathe(&[DVec2::new(radius, low), DVec2::new(radius, high)], 8);
    let across = DVec3::X * 2.0 * REACH;
    let corner = DVec3::new(-REACH, 0.0, WALL);
    Model {
        name: "wax",
        objects: vec![
            Object::new("table", Material::new("wood", [0.42, 0.24, 0.12]), {
                Mesh::parallelogram(corner, DVec3::Z * (REACH - WALL), across)
            }),
            Object::new("wall", Material::new("plaster", [0.55, 0.5, 0.45]), {
                Mesh::parallelogram(corner, across, DVec3::Y * REACH)
            }),
            Object::new("wick", Material::grey("soot", 0.03), wick),
            Object::new("flame", Material::shining("flame", [150.0, 80.0, 27.0]), flame()),
            Object::new("Candle.inside", Material::new("wax", [0.9, 0.85, 0.7]), candle()),
        ],
    }
}

/// A drop around the wick's end: at the share c^2 of its height its radius is as c - c^3, so that it is round below,
/// widest at a third, and pointed above.
fn flame() -> Mesh {
    let [bands, sides] = FLAME_PARTS;
    let [low, tall, radius] = FLAME;
    let widest = 2.0 / 27_f64.sqrt();
    let point = |i: u32| {
        let c = f64::from(i) / f64::from(bands);
        DVec2::new(radius / widest * (c - c * c * c), low + tall * c * c)
    };
    let profile: Vec<DVec2> = (0..=bands).map(point).collect();
    shapes::lathe(&profile, sides)
}

/// The candle: a solid of revolution, of which each point is moved a little, so that it stays closed.
fn candle() -> Mesh {
    let mut mesh = shapes::lathe(&profile(), SIDES);
    for position in &mut mesh.positions {
        *position = melted(*position);
    }
    mesh
}

/// Radii and heights from the middle of the foot to that of the bowl.
fn profile() -> Vec<DVec2> {
    let [body, rim, bowl] = BANDS;
    let share = |i: u32, of: u32| f64::from(i) / f64::from(of);
    let foot = [0.0, 0.5, 1.0].map(|share| DVec2::new(share * RADIUS, -SUNK));
    let side = (1..body).map(|i| DVec2::new(RADIUS, BODY * share(i, body)));
    // The rounding ends where it is as steep as the bowl.
    let last = FRAC_PI_2 + SLOPE.atan();
    let rounding = |i: u32| DVec2::new(RADIUS - RIM, BODY) + RIM * DVec2::from_angle(last * share(i, rim));
    let edge = rounding(rim);
    let inside = (1..=bowl).map(|i| {
        let radius = edge.x * share(bowl - i, bowl);
        DVec2::new(radius, edge.y - SLOPE * (edge.x * edge.x - radius * radius) / (2.0 * edge.x))
    });
    foot.into_iter().chain(side).chain((0..=rim).map(rounding)).chain(inside).collect()
}

/// Where a point of the solid of revolution is on the candle: the body is uneven, the rim sagged where wax ran over it,
/// and that wax is on the side.
fn melted(at: DVec3) -> DVec3 {
    let radius = at.x.hypot(at.z);
    let turn = at.z.atan2(at.x) / TAU;
    let wave = |around: f64, up: f64, phase: f64| (TAU * around * turn + up * at.y + phase).sin();
    let uneven = 1.0 + 0.008 * wave(3.0, 5.0, 0.0) + 0.005 * wave(7.0, -9.0, 1.0);
    let high = smooth((at.y - 0.5) / 0.5);
    // All of the side, and hardly any of the bowl.
    let outside = (radius / RADIUS).powi(12);
    let run: f64 = DRIPS.iter().map(|drip| drip.thickness_at(turn, at.y)).sum();
    let spilled: f64 = DRIPS.iter().map(|drip| bump(drip.beside(turn) / 1.5)).sum();
    let sag = high * (0.012 * wave(2.0, 0.0, 0.4) + 0.006 * wave(5.0, 0.0, 2.0) - 0.02 * spilled * outside);
    let stretch = if radius > 0.0 { uneven + outside * run / radius } else { 1.0 };
    // On the axis there is no turn.
    let sag = if radius > 0.0 { sag * (radius / RADIUS).powi(2) } else { 0.0 };
    DVec3::new(at.x * stretch, at.y + sag, at.z * stretch)
}

impl Drip {
    /// How far around the candle a turn is from it, in its widths.
    fn beside(&self, turn: f64) -> f64 {
        let away = turn - self.turn;
        TAU * RADIUS * (away - away.round()) / self.width
    }

    /// How thick it is at this turn and height `[m]`: it begins at the rim, and ends in a drop.
    fn thickness_at(&self, turn: f64, height: f64) -> f64 {
        let (beside, above) = (self.beside(turn), (height - self.end) / self.width);
        self.thickness * (0.6 * bump(beside.hypot(above.min(0.0))) + 0.6 * bump(beside.hypot(0.8 * above)))
    }
}

/// From 1 in the middle to 0 far away.
fn bump(distance: f64) -> f64 {
    (-distance * distance).exp()
}
