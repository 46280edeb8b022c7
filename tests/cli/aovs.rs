//! `--aov`: layers beside radiance in images, parts and checkpoints.

use fogbow::film::Region;
use fogbow::session::checkpoint::Checkpoint;
use fogbow::session::{Session, Settings};
use fogbow::{Limits, Scene, Target};

use super::support::{Folder, header, plane};

const ALL: &str = "depth,normal,albedo,transmittance,technique,length";

fn layers(folder: &Folder, name: &str, flags: &[&str]) {
    let base = ["render", "scene.toml", "-o", name, "--size", "40x36", "--progress", "none"];
    folder.done(&[&base[..], flags].concat());
}

/// Depths are means over samples that hit something: parts count by how many these are.
#[test]
fn weighted_means_of_depths_count_what_hit() {
    let folder = Folder::with_scene();
    for (name, samples) in [("a.exr", "0..3"), ("b.exr", "3..4")] {
        layers(&folder, name, &["--aov", "depth", "--sample-range", samples]);
    }
    folder.done(&["merge", "a.exr", "b.exr", "--weighted", "-o", "w.exr"]);
    folder.done(&["merge", "a.exr", "b.exr", "-o", "whole.exr"]);
    let [weighted, whole] = ["w.exr", "whole.exr"].map(|name| folder.image(name));
    for channel in ["depth.Z", "depth.A"] {
        for (a, b) in plane(&weighted, channel).iter().zip(plane(&whole, channel)) {
            assert!((a - b).abs() <= 1e-5 * b.abs(), "{channel}: {a} and {b}");
        }
    }
}

/// Whether `fogbow compare` says that both images have the same exact sums, those of all layers.
fn are_same(folder: &Folder, a: &str, b: &str) -> bool {
    let run = folder.done(&["compare", a, b]);
    run.stdout.contains("the same exact sums")
}

#[test]
fn an_exr_has_the_layers_that_are_asked_for() {
    let folder = Folder::with_scene();
    layers(&folder, "plain.exr", &[]);
    layers(&folder, "depth.exr", &["--aov", "depth"]);
    layers(&folder, "all.exr", &["--aov", ALL, "-o", "all.png"]);
    let names = |name: &str| {
        let names = folder.image(name).channels.into_iter().map(|(name, _)| name);
        let own = names.filter(|name| name.contains('.') && !name.starts_with("SE.")).collect::<Vec<_>>();
        own.into_iter().map(|name| name.split('.').next().expect("a layer").to_string()).collect::<Vec<_>>()
    };
    assert!(names("plain.exr").is_empty());
    assert_eq!(names("depth.exr"), ["depth"; 2]);
    let mut all = names("all.exr");
    all.dedup();
    let expected = [
        "albedo",
        "depth",
        "length_1",
        "length_2",
        "length_3_to_4",
        "length_5_to_8",
        "length_9_up",
        "normal",
        "technique_mvnee",
        "technique_path",
        "technique_view",
        "transmittance",
    ];
    assert_eq!(all, expected);
    let [plain, all] = ["plain.exr", "all.exr"].map(|name| folder.image(name));
    for name in ["R", "G", "B", "SE.R", "N"] {
        assert_eq!(plane(&plain, name), plane(&all, name), "{name}");
    }
    assert_eq!((header(&plain, "aov"), header(&all, "aov")), ("none", ALL));
    assert_eq!(header(&plain, "scene_hash"), header(&all, "scene_hash"), "samples are the same");
    let info = folder.done(&["info", "all.exr"]);
    assert!(info.stdout.contains("depth.Z mean") && info.stdout.contains(&format!("aov: {ALL}")), "{info}");
}

#[test]
fn layers_can_be_keys_of_the_scene_in_any_order() {
    let folder = Folder::with_edited_scene("size = [8, 8]", "size = [8, 8]\naov = [\"length\", \"depth\"]");
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    assert_eq!(header(&folder.image("a.exr"), "aov"), "depth,length");
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--aov", "albedo"]);
    assert_eq!(header(&folder.image("a.exr"), "aov"), "albedo");
}

#[test]
fn unknown_layers_and_repeated_ones_are_refused() {
    let folder = Folder::with_scene();
    for (flag, finding) in [
        ("colour", "--aov colour: film.aov: unknown name `colour`, expected one of `depth`, `normal`, `albedo`"),
        ("depth,depth", "--aov depth,depth: film.aov is a list that names depth twice"),
    ] {
        folder.refused(&["render", "scene.toml", "-o", "a.exr", "--aov", flag], 2, finding);
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn parts_with_layers_merge_to_the_bits_of_one_run() {
    let folder = Folder::with_edited_scene("radiance = 10", "radiance = [10, 7, 0.3]");
    layers(&folder, "whole.exr", &["--aov", ALL, "--samples", "12"]);
    for (name, samples) in [("a.exr", "0..5"), ("b.exr", "5..12")] {
        layers(&folder, name, &["--aov", ALL, "--sample-range", samples]);
    }
    folder.done(&["merge", "b.exr", "a.exr", "-o", "merged.exr"]);
    assert!(are_same(&folder, "merged.exr", "whole.exr"));
    for (left, crop) in [("left.exr", "0,0,17,36"), ("right.exr", "17,0,40,36")] {
        layers(&folder, left, &["--aov", ALL, "--samples", "12", "--crop", crop]);
    }
    folder.done(&["merge", "left.exr", "right.exr", "-o", "merged.exr"]);
    assert!(are_same(&folder, "merged.exr", "whole.exr"));
    layers(&folder, "other.exr", &["--aov", "depth", "--sample-range", "5..12"]);
    let finding = format!("other.exr: does not belong to the same render as a.exr: aov is {ALL} there, depth here");
    folder.refused(&["merge", "a.exr", "other.exr", "-o", "x.exr"], 1, &finding);
}

#[test]
fn adaptive_renders_have_layers_too() {
    let folder = Folder::with_scene();
    layers(&folder, "whole.exr", &["--aov", ALL, "--adaptive", "--samples", "40"]);
    layers(&folder, "a.exr", &["--aov", ALL, "--adaptive", "--sample-range", "0..20"]);
    layers(&folder, "b.exr", &["--aov", ALL, "--adaptive", "--sample-range", "20..40"]);
    folder.done(&["merge", "a.exr", "b.exr", "-o", "merged.exr"]);
    assert!(are_same(&folder, "merged.exr", "whole.exr"));
    let image = folder.image("whole.exr");
    assert!(plane(&image, "N").iter().any(|samples| *samples != plane(&image, "N")[0]), "tiles differ");
    assert!(plane(&image, "depth.A").iter().all(|hit| *hit == 1.0), "fog is everywhere, whatever the samples");
}

/// A session of the small scene with these layers.
fn session(folder: &Folder, aovs: &str) -> Session {
    let mut scene = Scene::load(folder.path("scene.toml")).expect("a scene");
    scene.set("film.aov", aovs).expect("layers");
    let mut session = Session::new(scene.loaded().clone(), Settings::default()).expect("memory");
    session.prepare(false, Limits::default(), |_| {});
    session
}

#[test]
fn a_session_with_layers_goes_on_from_a_checkpoint_to_the_same_bits() {
    let (folder, path) = (Folder::with_scene(), "a.exr.checkpoint");
    let [whole, stopped, mut resumed] = [(); 3].map(|()| session(&folder, ALL));
    whole.run(Target::Samples(9), || false, |_| {});
    stopped.run(Target::Samples(5), || false, |_| {});
    stopped.write_checkpoint(&folder.path(path)).expect("written");
    resumed.resume(&mut Checkpoint::open(&folder.path(path)).expect("a checkpoint")).expect("the same render");
    resumed.run(Target::Samples(9), || false, |_| {});
    assert!(resumed.film.is_same(&whole.film));
    folder.refused(
        &["render", "scene.toml", "-o", "a.exr", "--resume"],
        1,
        &format!("{path}: is the checkpoint of another render: aov is {ALL} there, none here"),
    );
    let info = folder.done(&["info", path]);
    assert!(info.stdout.contains(&format!("aov: {ALL}")), "{info}");
}

#[test]
fn layers_without_an_exr_image_are_warned_of_once() {
    let folder = super::frames::animated();
    let flags = super::frames::flags("a#.png", "1-2", &["--aov", "depth,normal", "--exposure", "0"]);
    let run = folder.done(&flags);
    let warning = "warning: --aov depth,normal has no effect: layers are channels of EXR images, and none is written; \
                   add -o room.####.exr, or leave it out\n";
    assert_eq!(run.stderr.matches("warning: --aov").count(), 1, "{run}");
    assert!(run.stderr.contains(warning), "{run}");
    let run = folder.done(&[&flags[..], &["-o", "b#.exr"]].concat());
    assert!(!run.stderr.contains("--aov"), "{run}");
}

#[test]
fn a_denoised_image_is_no_part_and_the_noisy_one_is_named() {
    let folder = Folder::with_scene();
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    let (region, entry) = (Region::whole(8, 8), ("denoised".to_string(), "Open Image Denoise 2.0.0".to_string()));
    for (name, noisy) in [("a.denoised.exr", ", a.exr"), ("clean.exr", "")] {
        let file = std::fs::File::create(folder.path(name)).expect("a file");
        let pixels = vec![[0.5; 3]; 64];
        fogbow::image::exr::write_pixels(file, &pixels, region, [8, 8], std::slice::from_ref(&entry))
            .expect("an image");
        let finding = format!(
            "{name}: is a denoised image, which has no samples to merge\n  help: give the noisy one{noisy}; merge \
             --denoise denoises what is merged\n"
        );
        folder.refused(&["merge", name, "-o", "b.exr"], 1, &finding);
    }
}

mod denoised {
    use std::process::Command;

    use fogbow::denoise::Denoiser;
    use fogbow_testing::not_run::not_run;

    use super::super::support::{Run, program};
    use super::*;

    const NOISY: [&str; 11] =
        ["render", "scene.toml", "-o", "a.exr", "-o", "a.png", "--size", "40x36", "--samples", "2", "--denoise"];

    /// The program where no shared library is looked for but where the system has its own.
    fn without_library(folder: &Folder) -> Command {
        let mut command = program(folder);
        command.env_remove("LD_LIBRARY_PATH");
        command
    }

    #[test]
    fn without_the_library_the_noisy_image_is_kept_and_the_reason_told() {
        let folder = Folder::with_scene();
        let run = Run::of(without_library(&folder).args(NOISY));
        if run.code == Some(0) {
            not_run("Open Image Denoise is installed for all programs");
            return;
        }
        assert_eq!(run.code, Some(1), "{run}");
        let [at_once, in_the_end] = ["warning: --denoise: ", "error: --denoise: "].map(|start| run.stderr.find(start));
        assert!(at_once.is_some() && at_once < in_the_end, "{run}");
        for words in
            ["Intel Open Image Denoise cannot be used", "openimagedenoise.org", "the image with its noise is written"]
        {
            assert!(run.stderr.contains(words), "{words}: {run}");
        }
        assert_eq!(folder.names(), ["a.exr", "a.png", "scene.toml"]);
        assert_eq!(header(&folder.image("a.exr"), "aov"), "normal,albedo");
    }

    /// It is told at once and in the end, and no frame is missing for it. What cannot be there is not waited for.
    #[test]
    fn without_the_library_all_frames_are_rendered() {
        let folder = super::super::frames::animated();
        let flags = super::super::frames::flags("a#.exr", "3-5", &["--denoise"]);
        let render = |more: &[&str]| Run::of(without_library(&folder).args(&flags).args(more));
        let run = render(&[]);
        if run.code == Some(0) {
            not_run("Open Image Denoise is installed for all programs");
            return;
        }
        let warnings = run.stderr.matches("warning: --denoise: ").count();
        assert!(run.code == Some(1) && warnings == 1 && run.stderr.contains("error: --denoise: "), "{run}");
        assert!(["a3.exr", "a4.exr", "a5.exr"].iter().all(|name| folder.path(name).is_file()), "{run}");
        let run = render(&["--resume"]);
        assert!(run.code == Some(1) && run.stderr.matches("already there, skipped").count() == 3, "{run}");
    }

    #[test]
    fn with_the_library_there_is_less_noise_and_the_noisy_image_is_kept() {
        if let Err(error) = Denoiser::find() {
            not_run(error);
            return;
        }
        let folder = Folder::with_edited_scene("radiance = 10", "radiance = [10, 7, 0.3]");
        folder.done(&NOISY);
        assert_eq!(folder.names(), ["a.denoised.exr", "a.denoised.png", "a.exr", "a.png", "scene.toml"]);
        folder.done(&["render", "scene.toml", "-o", "truth.exr", "--size", "40x36", "--samples", "1024"]);
        folder.done(&["render", "scene.toml", "-o", "plain.exr", "--size", "40x36", "--samples", "2"]);
        let [noisy, denoised, truth, plain] =
            ["a.exr", "a.denoised.exr", "truth.exr", "plain.exr"].map(|name| folder.image(name));
        for channel in ["R", "G", "B"] {
            assert_eq!(plane(&noisy, channel), plane(&plain, channel), "the noisy image is as without --denoise");
            let error = |image: &fogbow::image::Image| {
                let pairs = plane(image, channel).iter().zip(plane(&truth, channel));
                pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
            };
            assert!(error(&denoised) < 0.5 * error(&noisy), "{channel}: {} {}", error(&denoised), error(&noisy));
            assert!(plane(&denoised, channel).iter().all(|value| value.is_finite() && *value >= 0.0));
        }
        assert!(header(&denoised, "denoised").starts_with("Open Image Denoise 2."));
        assert_eq!(header(&denoised, "scene_hash"), header(&noisy, "scene_hash"));
        assert_eq!(folder.png("a.denoised.png").0.width, 40);
    }

    #[test]
    fn merged_parts_are_denoised_as_one_image() {
        if let Err(error) = Denoiser::find() {
            not_run(error);
            return;
        }
        let folder = Folder::with_scene();
        let base = ["render", "scene.toml", "--size", "40x36", "--aov", "albedo,normal"];
        for (name, samples) in [("b.exr", "0..1"), ("c.exr", "1..2")] {
            folder.done(&[&base[..], &["-o", name, "--sample-range", samples]].concat());
        }
        folder.done(&NOISY);
        folder.done(&["merge", "c.exr", "b.exr", "-o", "m.exr", "-o", "m.png", "--denoise"]);
        let [whole, merged] = ["a.denoised.exr", "m.denoised.exr"].map(|name| folder.image(name));
        for (a, b) in plane(&whole, "G").iter().zip(plane(&merged, "G")) {
            assert!((a - b).abs() <= 1e-3 * a, "{a} and {b}");
        }
        assert_eq!(folder.png("m.denoised.png").0.width, 40);
        folder.done(&["render", "scene.toml", "--size", "40x36", "-o", "d.exr"]);
        let run = folder.run(&["merge", "d.exr", "-o", "e.exr", "--denoise"]);
        let finding = "error: --denoise: the image has no layer albedo\n  help: render it with --aov albedo,normal";
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{run}");
        assert!(folder.names().contains(&"e.exr".to_string()), "the image with its noise is kept");
    }

    #[test]
    fn there_has_to_be_a_place_beside_the_image() {
        let folder = Folder::with_scene();
        let to_stdout = ["render", "scene.toml", "-o", "exr:/dev/stdout", "--denoise"];
        folder.refused(&to_stdout, 2, "--output /dev/stdout: is no file with a name");
        let twice = ["render", "scene.toml", "-o", "a.exr", "-o", "a.denoised.exr", "--denoise"];
        folder.refused(&twice, 2, "--denoise a.denoised.exr: names the same file as another output");
    }
}
