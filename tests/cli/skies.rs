//! Scenes with a sky or a sun.

use exr::prelude::{WritableImage, write_rgb_file};
use serde_json::json;

use super::models::with_model;
use super::support::{Folder, SCENE, mean};

/// The test scene in vacuum, with these lines at its end.
fn in_vacuum(lines: &str) -> Folder {
    let (before, rest) = SCENE.split_once("[medium]").expect("a medium");
    let after = &rest[rest.find("\n[").expect("another table")..];
    let folder = Folder::empty();
    folder.write("scene.toml", format!("{before}{after}\n{lines}"));
    folder
}

/// The same with an image of the sky, of which this is a pixel.
fn with_image(pixel: impl Fn(usize, usize) -> (f32, f32, f32) + Sync, lines: &str) -> Folder {
    let folder = in_vacuum(&format!("[environment]\nimage = \"sky.exr\"\n{lines}"));
    write_rgb_file(folder.path("sky.exr"), 8, 4, pixel).expect("an image");
    folder
}

#[test]
fn a_sky_is_seen_where_there_is_nothing_else() {
    let folder = in_vacuum("[environment]\nradiance = [1, 2, 3]\n");
    let scene = std::fs::read_to_string(folder.path("scene.toml")).expect("a scene");
    folder.write("scene.toml", scene.replace("radius = 1.5", "radius = 1e-6"));
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--progress", "none"]);
    let found = ["R", "G", "B"].map(|name| mean(&folder.image("a.exr"), name));
    assert_eq!(found, [1.0, 2.0, 3.0]);
}

#[test]
fn skies_and_suns_are_described() {
    let sun = "[[light]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = [3, 2, 1]\n";
    let run = in_vacuum(&format!("[environment]\nradiance = 0.5\n{sun}")).done(&["info", "scene.toml"]);
    for line in [
        "environment: radiance 0.5 W/(m^2 sr)",
        "light: sun of irradiance [3.0, 2.0, 1.0] W/m^2 and 0.2650 degrees about its centre",
    ] {
        assert!(run.stdout.lines().any(|found| found == line), "{line}: {run}");
    }
    let run = with_image(|x, _| (x as f32, 1.0, 0.0), "").done(&["info", "scene.toml"]);
    assert!(run.stdout.contains("environment: \"sky.exr\", 8x4 pixels, "), "{run}");
    assert!(run.stdout.contains("in the mean of all directions, 7 at most"), "{run}");
}

#[test]
fn images_that_are_no_skies_are_refused() {
    let finding = |folder: &Folder, finding: &str| {
        let run = folder.run(&["render", "scene.toml"]);
        assert!(
            run.code == Some(1) && run.stderr.contains(finding) && run.stderr.contains("help: "),
            "{finding}: {run}"
        );
    };
    for (value, text) in [(-1.0, "-1.0"), (f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        let pixel = move |x: usize, y: usize| (1.0, if (x, y) == (5, 2) { value } else { 2.0 }, 3.0);
        let expected = format!("sky.exr: has a pixel that is {text}: column 5, row 2, channel G");
        finding(&with_image(pixel, ""), &expected);
    }
    finding(&with_image(|_, _| (1e30, 1.0, 1.0), "scale = 10\n"), "sky.exr: has a pixel that is 1e30: column 0");
    let missing = in_vacuum("[environment]\nimage = \"none.exr\"\n");
    finding(&missing, "environment.image is \"none.exr\", but there is no file ");
    let folder = with_image(|_, _| (1.0, 1.0, 1.0), "");
    folder.write("sky.exr", "no image");
    finding(&folder, "sky.exr: is not an EXR image");
    let grey = exr::prelude::SpecificChannels::build().with_channel("Y");
    let grey = grey.with_pixel_fn(|_| (1.0_f32,));
    let image = exr::prelude::Image::from_channels((8, 4), grey);
    image.write().to_file(folder.path("sky.exr")).expect("an image");
    finding(&folder, "sky.exr: has no channel R, only Y");
}

#[test]
fn values_out_of_range_are_refused() {
    let sun = "[[light]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = 3\n";
    let refused = |folder: &Folder, set: &str, finding: &str| {
        let run = folder.run(&["render", "scene.toml", "--set", set]);
        assert!(
            run.code.is_some_and(|code| code > 0) && run.stderr.contains(finding) && run.stderr.contains("help: "),
            "{set}: {run}"
        );
    };
    let folder = in_vacuum(sun);
    for (set, finding) in [
        ("light[1].direction=[0, 0, 0]", "light[1].direction is [0.0, 0.0, 0.0]"),
        ("light[1].angular_radius_deg=0", "light[1].angular_radius_deg is 0.0"),
        ("light[1].angular_radius_deg=90", "light[1].angular_radius_deg is 90.0"),
        ("light[1].angular_radius_deg=nan", "light[1].angular_radius_deg is NaN"),
        ("light[1].irradiance=-1", "light[1].irradiance is -1.0"),
        ("light[1].irradiance=[1, 1e29, 1]", "light[1].irradiance is [1.0, 1e29, 1.0]"),
        ("light[1].radius=1", "light[1].radius is given, but the light is a sun"),
        ("light[0].irradiance=1", "light[0].irradiance is given, but the light is a disk"),
        ("environment.radiance=-1", "environment.radiance is -1.0"),
        ("environment.scale=1", "environment has neither a radiance nor an image"),
    ] {
        refused(&folder, set, finding);
    }
    let folder = with_image(|_, _| (1.0, 1.0, 1.0), "");
    for (set, finding) in [
        ("environment.rotation_deg=1e9", "environment.rotation_deg is 1000000000.0"),
        ("environment.rotation_deg=inf", "environment.rotation_deg is inf"),
        ("environment.scale=0", "environment.scale is 0.0"),
        ("environment.radiance=1", "environment has both a radiance and an image"),
    ] {
        refused(&folder, set, finding);
    }
    for key in ["direction", "irradiance"] {
        let line = sun.lines().find(|line| line.starts_with(key)).expect("a line");
        let finding = format!("light[1].{key} is missing, but the light is a sun");
        let folder = in_vacuum(&sun.replace(line, ""));
        let run = folder.run(&["render", "scene.toml"]);
        assert!(run.stderr.contains(&finding), "{run}");
    }
}

#[test]
fn where_a_medium_is_around_everything_nothing_arrives_from_infinity() {
    let sky = Folder::empty();
    sky.write("scene.toml", format!("{SCENE}\n[environment]\nradiance = 1\n"));
    let run = sky.run(&["render", "scene.toml"]);
    assert!(run.code == Some(1) && run.stderr.contains("environment is a sky, of which nothing would arrive"), "{run}");
    let sun = Folder::empty();
    sun.write("scene.toml", format!("{SCENE}\n[[light]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = 1\n"));
    let run = sun.run(&["render", "scene.toml"]);
    assert!(run.code == Some(1) && run.stderr.contains("light[1] is a sun, of which nothing would arrive"), "{run}");
}

#[test]
fn no_result_replaces_the_image_of_the_sky() {
    let folder = with_image(|_, _| (1.0, 1.0, 1.0), "");
    let finding = "--output sky.exr: names a file that this command reads";
    folder.refused(&["render", "scene.toml", "-o", "sky.exr"], 2, finding);
}

#[test]
fn directional_lights_of_models_are_suns() {
    let folder = with_model(|model| {
        let sun = json!({ "type": "directional", "intensity": 2, "extras": { "angular_radius_deg": 1 } });
        model["extensions"]["KHR_lights_punctual"]["lights"][0] = sun;
    });
    let view = ["--size", "6x4", "--technique", "nee", "--samples", "16", "--progress", "none", "-o", "a.exr"];
    let run = folder.done(&[&["render", "room.gltf"], &view[..]].concat());
    assert!(!run.stderr.contains("warning"), "{run}");
    // The wall is white and faces the sun.
    let found = mean(&folder.image("a.exr"), "G");
    assert!((found / (2.0 / core::f64::consts::PI) - 1.0).abs() < 1e-3, "{found}");
    let run = folder.done(&["info", "room.gltf"]);
    assert!(run.stdout.contains("light \"Lamp\": sun of irradiance 2.0 W/m^2 and 1 degrees"), "{run}");
}
