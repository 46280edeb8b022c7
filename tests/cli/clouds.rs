//! Scenes with a volume.

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
    for (name, grids) in [("cloud-box", 1), ("cloud-sky", 1), ("smoke-fire", 4)] {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
        let run = Folder::empty().done(&["info", scene.to_str().expect("a name in UTF-8")]);
        // Of a grid that is named for emission, too, the voxels are those of one that is named for its density.
        let active = |line: &str| line.split(", ").find_map(|part| part.strip_suffix(" active voxels")?.parse().ok());
        let active: Vec<f64> = run.stdout.lines().filter_map(active).collect();
        let taken = run.stdout.lines().find(|line| line.starts_with("volumes: "));
        let kib = taken.and_then(|line| line.strip_suffix(" KiB")?.rsplit(' ').next()?.parse::<f64>().ok());
        let ratio = kib.unwrap_or_else(|| panic!("{run}")) * 1024.0 / (4.0 * active.iter().sum::<f64>());
        assert!(active.len() == grids && ratio > 0.1 && ratio <= 1.3, "{name}: {ratio}; {run}");
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
fn shapes_with_keys_of_others_are_refused() {
    for (shape, finding) in [
        ("type = \"sphere\", center = [0, 0, 1]", "volume[0].shape.radius is missing: the shape is a sphere"),
        ("type = \"sphere\", center = [0, 0, 1], radius = -1", "volume[0].shape.radius is -1.0"),
        ("type = \"sphere\", center = [0, inf, 1], radius = 1", "volume[0].shape.center is [0.0, inf, 1.0]"),
        ("type = \"box\", min = [0, 0, 0], max = [1, 1, 1], radius = 1", "volume[0].shape.radius is given"),
        ("type = \"mesh\"", "volume[0].shape.name is missing"),
        ("type = \"mesh\", name = \"Glass\"", "the scene has no geometry"),
    ] {
        let run = with_volumes("", &[&format!("shape = {{ {shape} }}\nscattering = 1")]).run(&["render", "scene.toml"]);
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{shape}: {run}");
    }
}

#[test]
fn keys_out_of_range_and_missing_grids_are_refused() {
    for (keys, finding) in [
        (", scale = 1e9", "volume[0].grid.scale is 1000000000.0, which makes an extinction of 9.766e9/m"),
        (
            ", scale = 1e6",
            "volume[0].grid.scale is 1000000.0, which makes 2.441e6 mean free paths from a voxel to the next",
        ),
        (", scale_by = -1", "volume[0].grid.scale_by is -1.0"),
        (", rotate_deg = [0, 0, 999]", "volume[0].grid.rotate_deg is [0.0, 0.0, 999.0]"),
        (", translate = [1e10, 0, 0]", "volume[0].grid.translate is [10000000000.0, 0.0, 0.0]"),
        (", name = \"smoke\"", "volume[0].grid.name: cloud.vdb: has no grid \"smoke\""),
    ] {
        let run = with_cloud(keys).run(&["render", "scene.toml"]);
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{keys}: {run}");
    }
    let folder = with_cloud(", scale = 0");
    let place = folder.place("scale = 0");
    folder.refused(&["render", "scene.toml"], 1, &format!("{place}: volume[0].grid.scale is 0.0\n"));
    let folder = with_cloud("");
    folder.write("cloud.vdb", "no voxels");
    let place = format!("{}: volume[0].grid.file: ", folder.place("file ="));
    folder.refused(&["render", "scene.toml"], 1, &format!("{place}cloud.vdb: is not an OpenVDB file\n"));
    std::fs::remove_file(folder.path("cloud.vdb")).expect("a file");
    let run = folder.refused(&["render", "scene.toml"], 1, &folder.place("file ="));
    assert!(run.stderr.contains("volume[0].grid.file is \"cloud.vdb\", but there is no file cloud.vdb\n"), "{run}");
}

/// Of several numbers whose product is too large, the largest is to blame.
#[test]
fn the_key_that_does_most_is_blamed() {
    let folder = with_cloud("");
    let leaf = fogbow::volume::Leaf { origin: [0; 3], values: [1e12; 512].into() };
    fogbow_testing::volume_writer::write(&folder.path("dense.vdb"), 0.25, &[leaf]);
    for (set, finding) in [
        ("volume[0].scattering=9e8", "volume[0].scattering is 900000000.0, which makes 2.197e8 mean free paths"),
        ("volume[0].absorption=[0, 9e8, 0]", "volume[0].absorption is [0.0, 900000000.0, 0.0], which makes 2.197e8"),
        ("volume[0].grid.scale=1e6", "volume[0].grid.scale is 1000000.0, which makes 2.441e6 mean free paths"),
        ("volume[0].grid.scale_by=1e6", "volume[0].grid.scale_by is 1000000.0, which makes 2.441e6 mean free paths"),
        (
            "volume[0].grid.file=dense.vdb",
            "volume[0].grid.file is \"dense.vdb\", whose largest density is 1.000e12, which makes an extinction of 1.000e13/m",
        ),
        ("volume[0].grid.scale_by=1e-20", "volume[0].grid.scale_by is 1e-20, which makes voxels of 2.500e-21 m"),
        ("volume[0].grid.file=", "volume[0].grid.file is empty"),
    ] {
        let run = folder.run(&["info", "scene.toml", "--set", set]);
        assert!(run.code == Some(2) && run.stderr.contains(finding), "{set}: {run}");
    }
    let run = folder.run(&["info", "scene.toml", "--set", "volume[0].scattering=1e9"]);
    let finding = "volume[0].absorption is 3.0, which makes an extinction of 1000000003.0/m with the scattering";
    assert!(run.code == Some(1) && run.stderr.contains(finding), "{run}");
}

#[test]
fn volumes_that_do_nothing_are_told() {
    let folder = with_cloud("");
    let told = |folder: &Folder, sets: &[&str]| {
        let sets: Vec<_> = sets.iter().flat_map(|set| ["--set", set]).collect();
        folder.done(&[&["info", "scene.toml"], &sets[..]].concat()).stdout
    };
    let vacuum = ["volume[0].scattering=0", "volume[0].absorption=0"];
    let all_vacuum =
        "volume[0] has neither scattering nor absorption nor emission, and there is no other medium, so that it";
    assert!(told(&folder, &vacuum).contains(all_vacuum));
    let in_fog = [vacuum[0], vacuum[1], "medium.scattering=1"];
    let without = "volume[0].grid is given, but volume[0] has neither scattering nor absorption to multiply";
    let said = told(&folder, &in_fog);
    assert!(said.contains(without) && !said.contains(all_vacuum), "{said}");
    // A hole in fog.
    let hole = with_volumes(MEDIUM, &["shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }"]);
    let said = told(&hole, &[]);
    assert!(!said.contains("warning") && said.contains("a sphere, vacuum"), "{said}");
}

#[test]
fn volumes_too_far_away_to_have_a_size_are_refused() {
    let shape = "shape = { type = \"box\", min = [1e8, 0, 0], max = [100000001, 1, 1] }\nscattering = 1";
    let run = with_volumes("", &[shape]).run(&["info", "scene.toml"]);
    let finding = "volume[0] is from [100000000, 0, 0] to [100000000, 1, 1] m, too far from the camera for its size";
    assert!(run.code == Some(1) && run.stderr.contains(finding), "{run}");
    with_volumes("", &[&shape.replace("100000001", "100000100")]).done(&["info", "scene.toml"]);
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

#[test]
fn a_volume_is_no_scene() {
    let run = with_cloud("").refused(&["render", "cloud.vdb"], 1, "cloud.vdb: is an OpenVDB file, not a scene\n");
    assert!(run.stderr.contains("[[volume]] grid = { file = \"cloud.vdb\" }"), "{run}");
}

/// The test scene with a cloud, `empty.vdb` beside it, in which no density is above 0.
fn with_nothing() -> Folder {
    let folder = with_cloud(", translate = [0, 0, 1.5]");
    let leaf = fogbow::volume::Leaf { origin: [0; 3], values: [0.0; 512].into() };
    fogbow_testing::volume_writer::write(&folder.path("empty.vdb"), 0.25, &[leaf]);
    folder
}

#[test]
fn a_grid_without_densities_is_told() {
    let folder = with_nothing();
    let empty = ["--set", "volume[0].grid.file=empty.vdb"];
    let run = folder.done(&[&["render", "scene.toml", "-o", "a.exr"], &empty[..]].concat());
    let warning = "warning: --set volume[0].grid.file=empty.vdb: volume[0].grid.file is \"empty.vdb\", whose grid \
                   \"density\" has no density above 0, so that nothing is there: name another grid or file\n";
    assert!(run.stderr.contains(warning), "{run}");
    let run = folder.done(&[&["info", "scene.toml"], &empty[..]].concat());
    assert!(run.stdout.contains("\n  nothing: its grid has no density that counts\n"), "{run}");
    assert!(run.stdout.contains(warning) && !run.stdout.contains("inf"), "{run}");
    // Where it has a shape, the volume is still there, without a medium.
    let shape = "volume[0].shape={ type = \"sphere\", center = [0, 0, 2], radius = 0.5 }";
    let run = folder.done(&[&["info", "scene.toml", "--set", shape], &empty[..]].concat());
    assert!(run.stdout.contains("\nvolumes: no extinction; ") && !run.stdout.contains("inf"), "{run}");
    let emission = ["volume[0].emission=5", "volume[0].emission_grid.file=empty.vdb"];
    let run = folder.done(&["render", "scene.toml", "-o", "b.exr", "--set", emission[0], "--set", emission[1]]);
    assert!(
        run.stderr.contains("volume[0].emission_grid.file is \"empty.vdb\", whose grid \"density\" has no"),
        "{run}"
    );
}

#[test]
fn densities_too_small_to_count_are_told() {
    let folder = with_cloud("");
    let tiny = |density: f32| {
        let leaf = fogbow::volume::Leaf { origin: [0; 3], values: [density; 512].into() };
        fogbow_testing::volume_writer::write(&folder.path("tiny.vdb"), 0.25, &[leaf]);
        let info = folder.done(&["info", "tiny.vdb"]);
        let set = "volume[0].grid.file=tiny.vdb";
        (folder.done(&["render", "scene.toml", "-o", "a.exr", "--set", set]), info)
    };
    let nothing = "has no density above 1e-40, and smaller ones do not count";
    for density in [f32::from_bits(1), 1e-42, 1e-40] {
        let (run, info) = tiny(density);
        let warning = format!("volume[0].grid.file is \"tiny.vdb\", whose grid \"density\" {nothing}, so that nothing");
        assert!(run.stderr.contains(&warning), "{density:e}: {run}");
        assert!(info.stdout.ends_with(&format!("\n  cannot be rendered: it {nothing}\n")), "{density:e}: {info}");
    }
    let (run, info) = tiny(2e-40);
    assert!(!run.stderr.contains("nothing is there") && !info.stdout.contains("cannot be rendered"), "{run}{info}");
}

#[test]
fn a_shape_that_misses_its_grid_is_refused() {
    let folder = with_nothing();
    let refused = |sets: &[&str], place: &str, finding: &str| {
        let sets: Vec<_> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let run = folder.refused(&[&["render", "scene.toml"], &sets[..]].concat(), 1, place);
        assert!(run.stderr.contains(finding) && run.stderr.contains("move the grid to the volume"), "{run}");
    };
    let grid = folder.place("grid");
    let finding = "volume[0].grid is outside of the volume, which is from [49, -1, 4] to [51, 1, 6] m: densities above \
                   0 are from [";
    refused(&["volume[0].shape={ type = \"sphere\", center = [50, 0, 5], radius = 1 }"], &grid, finding);
    let finding = "is outside of the volume, which is from [0, 0, -9] to [1, 1, 14] m: ";
    refused(&["volume[0].shape={ type = \"box\", min = [0, 0, -9], max = [1, 1, 14] }"], &grid, finding);
    // It may reach out of its grid.
    let shape = "volume[0].shape={ type = \"box\", min = [0, 0, -9], max = [1, 3, 16] }";
    folder.done(&["render", "scene.toml", "-o", "a.exr", "--set", shape]);
    let sets = ["volume[0].emission=5", "volume[0].emission_grid={ file = \"cloud.vdb\", translate = [0, 40, 0] }"];
    let sets = ["--set", sets[0], "--set", sets[1]];
    let place = "--set volume[0].emission_grid={ file = \"cloud.vdb\", translate = [0, 40, 0] }: volume[0].emission_grid \
                 is outside of the volume, ";
    folder.refused(&[&["render", "scene.toml"], &sets[..]].concat(), 2, place);
}

#[test]
fn grids_that_reach_too_far_are_refused() {
    let run = with_cloud(", translate = [1e9, 0, 0]").run(&["info", "scene.toml"]);
    let finding =
        "volume[0].grid.translate is [1000000000.0, 0.0, 0.0], which puts the densities of \"cloud.vdb\" at [";
    assert!(run.code == Some(1) && run.stderr.contains(finding), "{run}");
    let folder = with_cloud("");
    let set = "volume[0].grid.scale_by=1e8";
    let finding = "volume[0].grid.scale_by is 100000000.0, which puts the densities of \"cloud.vdb\" at [";
    let run = folder.refused(&["info", "scene.toml", "--set", set], 2, &format!("--set {set}: {finding}"));
    assert!(run.stderr.contains("coordinates go from -1e9 to 1e9 m"), "{run}");
}
