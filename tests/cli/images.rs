//! What is in the images.

use fogbow_testing::tolerances::SRGB_BYTE;

use super::support::{Folder, header, plane};

#[test]
fn an_exr_holds_radiance_its_error_and_the_number_of_samples() {
    let folder = Folder::with_edited_scene("radiance = 10", "radiance = [10, 20, 0]");
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--samples", "7"]);
    let image = folder.image("a.exr");
    let names: Vec<_> = image.channels.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["B", "G", "N", "R", "SE.B", "SE.G", "SE.R"]);
    assert_eq!((image.width, image.height), (8, 8));
    assert!(plane(&image, "N").iter().all(|samples| *samples == 7.0));
    for (red, green) in [("R", "G"), ("SE.R", "SE.G")] {
        for (red, green) in plane(&image, red).iter().zip(plane(&image, green)) {
            assert!((green - 2.0 * red).abs() <= 1e-6 * green, "{red} {green}");
        }
    }
    assert!(plane(&image, "R").iter().any(|radiance| *radiance > 0.0));
    assert!(plane(&image, "B").iter().chain(plane(&image, "SE.B")).all(|value| *value == 0.0));
}

#[test]
fn the_header_says_how_the_image_came_about() {
    let folder = Folder::with_scene();
    let flags = ["--technique", "nee,mvnee", "--set", "medium.phase.g=0.25", "--seed", "9", "--threads", "2"];
    folder.done(&[&["render", "scene.toml", "-o", "a.exr"], &flags[..]].concat());
    let image = folder.image("a.exr");
    let entries = [
        ("version", env!("CARGO_PKG_VERSION")),
        ("technique", "nee,mvnee"),
        ("seed", "9"),
        ("sample_range", "0..4"),
        ("samples", "256"),
        ("threads", "2"),
        ("region", "0,0,8,8"),
    ];
    for (name, text) in entries {
        assert_eq!(header(&image, name), text, "{name}");
    }
    assert!(header(&image, "seconds").parse::<f64>().is_ok_and(|seconds| seconds > 0.0));
    assert!(header(&image, "cpu_features").is_ascii());
    assert_eq!(header(&image, "scene_hash").len(), 32);
    let settings: toml::Table = header(&image, "settings").parse().expect("settings are TOML");
    assert_eq!(settings["medium"]["phase"]["g"].as_float(), Some(0.25));
    assert_eq!(settings["render"]["max_segments"].as_integer(), Some(24));
    folder.write("again.toml", header(&image, "settings"));
    folder.done(&["render", "again.toml", "-o", "b.exr"]);
    assert_eq!(
        plane(&folder.image("b.exr"), "R"),
        plane(&image, "R"),
        "settings are a scene that gives the same image"
    );
    assert_eq!(header(&folder.image("b.exr"), "scene_hash"), header(&image, "scene_hash"));
}

#[test]
fn the_hash_follows_the_scene_but_not_the_number_of_samples() {
    let folder = Folder::with_scene();
    let hash = |flags: &[&str]| {
        folder.done(&[&["render", "scene.toml", "-o", "a.exr"], flags].concat());
        header(&folder.image("a.exr"), "scene_hash").to_string()
    };
    let plain = hash(&[]);
    assert_eq!(hash(&["--samples", "2", "--threads", "1"]), plain);
    assert_ne!(hash(&["--seed", "2"]), plain);
    assert_ne!(hash(&["--set", "light[0].radius=0.4"]), plain);
}

#[test]
fn a_png_is_eight_bit_srgb_of_the_right_size() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.png", "--size", "13x9"]);
    let (info, pixels) = folder.png("a.png");
    assert_eq!((info.width, info.height), (13, 9));
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert!(info.srgb.is_some());
    assert_eq!(pixels.len(), 3 * 13 * 9);
    assert!(pixels.chunks(3).all(|rgb| rgb[0] == rgb[1] && rgb[1] == rgb[2]), "grey light gives a grey image");
}

/// The light of a pixel as a screen shows it, from the papers: Reinhard et al. 2002, Eq. 4, of the largest channel,
/// with white at 16, then IEC 61966-2-1.
fn shown(rgb: [f64; 3], exposure: f64) -> [f64; 3] {
    let light = exposure * rgb.into_iter().fold(0.0, f64::max);
    rgb.map(|channel| {
        let linear = (exposure * channel * (1.0 + light / 256.0) / (1.0 + light)).clamp(0.0, 1.0);
        255.0 * if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
    })
}

#[test]
fn a_png_shows_the_colours_of_the_exr() {
    let folder = Folder::with_edited_scene("radiance = 10", "radiance = [10, 4, 1]");
    folder.done(&["render", "scene.toml", "-o", "a.png", "-o", "a.exr", "--size", "13x9", "--exposure", "-2"]);
    let ((_, pixels), image) = (folder.png("a.png"), folder.image("a.exr"));
    let planes = ["R", "G", "B"].map(|channel| plane(&image, channel));
    let radiance: Vec<_> = (0..13 * 9).map(|i| planes.map(|plane| f64::from(plane[i]))).collect();
    for (i, (found, rgb)) in pixels.chunks(3).zip(radiance).enumerate() {
        let expected = shown(rgb, 0.25);
        let close =
            found.iter().zip(expected).all(|(found, expected)| (f64::from(*found) - expected).abs() < SRGB_BYTE);
        assert!(close, "pixel {i} is {found:?} where {rgb:?} should look like {expected:?}");
    }
    assert!(pixels.chunks(3).any(|rgb| rgb[0] > rgb[1] && rgb[1] > rgb[2]), "red light gives a red image");
}

#[test]
fn a_crop_has_the_pixels_of_the_whole_image_and_knows_where_they_belong() {
    use exr::meta::MetaData;
    let folder = Folder::with_scene();
    let (size, [x0, y0, x1, y1]) = ([40, 36], [5, 7, 38, 35]);
    folder.done(&["render", "scene.toml", "-o", "whole.exr", "--size", "40x36"]);
    folder.done(&["render", "scene.toml", "-o", "crop.exr", "--size", "40x36", "--crop", "5,7,38,35"]);
    let (whole, crop) = (folder.image("whole.exr"), folder.image("crop.exr"));
    assert_eq!((crop.width, crop.height), (x1 - x0, y1 - y0));
    for channel in ["R", "SE.G", "N"] {
        let (whole, crop) = (plane(&whole, channel), plane(&crop, channel));
        for (y, row) in crop.chunks(x1 - x0).enumerate() {
            assert_eq!(row, &whole[(y0 + y) * size[0] + x0..][..x1 - x0], "{channel}, row {y}");
        }
    }
    let meta = MetaData::read_from_file(folder.path("crop.exr"), true).expect("metadata");
    let display = meta.headers[0].shared_attributes.display_window;
    assert_eq!((display.position, display.size), ((0, 0).into(), (size[0], size[1]).into()));
    assert_eq!(meta.headers[0].own_attributes.layer_position, (x0 as i32, y0 as i32).into());
}

#[test]
fn row_zero_is_the_top_and_columns_go_to_the_right() {
    // In vacuum, looking along +z with +y up: image right is forward x up, -x.
    for (center, lit) in [("[0, 1, 3]", 1), ("[-1, 0, 3]", 5)] {
        let folder = Folder::with_scene();
        let center = format!("light[0].center={center}");
        let vacuum = ["--set", "medium.scattering=0", "--set", "light[0].radius=0.4", "--set", &center];
        folder.done(
            &[&["render", "scene.toml", "-o", "a.exr", "--size", "3x3", "--samples", "64"], &vacuum[..]].concat(),
        );
        let image = folder.image("a.exr");
        let found: Vec<_> = (0..9).filter(|i| plane(&image, "R")[*i] > 0.0).collect();
        assert_eq!(found, [lit], "{center}");
    }
}
