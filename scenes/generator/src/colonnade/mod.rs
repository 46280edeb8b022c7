//! A court between two-storey arcades, open to the sky, with a tall window at either end: the proportions of the atrium
//! of the Sponza palace, from blocks, arches and columns of our own.

mod column;
mod cornice;
pub mod dimensions;
mod end_wall;
mod storey;

use dimensions::{
    ARCADE, ARCADE_THICKNESS, GALLERY, GALLERY_THICKNESS, HALF_LENGTH, LOWER_COLUMN_RADIUS, LOWER_SPRING, MIDDLE,
    OUTER, OUTER_THICKNESS, PARAPET, ROOF, ROOF_TOP, UPPER_COLUMN_RADIUS, UPPER_SPRING,
};
use glam::DVec3;
use storey::Storey;

use crate::{Material, Mesh, Model, Object, shapes};

const LOWER: Storey =
    Storey { floor: 0.0, spring: LOWER_SPRING, top: GALLERY - GALLERY_THICKNESS, column_radius: LOWER_COLUMN_RADIUS };

const UPPER: Storey = Storey { floor: GALLERY, spring: UPPER_SPRING, top: ROOF, column_radius: UPPER_COLUMN_RADIUS };

/// The model: closed solids of one stone.
pub fn model() -> Model {
    let storeys = |part: fn(&Storey) -> Mesh| twice(Mesh::union([part(&LOWER), part(&UPPER)]));
    let stone = Material::grey("stone", 0.3);
    let object = |name, mesh: Mesh| Object::new(name, stone, mesh.moved(DVec3::Z * MIDDLE));
    Model {
        name: "colonnade",
        objects: vec![
            object("floor", floor()),
            object("columns", storeys(Storey::columns)),
            object("arcades", storeys(Storey::arcade)),
            object("ribs", storeys(Storey::ribs)),
            object("court arches", storey::court_arches(UPPER_SPRING)),
            object("galleries", twice(gallery())),
            object("cornices", twice(Mesh::union([cornice::string_course(), cornice::cornice()]))),
            object("roofs", twice(roof())),
            object("outer walls", twice(outer_wall())),
            object("end walls", twice(end_wall::end_wall())),
        ],
    }
}

/// A part of one side, and the same of the other.
fn twice(part: Mesh) -> Mesh {
    Mesh::union([part.clone(), part.half_turned(DVec3::ZERO)])
}

/// The ground under everything.
fn floor() -> Mesh {
    let edge = DVec3::new(OUTER + 2.0, 0.0, HALF_LENGTH + 2.0);
    shapes::cuboid(-edge - 0.5 * DVec3::Y, edge)
}

/// The floor of a gallery, and the parapet between its columns.
fn gallery() -> Mesh {
    let inner = ARCADE - 0.5 * ARCADE_THICKNESS;
    let parapet = 0.15;
    Mesh::union([
        along([inner, OUTER + 0.1], [GALLERY - GALLERY_THICKNESS, GALLERY]),
        along([ARCADE - parapet, ARCADE + parapet], [GALLERY - 0.1, PARAPET]),
    ])
}

/// The roof of a gallery.
fn roof() -> Mesh {
    along([ARCADE - 0.5 * ARCADE_THICKNESS, OUTER + OUTER_THICKNESS], [ROOF, ROOF_TOP])
}

/// The wall behind a gallery.
fn outer_wall() -> Mesh {
    along([OUTER, OUTER + OUTER_THICKNESS], [0.0, ROOF])
}

/// A block from end to end of the court.
fn along([inner, outer]: [f64; 2], [bottom, top]: [f64; 2]) -> Mesh {
    shapes::cuboid(DVec3::new(inner, bottom, -HALF_LENGTH), DVec3::new(outer, top, HALF_LENGTH))
}
