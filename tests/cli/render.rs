//! What flags do to a render.

use std::time::Instant;

use super::support::{Folder, header, mean, plane};

/// Renders the small scene with `flags` and reads the image.
fn rendered(folder: &Folder, flags: &[&str]) -> fogbow::image::Image {
    folder.done(&[&["render", "scene.toml", "-o", "a.exr"], flags].concat());
    folder.image("a.exr")
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let folder = Folder::with_scene();
    let flags = ["--size", "70x40", "--samples", "20"];
    let one = rendered(&folder, &[&flags[..], &["--threads", "1"]].concat());
    for threads in ["2", "3", "16"] {
        let many = rendered(&folder, &[&flags[..], &["--threads", threads]].concat());
        assert!(one.channels == many.channels, "{threads} threads give another image than one");
    }
}

#[test]
fn the_seed_changes_the_image() {
    let folder = Folder::with_scene();
    let red = |flags: &[&str]| plane(&rendered(&folder, flags), "R").to_vec();
    assert_eq!(red(&["--seed", "1"]), red(&[]));
    assert_ne!(red(&["--seed", "2"]), red(&[]));
    assert_ne!(red(&["--seed", "4294967295"]), red(&["--seed", "0"]));
}

#[test]
fn the_number_of_samples_is_that_of_every_pixel() {
    let folder = Folder::with_scene();
    for samples in ["1", "17", "100"] {
        let image = rendered(&folder, &["--samples", samples, "--size", "35x33"]);
        assert!(plane(&image, "N").iter().all(|n| n.to_string() == samples), "{samples}");
    }
}

#[test]
fn a_time_limit_is_kept_once_every_pixel_has_a_sample() {
    let folder = Folder::with_scene();
    let start = Instant::now();
    let image = rendered(&folder, &["--time", "300ms", "--size", "40x40"]);
    assert!(start.elapsed().as_millis() >= 300 && start.elapsed().as_secs() < 20, "took {:?}", start.elapsed());
    assert!(plane(&image, "N").iter().all(|n| *n >= 1.0));
    let image = rendered(&folder, &["--time", "0s", "--size", "40x40"]);
    assert!(plane(&image, "N").iter().all(|n| *n == 1.0), "no time is enough for one sample");
}

/// Root mean square of relative errors of a grey image of 64 pixels, all about alike, without the largest.
fn noise(image: &fogbow::image::Image) -> f64 {
    let pixels = plane(image, "SE.R").iter().zip(plane(image, "R"));
    let mut squares: Vec<_> = pixels.map(|(error, mean)| f64::from(error / mean).powi(2)).collect();
    squares.sort_by(f64::total_cmp);
    (squares[..63].iter().sum::<f64>() / 63.0).sqrt()
}

#[test]
fn a_pixel_that_sees_a_lamp_does_not_hold_up_a_noise_target() {
    let folder = Folder::with_scene();
    let lamp = "light=[{ type = \"disk\", center = [0, 0, 3], normal = [0, 0, -1], radius = 1.5, radiance = 10 }, \
                { type = \"sphere\", center = [0.05, 0.05, 2], radius = 0.01, radiance = 100000 }]";
    let image = rendered(&folder, &["--noise", "0.05", "--set", lamp, "--technique", "nee"]);
    let worst =
        plane(&image, "SE.R").iter().zip(plane(&image, "R")).map(|(error, mean)| error / mean).fold(0.0, f32::max);
    assert!(worst > 0.15, "no pixel is noisy, the worst at {worst}: this tests nothing");
    assert!(noise(&image) <= 0.05);
}

#[test]
fn a_noise_target_is_met() {
    let folder = Folder::with_scene();
    for target in [0.3, 0.05] {
        let image = rendered(&folder, &["--noise", &target.to_string()]);
        let noise = noise(&image);
        assert!(noise <= target && noise > 0.3 * target, "{noise} for {target}");
    }
}

#[test]
fn a_noise_target_ends_on_a_black_image() {
    let folder = Folder::with_edited_scene("radiance = 10", "radiance = 0");
    let image = rendered(&folder, &["--noise", "0.01", "--size", "2x2"]);
    assert!(plane(&image, "R").iter().all(|radiance| *radiance == 0.0));
}

#[test]
fn size_overrides_the_scene() {
    let folder = Folder::with_scene();
    let image = rendered(&folder, &["--size", "5x3"]);
    assert_eq!((image.width, image.height), (5, 3));
    let image = rendered(&folder, &["--set", "film.size=[5, 3]", "--set", "film.size=[2, 9]"]);
    assert_eq!((image.width, image.height), (2, 9), "the last one holds");
}

#[test]
fn any_key_can_be_overridden() {
    let folder = Folder::with_scene();
    let plain = rendered(&folder, &[]);
    let doubled = rendered(&folder, &["--set", "light[0].radiance=20"]);
    for (doubled, plain) in plane(&doubled, "R").iter().zip(plane(&plain, "R")) {
        assert!((doubled - 2.0 * plain).abs() <= 1e-6 * doubled, "{doubled} {plain}");
    }
    let flags = ["--set", "medium.absorption = 0.3", "--set", "render.technique = [\"nee\", \"mvnee\"]"];
    assert!(mean(&rendered(&folder, &flags), "R") < mean(&plain, "R"));
    let same = ["--technique", "mvnee", "--mesc", "4", "--max-segments", "24", "--samples", "4", "--seed", "1"];
    assert_eq!(plane(&rendered(&folder, &same), "R"), plane(&plain, "R"));
    assert_ne!(plane(&rendered(&folder, &["--max-segments", "1"]), "R"), plane(&plain, "R"));
    assert_ne!(plane(&rendered(&folder, &["--mesc", "1e-3"]), "R"), plane(&plain, "R"));
}

#[test]
fn a_scene_may_leave_out_what_has_a_default() {
    let folder = Folder::empty();
    let minimal = "camera = { position = [0, 0, 0], look_at = [0, 0, 1], vertical_fov_deg = 60 }\n\
                   film.size = [4, 4]\n\
                   light = [{ type = \"disk\", center = [0, 0, 3], normal = [0, 0, -1], radius = 9, radiance = 2.5 }]\n";
    folder.write("scene.toml", minimal);
    let image = rendered(&folder, &[]);
    assert!(plane(&image, "R").iter().all(|radiance| *radiance == 2.5), "a light that fills the view in vacuum");
    assert!(plane(&image, "N").iter().all(|samples| *samples == 64.0));
}

#[test]
fn twins_agree_with_the_stages() {
    let folder = Folder::with_scene();
    for technique in ["path", "nee", "mvnee", "omnee,nee", "bridge", "lis", "path,nee,mvnee,omnee,bridge,lis"] {
        let flags = ["--samples", "16", "--technique", technique];
        let simd = mean(&rendered(&folder, &flags), "R");
        for reference in [&["--reference"][..], &["--reference", "all"], &["--reference", "mis_weight"]] {
            let twin = mean(&rendered(&folder, &[&flags[..], reference].concat()), "R");
            assert!((twin / simd - 1.0).abs() < 1e-3, "{technique} {reference:?}: {twin}, SIMD {simd}");
        }
    }
}

#[test]
fn bridges_are_the_default_technique() {
    let folder = Folder::with_edited_scene("technique = \"mvnee\"\n", "");
    let image = rendered(&folder, &[]);
    assert_eq!(header(&image, "technique"), "bridge");
    assert!(image.channels == rendered(&folder, &["--technique", "bridge"]).channels);
    assert!(image.channels != rendered(&folder, &["--technique", "mvnee"]).channels);
}

#[test]
fn techniques_are_named_alone_or_together() {
    let folder = Folder::with_scene();
    for (flag, named) in [
        ("path", "path"),
        ("bridge", "bridge"),
        ("omnee,nee", "nee,omnee"),
        ("path, bridge", "bridge"),
        ("lis", "lis"),
        ("lis,bridge", "bridge,lis"),
        ("path,nee,mvnee,omnee,bridge,lis", "nee,mvnee,omnee,bridge,lis"),
    ] {
        let image = rendered(&folder, &["--technique", flag]);
        assert_eq!(header(&image, "technique"), named);
        assert!(mean(&image, "R") > 0.0, "{flag}");
    }
}

#[test]
fn light_importance_sampling_is_joined_by_bridges_or_by_mvnee() {
    let folder = Folder::with_scene();
    let with = |flags: &[&str]| rendered(&folder, &[&["--technique", "lis", "--samples", "64"], flags].concat());
    let [plain, bridge, mvnee] = [&[][..], &["--set", "render.lis=bridge"], &["--set", "render.lis=mvnee"]].map(with);
    assert!(plain.channels == bridge.channels && plain.channels != mvnee.channels);
    assert_ne!(with(&["--set", "render.roll=uniform"]).channels, plain.channels, "bridges are those of the scene");
    let limited = with(&["--set", "render.lis=mvnee", "--mesc", "1"]);
    assert_ne!(limited.channels, mvnee.channels, "and so is MVNEE");
    let (a, b) = (mean(&bridge, "R"), mean(&mvnee, "R"));
    assert!((a / b - 1.0).abs() < 0.1, "{a} and {b}");
}

#[test]
fn settings_of_bridges_change_the_image() {
    let folder = Folder::with_scene();
    let with = |setting: &str| {
        let flags =
            ["--technique", "bridge", "--set", "render.starts=2", "--set", "render.survival=0.9", "--set", setting];
        plane(&rendered(&folder, &flags), "R").to_vec()
    };
    let plain = with("render.roulette=0");
    for setting in ["roll=uniform", "bridge_mesc=1.5", "bridge_vertices=1", "starts=3", "survival=0.5", "roulette=2"] {
        assert_ne!(with(&format!("render.{setting}")), plain, "{setting}");
    }
    assert_eq!(with("render.roll=aligned"), plain);
}
