//! Parts of a render, and what is made of them.

use fogbow::image::Image;

use super::support::{Folder, assert_same_bits, header, plane};

/// Renders `name` with these flags, 12 samples of 40 x 36 pixels unless they say otherwise.
fn part(folder: &Folder, name: &str, flags: &[&str]) {
    let base = ["render", "scene.toml", "-o", name, "--size", "40x36", "--progress", "none"];
    folder.done(&[&base[..], flags].concat());
}

fn range(folder: &Folder, name: &str, samples: &str) {
    part(folder, name, &["--sample-range", samples]);
}

/// A folder with a render of 12 samples, `whole.exr`, and three parts of it, `a.exr`, `b.exr` and `c.exr`.
fn parts() -> Folder {
    let folder = Folder::with_edited_scene("radiance = 10", "radiance = [10, 7, 0.3]");
    part(&folder, "whole.exr", &["--samples", "12"]);
    for (name, samples) in [("a.exr", "0..1"), ("b.exr", "1..9"), ("c.exr", "9..12")] {
        range(&folder, name, samples);
    }
    folder
}

#[test]
fn parts_in_any_order_merge_to_the_bits_of_one_run() {
    let folder = parts();
    for order in [["a.exr", "b.exr", "c.exr"], ["c.exr", "a.exr", "b.exr"], ["b.exr", "c.exr", "a.exr"]] {
        let run = folder.done(&[&["merge"], &order[..], &["-o", "merged.exr"]].concat());
        assert_eq!(run.stderr, run.stderr.trim_start_matches("warning"), "{run}");
        assert_same_bits(&folder, "merged.exr", "whole.exr");
        let (merged, whole) = (folder.image("merged.exr"), folder.image("whole.exr"));
        for name in ["sample_range", "coverage", "samples", "scene_hash", "settings", "region", "seed"] {
            assert_eq!(header(&merged, name), header(&whole, name), "{name}");
        }
        let seconds = |image: &Image| header(image, "seconds").parse::<f64>().expect("a number");
        let sum: f64 = order.iter().map(|name| seconds(&folder.image(name))).sum();
        assert!((seconds(&merged) - sum).abs() < 0.002, "{}", seconds(&merged));
    }
}

#[test]
fn what_was_merged_can_be_merged_again() {
    let folder = parts();
    folder.done(&["merge", "c.exr", "a.exr", "-o", "ca.exr"]);
    folder.done(&["merge", "ca.exr", "b.exr", "-o", "merged.exr", "-o", "merged.png"]);
    assert_same_bits(&folder, "merged.exr", "whole.exr");
    assert_eq!(header(&folder.image("merged.exr"), "parts"), "3");
    assert_eq!(folder.png("merged.png").0.width, 40);
    folder.refused(&["merge", "ca.exr", "c.exr", "-o", "x.exr"], 1, "c.exr: has samples 9..12, which ca.exr has, too");
}

#[test]
fn crops_merge_too() {
    let folder = parts();
    for (name, crop, samples) in [
        ("left.exr", "0,0,17,36", "0..12"),
        ("top.exr", "17,0,40,10", "0..5"),
        ("late.exr", "17,0,40,10", "5..12"),
        ("bottom.exr", "17,10,40,36", "0..12"),
    ] {
        part(&folder, name, &["--crop", crop, "--sample-range", samples]);
    }
    let run = folder.done(&["merge", "late.exr", "bottom.exr", "left.exr", "-o", "most.exr"]);
    assert!(
        run.stderr
            .contains("warning: samples 0..5 are missing from 230 of the 1440 pixels (columns 17..40, rows 0..10)\n"),
        "{run}"
    );
    let fewest = |image: &Image| plane(image, "N").iter().copied().fold(f32::MAX, f32::min);
    assert_eq!(fewest(&folder.image("most.exr")), 7.0);
    folder.done(&["merge", "top.exr", "most.exr", "-o", "merged.exr"]);
    assert_same_bits(&folder, "merged.exr", "whole.exr");
    let run =
        folder.refused(&["merge", "left.exr", "a.exr", "-o", "x.exr"], 1, "a.exr: has samples 0..1 of the pixels ");
    assert!(run.stderr.contains("0,0,17,36, which left.exr has, too"), "{run}");
    let run = folder.done(&["merge", "bottom.exr", "-o", "crop.exr"]);
    assert!(run.stderr.contains("warning: samples 0..12 are missing from 842 of the 1440 pixels (columns "), "{run}");
    assert_same_bits(&folder, "crop.exr", "bottom.exr");
}

#[test]
fn folders_and_lists_name_parts() {
    let folder = parts();
    for name in ["a.exr", "b.exr", "c.exr"] {
        std::fs::create_dir_all(folder.path("parts")).expect("a folder");
        std::fs::rename(folder.path(name), folder.path(&format!("parts/{name}"))).expect("a part");
    }
    folder.write("parts/notes.txt", "no part");
    folder.write("parts/.hidden.exr", "no part");
    // The second time the result is there already.
    for _ in 0..2 {
        let run = folder.done(&["merge", "parts", "-o", "parts/merged.exr", "--expect", "0..12"]);
        assert!(run.stderr.starts_with("parts/merged.exr: 3 images, 12 samples per pixel"), "{run}");
        assert_same_bits(&folder, "parts/merged.exr", "whole.exr");
    }
    folder.write("list", "parts/c.exr\r\n\nparts/a.exr\n");
    let run = folder.done(&["merge", "@list", "parts/b.exr", "-o", "listed.exr"]);
    assert!(run.stderr.starts_with("listed.exr: 3 images, "), "{run}");
    assert_same_bits(&folder, "listed.exr", "whole.exr");
    folder.done(&["merge", "parts", "-o", "parts/merged.exr", "-o", "mean.exr", "--weighted"]);
    std::fs::create_dir(folder.path("empty")).expect("a folder");
    folder.write("blank", "\n");
    for (part, finding) in [
        ("empty", "empty: is a folder without EXR images\n"),
        ("@blank", "@blank: lists no image\n"),
        ("@nowhere", "@nowhere: cannot be read: "),
    ] {
        folder.refused(&["merge", part, "-o", "x.exr"], 1, finding);
    }
    folder.refused(&["merge", "@list", "parts", "-o", "x.exr"], 1, "parts/a.exr: is given twice");
}

#[test]
fn missing_and_repeated_parts_are_told() {
    let folder = parts();
    let run = folder.done(&["merge", "a.exr", "c.exr", "-o", "ac.exr"]);
    assert!(run.stderr.contains("warning: samples 1..9 are missing from every pixel\n"), "{run}");
    assert!(plane(&folder.image("ac.exr"), "N").iter().all(|samples| *samples == 4.0));
    folder.refused(&["merge", "a.exr", "b.exr", "a.exr", "-o", "x.exr"], 1, "a.exr: is given twice");
    folder.refused(&["merge", "whole.exr", "b.exr", "-o", "x.exr"], 1, "b.exr: has samples 1..9, which whole.exr has");
}

#[test]
fn other_renders_are_refused_with_what_differs() {
    let folder = parts();
    for (flags, difference) in [
        (&["--seed", "2"][..], "render.seed is 1 there, 2 here"),
        (&["--size", "36x40"], "film.size is [40, 36] there, [36, 40] here"),
        (&["--technique", "nee"], "render.technique is [\"mvnee\"] there, [\"nee\"] here"),
        (&["--set", "light[0].radius=1.25"], "light[0].radius is 1.5 there, 1.25 here"),
        (&["--reference", "scatter"], "--reference is none there, scatter here"),
    ] {
        let base = ["render", "scene.toml", "-o", "other.exr", "--sample-range", "12..13", "--progress", "none"];
        let size = if flags[0] == "--size" { &[][..] } else { &["--size", "40x36"] };
        folder.done(&[&base[..], size, flags].concat());
        let beginning = format!("other.exr: does not belong to the same render as a.exr: {difference}");
        folder.refused(&["merge", "a.exr", "other.exr", "-o", "x.exr"], 1, &beginning);
    }
}

#[test]
fn images_without_sums_merge_by_weights_if_asked_to() {
    let folder = parts();
    folder.done(&["merge", "a.exr", "b.exr", "--weighted", "-o", "ab.exr", "-o", "ab.png"]);
    let beginning = "ab.exr: has no exact sums: another program wrote it, or an earlier version of fogbow";
    let run = folder.refused(&["merge", "ab.exr", "c.exr", "-o", "x.exr"], 1, beginning);
    assert!(run.stderr.contains("--weighted"), "{run}");
    folder.done(&["merge", "ab.exr", "c.exr", "--weighted", "-o", "merged.exr"]);
    let (merged, whole) = (folder.image("merged.exr"), folder.image("whole.exr"));
    assert_eq!(plane(&merged, "N"), plane(&whole, "N"));
    for (a, b) in plane(&merged, "R").iter().zip(plane(&whole, "R")) {
        assert!((a - b).abs() <= 1e-5 * b, "{a} {b}");
    }
    part(&folder, "small.exr", &["--crop", "0,0,8,8"]);
    folder.refused(&["merge", "a.exr", "small.exr", "--weighted", "-o", "x.exr"], 1, "small.exr: cannot be averaged");
}

/// Writes the image called `from` as `to`, with the channel N changed: left out if `count` is.
fn recounted(folder: &Folder, from: &str, to: &str, count: Option<f32>) {
    let mut image = Image { header: Vec::new(), ..folder.image(from) };
    match count {
        Some(count) => image.channels.iter_mut().filter(|(name, _)| name == "N").for_each(|(_, n)| n[41] = count),
        None => image.channels.retain(|(name, _)| name != "N"),
    }
    let mut file = std::io::Cursor::new(Vec::new());
    fogbow::image::exr::write_image(&mut file, &image).expect("an image");
    folder.write(to, file.into_inner());
}

#[test]
fn numbers_of_samples_that_do_not_count_are_told() {
    let folder = parts();
    recounted(&folder, "b.exr", "silent.exr", None);
    let run = folder.done(&["merge", "a.exr", "silent.exr", "--weighted", "-o", "x.exr"]);
    let warning =
        "warning: silent.exr: has no numbers of samples (channel N), but others have: all images count alike\n";
    assert!(run.stderr.contains(warning), "{run}");
    let run = folder.done(&["merge", "silent.exr", "--weighted", "-o", "x.exr"]);
    assert!(!run.stderr.contains("warning"), "nobody counts: {run}");
    for count in [-3.0, f32::NAN, f32::INFINITY] {
        recounted(&folder, "b.exr", "wrong.exr", Some(count));
        let beginning = format!("wrong.exr: has {count} samples in pixel (1, 1), by its channel N");
        folder.refused(&["merge", "a.exr", "wrong.exr", "--weighted", "-o", "y.exr"], 1, &beginning);
    }
    assert!(!folder.path("y.exr").exists());
}

#[test]
fn a_denoised_image_in_the_folder_of_the_parts_is_told_to_be_left_out() {
    let folder = parts();
    std::fs::create_dir(folder.path("parts")).expect("a folder");
    std::fs::rename(folder.path("a.exr"), folder.path("parts/a.exr")).expect("a part");
    recounted(&folder, "b.exr", "parts/a.denoised.exr", None);
    let finding = "parts/a.denoised.exr: is the denoised image of parts/a.exr, which is merged, too\n";
    let run = folder.refused(&["merge", "parts", "-o", "x.exr"], 1, finding);
    assert!(run.stderr.contains("help: leave it out: move it elsewhere, or name the parts"), "{run}");
}

#[test]
fn no_part_is_overwritten() {
    let folder = parts();
    for flags in [&["-o", "b.exr"][..], &["-o", "x.png", "-o", "exr:./a.exr", "--weighted"]] {
        let run = folder.run(&[&["merge", "a.exr", "b.exr"], flags].concat());
        assert_eq!(run.code, Some(2), "{run}");
        assert!(run.stderr.contains("names a file that this command reads"), "{run}");
    }
}

#[test]
fn damaged_parts_are_refused() {
    let folder = parts();
    let whole = std::fs::read(folder.path("a.exr")).expect("a file");
    let step = whole.len() / 60;
    for at in (0..whole.len()).step_by(step) {
        folder.write("a.exr", &whole[..at]);
        let run = folder.run(&["merge", "b.exr", "a.exr", "-o", "x.exr"]);
        assert!(run.code == Some(1) && run.stderr.starts_with("error: a.exr: "), "{at}: {run}");
        let mut flipped = whole.clone();
        flipped[at] ^= 1 << (at % 8);
        folder.write("a.exr", flipped);
        // What is not read may differ, but never what comes out of it.
        let run = folder.run(&["merge", "b.exr", "a.exr", "-o", "x.exr"]);
        assert!(matches!(run.code, Some(0 | 1)), "{at}: {run}");
        if run.code == Some(0) {
            folder.write("a.exr", &whole);
            folder.done(&["merge", "b.exr", "a.exr", "-o", "y.exr"]);
            assert!(plane(&folder.image("x.exr"), "R") == plane(&folder.image("y.exr"), "R"), "{at}");
        }
    }
}

#[test]
fn an_image_that_another_program_changed_is_no_part() {
    use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, WritableImage};
    let folder = parts();
    let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let mut image = read.all_attributes().from_file(folder.path("a.exr")).expect("an image");
    let red = image.layer_data[0].channel_data.list.iter_mut().find(|channel| channel.name == *"R").expect("R");
    let FlatSamples::F32(values) = &mut red.sample_data else { panic!("f32") };
    values[7] *= 2.0;
    image.write().to_file(folder.path("a.exr")).expect("a file");
    folder.refused(&["merge", "a.exr", "b.exr", "-o", "x.exr"], 1, "a.exr: was changed by another program");
}

#[test]
fn ranges_of_samples_are_checked() {
    let folder = Folder::with_scene();
    for (range, finding) in [
        ("4", "is not a range of samples"),
        ("4..4", "is empty"),
        ("5..4", "is empty"),
        ("-1..4", "is not a range of samples"),
        ("0..2147483649", "reaches beyond 2147483648, the most that a pixel can have\n"),
        ("4294967290..4294967300", "reaches beyond 2147483648, the most that a pixel can have\n"),
        ("0..99999999999999999999999", "reaches beyond 2147483648, the most that a pixel can have\n"),
        ("0..+4", "is not a range of samples"),
    ] {
        let place = format!("--sample-range {range}: {finding}");
        folder.refused(&["render", "scene.toml", "--sample-range", range], 2, &place);
    }
    let run = folder.run(&["render", "scene.toml", "--sample-range", "0..4", "--samples", "4"]);
    assert_eq!(run.code, Some(2), "{run}");
}
