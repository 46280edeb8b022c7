//! cloud-sky: hills under a cumulus, and the sky behind it.

use exr::prelude::{f16, read_first_rgba_layer_from_file};
use fogbow_scenes::cloud_sky::{EYE, SKY_SIZE, TO_SUN, sky};
use glam::DVec3;

use crate::{
    glb::File,
    scene::{camera, folder, read, vector},
    surfaces::first,
};

#[test]
fn hills_and_sky_are_made_for_the_scene() {
    let [position, _] = camera("cloud-sky");
    assert_eq!(position, EYE);
    assert_eq!(vector(&read("cloud-sky")["light"][0]["direction"]), -TO_SUN);
}

#[test]
fn the_committed_sky_is_what_is_generated() {
    let file = folder("cloud-sky").join("sky.exr");
    let empty = |size: exr::math::Vec2<usize>, _: &_| (size.width(), vec![[0.0_f32; 3]; size.area()]);
    let set = |(width, pixels): &mut (usize, Vec<[f32; 3]>),
               at: exr::math::Vec2<usize>,
               (r, g, b, _): (f32, f32, f32, f32)| {
        pixels[at.y() * *width + at.x()] = [r, g, b];
    };
    let image = read_first_rgba_layer_from_file(&file, empty, set).expect("a readable image");
    let (width, committed) = image.layer_data.channel_data.pixels;
    assert_eq!([width, committed.len() / width], SKY_SIZE);
    for (at, (committed, generated)) in committed.iter().zip(sky()).enumerate() {
        // Half floats; other machines may round sines otherwise.
        let near = |c: usize| (committed[c] - f16::from_f32(generated[c]).to_f32()).abs() <= 2e-3 * generated[c];
        assert!((0..3).all(near), "pixel {at}: {committed:?}, run cargo run --release -p fogbow-scenes");
    }
}

/// Radiance in the direction `to`.
fn seen(pixels: &[[f32; 3]], to: DVec3) -> [f32; 3] {
    let [width, height] = SKY_SIZE;
    let (polar, azimuth) = (to.normalize().y.acos(), to.x.atan2(-to.z));
    let column = (azimuth / core::f64::consts::TAU + 0.5) * width as f64;
    let row = polar / core::f64::consts::PI * height as f64;
    pixels[(row as usize).min(height - 1) * width + (column as usize).min(width - 1)]
}

#[test]
fn the_sky_is_blue_above_pale_at_the_horizon_and_brightest_at_the_sun() {
    let pixels = sky();
    let [zenith, horizon] = [DVec3::Y, DVec3::new(0.3, 0.02, -1.0)].map(|to| seen(&pixels, to));
    assert!(zenith[2] > 2.0 * zenith[0] && horizon[2] < 2.0 * horizon[0], "{zenith:?}, {horizon:?}");
    assert!((0..3).all(|c| horizon[c] > zenith[c]), "{zenith:?}, {horizon:?}");
    let sun = seen(&pixels, TO_SUN);
    let brightest = pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
    assert!(sun[1] > 0.5 * brightest && sun[1] > 2.0 * zenith[1], "{sun:?} of {brightest}");
}

#[test]
fn the_hills_face_the_sky_and_reach_from_below_the_camera_to_the_horizon() {
    let surfaces = File::read("cloud-sky").surfaces();
    for surface in &surfaces {
        assert!(surface.areas().all(|area| area.y > 0.0) && surface.emission == [0.0; 3], "{}", surface.name);
    }
    let [eye, forward] = camera("cloud-sky");
    assert!(first(&surfaces, eye, forward).is_none(), "nothing solid where the cloud is");
    for across in [-0.3, 0.0, 0.3] {
        let right = forward.cross(DVec3::Y).normalize();
        let flat = forward.with_y(0.0).normalize() + across * right;
        for down in [0.02, 0.1] {
            let hit = first(&surfaces, eye, flat - down * DVec3::Y).expect("ground");
            assert!(hit.front && hit.distance > 300.0, "{hit:?}");
        }
    }
}
