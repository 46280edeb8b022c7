//! A storey of one side of the court, the one at +x. Everything stands around the middle of the court.

use glam::DVec3;

use super::{
    column::column,
    dimensions::{
        ARCADE, ARCADE_THICKNESS, ARCH_RADIUS, BAYS, COURT_ARCH_RADIUS, GALLERY_ARCH_RADIUS, HALF_LENGTH, OUTER, PITCH,
    },
};
use crate::{
    Mesh,
    shapes::{self, Arch},
};

/// How deep parts reach into their neighbours, so that no light passes between them `[m]`.
const JOINT: f64 = 0.1;
/// Thickness of the arches across a gallery `[m]`.
const RIB_THICKNESS: f64 = 0.45;
/// Half the width of the piers that carry these arches at the outer wall `[m]`.
const PIER_HALF_WIDTH: f64 = 0.3;
/// Width and thickness of the arches across the court `[m]`.
const COURT_ARCH: [f64; 2] = [0.45, 0.4];
/// Width of the rings around arches, and how far they stand out from walls `[m]`.
const RING: [f64; 2] = [0.22, 0.07];
/// How far rings reach into openings `[m]`.
const RING_OVERHANG: f64 = 0.03;

/// Columns, arches on them, and arches from them across the gallery.
#[derive(Clone, Copy, Debug)]
pub struct Storey {
    /// What the columns stand on `[m]`.
    pub floor: f64,
    /// What the arches rise from: the tops of the columns `[m]`.
    pub spring: f64,
    /// Top of the walls on the arches `[m]`.
    pub top: f64,
    /// Radius of the columns `[m]`.
    pub column_radius: f64,
}

impl Storey {
    /// The columns; the first and the last stand half in the end walls.
    pub fn columns(&self) -> Mesh {
        let column = column(self.spring - self.floor, self.column_radius);
        Mesh::union(piers().map(|z| column.clone().moved(DVec3::new(ARCADE, self.floor, z))))
    }

    /// The wall on the columns, with its arches.
    pub fn arcade(&self) -> Mesh {
        let arches: Vec<Arch> = (0..BAYS).map(|bay| self.arch(bay)).collect();
        let end = HALF_LENGTH + JOINT;
        let wall = shapes::arch_band([-end, end], self.top, &arches, ARCADE_THICKNESS);
        let rings = arches.iter().map(|&arch| ring(arch, ARCADE_THICKNESS));
        Mesh::union([wall].into_iter().chain(rings)).quarter_turned().moved(DVec3::X * ARCADE)
    }

    /// The arches from the columns to the outer wall, and the piers that carry them there.
    pub fn ribs(&self) -> Mesh {
        let inner = ARCADE + 0.5 * ARCADE_THICKNESS;
        let arch = Arch { center: 0.5 * (inner + OUTER), spring: self.spring, radius: GALLERY_ARCH_RADIUS };
        let band = shapes::arch_band([inner - JOINT, OUTER + JOINT], self.top + JOINT, &[arch], RIB_THICKNESS);
        let pier = shapes::cuboid(
            DVec3::new(arch.center + arch.radius, self.floor - JOINT, -PIER_HALF_WIDTH),
            DVec3::new(OUTER + JOINT, self.spring, PIER_HALF_WIDTH),
        );
        let rib = Mesh::union([band, pier]);
        Mesh::union(piers().map(|z| rib.clone().moved(DVec3::Z * z)))
    }

    /// The arch of a bay, along the wall before it is turned.
    fn arch(&self, bay: u32) -> Arch {
        Arch { center: (f64::from(bay) + 0.5) * PITCH - HALF_LENGTH, spring: self.spring, radius: ARCH_RADIUS }
    }
}

/// The ring around an arch of a wall of the given thickness.
pub fn ring(arch: Arch, thickness: f64) -> Mesh {
    let [width, relief] = RING;
    let arch = Arch { radius: arch.radius - RING_OVERHANG, ..arch };
    shapes::arch_ring(arch, width, thickness + 2.0 * relief)
}

/// The arches across the court from column to column, which carry nothing: the court is open to the sky.
pub fn court_arches(spring: f64) -> Mesh {
    let [width, thickness] = COURT_ARCH;
    let arch = shapes::arch_ring(Arch { center: 0.0, spring, radius: COURT_ARCH_RADIUS }, width, thickness);
    Mesh::union(piers().map(|z| arch.clone().moved(DVec3::Z * z)))
}

/// Where columns stand along the court.
fn piers() -> impl Iterator<Item = f64> {
    (0..=BAYS).map(|pier| f64::from(pier) * PITCH - HALF_LENGTH)
}
