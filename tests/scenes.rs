//! The scenes that ship: each loads, says what it is, and has the mean that its README promises.

use std::path::{Path, PathBuf};

use fogbow::scene::{self, LoadedScene, document::Override};
use fogbow_kernels::connect::bridge::MOST_ALTERNATIVES;
use fogbow_testing::render::{green, render};
use fogbow_testing::suite::IS_LONG;

fn folders() -> Vec<PathBuf> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = std::fs::read_dir(&scenes).expect("the project has scenes");
    let paths = entries.map(|entry| entry.expect("a readable entry").path());
    let mut folders: Vec<_> = paths.filter(|path| path.join("scene.toml").is_file()).collect();
    folders.sort();
    folders
}

/// The scene at a small size of the same shape: some 20 pixels in a row.
fn small(folder: &Path) -> LoadedScene {
    let load = |changes| scene::load(folder, changes).unwrap_or_else(|error| panic!("{error}"));
    let [width, height] = load(vec![]).scene.film.size;
    let common = (1..=width).rev().find(|n| width % n == 0 && height % n == 0).expect("one divides all");
    let [width, height] = [width / common, height / common].map(|side| side * (24 * common / width).max(1));
    load(vec![Override::parse(&format!("film.size=[{width}, {height}]")).expect("has a =")])
}

/// Channels of which the README has a mean with its error, and these: green, and in coloured scenes the other two.
fn promised(folder: &Path) -> Vec<(usize, f64, f64)> {
    let readme = std::fs::read_to_string(folder.join("README.md")).expect("every scene has a README");
    let row = |start: &str| {
        let row = readme.lines().find(|line| line.starts_with(start))?;
        let numbers: Vec<f64> = row.split([' ', '|']).filter_map(|word| word.parse().ok()).collect();
        (numbers.len() == 2).then(|| (numbers[0], numbers[1]))
    };
    let rows = ["| red |", "| expected image mean", "| blue |"].map(row);
    assert!(rows[1].is_some(), "{}: no expected image mean", folder.display());
    (0..3).filter_map(|channel| rows[channel].map(|(mean, error)| (channel, mean, error))).collect()
}

#[test]
fn every_scene_comes_with_a_picture_and_with_small_files() {
    for folder in folders() {
        let name = folder.file_name().expect("a name").to_string_lossy();
        let places = ["thumbnail.png".to_string(), format!("{name}.png")].map(|picture| folder.join(picture));
        let place = places.iter().find(|place| place.is_file()).expect("every scene has a picture");
        let picture = std::fs::File::open(place).expect("a readable picture");
        let reader = png::Decoder::new(std::io::BufReader::new(picture)).read_info().expect("a PNG");
        let (width, height) = reader.info().size();
        let [x, y] = scene::load(&folder, vec![]).unwrap_or_else(|error| panic!("{error}")).scene.film.size;
        let (shape, shown) = (f64::from(x) / f64::from(y), f64::from(width) / f64::from(height));
        assert!(
            width.max(height) >= 160 && (shown / shape - 1.0).abs() < 0.02,
            "{}: {width}x{height}",
            folder.display()
        );
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let file = entry.expect("a readable entry");
            let size = file.metadata().expect("its size").len();
            assert!(size <= 4_000_000, "{}: {size} bytes", file.path().display());
        }
    }
}

#[test]
fn every_scene_has_the_mean_that_its_readme_promises() {
    let folders = folders();
    assert!(folders.len() >= 8, "only {folders:?}");
    for folder in folders {
        let scene = small(&folder);
        // Bridges need fewer samples where there is less fog, and take longer where there is more to hit.
        let samples = if scene.frame.surfaces.is_empty() { 6000 } else { 600 };
        let samples = if IS_LONG { samples } else { samples / 4 };
        let (means, errors) = render(&scene.frame, scene.scene.film.size, 0..samples).0.mean();
        for (channel, expected, known) in promised(&folder) {
            let (name, mean, error) = (&scene.name, means[channel], errors[channel]);
            let z = (mean - expected) / error.hypot(known);
            println!("{name}, channel {channel}: {mean} +- {error}, expected {expected} +- {known}, {z:.1}");
            assert!(z.abs() < 4.0, "{name}, channel {channel}: {mean} +- {error} instead of {expected} +- {known}");
            assert!(error < 0.05 * expected, "{name}, channel {channel}: {mean} +- {error} says nothing");
        }
    }
}

#[test]
fn the_place_of_a_scene_does_not_show() {
    let text = |shift: f64| {
        format!(
            "[camera]\nposition = [{shift:?}, 0, {:?}]\nlook_at = [{shift:?}, 0, {:?}]\nvertical_fov_deg = 50\n\
             [film]\nsize = [8, 8]\n[medium]\nscattering = 0.5\nphase = {{ type = \"henyey_greenstein\", g = 0.8 }}\n\
             [[light]]\ntype = \"sphere\"\ncenter = [{shift:?}, 0.5, {:?}]\nradius = 0.01\nradiance = 1000\n",
            shift - 3.25,
            shift,
            shift + 0.5
        )
    };
    let mean = |shift: f64| {
        let scene = scene::parse("scene.toml", &text(shift)).unwrap_or_else(|error| panic!("{error}"));
        green(&render(&scene.frame, [8, 8], 0..64).0).0
    };
    let here = mean(0.0);
    for shift in [2e3, 1e6, 3e7] {
        let there = mean(shift);
        assert!((there / here - 1.0).abs() < 1e-3, "{there} at {shift} m, {here} at 0");
    }
}

/// What is seen through two blocks, one behind the other, has passed through both: e^{-mu d} in every channel, whether
/// they have a colour in common, which is known from their coefficients, or not.
#[test]
fn volumes_may_be_of_several_colours() {
    let volume = |(absorption, [near, far]): ([f64; 3], [i32; 2])| {
        format!(
            "[[volume]]\nabsorption = {absorption:?}\n\
             shape = {{ type = \"box\", min = [-1, -1, {near}], max = [1, 1, {far}] }}\n"
        )
    };
    let first = [0.2, 0.4, 0.1];
    // Beyond 60 mean free paths, weights count no more: where one channel is so deep, others still come through.
    let ink = [0.1, 0.4, 40.0];
    // Nearly clear in one channel, and clearer by half: that counts, however little it is of the others.
    let nearly_clear = [4e4, 0.4, 4e4];
    for (first, second, is_common) in [
        (first, [0.3, 0.6, 0.15], true),
        (first, [0.5, 0.1, 0.4], false),
        (first, [0.3; 3], false),
        (first, [0.0; 3], true),
        (first, [0.3, 0.0, 0.6], false),
        (ink, ink, true),
        (ink, [0.1, 0.3, 40.0], false),
        (nearly_clear, [4e4, 0.4, 4e4], true),
        (nearly_clear, [4e4, 0.2, 4e4], false),
    ] {
        let text = "[camera]\nposition = [0, 0, -5]\nlook_at = [0, 0, 0]\nvertical_fov_deg = 1\n[film]\nsize = [8, 8]\n\
                    [environment]\nradiance = 1\n[render]\ntechnique = \"path\"\n";
        let text = text.to_string() + &[(first, [0, 1]), (second, [2, 4])].map(volume).concat();
        let scene = scene::parse("scene.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        let field = scene.frame.medium.field().expect("volumes");
        assert_eq!(field.apart().is_none(), is_common, "{second:?}");
        let (mean, error) = render(&scene.frame, [8, 8], 0..2048).0.mean();
        for c in 0..3 {
            let expected = (-first[c] - 2.0 * second[c]).exp();
            let off = (mean[c] - expected).abs();
            assert!(off < 4.2 * error[c] + 1e-4, "{second:?}, channel {c}: {} +- {}, {expected}", mean[c], error[c]);
            assert!(error[c] < 5e-3, "{} +- {} says little", mean[c], error[c]);
        }
    }
}

/// What two channels scatter does not depend on how deep the third one is.
#[test]
fn a_dense_channel_leaves_the_others_as_they_are() {
    let scene = |extinction: [f64; 3], technique: &str| {
        let half = extinction.map(|extinction| 0.5 * extinction);
        let volume = |[near, far]: [i32; 2]| {
            format!(
                "[[volume]]\nscattering = {half:?}\nabsorption = {half:?}\n\
                 shape = {{ type = \"box\", min = [-1, -1, {near}], max = [1, 1, {far}] }}\n"
            )
        };
        let text = format!(
            "[camera]\nposition = [0, 0, -5]\nlook_at = [0, 0, 0]\nvertical_fov_deg = 1\n[film]\nsize = [8, 8]\n\
             [environment]\nradiance = 1\n[render]\ntechnique = \"{technique}\"\nmax_segments = 3\n"
        );
        let text = text + &[[0, 1], [2, 4]].map(volume).concat();
        scene::parse("scene.toml", &text).unwrap_or_else(|error| panic!("{error}")).frame
    };
    let mean = |extinction: [f64; 3], technique: &str| render(&scene(extinction, technique), [8, 8], 0..4096).0.mean();
    let ink = [0.3, 0.8, 50.0];
    for technique in ["path", "nee", "bridge"] {
        let (found, error) = mean(ink, technique);
        for c in 0..2 {
            let (grey, of_grey) = mean([ink[c]; 3], "nee");
            let (off, error) = (found[c] - grey[c], error[c].hypot(of_grey[c]));
            assert!(off.abs() < 4.2 * error, "{technique}, channel {c}: {} +- {error}, {}", found[c], grey[c]);
            assert!(error < 0.02 * grey[c], "{technique}, channel {c}: {} +- {error} says little", found[c]);
        }
    }
}

/// Where two volumes overlap, one of them is there: that of the higher priority, or the last.
#[test]
fn of_volumes_that_overlap_the_highest_priority_is_seen() {
    let volume = |(absorption, priority): (f64, i32)| {
        format!(
            "[[volume]]\nabsorption = {absorption:?}\npriority = {priority}\n\
             shape = {{ type = \"box\", min = [-1, -1, 0], max = [1, 1, 1] }}\n"
        )
    };
    let seen = |volumes: [(f64, i32); 2]| {
        let text = "[camera]\nposition = [0, 0, -5]\nlook_at = [0, 0, 0]\nvertical_fov_deg = 1\n[film]\nsize = [8, 8]\n\
                    [environment]\nradiance = 1\n[render]\ntechnique = \"path\"\n";
        let text = text.to_string() + &volumes.map(volume).concat();
        let scene = scene::parse("scene.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        green(&render(&scene.frame, [8, 8], 0..1024).0)
    };
    for (priorities, winner) in
        [([0, 0], 1), ([3, 3], 1), ([1, 0], 0), ([0, 1], 1), ([-2, -1], 1), ([-1, -2], 0), ([2, 10], 1)]
    {
        for absorption in [[1.0_f64, 3.0], [3.0, 1.0]] {
            let (mean, error) = seen([0, 1].map(|index| (absorption[index], priorities[index])));
            let expected = (-absorption[winner]).exp();
            let close = (mean - expected).abs() <= 4.0 * error + 1e-3 * expected && error < 0.03 * expected;
            assert!(close, "{priorities:?} of {absorption:?}: {mean} +- {error} instead of {expected}");
        }
    }
}

#[test]
fn scenes_are_called_after_their_folders() {
    for folder in folders() {
        let name = folder.file_name().expect("a folder").to_string_lossy().into_owned();
        assert_eq!(small(&folder).name, name);
        assert_eq!(scene::load(&folder.join("scene.toml"), vec![]).expect("loads").name, name);
    }
}

#[test]
fn the_hash_names_what_samples_depend_on_and_nothing_else() {
    let hash = |changes: &[&str]| {
        let changes = changes.iter().map(|change| Override::parse(change).expect("has a =")).collect();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog-facing");
        scene::load(&folder, changes).unwrap_or_else(|error| panic!("{error}")).hash()
    };
    assert_eq!(hash(&[]), hash(&["render.samples=7"]));
    assert_eq!(hash(&[]), hash(&["light[0].radiance=[80, 80, 80.0]"]));
    let geometry = ["geometry=../dense-plate/dense-plate.glb", "geometry=../spotlight/spotlight.glb"];
    for change in ["render.seed=2", "medium.phase.g=0.8", "film.size=[8, 8]", "render.technique=nee", geometry[0]] {
        assert_ne!(hash(&[]), hash(&[change]), "{change}");
    }
    assert_ne!(hash(&[geometry[0]]), hash(&[geometry[1]]), "other triangles");
    assert_eq!(hash(&[geometry[0]]), hash(&["geometry=../cornell-fog/../dense-plate/dense-plate.glb"]), "another name");
}

/// Where there are surfaces, more walks to choose from cost more than they bring.
#[test]
fn bridges_choose_among_walks_where_there_are_no_surfaces() {
    for folder in folders() {
        let LoadedScene { frame, .. } = small(&folder);
        let Some(bridge) = &frame.techniques.bridge else { continue };
        let expected = if frame.surfaces.is_empty() { MOST_ALTERNATIVES } else { 1 };
        assert_eq!(bridge.alternatives, expected, "{}", folder.display());
    }
}

#[test]
fn limited_bridges_are_not_drawn_longer_than_they_may_be() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog-facing");
    let counts = |settings: &[&str]| {
        let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
        let frame = scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}")).frame;
        frame.techniques.bridge.map(|bridge| bridge.counts.edges())
    };
    assert_eq!(counts(&[]), Some(14), "15 segments, of which the first is the camera's");
    assert_eq!(counts(&["render.bridge_vertices=3"]), Some(4));
    assert_eq!(counts(&["render.bridge_vertices=0"]), Some(1));
    assert_eq!(counts(&["render.bridge_vertices=100"]), Some(14));
    assert_eq!(counts(&["render.max_segments=1024"]), Some(128));
    assert_eq!(counts(&["render.technique=nee"]), None);
}
