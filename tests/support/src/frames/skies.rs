//! Frames with lights at infinity.

use fogbow_kernels::media::field::Interpolation;
use fogbow_kernels::tables::lights::{Panorama, Source};

use super::clouds::{cloud, with_field};
use super::*;

/// An image of a sky: coloured waves, a bright patch, and a row of black.
pub fn panorama(size: [u32; 2], rotation: f64) -> Panorama {
    let pixel = |i: u32| {
        let (x, y) = (i % size[0], i / size[0]);
        let wave = |k: f64| (1.0 + (f64::from(x) * k + f64::from(y)).sin()) as f32;
        match (x, y) {
            (_, 2) => [0.0; 3],
            (3, 1) => [20.0, 15.0, 5.0],
            _ => [0.5 * wave(0.7), 0.4 * wave(1.1), 0.7 * wave(0.5)],
        }
    };
    Panorama::new(size, (0..size[0] * size[1]).map(pixel).collect(), rotation)
}

/// Lights at infinity, by name: a sky, a sun, an image, and all of them with two suns that overlap.
pub fn sources() -> [(&'static str, Vec<Source>); 4] {
    let sun = |degrees: f64, direction: DVec3| Source::Sun {
        direction,
        irradiance: [3.0, 2.5, 1.5],
        angular_radius: degrees.to_radians(),
    };
    let sky = Source::Sky([0.3, 0.5, 0.9]);
    let image = Source::Panorama(Arc::new(panorama([16, 8], 0.4)));
    // The wide ones are seen by the camera, which looks along +z.
    let wide = sun(20.0, DVec3::new(0.2, -0.3, -1.0));
    let wider = sun(35.0, DVec3::new(-0.1, -0.6, -1.0));
    [
        ("a sky", vec![sky.clone()]),
        ("a sun", vec![sun(3.0, DVec3::new(0.3, -1.0, 0.4))]),
        ("an image", vec![image.clone()]),
        ("everything", vec![image, wide, wider, sky]),
    ]
}

/// `frame` with lights at infinity as well.
pub fn under(frame: &Frame, sources: &[Source], selection: Selection) -> Frame {
    Frame { lights: frame.lights.clone().with_distant(sources, selection), ..frame.clone() }
}

/// `frame` with lights at infinity alone.
pub fn only_under(frame: &Frame, sources: &[Source], selection: Selection) -> Frame {
    let none = Lights::new(Vec::new(), frame.lights.selection());
    Frame { lights: none.with_distant(sources, selection), ..frame.clone() }
}

/// Frames in vacuum: a room that is open to the sky, with lamps and without.
pub fn rooms(size: [u32; 2]) -> Vec<(String, Frame)> {
    let lamps = lamps(1.0, 0.0, Selection::IntensityDistance, size);
    let in_vacuum = |frame: &Frame, nee: bool| {
        let techniques = Techniques { nee, ..Techniques::default() };
        with_medium(&Frame { techniques, ..frame.clone() }, Medium::vacuum())
    };
    let mut frames = Vec::new();
    for (name, sources) in sources() {
        let lit = in_vacuum(&under(&lamps, &sources, Selection::IntensityDistance), true);
        frames.push((format!("lamps under {name}"), lit.clone()));
        frames.push((format!("lamps under {name}, survival 0.7"), lit.with_walk(2, 0.7)));
        let room = room(0.0, Selection::Uniform, size);
        for nee in [true, false] {
            let open = in_vacuum(&only_under(&room, &sources, Selection::Uniform), nee);
            frames.push((format!("room under {name}, {}", if nee { "nee" } else { "path" }), open));
        }
    }
    frames
}

/// Clouds under a sky: with three lights, one of them coloured, and with the sky alone and a floor; techniques have to be
/// set anew.
pub fn clouds(size: [u32; 2]) -> Vec<(String, Frame)> {
    let lights = three_lights(0.6, Selection::IntensityDistance, size);
    let [floor, ..] = walls();
    let above = |frame: &Frame| {
        with_field(frame, cloud(2.4, DVec3::new(0.0, 1.0, 1.4), 9.0, Interpolation::Trilinear).with_cells(3, 1.0, 1.0))
    };
    let open = cloud(3.0, DVec3::new(0.1, 0.0, 1.6), 6.0, Interpolation::Trilinear).with_cells(3, 1.0, 1.0);
    let mut frames = Vec::new();
    let [(name, a_sky), ..] = sources();
    let tinted = with_field(&under(&lights, &a_sky, Selection::Intensity), open.clone().coloured([0.4, 1.0, 0.7]));
    frames.push((format!("coloured cloud among lights under {name}"), tinted));
    for (name, sources) in sources() {
        let lit = with_field(&under(&lights, &sources, Selection::Intensity), open.clone());
        frames.push((format!("cloud among lights under {name}"), lit));
        let room = only_under(&room(0.5, Selection::Uniform, size), &sources, Selection::Intensity);
        let floor = surfaces(&[(Material::plain([0.7, 0.6, 0.5], false), floor.clone())]);
        frames.push((format!("cloud above a floor under {name}"), above(&Frame { surfaces: floor, ..room })));
    }
    frames
}
