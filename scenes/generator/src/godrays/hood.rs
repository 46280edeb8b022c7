//! A black hood around the sun, open towards the windows: its light falls nowhere else, and nothing scatters close to
//! it.

use glam::{DVec2, DVec3};

use super::{
    clerestory::window,
    dimensions::{ARCADE, DARK_BAYS, HALF_LENGTH, MIDDLE, PITCH, SILL, SUN},
};
use crate::Mesh;

/// Where the hood begins and ends on the way from the sun to the windows, as shares of it.
const REACH: [f64; 2] = [-0.03, 0.75];
/// How far its inner and outer faces stay off the light that falls on windows `[m]`.
const MARGINS: [f64; 2] = [0.4, 0.6];

/// The hood, a tube of four walls.
pub fn hood() -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(DVec2::from_array);
    let [[begin, end], [inner, outer]] = [REACH, MARGINS];
    let rings = [(begin, inner), (begin, outer), (end, outer), (end, inner)];
    let positions = rings.into_iter().flat_map(|(share, margin)| corners.map(|corner| on_tube(share, margin, corner)));
    let mut mesh = Mesh { positions: positions.collect(), triangles: vec![] };
    for ring in 0..4 {
        let [here, next] = [4 * ring, 4 * ((ring + 1) % 4)];
        for side in 0..4 {
            let other = (side + 1) % 4;
            mesh.quad([here + side, here + other, next + other, next + side]);
        }
    }
    mesh
}

/// A corner of the tube's section with a plane along the windows.
fn on_tube(share: f64, margin: f64, corner: DVec2) -> DVec3 {
    let sun = SUN - DVec3::Z * MIDDLE;
    let top = window(0.0).apex();
    let dark = 0.5 * f64::from(DARK_BAYS) * PITCH;
    let middle = DVec3::new(ARCADE, 0.5 * (SILL + top), -dark);
    let half = DVec2::new(HALF_LENGTH - dark, 0.5 * (top - SILL));
    let [along, up] = (corner * (share.abs() * half + margin)).to_array();
    sun.lerp(middle, share) + DVec3::new(0.0, up, along)
}
