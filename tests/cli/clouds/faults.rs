//! Volumes that cannot be as they are given, or do nothing: what is said of them.

use super::super::support::Folder;
use super::{MEDIUM, with_cloud, with_volumes};

#[test]
fn shapes_with_keys_of_others_are_refused() {
    for (shape, finding) in [
        ("type = \"sphere\", center = [0, 0, 1]", "volume[0].shape.radius is missing: the shape is a sphere"),
        ("type = \"sphere\", center = [0, inf, 1], radius = 1", "volume[0].shape.center is [0.0, inf, 1.0]"),
        ("type = \"box\", min = [0, 0, 0], max = [1, 1, 1], radius = 1", "volume[0].shape.radius is given"),
        ("type = \"mesh\"", "volume[0].shape.name is missing"),
        ("type = \"mesh\", name = \"Glass\"", "the scene has no geometry"),
    ] {
        let run = with_volumes("", &[&format!("shape = {{ {shape} }}\nscattering = 1")]).run(&["render", "scene.toml"]);
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{shape}: {run}");
    }
    for (radius, shown) in [("-1", "-1.0"), ("0", "0.0"), ("1e-8", "1e-8"), ("2e9", "2000000000.0")] {
        let ball = format!("shape = {{ type = \"sphere\", center = [0, 0, 1], radius = {radius} }}\nscattering = 1");
        let run = with_volumes("", &[&ball]).run(&["render", "scene.toml"]);
        let said = format!("volume[0].shape.radius is {shown}\n  help: give a radius from 1e-6 to 1e9 m\n");
        assert!(run.code == Some(1) && run.stderr.contains(&said), "{run}");
    }
}

#[test]
fn what_should_have_been_a_table_or_a_list_of_them_is_explained() {
    for (keys, finding, remedy) in [
        ("shape = \"sphere\"", "volume[0].shape: ", "write a table: { type = \"sphere\", "),
        ("grid = \"cloud.vdb\"", "volume[0].grid: ", "name the file in a table: { file = \"cloud.vdb\" }\n"),
        ("emission_grid = \"cloud.vdb\"", "volume[0].emission_grid: ", "name the file in a table: { file = "),
    ] {
        let folder = with_volumes("", &[&format!("{keys}\nscattering = 1")]);
        let beginning = format!("{}: {finding}", folder.place(keys.split(' ').next().expect("a key")));
        let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
        assert!(run.stderr.contains(&format!("help: {remedy}")), "{run}");
    }
    let folder = Folder::with_edited_scene(MEDIUM, "[volume]\nscattering = 1");
    let beginning = format!("{}: volume: this is a table, expected a list", folder.place("volume]"));
    let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
    assert!(run.stderr.contains("help: write [[volume]]: volumes are a list of tables\n"), "{run}");
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
        (
            "volume[0].scattering=1e9",
            "volume[0].scattering is 1000000000.0, which makes an extinction of 1000000003.0/m with the absorption",
        ),
        (
            "volume[0].absorption=[1, 1e9, 1]",
            "volume[0].absorption is [1.0, 1000000000.0, 1.0], which makes an extinction of 1000000007.0/m with the scattering",
        ),
    ] {
        let run = folder.run(&["info", "scene.toml", "--set", set]);
        assert!(run.code == Some(2) && run.stderr.contains(finding), "{set}: {run}");
    }
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
fn what_is_too_thin_or_too_dense_to_be_meant_is_told() {
    let folder = with_cloud("");
    let told = |set: &str| folder.done(&["info", "scene.toml", "--set", set]).stdout;
    let (thin, dense) = ("so that it is as good as vacuum", "mean free paths from a voxel to the next");
    for scale in ["1e-9", "1e-30"] {
        let said = told(&format!("volume[0].grid.scale={scale}"));
        assert!(said.contains("volume[0] has an optical depth of") && said.contains(thin), "{scale}: {said}");
    }
    let said = told("volume[0].grid.scale=100");
    assert!(said.contains("volume[0].grid is so dense that there are") && said.contains(dense), "{said}");
    for scale in ["1e-3", "1", "10"] {
        let said = told(&format!("volume[0].grid.scale={scale}"));
        assert!(!said.contains(thin) && !said.contains(dense), "{scale}: {said}");
    }
    // What glows is seen however thin it is.
    let flame = "shape = { type = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nabsorption = 1e-9";
    let said = with_volumes("", &[flame]).done(&["info", "scene.toml"]).stdout;
    assert!(said.contains(thin), "{said}");
    let said = with_volumes("", &[&format!("{flame}\nemission = 1")]).done(&["info", "scene.toml"]).stdout;
    assert!(!said.contains(thin), "{said}");
}

#[test]
fn volumes_too_far_away_to_have_a_size_are_told() {
    let shape = "shape = { type = \"box\", min = [1e8, 0, 0], max = [100000001, 1, 1] }\nscattering = 1";
    let run = with_volumes("", &[shape]).run(&["info", "scene.toml"]);
    let finding = "volume[0] is from [100000000, 0, 0] to [100000001, 1, 1] m, too far from the camera for its size";
    assert!(run.code == Some(1) && run.stderr.contains(finding), "{run}");
    // With a dozen places along it, it can be seen, but not well.
    let said = |size: f64| {
        let shape = shape.replace("max = [100000001, 1, 1]", &format!("max = [{}, {size}, {size}]", 1e8 + size));
        with_volumes("", &[&shape]).done(&["info", "scene.toml"]).stdout
    };
    let few = "knows fewer than 16 places along it, so that its image may be wrong; move it nearer to the camera";
    assert!(said(100.0).contains(few), "{}", said(100.0));
    assert!(!said(1000.0).contains("places along it"), "{}", said(1000.0));
}

#[test]
fn volumes_that_are_small_next_to_others_are_told() {
    let said = |radius: f64| {
        let haze = "shape = { type = \"box\", min = [-5e4, -5e4, -5e4], max = [5e4, 5e4, 5e4] }\nabsorption = 1e-9";
        let ball =
            format!("shape = {{ type = \"sphere\", center = [0, 0, 0], radius = {radius:?} }}\nabsorption = 1e-3");
        with_volumes("", &[haze, &ball]).run(&["info", "scene.toml"])
    };
    let small = "too small next to all volumes, which are from [-50000, -50000, -50000] to [50000, 50000, 50000] m: \
                 single precision, in which positions are counted in parts of the box around them, knows ";
    let run = said(0.001);
    let finding =
        format!("volume[1] is from [-0.001, -0.001, -0.001] to [0.001, 0.001, 0.001] m, {small}no difference\n");
    assert!(run.code == Some(1) && run.stderr.contains(&finding), "{run}");
    let run = said(0.05);
    let few = format!("{small}fewer than 16 places along it, so that its image may be wrong; make it larger");
    assert!(run.code == Some(0) && run.stdout.contains(&few), "{run}");
    let run = said(0.5);
    assert!(run.code == Some(0) && !run.stdout.contains("too small next to"), "{run}");
    // Voxels that are 1/40 m apart.
    let haze = "shape = { type = \"box\", min = [-9e4, -9e4, -9e4], max = [9e4, 9e4, 9e4] }\nabsorption = 1e-9";
    let folder = with_volumes("", &[haze, "grid = { file = \"cloud.vdb\", scale_by = 0.1 }\nabsorption = 1e-3"]);
    std::fs::copy(with_cloud("").path("cloud.vdb"), folder.path("cloud.vdb")).expect("a file");
    let run = folder.run(&["info", "scene.toml"]);
    let few = "knows fewer than 2 places from a voxel to the next";
    assert!(run.code == Some(0) && run.stdout.contains(few), "{run}");
}

#[test]
fn channels_that_are_meant_to_be_clear_and_are_not_are_told() {
    let said = |absorption: &str| {
        let ball =
            format!("shape = {{ type = \"sphere\", center = [0, 0, 30], radius = 10 }}\nabsorption = {absorption}");
        with_volumes("", &[&ball]).done(&["info", "scene.toml"]).stdout
    };
    let told = "volume[0] is clearer in green and blue than a millionth of its densest channel, and is given a \
                millionth: up to 3.5 mean free paths across; make its densest channel less dense";
    let text = said("[1e5, 0, 0]");
    assert!(text.contains(told), "{text}");
    for absorption in ["[10, 0, 0]", "[1e5, 0.2, 0.3]", "1e5"] {
        assert!(!said(absorption).contains("is clearer in"), "{absorption}: {}", said(absorption));
    }
}

#[test]
fn flights_too_short_to_be_known_from_afar_are_told() {
    let said = |away: f64, keys: &str| {
        let shape = format!("shape = {{ type = \"box\", min = [{away:?}, 0, 0], max = [{:?}, 1, 1] }}", away + 2.0);
        with_volumes("", &[&format!("{shape}\n{keys}")]).done(&["info", "scene.toml"]).stdout
    };
    let warned = "volume[0] is 1.000e5 m away from the camera, with mean free paths of 1.000e-1 m where it is densest: \
                  single precision hardly tells them there, so that its image may be wrong; move it nearer to the camera";
    let text = said(1e5, "scattering = 9\nabsorption = 1");
    assert!(text.contains(warned), "{text}");
    for (away, keys) in [(2e4, "scattering = 9\nabsorption = 1"), (1e5, "scattering = 1"), (1e5, "absorption = 10")] {
        assert!(!said(away, keys).contains("hardly tells"), "{away} m, {keys}: {}", said(away, keys));
    }
}

#[test]
fn voxels_too_far_away_to_be_told_apart_are_told() {
    let said = |away: f64| {
        let set = format!("volume[0].grid.translate=[{away:?},0,0]");
        with_cloud("").done(&["info", "scene.toml", "--set", &set]).stdout
    };
    let finding = "\"cloud.vdb\", a grid whose voxels are 2.500e-1 m apart and up to ";
    let warned = "from the camera: single precision hardly tells one from the next there, so that its image may be \
                  wrong; move it nearer to the camera, or make it larger";
    let text = said(3e6);
    assert!(text.contains(finding) && text.contains(warned), "{text}");
    assert!(!said(5e5).contains("from the next there"), "{}", said(5e5));
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
        assert!(info.stdout.ends_with(&format!("\n  renders as nothing: it {nothing}\n")), "{density:e}: {info}");
    }
    let (run, info) = tiny(2e-40);
    assert!(!run.stderr.contains("nothing is there") && !info.stdout.contains("as nothing"), "{run}{info}");
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
