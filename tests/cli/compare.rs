//! `fogbow compare`

use super::support::{Folder, mean};
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, Layer, WritableImage};
use fogbow_testing::not_run::not_run;
use serde_json::Value;

/// A folder with renders of two seeds and one of another size.
fn renders() -> Folder {
    let folder = Folder::with_scene();
    let flags = [("a.exr", "1", "8x8"), ("b.exr", "2", "8x8"), ("small.exr", "1", "4x4")];
    for (name, seed, size) in flags {
        folder.done(&["render", "scene.toml", "-o", name, "--seed", seed, "--size", size, "--samples", "400"]);
    }
    folder
}

/// Writes an image of 2 x 2 pixels with these planes.
fn write_planes(folder: &Folder, name: &str, planes: &[(&str, f32)]) {
    let plane = |(name, value): &(&str, f32)| AnyChannel::new(*name, FlatSamples::F32(vec![*value; 4]));
    let channels = AnyChannels::sort(planes.iter().map(plane).collect());
    let layer = Layer::new((2, 2), Default::default(), exr::prelude::Encoding::UNCOMPRESSED, channels);
    Image::from_layer(layer).write().to_file(folder.path(name)).expect("an image");
}

fn json(folder: &Folder, a: &str, b: &str) -> Value {
    let run = folder.done(&["compare", a, b, "--json"]);
    assert_eq!(run.stderr, "", "{run}");
    serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{error}\n{run}"))
}

#[test]
fn an_image_does_not_differ_from_itself() {
    let folder = renders();
    let report = json(&folder, "a.exr", "a.exr");
    assert_eq!((report["width"].as_u64(), report["height"].as_u64()), (Some(8), Some(8)));
    let channels = report["channels"].as_array().expect("channels");
    assert_eq!(channels.len(), 3);
    for (channel, name) in channels.iter().zip(["R", "G", "B"]) {
        assert_eq!(channel["channel"].as_str(), Some(name));
        for figure in ["rmse", "relative_mse", "mean_difference_in_standard_errors", "chi_square"] {
            assert_eq!(channel[figure].as_f64(), Some(0.0), "{figure} of {name}");
        }
        assert_eq!((channel["pixels"].as_u64(), channel["p_value"].as_f64()), (Some(64), Some(1.0)));
    }
}

#[test]
fn noise_explains_the_difference_of_two_seeds() {
    let folder = renders();
    let report = json(&folder, "a.exr", "b.exr");
    let red = &report["channels"][0];
    let figure = |name: &str| red[name].as_f64().unwrap_or_else(|| panic!("no {name} in {report:#}"));
    let (a, b) = (folder.image("a.exr"), folder.image("b.exr"));
    assert!((figure("mean_a") / mean(&a, "R") - 1.0).abs() < 1e-9);
    assert!((figure("mean_b") / mean(&b, "R") - 1.0).abs() < 1e-9);
    assert!(figure("rmse") > 0.0 && figure("relative_mse") > 0.0);
    assert!(figure("mean_difference_in_standard_errors").abs() < 5.0, "{report:#}");
    assert_eq!(figure("noisy_pixels"), 64.0);
    assert!((20.0..150.0).contains(&figure("chi_square")), "{report:#}");
    assert!((0.0..=1.0).contains(&figure("p_value")), "{report:#}");
    // One block, of which the difference is that of the means.
    assert_eq!(figure("noisy_blocks"), 1.0);
    let of_means = figure("mean_difference_in_standard_errors").powi(2);
    assert!((figure("chi_square_of_blocks") / of_means - 1.0).abs() < 1e-9, "{report:#}");
}

#[test]
fn a_different_scene_is_not_noise() {
    let folder = renders();
    folder.done(&["render", "scene.toml", "-o", "bright.exr", "--samples", "400", "--set", "light[0].radiance=20"]);
    let red = json(&folder, "bright.exr", "a.exr")["channels"][0].clone();
    assert!(red["mean_difference_in_standard_errors"].as_f64().is_some_and(|z| z > 10.0), "{red:#}");
    assert!(red["p_value"].as_f64().is_some_and(|p| p < 1e-6), "{red:#}");
    let run = folder.done(&["compare", "bright.exr", "a.exr"]);
    assert!(run.stdout.starts_with("bright.exr and a.exr: 8x8 pixels\nR  means "), "{run}");
    assert!(run.stdout.contains(" over 64 noisy pixels, p = 0.000; "), "{run}");
    assert_eq!(run.stdout.lines().count(), 10, "{run}");
}

#[test]
fn single_samples_have_no_errors_to_judge_by() {
    let folder = renders();
    folder.done(&["render", "scene.toml", "-o", "one.exr", "--samples", "1"]);
    let red = json(&folder, "one.exr", "a.exr")["channels"][0].clone();
    assert!(red["rmse"].as_f64().is_some_and(|rmse| rmse > 0.0) && red.get("p_value").is_none(), "{red:#}");
    let run = folder.done(&["compare", "one.exr", "a.exr"]);
    assert!(!run.stdout.contains("standard errors"), "{run}");
}

#[test]
fn images_of_other_programs_can_be_compared() {
    let folder = Folder::empty();
    write_planes(&folder, "a.exr", &[("R", 1.0), ("G", 2.0), ("B", 3.0), ("Z", 9.0)]);
    write_planes(&folder, "b.exr", &[("R", 1.5), ("G", 2.0), ("B", 3.0), ("A", 1.0)]);
    let report = json(&folder, "a.exr", "b.exr");
    let rmse = report["channels"].as_array().expect("channels").iter().map(|channel| channel["rmse"].as_f64());
    assert_eq!(rmse.collect::<Vec<_>>(), [Some(0.5), Some(0.0), Some(0.0)]);
    assert!(report["channels"][0].get("chi_square").is_none());
}

#[test]
fn a_picture_shows_where_images_differ() {
    let folder = renders();
    let run = folder.done(&["compare", "a.exr", "b.exr", "--png", "d.png"]);
    assert_eq!(run.stderr, "d.png: full colour stands for 3 standard errors\n");
    let file = std::fs::File::open(folder.path("d.png")).expect("a file");
    let reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    assert_eq!((reader.info().width, reader.info().height), (8, 8));
}

#[test]
fn the_picture_replaces_neither_image() {
    let folder = renders();
    std::fs::copy(folder.path("b.exr"), folder.path("b.png")).expect("a copy");
    std::fs::create_dir(folder.path("sub")).expect("a folder");
    let finding = "names a file that this command reads\n";
    for (images, picture) in [(["a.exr", "b.png"], "b.png"), (["b.png", "a.exr"], "sub/../b.png")] {
        let args = [&["compare"][..], &images, &["--png", picture]].concat();
        folder.refused(&args, 2, &format!("--png {picture}: {finding}"));
    }
    folder.refused(&["compare", "a.exr", "b.exr", "--png", "png:a.exr"], 2, &format!("--png a.exr: {finding}"));
    folder.refused(
        &["compare", "a.exr", "b.exr", "--png", "exr:d.png"],
        2,
        "--png exr:d.png: does not name a PNG image\n",
    );
    folder.refused(&["compare", "a.exr", "b.exr", "--png", "png:"], 2, "--png png:: does not name a file\n");
}

#[cfg(target_os = "linux")]
#[test]
fn the_picture_may_go_into_a_pipe() {
    let folder = renders();
    let script = |shell: &str, script: &str| {
        let mut command = std::process::Command::new(shell);
        let output = command.args(["-c", script, env!("CARGO_BIN_EXE_fogbow")]).current_dir(folder.path(".")).output();
        let output = output.expect("a shell");
        assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
        (output.stdout, String::from_utf8(output.stderr).expect("UTF-8"))
    };
    let is_png = |bytes: &[u8]| bytes.starts_with(b"\x89PNG");
    for name in ["png:/dev/stdout", "/dev/stdout"] {
        let (picture, report) = script("sh", &format!("\"$0\" compare a.exr b.exr --png {name} | cat"));
        assert!(is_png(&picture) && report.starts_with("a.exr and b.exr: 8x8 pixels\nR  means "), "{report}");
    }
    if std::process::Command::new("bash").arg("--version").output().is_err() {
        not_run("there is no bash; all but process substitution was");
        return;
    }
    for name in [">(cat > d.png)", "png:>(cat > d.png)"] {
        let (report, _) = script("bash", &format!("\"$0\" compare a.exr b.exr --png {name}; wait; sleep 0.2"));
        assert!(report.starts_with(b"a.exr and b.exr: 8x8 pixels\n"), "{report:?}");
        assert_eq!(folder.png("d.png").0.width, 8);
        std::fs::remove_file(folder.path("d.png")).expect("a file");
    }
}

#[test]
fn images_that_cannot_be_compared_are_refused() {
    let folder = renders();
    folder.write("scene.exr", "no image");
    folder.write("empty.exr", "");
    let whole = std::fs::read(folder.path("a.exr")).expect("an image");
    folder.write("cut.exr", &whole[..whole.len() / 2]);
    write_planes(&folder, "grey.exr", &[("Y", 1.0)]);
    write_planes(&folder, "colour.exr", &[("R", 1.0), ("G", 1.0), ("B", 1.0)]);
    let different = "a.exr, small.exr: the images have different sizes, 8x8 and 4x4\n";
    folder.refused(&["compare", "a.exr", "small.exr"], 1, different);
    folder.refused(&["compare", "a.exr", "missing.exr"], 1, "missing.exr: cannot be read: ");
    folder.refused(&["compare", "scene.exr", "a.exr"], 1, "scene.exr: is not an EXR image\n");
    folder.refused(&["compare", "empty.exr", "a.exr"], 1, "empty.exr: is empty\n");
    folder.refused(&["compare", "a.exr", "cut.exr"], 1, "cut.exr: is truncated: ");
    folder.refused(&["compare", ".", "a.exr"], 1, ".: cannot be read: ");
    let lacking = "colour.exr, grey.exr: the second image has no channel R, only Y\n";
    folder.refused(&["compare", "colour.exr", "grey.exr"], 1, lacking);
    folder.refused(&["compare", "a.exr", "b.exr", "--png", "b.exr"], 2, "--png b.exr: does not name a PNG image\n");
    folder.refused(&["compare", "a.exr", "b.exr", "--png", "no/d.png"], 1, "no/d.png: no file can be created in no: ");
}

#[test]
fn an_image_that_is_not_whole_is_called_truncated() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--size", "64x64"]);
    let whole = std::fs::read(folder.path("a.exr")).expect("an image");
    for length in [1, 3, 100, 1000, whole.len() / 2, whole.len() - 1] {
        folder.write("part.exr", &whole[..length]);
        let beginning = "part.exr: is truncated: the file ends before the image does\n";
        folder.refused(&["info", "part.exr"], 1, beginning);
        folder.refused(&["compare", "a.exr", "part.exr"], 1, beginning);
    }
    folder.write("part.exr", "");
    folder.refused(&["info", "part.exr"], 1, "part.exr: is empty\n");
}

#[test]
fn a_damaged_image_is_no_crash() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    let whole = std::fs::read(folder.path("a.exr")).expect("an image");
    for place in (4..whole.len()).step_by(whole.len() / 150) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x55;
        folder.write("b.exr", &bytes);
        let run = folder.run(&["info", "b.exr"]);
        assert!(matches!(run.code, Some(0 | 1)), "byte {place}: {run}");
    }
}
