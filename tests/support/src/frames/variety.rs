//! Frames that visit every branch.

use super::*;

/// A frame for every branch: each set of techniques on the fog scene, several lights with every selection rule,
/// backward, isotropic and needle-sharp scattering, surfaces, vacuum, short and long limits.
pub fn variety(size: [u32; 2]) -> Vec<(String, Frame)> {
    let mut frames = Vec::new();
    let mut add = |name: String, frame: Frame| frames.push((name, frame));
    for active in Active::ALL {
        add(format!("fog-facing, {active:?}"), with_techniques(&fog_facing(0.0, 0.9, size), active, 4.0));
        let lights = three_lights(0.5, Selection::IntensityDistance, size);
        add(format!("three lights, {active:?}"), with_techniques(&lights, active, f64::INFINITY));
    }
    for g in [-0.9, -0.3, 0.0, 1e-5, 0.3, 0.97] {
        add(format!("three lights, g {g}"), three_lights(g, Selection::Intensity, size));
    }
    for (phase_name, phase) in phase_functions() {
        let frame = with_phase(&three_lights(0.0, Selection::IntensityDistance, size), phase);
        for active in [Active::Both, Active::Every] {
            add(format!("three lights, {phase_name}, {active:?}"), with_techniques(&frame, active, 2.0));
        }
    }
    for (starts, survival) in [(1, 1.0), (2, 0.5), (u32::MAX, 0.7)] {
        for active in [Active::Bridge, Active::Every] {
            let name = format!("three lights, {starts} starts, survival {survival}, {active:?}");
            let lights = three_lights(0.7, Selection::IntensityDistance, size);
            add(name, with_techniques(&lights, active, 2.0).with_walk(starts, survival));
        }
    }
    let limited = with_techniques(&three_lights(0.8, Selection::Intensity, size), Active::Bridge, 2.0);
    let bridge = Bridge::new(Roll::Aligned, &limited.medium, limited.lengths.max);
    let bridge = Bridge { max_inserted: 3, ..bridge.with_mesc(&limited.medium, 2.5) };
    let techniques = Techniques { bridge: Some(bridge.clone()), ..limited.techniques.clone() };
    add("limited bridges".into(), Frame { techniques, ..limited.clone() });
    let spots = focused(&three_lights(0.8, Selection::IntensityDistance, size), &[0.0, 3.0, 30.0]);
    for active in [Active::Lis, Active::LisMvnee, Active::Every] {
        add(format!("spotlights, {active:?}"), with_techniques(&spots, active, 2.0));
    }
    let cones = with_cones(&spots, &[[0.2, 0.7], [0.9, 0.9], [0.3, 1.5]]);
    for active in [Active::Both, Active::Every] {
        add(format!("cones, {active:?}"), with_techniques(&cones, active, 2.0));
    }
    let connector = Connector::Bridge(bridge);
    let lis = Some(Lis { near: 0.7, ..Lis::new(&spots.medium, connector) });
    let mvnee = Active::Mvnee.techniques(&spots.medium, spots.lengths.max, 1.0).mvnee;
    let techniques = Techniques { lis, mvnee, ..Techniques::default() };
    add("spotlights, limited".into(), Frame { techniques, ..spots.with_walk(3, 0.8) });
    add(
        "aimed, one light".into(),
        Frame { aimed: 0.5, ..with_techniques(&fog_facing(0.0, 0.9, size), Active::Every, 4.0) },
    );
    add("aimed, three lights".into(), Frame { aimed: 0.3, ..with_techniques(&limited, Active::Bridge, 2.0) });
    add("roulette".into(), Frame { roulette: 0.3, ..with_techniques(&limited, Active::Every, 2.0) });
    add("three lights, uniform".into(), three_lights(0.7, Selection::Uniform, size));
    for active in Active::ALL {
        add(format!("room, {active:?}"), with_techniques(&room(0.6, Selection::IntensityDistance, size), active, 3.0));
    }
    let few = room(0.8, Selection::Intensity, size).with_walk(1, 0.7);
    add("room, 1 start, survival 0.7".into(), few);
    let aimed = Frame { aimed: 0.4, ..room(0.8, Selection::Intensity, size) };
    add("room, aimed".into(), aimed.with_walk(2, 0.8));
    for (selection, active) in [
        (Selection::Uniform, Active::Nee),
        (Selection::Intensity, Active::Bridge),
        (Selection::IntensityDistance, Active::Every),
    ] {
        add(
            format!("lamps, {selection:?}, {active:?}"),
            with_techniques(&lamps(1.0, 0.5, selection, size), active, 3.0),
        );
    }
    for active in [Active::Mvnee, Active::Every] {
        let frame = with_techniques(&room(0.6, Selection::Intensity, size), active, 3.0);
        add(format!("crowded room, {active:?}"), crowded(&frame));
    }
    add("crowded lamps".into(), crowded(&lamps(1.0, 0.5, Selection::Intensity, size)));
    let medium = Medium::vacuum();
    let vacuum = room(0.0, Selection::Uniform, size);
    add("room in vacuum".into(), Frame { medium, techniques: vacuum.techniques.without_vertices(), ..vacuum });
    for (name, coloured) in coloured(size) {
        for active in Active::ALL {
            add(format!("{name}, {active:?}"), with_techniques(&coloured, active, 4.0));
        }
        let aimed = Frame { aimed: 0.3, ..with_techniques(&coloured, Active::Every, 4.0) };
        add(format!("{name}, aimed"), aimed.with_walk(2, 0.8));
    }
    connected_in_place(size).into_iter().for_each(|(name, frame)| add(name, frame));
    skies::rooms(size).into_iter().for_each(|(name, frame)| add(name, frame));
    let short = PathLengths { min: 1, max: 2 };
    add("K 2".into(), Frame { lengths: short, ..three_lights(0.6, Selection::Uniform, size) });
    let only = PathLengths { min: 3, max: 5 };
    add("3 to 5 segments".into(), Frame { lengths: only, ..three_lights(0.6, Selection::IntensityDistance, size) });
    frames
}
