//! A chapel of pointed arches, full of fog, through whose high windows the sun shines in shafts.

mod bench;
mod clerestory;
pub mod dimensions;
mod ends;
mod figure;
mod floor;
mod hood;
mod pier;
mod rose;
mod side;
mod vault;

use dimensions::{BENCHES, DARK_BAYS, FIGURE, HALF_LENGTH, MIDDLE, PITCH};
use glam::DVec3;

use crate::{Material, Mesh, Model, Object};

const STONE: Material = Material::new("stone", [0.3, 0.28, 0.25]);
const LIGHT_SLABS: Material = Material::new("light slabs", [0.26, 0.24, 0.21]);
const DARK_SLABS: Material = Material::new("dark slabs", [0.13, 0.12, 0.115]);
const MORTAR: Material = Material::grey("mortar", 0.06);
const OAK: Material = Material::new("oak", [0.14, 0.085, 0.05]);
const WOOL: Material = Material::new("wool", [0.06, 0.045, 0.035]);
const BLACK: Material = Material::grey("black", 0.0);
const NORTH: Material = Material::shining("northern sky", [0.075, 0.125, 0.205]);
const EAST: Material = Material::shining("eastern sky", [0.22, 0.38, 0.7]);

/// The model: closed solids.
pub fn model() -> Model {
    let parts = [
        ("ground", MORTAR, floor::ground()),
        ("light slabs", LIGHT_SLABS, floor::slabs(0)),
        ("dark slabs", DARK_SLABS, floor::slabs(1)),
        ("chancel", STONE, floor::chancel()),
        ("piers", STONE, twice(side::piers())),
        ("shafts", STONE, twice(side::shafts())),
        ("arcades", STONE, twice(side::arcade())),
        ("aisles", STONE, twice(side::aisle())),
        ("clerestories", STONE, twice(clerestory::walls())),
        ("tracery", STONE, Mesh::union([twice(clerestory::tracery()), ends::tracery()])),
        ("fillings", STONE, fillings()),
        ("vault", STONE, vault::webs()),
        ("ribs", STONE, vault::ribs()),
        ("end walls", STONE, ends::walls()),
        ("northern sky", NORTH, clerestory::panes().half_turned(DVec3::ZERO)),
        ("eastern sky", EAST, ends::panes()),
        ("hood", BLACK, hood::hood()),
        ("benches", OAK, benches()),
        ("figure", WOOL, figure::figure().moved(FIGURE - DVec3::Z * MIDDLE)),
    ];
    let object = |(name, material, mesh): (_, _, Mesh)| Object::new(name, material, mesh.moved(DVec3::Z * MIDDLE));
    Model { name: "godrays", objects: parts.map(object).into() }
}

/// What fills the windows in the west on the side of the sun.
fn fillings() -> Mesh {
    clerestory::filling([HALF_LENGTH - f64::from(DARK_BAYS) * PITCH, HALF_LENGTH])
}

fn benches() -> Mesh {
    let (first, count, step) = BENCHES;
    bench::rows((0..count).map(|row| first - MIDDLE - step * f64::from(row)))
}

/// A part of one side, and the same of the other.
fn twice(part: Mesh) -> Mesh {
    Mesh::union([part.clone(), part.half_turned(DVec3::ZERO)])
}
