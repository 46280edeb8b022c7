//! Frames whose connections are made in place.

use super::*;

/// Next event estimation alone, from every vertex of grey fog, to lights of all kinds, among walks that end and channels
/// that differ: where nothing hides them, and where surfaces or other lights do; with a roulette and without.
pub fn connected_in_place(size: [u32; 2]) -> Vec<(String, Frame)> {
    let disk = with_techniques(&fog_facing(0.0, 0.9, size), Active::Nee, f64::INFINITY);
    let lit_by =
        |emitter: Emitter| Frame { lights: Lights::new(vec![emitter], Selection::IntensityDistance), ..disk.clone() };
    let [center, down] = [DVec3::new(0.2, 0.1, 2.0), DVec3::new(-0.2, 0.1, -1.0)];
    let of_colours = Medium::homogeneous(1.2, [0.9, 0.75, 0.5], PhaseFunction::two_lobe([0.9, -0.4], 0.7));
    let spot = lit_by(Emitter::disk(center, down, 0.4, [10.0, 2.0, 1.0]).focused(3.0));
    let room = with_techniques(&room(0.6, Selection::Uniform, size), Active::Nee, f64::INFINITY);
    let lamp = with_techniques(&lamps(1.0, 0.6, Selection::IntensityDistance, size), Active::Nee, f64::INFINITY);
    let three = with_techniques(&three_lights(0.6, Selection::IntensityDistance, size), Active::Nee, f64::INFINITY);
    let with_roulette = |frame: &Frame, roulette: f32| Frame { roulette, ..frame.clone() };
    let frames = [
        ("one disk", disk.clone()),
        ("one disk, roulette", with_roulette(&disk, 0.3)),
        ("one disk, walks end", disk.clone().with_walk(u32::MAX, 0.8)),
        ("one disk, coloured", with_medium(&lit_by(Emitter::disk(center, down, 0.4, [10.0, 2.0, 1.0])), of_colours)),
        ("one sphere", lit_by(Emitter::sphere(center, 0.3, [5.0; 3]))),
        ("one spotlight", spot.clone()),
        ("one cone", with_cones(&spot, &[[0.3, 1.2]])),
        ("a wall of disks", wall_of_lights(3, 0.0, size)),
        ("a wall of many disks", wall_of_lights(12, 0.0, size)),
        ("disks that hide each other", wall_of_lights(3, 1.0, size)),
        ("three lights", three),
        ("a room", room.clone()),
        ("a room, roulette", with_roulette(&room, 0.1)),
        ("a room, walks end", room.clone().with_walk(u32::MAX, 0.9)),
        ("a room with a lamp", with_roulette(&lamp, 0.1)),
    ];
    frames.map(|(name, frame)| (format!("in place, {name}"), frame)).into()
}
