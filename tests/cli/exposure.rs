//! How bright PNG images are.

use super::support::Folder;

/// Pixels of a PNG, and what it says of its exposure.
#[track_caller]
fn shown(folder: &Folder, name: &str) -> (Vec<[u8; 3]>, String) {
    let file = std::fs::File::open(folder.path(name)).expect("a file");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a small image")];
    reader.next_frame(&mut bytes).expect("pixels");
    let note = reader.info().uncompressed_latin1_text.iter().find(|chunk| chunk.keyword == "exposure");
    (bytes.as_chunks().0.to_vec(), note.expect("an exposure").text.clone())
}

/// The pixels of the small scene rendered with `flags`.
#[track_caller]
fn rendered(flags: &[&str]) -> (Vec<[u8; 3]>, String) {
    let folder = Folder::with_scene();
    let run = folder.done(&[&["render", "scene.toml", "-o", "a.png"], flags].concat());
    let (pixels, note) = shown(&folder, "a.png");
    assert!(run.stderr.trim_end().ends_with(&format!(", exposure {note}")), "{note}\n{run}");
    (pixels, note)
}

#[test]
fn a_crop_is_exposed_like_the_whole_image() {
    let folder = Folder::with_scene();
    let flags = ["render", "scene.toml", "--size", "24x16", "--samples", "8"];
    folder.done(&[&flags[..], &["-o", "whole.png"]].concat());
    folder.done(&[&flags[..], &["-o", "crop.png", "--crop", "2,3,7,9"]].concat());
    let ((whole, note), (crop, note_of_crop)) = (shown(&folder, "whole.png"), shown(&folder, "crop.png"));
    assert_eq!(note, note_of_crop);
    for (y, row) in crop.chunks(5).enumerate() {
        assert_eq!(row, &whole[(3 + y) * 24 + 2..][..5], "row {y}");
    }
}

#[test]
fn the_metered_exposure_depends_on_the_scene_alone() {
    let (_, plain) = rendered(&[]);
    for flags in
        [["--seed", "5"], ["--samples", "1"], ["--threads", "1"], ["--exposure", "auto"], ["--technique", "nee"]]
    {
        assert_eq!(rendered(&flags).1, plain, "{flags:?}");
    }
    let stops = |note: &str| note.strip_suffix(" EV").and_then(|stops| stops.parse::<f64>().ok()).expect("stops");
    let (_, brighter) = rendered(&["--set", "light[0].radiance=40"]);
    assert!((stops(&plain) - stops(&brighter) - 2.0).abs() < 1e-9, "{plain}, then {brighter}");
}

#[test]
fn the_middle_of_the_image_becomes_middle_grey() {
    let (pixels, _) = rendered(&["--samples", "256"]);
    let logs = pixels.iter().map(|rgb| f64::from(rgb[0]).ln()).sum::<f64>() / pixels.len() as f64;
    // 0.18 is compressed to 0.153, of which sRGB makes 109.
    assert!((logs.exp() - 109.0).abs() < 8.0, "{} of 255", logs.exp());
}

#[test]
fn exposures_are_given_by_flag_or_scene() {
    let (pixels, note) = rendered(&["--exposure", "-1.5"]);
    assert_eq!(note, "-1.5 EV");
    assert_eq!(rendered(&["--set", "film.exposure=-1.5"]).0, pixels);
    // A stop and twice the light are the same.
    assert_eq!(rendered(&["--exposure", "-2.5", "--set", "light[0].radiance=20"]).0, pixels);
    let brighter = rendered(&["--exposure", "1.5"]).0;
    assert!(brighter.iter().zip(&pixels).all(|(brighter, pixel)| brighter[0] > pixel[0]));
}

#[test]
fn an_exposure_is_a_number_of_stops() {
    let folder = Folder::with_scene();
    for (value, beginning) in [
        ("bright", "--exposure bright: is not a number of stops\n"),
        ("101", "--exposure 101.0: film.exposure is 101.0\n"),
        ("nan", "--exposure nan: film.exposure is NaN\n"),
    ] {
        folder.refused(&["render", "scene.toml", "-o", "a.png", "--exposure", value], 2, beginning);
    }
    let beginning = "--exposure 1.0: contradicts --set film.exposure=2\n";
    folder.refused(&["render", "scene.toml", "--exposure", "1", "--set", "film.exposure=2"], 2, beginning);
}

#[test]
fn an_exposure_without_a_png_image_is_told_to_have_no_effect() {
    let folder = Folder::with_scene();
    let render = |output: &str, exposure: &str| {
        let args = ["render", "scene.toml", "-o", output, "--exposure", exposure, "--progress", "none"];
        folder.done(&args).stderr
    };
    for exposure in ["2", "auto"] {
        let warning = "has no effect: only PNG images are exposed, and none is written\n";
        let stops = if exposure == "2" { "2.0" } else { exposure };
        assert_eq!(render("a.exr", exposure), format!("warning: --exposure {stops} {warning}"));
    }
    assert_eq!(render("a.png", "2"), "");
}

#[test]
fn an_exposure_changes_no_radiance() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    folder.done(&["render", "scene.toml", "-o", "b.exr", "-o", "b.png", "--exposure", "3"]);
    let (a, b) = (folder.image("a.exr"), folder.image("b.exr"));
    assert_eq!(a.channels, b.channels);
    assert_eq!(super::support::header(&a, "scene_hash"), super::support::header(&b, "scene_hash"));
}

#[test]
fn colours_of_bright_lights_keep_their_hue() {
    let lamp = "light[0].radiance=[4000, 1000, 250]";
    let (pixels, _) = rendered(&["--set", lamp, "--set", "medium.scattering=0", "--exposure", "0"]);
    let lit = pixels.iter().filter(|rgb| rgb[0] > 0);
    // Of a full red, a quarter and a sixteenth of its light, as sRGB has them.
    assert_eq!(lit.clone().next(), Some(&[255, 137, 71]), "{pixels:?}");
    assert!(lit.count() > 8);
}
