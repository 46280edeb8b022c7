//! Frames with layers beside radiance.

use fogbow::film::aov::{Aov, Aovs};

use super::*;

/// Distance of the wall from the camera `[m]`.
pub const WALL_DISTANCE: f64 = 2.5;
/// Its albedo.
pub const WALL_ALBEDO: [f64; 3] = [0.75, 0.5, 0.25];

/// A wall across the view of a camera with a narrow field, in fog of this extinction [1/m], and a small lamp beside.
pub fn in_front_of_a_wall(extinction: f32, size: [u32; 2]) -> Frame {
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.001, 0.0, size);
    let medium = Medium::homogeneous(extinction, [0.9, 0.6, 0.3], PhaseFunction::henyey_greenstein(0.3));
    let lamp = Emitter::disk(DVec3::new(0.5, 0.0, 1.0), -DVec3::X, 0.2, [3.0, 2.0, 1.0]);
    let frame = plain(camera, medium, Lights::new(vec![lamp], Selection::Uniform), 8, 5);
    let z = WALL_DISTANCE as f32;
    let corners = vec![[-4.0, -4.0, z], [4.0, -4.0, z], [-4.0, 4.0, z], [4.0, 4.0, z]];
    let geometry = Geometry::new(corners, vec![[0, 2, 1], [1, 2, 3]]);
    let material = Material::plain(WALL_ALBEDO.map(|albedo| albedo as f32), false);
    let surfaces = Arc::new(Surfaces::new(geometry, vec![material], vec![0, 0]));
    with_techniques(&Frame { surfaces, ..frame }, Active::Nee, 4.0)
}

/// `frame` with all layers that there are.
pub fn with_all_layers(frame: &Frame) -> Frame {
    Frame { aovs: Aovs::of(&Aov::ALL), ..frame.clone() }
}

/// Frames with all layers in which the camera sees everything that there is to see first: media of one and of three
/// extinctions, lamps, surfaces, the sky, and nothing.
pub fn seen_first(size: [u32; 2]) -> Vec<(String, Frame)> {
    let aimed = Frame { aimed: 0.4, ..three_lights(0.5, Selection::Intensity, size) };
    let mut frames = vec![
        ("aimed".into(), with_techniques(&aimed, Active::Bridge, 3.0)),
        ("room".into(), with_techniques(&room(0.6, Selection::IntensityDistance, size), Active::Every, 3.0)),
        ("lamps".into(), lamps(1.0, 0.5, Selection::Intensity, size)),
    ];
    frames.extend(coloured(size).map(|(name, frame)| (name.to_string(), with_techniques(&frame, Active::Every, 3.0))));
    frames.extend(skies::rooms(size));
    frames.into_iter().map(|(name, frame)| (name, with_all_layers(&frame))).collect()
}

/// The same in volumes and clouds.
pub fn seen_first_in_volumes(size: [u32; 2]) -> Vec<(String, Frame)> {
    let volumes = clouds::volumes(size).map(|(name, frame)| (name.to_string(), frame));
    let frames = volumes.into_iter().chain(skies::clouds(size));
    frames.map(|(name, frame)| (name, with_all_layers(&frame))).collect()
}
