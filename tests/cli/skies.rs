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
        let expected = format!("environment.image: sky.exr: has a pixel that is {text}: column 5, row 2, channel G");
        finding(&with_image(pixel, ""), &expected);
    }
    finding(&with_image(|_, _| (1e30, 1.0, 1.0), "scale = 10\n"), "sky.exr: has a pixel that is 1e30: column 0");
    let missing = in_vacuum("[environment]\nimage = \"none.exr\"\n");
    finding(&missing, "environment.image is \"none.exr\", but there is no file ");
    let folder = with_image(|_, _| (1.0, 1.0, 1.0), "");
    folder.write("sky.exr", "no image");
    finding(&folder, "sky.exr: is neither an OpenEXR nor a Radiance image");
    folder.write("sky.exr", b"\x89PNG\r\n\x1a\n");
    finding(&folder, "sky.exr: is a PNG image, which holds no radiance");
    folder.write("sky.exr", "");
    finding(&folder, "sky.exr: is empty");
    let grey = exr::prelude::SpecificChannels::build().with_channel("Y");
    let grey = grey.with_pixel_fn(|_| (1.0_f32,));
    let image = exr::prelude::Image::from_channels((8, 4), grey);
    image.write().to_file(folder.path("sky.exr")).expect("an image");
    finding(&folder, "sky.exr: has no channel R, only Y");
}

/// How the rows of a Radiance image are stored.
#[derive(Clone, Copy, Debug)]
enum Rows {
    /// Pixel after pixel.
    Flat,
    /// Pixel after pixel, equal ones counted.
    Counted,
    /// Component after component, equal bytes counted.
    Components,
}

/// Sides of the Radiance images.
const SIDES: [usize; 2] = [16, 8];

/// Mantissas and exponent of a pixel, some of them equal to their neighbours.
fn rgbe(x: usize, y: usize) -> [u8; 4] {
    match (x / 3 + y) % 4 {
        0 => [0; 4],
        1 => [200, 3, y as u8, 120],
        2 => [255, 128, 2, 190],
        _ => [7, x as u8, 130, 129],
    }
}

/// The value of a channel of such a pixel.
fn value(pixel: [u8; 4], channel: usize) -> f32 {
    if pixel[3] == 0 { 0.0 } else { f32::from(pixel[channel]) * (f32::from(pixel[3]) - 136.0).exp2() }
}

/// Lengths of runs of what is equal, and what it is.
fn runs<T: Copy + PartialEq>(items: impl Iterator<Item = T>) -> Vec<(u8, T)> {
    let mut runs: Vec<(u8, T)> = Vec::new();
    for item in items {
        match runs.last_mut() {
            Some((count, last)) if *last == item => *count += 1,
            _ => runs.push((1, item)),
        }
    }
    runs
}

/// A Radiance image of these pixels, with `lines` in its header.
fn radiance(rows: Rows, lines: &str) -> Vec<u8> {
    let [width, height] = SIDES;
    let mut file =
        format!("#?RADIANCE\n# a sky\nFORMAT=32-bit_rle_rgbe\n{lines}\n-Y {height} +X {width}\n").into_bytes();
    for y in 0..height {
        let row = (0..width).map(|x| rgbe(x, y));
        match rows {
            Rows::Flat => file.extend(row.flatten()),
            Rows::Counted => runs(row).iter().for_each(|(count, pixel)| {
                file.extend(pixel);
                file.extend([1, 1, 1, count - 1].iter().filter(|_| *count > 1));
            }),
            Rows::Components => {
                file.extend([2, 2, 0, width as u8]);
                for component in 0..4 {
                    for (count, byte) in runs(row.clone().map(|pixel| pixel[component])) {
                        file.extend(if count > 1 { [128 + count, byte] } else { [1, byte] });
                    }
                }
            }
        }
    }
    file
}

#[test]
fn radiance_images_are_the_same_skies() {
    let folder = in_vacuum("[environment]\nimage = \"sky.exr\"\n");
    let hash =
        || fogbow::scene::load(&folder.path("scene.toml"), vec![]).unwrap_or_else(|error| panic!("{error}")).hash();
    let write = |factors: [f32; 3]| {
        let pixel = |x, y| {
            let [r, g, b] = [0, 1, 2].map(|channel| value(rgbe(x, y), channel) / factors[channel]);
            (r, g, b)
        };
        write_rgb_file(folder.path("sky.exr"), SIDES[0], SIDES[1], pixel).expect("an image");
        hash()
    };
    let [plain, exposed] = [write([1.0; 3]), write([8.0, 4.0, 2.0])];
    assert_ne!(plain, exposed);
    // What counts is how a file begins, and not what it is called.
    for rows in [Rows::Flat, Rows::Counted, Rows::Components] {
        for (lines, expected) in [("", &plain), ("EXPOSURE= 2\nVIEW\nCOLORCORR=4 2 1\n", &exposed)] {
            folder.write("sky.exr", radiance(rows, lines));
            assert_eq!(&hash(), expected, "{rows:?}, {lines:?}");
        }
    }
    let other = String::from_utf8_lossy(&radiance(Rows::Flat, "")[..11]).replace("RADIANCE", "RGBE");
    folder.write("sky.exr", [other.as_bytes(), &radiance(Rows::Flat, "")[11..]].concat());
    assert_eq!(hash(), plain);
}

#[test]
fn damaged_radiance_images_are_images_or_errors() {
    let read = |bytes: &[u8]| fogbow::image::hdr::read_bytes("x.hdr", bytes);
    for rows in [Rows::Flat, Rows::Counted, Rows::Components] {
        let file = radiance(rows, "EXPOSURE=2\n");
        assert_eq!(read(&file).expect("an image").width, SIDES[0]);
        for len in 0..file.len() {
            let error = read(&file[..len]).expect_err("too short");
            assert!(error.place.starts_with("x.hdr") && !error.remedy.is_empty(), "{error}");
        }
        let header = file.windows(2).rposition(|two| two == b"X ").expect("a size");
        for at in 0..file.len() {
            for byte in [0, 1, 2, 127, 128, 129, 255, b'9', b'\n', file[at] ^ 1] {
                // Large sizes are another test: here they would only take long.
                if at <= header || at > header + 4 || byte != b'9' {
                    let mut file = file.clone();
                    file[at] = byte;
                    let image = read(&file);
                    assert!(image.is_err() || image.is_ok_and(|image| image.channels.len() == 3), "{at}: {byte}");
                }
            }
        }
    }
}

#[test]
fn radiance_images_that_are_no_skies_are_refused() {
    let folder = in_vacuum("[environment]\nimage = \"sky.hdr\"\n");
    let file = |from: &str, to: &str, rows: Rows| {
        let (file, lines) = (radiance(rows, ""), "\n\n-Y 8 +X 16\n");
        let at = file.windows(lines.len()).position(|window| window == lines.as_bytes()).expect("a size") + lines.len();
        let header = String::from_utf8(file[..at].to_vec()).expect("UTF-8");
        assert!(header.contains(from), "{header}");
        [header.replace(from, to).as_bytes(), &file[at..]].concat()
    };
    for (from, to, finding) in [
        ("-Y 8 +X 16", "-Y 80000 +X 80000", "sky.hdr: has 80000x80000 pixels, more than the limit of 134217728"),
        ("-Y 8 +X 16", "-Y 99999999999 +X 99999999999", "pixels, more than the limit of 134217728"),
        ("-Y 8 +X 16", "-Y 1 +X 100000", "sky.hdr: row 0: is truncated: the file ends before the image does"),
        ("-Y 8 +X 16", "-Y 0 +X 16", "sky.hdr: has no size, but \"-Y 0 +X 16\""),
        ("-Y 8 +X 16", "+X 16 -Y 8", "sky.hdr: has its pixels in the order \"+X 16 -Y 8\""),
        ("-Y 8 +X 16", "-Y 9 +X 16", "sky.hdr: row 8: is truncated"),
        ("rle_rgbe", "rle_xyze", "sky.hdr: has pixels of the format \"32-bit_rle_xyze\", not 32-bit_rle_rgbe"),
        ("# a sky", "EXPOSURE=0", "sky.hdr: has the header \"EXPOSURE=0\", which is no factor of radiance"),
        ("# a sky", "COLORCORR=1 2", "sky.hdr: has the header \"COLORCORR=1 2\""),
        ("# a sky", "EXPOSURE=1e-30", "sky.hdr: has a pixel that is inf: column "),
    ] {
        folder.write("sky.hdr", file(from, to, Rows::Flat));
        let run = folder.run(&["render", "scene.toml"]);
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{finding}: {run}");
        assert!(run.stderr.contains("\n  help: "), "{run}");
    }
    folder.write("sky.hdr", file("+X 16", "+X 17", Rows::Components));
    let finding = "sky.hdr: row 0: has 16 pixels instead of 17";
    let run = folder.run(&["render", "scene.toml"]);
    assert!(run.stderr.contains(finding), "{run}");
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
    let run = folder.run(&["info", "scene.toml", "--set", "environment.radiance=1"]);
    assert!(run.stderr.contains("--set 'environment={ radiance = 1.0 }'"), "{run}");
    folder.done(&["info", "scene.toml", "--set", "environment={ radiance = 1.0 }"]);
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
