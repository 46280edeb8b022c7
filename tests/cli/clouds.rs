//! Scenes with a volume.

mod faults;

use std::path::Path;

use super::support::{Folder, SCENE, header, mean};

const MEDIUM: &str = "[medium]\nscattering = 0.7\nabsorption = 0.3";

/// The test scene with a cloud of these keys in place of its fog.
fn with_cloud(keys: &str) -> Folder {
    let volume =
        format!("[[volume]]\nname = \"puff\"\ngrid = {{ file = \"cloud.vdb\"{keys} }}\nscattering = 7\nabsorption = 3");
    assert!(SCENE.contains(MEDIUM));
    let folder = Folder::empty();
    folder.write("scene.toml", SCENE.replace(MEDIUM, &volume));
    let cloud = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/blob.vdb");
    std::fs::copy(cloud, folder.path("cloud.vdb")).expect("a file");
    folder
}

#[test]
fn a_cloud_is_rendered_by_every_technique() {
    let folder = with_cloud(", translate = [0, 0, 1.5]");
    for technique in ["path", "nee", "mvnee", "nee,omnee", "bridge", "lis", "nee,mvnee,omnee,bridge,lis"] {
        let run = folder.done(&["render", "scene.toml", "--technique", technique, "-o", "a.exr"]);
        assert!(!run.stderr.contains("dropped"), "{run}");
        assert_eq!(header(&folder.image("a.exr"), "technique").split(", ").collect::<Vec<_>>().join(","), technique);
    }
}

#[test]
fn a_cloud_is_described() {
    let run = with_cloud(", scale = 2").done(&["info", "scene.toml"]);
    let cloud = "volume \"puff\": grid \"density\" of \"cloud.vdb\", mean free path 0.05000 m at density 1, albedo 0.7";
    assert!(run.stdout.lines().any(|line| line.starts_with(cloud)), "{run}");
    assert!(!run.stdout.contains("vacuum") && !run.stdout.contains("fog:"), "{run}");
    let grid = run.stdout.lines().find(|line| line.contains(", 9544 active voxels, "));
    assert!(grid.is_some_and(|line| line.starts_with("  from [") && line.ends_with(" KiB")), "{run}");
    // The lamp is beside the cloud.
    assert!(
        run.stdout.contains("\nlight: disk of radius 1.5 m at 3 m from the camera (no medium in between)\n"),
        "{run}"
    );
    // The densest voxels have 250/256; at the edge there is next to nothing.
    assert!(run.stdout.contains("\n  mean free path 0.05120 m where it is densest, 0."), "{run}");
}

/// However dense it is, and though connections through it count less.
#[test]
fn the_depth_of_what_is_before_a_light_is_told() {
    let depth = |scale: f64| {
        let grid = format!("grid = {{ file = \"cloud.vdb\", scale = {scale:?}, translate = [-3.1, -4.9, -14.4] }}");
        let folder = with_volumes("", &[&format!("{grid}\nabsorption = 10")]);
        std::fs::copy(with_cloud("").path("cloud.vdb"), folder.path("cloud.vdb")).expect("a file");
        let run = folder.done(&["info", "scene.toml"]);
        let told = run.stdout.split_once("at 3 m from the camera (").and_then(|(_, rest)| rest.split(' ').next());
        told.and_then(|told| told.parse::<f64>().ok()).unwrap_or_else(|| panic!("{run}"))
    };
    let [thin, dense] = [0.1, 20.0].map(depth);
    assert!(dense > 400.0 && (dense / thin / 200.0 - 1.0).abs() < 1e-3, "{thin} and {dense} mean free paths");
}

#[test]
fn a_grid_that_is_named_several_times_is_held_once() {
    let taken = |folder: &Folder, start: &str| {
        let run = folder.done(&["info", "scene.toml"]);
        let line = run.stdout.lines().find(|line| line.contains(start)).unwrap_or_else(|| panic!("{run}"));
        let kib = line.strip_suffix(" KiB").and_then(|line| line.rsplit(' ').next());
        kib.and_then(|kib| kib.parse::<f64>().ok()).unwrap_or_else(|| panic!("{run}"))
    };
    let folder = with_cloud("");
    let [once, all] = [", 9544 active voxels, ", " cells, "].map(|line| taken(&folder, line));
    let scene = std::fs::read_to_string(folder.path("scene.toml")).expect("a scene");
    let grid = "grid = { file = \"cloud.vdb\" }";
    folder.write("scene.toml", scene.replace(grid, &format!("{grid}\nemission = [3, 2, 1]\nemission_{grid}")));
    assert_eq!([", 9544 active voxels of emission, ", " cells, "].map(|line| taken(&folder, line)), [once, all]);
    // By another name it is the same.
    let again = "grid = { file = \"./cloud.vdb\", name = \"density\" }";
    folder.write("scene.toml", scene.replace(grid, &format!("{grid}\nemission = [3, 2, 1]\nemission_{again}")));
    assert_eq!([", 9544 active voxels of emission, ", " cells, "].map(|line| taken(&folder, line)), [once, all]);
    // A copy of the file is a grid of its own.
    std::fs::copy(folder.path("cloud.vdb"), folder.path("copy.vdb")).expect("a file");
    let [same, copy] = ["cloud", "copy"].map(|name| {
        let tuft = format!("[[volume]]\nscattering = 2\ngrid = {{ file = \"{name}.vdb\" }}\n\n[[volume]]");
        folder.write("scene.toml", scene.replace("[[volume]]", &tuft));
        taken(&folder, " cells, ")
    });
    assert!((copy - same - once).abs() <= 1.0, "{copy} KiB with a copy of {once} KiB, {same} KiB without");
}

#[test]
fn volumes_take_little_more_than_their_active_voxels() {
    // Volumes that show the same grid, as the three of cloud-sky do, have its voxels in common.
    for (name, volumes, grids) in [("cloud-box", 1, 1), ("cloud-sky", 3, 1), ("smoke-fire", 4, 4)] {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
        let run = Folder::empty().done(&["info", scene.to_str().expect("a name in UTF-8")]);
        // Of a grid that is named for emission, too, the voxels are those of one that is named for its density.
        let active = |line: &str| line.split(", ").find_map(|part| part.strip_suffix(" active voxels")?.parse().ok());
        let active: Vec<f64> = run.stdout.lines().filter_map(active).collect();
        let taken = run.stdout.lines().find(|line| line.starts_with("volumes: "));
        let kib = taken.and_then(|line| line.strip_suffix(" KiB")?.rsplit(' ').next()?.parse::<f64>().ok());
        let ratio = kib.unwrap_or_else(|| panic!("{run}")) * 1024.0 / (4.0 * active.iter().take(grids).sum::<f64>());
        assert!(active.len() == volumes && ratio > 0.1 && ratio <= 1.3, "{name}: {ratio}; {run}");
    }
}

#[test]
fn a_box_is_rendered_and_described() {
    let volume = "[[volume]]\nshape = { type = \"box\", min = [-1, -1, 1], max = [1, 1, 2] }\nscattering = 2";
    let folder = Folder::empty();
    folder.write("scene.toml", SCENE.replace(MEDIUM, volume));
    folder.done(&["render", "scene.toml", "--technique", "bridge", "-o", "a.exr"]);
    let run = folder.done(&["info", "scene.toml"]);
    let lines = "volume: a box, mean free path 0.5000 m, albedo 1, henyey_greenstein of mean cosine 0.5000\n  from [-1, -1, 1] to [1, 1, 2] m\n";
    assert!(run.stdout.contains(lines), "{run}");
    for (set, finding) in [
        ("volume[0].shape.max=[1, 1, 1]", "volume[0].shape.max is [1.0, 1.0, 1.0], where min is [-1.0, -1.0, 1.0]"),
        ("volume[0].shape.min=[nan, 0, 0]", "volume[0].shape.min is [NaN, 0.0, 0.0]"),
        ("volume[0].shape.type=ball", "box"),
    ] {
        let run = folder.run(&["render", "scene.toml", "--set", set]);
        assert!(run.code == Some(2) && run.stderr.contains(finding), "{run}");
    }
    folder.write("scene.toml", SCENE.replace(MEDIUM, "[[volume]]\nscattering = 2"));
    folder.refused(&["render", "scene.toml"], 1, "scene.toml:");
}

/// In the clear channel light comes from where a voxel is less than a digit of the distance.
#[test]
fn fog_may_be_clear_in_one_channel() {
    let folder = with_cloud("");
    for (technique, fog) in [("nee", "[1, 0, 0]"), ("path", "[0.1, 0.01, 0]"), ("bridge", "1e-6")] {
        let fog = format!("medium.scattering={fog}");
        let args =
            ["render", "scene.toml", "--technique", technique, "--max-segments", "4", "-o", "a.exr", "--set", &fog];
        let run = folder.done(&args);
        assert!(!run.stderr.contains("dropped"), "{run}");
        assert!(mean(&folder.image("a.exr"), "G") > 0.0, "{run}");
    }
}

#[test]
fn no_result_replaces_the_voxels() {
    let folder = with_cloud("");
    folder.refused(
        &["render", "scene.toml", "-o", "exr:cloud.vdb"],
        2,
        "--output cloud.vdb: names a file that this command reads",
    );
    assert!(folder.path("cloud.vdb").metadata().expect("a file").len() > 1000);
}

#[test]
fn vertices_from_the_light_are_joined_through_a_cloud_as_the_scene_says() {
    let folder = with_cloud(", translate = [0, 0, 1.5]");
    let rendered = |connector: &str| {
        let args = ["render", "scene.toml", "--technique", "lis", "--set", connector, "-o", "a.exr"];
        let run = folder.done(&args);
        assert!(!run.stderr.contains("dropped"), "{run}");
        assert_eq!(header(&folder.image("a.exr"), "technique"), "lis");
        std::fs::read(folder.path("a.exr")).expect("an image")
    };
    assert_ne!(rendered("render.lis=bridge"), rendered("render.lis=mvnee"));
}

/// The test scene with these volumes in fog that is given by `medium`.
fn with_volumes(medium: &str, volumes: &[&str]) -> Folder {
    let volumes: String = volumes.iter().map(|keys| format!("\n[[volume]]\n{keys}\n")).collect();
    let phase = "phase = { type = \"henyey_greenstein\", g = 0.5 }\n";
    assert!(SCENE.contains(phase));
    let scene = SCENE.replace(phase, "").replace(MEDIUM, medium);
    let folder = Folder::empty();
    folder.write("scene.toml", scene + &volumes);
    folder
}

#[test]
fn volumes_in_fog_are_rendered_and_described() {
    let ball = "shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nscattering = 3\npriority = 2";
    let hole = "name = \"hole\"\nshape = { type = \"box\", min = [-1, -1, 1], max = [0.2, 1, 2] }\npriority = 3";
    let folder = with_volumes("[medium]\nscattering = 0.2\nabsorption = 0.1", &[ball, hole]);
    for technique in ["path", "nee", "mvnee", "bridge", "lis"] {
        let run = folder.done(&["render", "scene.toml", "--technique", technique, "-o", "a.exr"]);
        assert!(!run.stderr.contains("dropped"), "{run}");
    }
    let run = folder.done(&["info", "scene.toml"]);
    for line in [
        "volume: a sphere, mean free path 0.3333 m, albedo 1",
        "volume \"hole\": a box, vacuum",
        "fog: mean free path 3.333 m, albedo 0.6667",
    ] {
        assert!(run.stdout.lines().any(|found| found.starts_with(line)), "{line}: {run}");
    }
}

#[test]
fn the_technique_is_nee_where_all_media_are_volumes_and_nobody_says_otherwise() {
    let ball = "shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nscattering = [1, 2, 3]";
    for (medium, technique) in [("", "nee"), ("[medium]\nscattering = [0.1, 0.2, 0.3]", "bridge")] {
        let folder = with_volumes(medium, &[ball]);
        let scene = std::fs::read_to_string(folder.path("scene.toml")).expect("a scene");
        let without: String =
            scene.lines().filter(|line| !line.starts_with("technique")).map(|l| format!("{l}\n")).collect();
        folder.write("scene.toml", without);
        folder.done(&["render", "scene.toml", "-o", "a.exr"]);
        assert_eq!(header(&folder.image("a.exr"), "technique"), technique);
    }
}

#[test]
fn media_may_have_colours_of_their_own() {
    let shape = "shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }";
    let folder = with_volumes("[medium]\nscattering = [0.4, 0.2, 0.1]", &[&format!("{shape}\nscattering = [1, 2, 4]")]);
    let said = folder.done(&["info", "scene.toml"]).stdout;
    for line in ["a sphere, mean free path 1 | 0.5000 | 0.2500 m", "fog: mean free path 2.500 | 5 | 10 m"] {
        assert!(said.contains(line), "{line}: {said}");
    }
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    folder.done(&["render", "scene.toml", "--reference", "-o", "twins.exr"]);
    let [kernels, twins] = ["a.exr", "twins.exr"].map(|name| folder.image(name));
    for channel in ["R", "G", "B"] {
        let [kernels, twins] = [&kernels, &twins].map(|image| mean(image, channel));
        assert!(twins > 0.0 && (kernels / twins - 1.0).abs() < 1e-2, "{channel}: {kernels} and {twins}");
    }
}

#[test]
fn media_may_have_phase_functions_of_their_own() {
    let shape = "shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nphase = { g = 0.5 }";
    let image = |fog: &str, coefficient: &str| {
        let folder = with_volumes(fog, &[&format!("{shape}\n{coefficient} = 1")]);
        folder.done(&["render", "scene.toml", "-o", "a.exr"]);
        (folder.run(&["info", "scene.toml"]).stdout, folder.image("a.exr").channels)
    };
    let fog = |g: f64| format!("[medium]\nscattering = 0.2\nphase = {{ g = {g} }}");
    let (said, own) = image(&fog(-0.2), "scattering");
    for line in ["albedo 1, henyey_greenstein of mean cosine 0.5000\n", "henyey_greenstein of mean cosine -0.2000\n"] {
        assert!(said.contains(line), "{line}: {said}");
    }
    assert!(own != image(&fog(0.5), "scattering").1);
    // What does not scatter has no phase function.
    let absorbing = |g: f64| image(&format!("[medium]\nabsorption = 0.2\nphase = {{ g = {g} }}"), "scattering").1;
    assert!(absorbing(-0.2) == absorbing(0.5));
}

#[test]
fn the_table_of_a_volumes_phase_function_is_a_file_of_the_scene() {
    let ball = "shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nscattering = 1\n\
                phase = { type = \"tabulated\", file = \"phase.csv\" }";
    let folder = with_volumes("", &[ball]);
    let hashes = ["-1, 1\n1, 5\n", "-1, 1\n1, 6\n"].map(|table| {
        folder.write("phase.csv", table);
        folder.done(&["render", "scene.toml", "-o", "a.exr"]);
        header(&folder.image("a.exr"), "scene_hash").to_string()
    });
    assert_ne!(hashes[0], hashes[1]);
    folder.refused(&["render", "scene.toml", "-o", "png:phase.csv"], 2, "--output phase.csv: names a file that this");
    folder.write("phase.csv", "-1, 1\n0.5\n");
    let place = format!("{}: volume[0].phase.file: phase.csv:2: ", folder.place("file ="));
    folder.refused(&["render", "scene.toml"], 1, &place);
}
