//! OpenVDB files: what is read, voxel by voxel, and what is refused.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use fogbow::volume::{GridSummary, Leaf, VoxelGrid, list, list_bytes, read, read_bytes, read_listed};
use fogbow_kernels::media::field::Bricks;
use fogbow_testing::not_run::not_run;
use fogbow_testing::volume_writer;
use fogbow_testing::volumes::{FILES, Outcomes, assert_sound, bytes, damage, path};
use glam::{DMat3, DVec3};

/// Damaged files that are read.
const CASES: u64 = 2000;

/// The grid called `name` of `file`.
#[track_caller]
fn grid(file: &str, name: Option<&str>) -> VoxelGrid {
    let grid = read(&path(file), name, &|_, _| {}).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&grid);
    grid
}

/// All voxels that are not 0.
fn voxels(grid: &VoxelGrid) -> BTreeMap<[i32; 3], f32> {
    let mut voxels = BTreeMap::new();
    for leaf in &grid.leaves {
        let [x0, y0, z0] = leaf.origin;
        for (index, value) in leaf.values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            let [x, y, z] = [index % 8, index / 8 % 8, index / 64].map(|offset| offset as i32);
            voxels.insert([x0 + x, y0 + y, z0 + z], *value);
        }
    }
    voxels
}

/// `value` of all voxels in a block of `size` from `origin` on that are not 0.
fn block(size: [i32; 3], origin: [i32; 3], value: impl Fn([i32; 3]) -> f32) -> BTreeMap<[i32; 3], f32> {
    let mut voxels = BTreeMap::new();
    for x in 0..size[0] {
        for y in 0..size[1] {
            for z in 0..size[2] {
                voxels.insert([origin[0] + x, origin[1] + y, origin[2] + z], value([x, y, z]));
            }
        }
    }
    voxels.retain(|_, value| *value != 0.0);
    voxels
}

/// The Gaussian of 24^3 voxels from `origin` on.
fn blob(origin: [i32; 3]) -> BTreeMap<[i32; 3], f32> {
    block([24; 3], origin, |voxel| {
        let squares: f64 = voxel.iter().map(|offset| (f64::from(*offset) - 11.5).powi(2)).sum();
        ((256.0 * (squares / -32.0).exp()).floor() / 256.0) as f32
    })
}

/// The block of `formats.cpp`.
fn steps() -> BTreeMap<[i32; 3], f32> {
    block([10; 3], [-5, 0, 0], |[x, y, z]| ((x * 7 + y * 3 + z) % 16) as f32 / 16.0)
}

/// Expects that `file` is refused like this.
#[track_caller]
fn refused(file: &[u8], name: Option<&str>, message: &str) {
    let error = read_bytes("x.vdb", file, name).expect_err(message).to_string();
    assert!(error.contains(message), "expected {message:?}\n{error}");
    assert!(error.starts_with("error: x.vdb: ") && error.contains("\n  help: "), "{error}");
}

/// `file` with the first `old` after byte `from` replaced.
#[track_caller]
fn replaced(file: &[u8], from: usize, old: &[u8], new: &[u8]) -> Vec<u8> {
    let at = file[from..].windows(old.len()).position(|window| window == old).expect("the old bytes") + from;
    [&file[..at], new, &file[at + old.len()..]].concat()
}

/// Where the transform of `plain.vdb` begins: five vectors of three numbers.
fn transform(file: &[u8]) -> usize {
    let name = b"UniformScaleMap";
    file.windows(name.len()).position(|window| window == name).expect("a transform") + name.len()
}

/// `plain.vdb` with `new` at this distance from the beginning of its transform.
fn edited(offset: usize, new: &[u8]) -> Vec<u8> {
    let mut file = bytes("plain.vdb");
    let at = transform(&file) + offset;
    file[at..at + new.len()].copy_from_slice(new);
    file
}

#[test]
fn every_voxel_is_where_it_was_saved() {
    let constant = grid("block.vdb", None);
    assert_eq!(voxels(&constant), block([16; 3], [4, -4, 100], |_| 0.5));
    assert_eq!((constant.name.as_str(), constant.active_voxels, constant.leaves.len()), ("density", 4096, 27));
    assert_eq!(voxels(&grid("blob.vdb", None)), blob([-3, 0, 40]));
}

#[test]
fn every_compression_holds_the_same() {
    for file in ["plain.vdb", "zip.vdb", "zip_half.vdb"] {
        let grid = grid(file, Some("density"));
        assert_eq!(voxels(&grid), steps(), "{file}");
        assert_eq!(grid.active_voxels, 1000, "{file}");
    }
}

#[test]
fn half_floats_are_read() {
    let mut expected = blob([0; 3]);
    expected.extend(block([8; 3], [128, 0, 0], |_| 0.300_048_83));
    assert_eq!(voxels(&grid("half.vdb", None)), expected);
}

#[test]
fn constant_regions_become_leaves() {
    let grid = grid("tiles.vdb", None);
    assert_eq!(grid.active_voxels, 128 * 128 * 128 + 16 * 8 * 10);
    assert_eq!(grid.leaves.len(), 16 * 16 * 16 + 4);
    let mut expected = block([128; 3], [-128, 0, 0], |_| 0.5);
    expected.extend(block([16, 8, 10], [0, 0, 0], |_| 0.25));
    assert!(voxels(&grid) == expected);
}

#[test]
fn grids_are_found_by_name() {
    assert_eq!(voxels(&grid("two.vdb", None)), blob([-3, 0, 40]), "the one called density");
    assert_eq!(voxels(&grid("two.vdb", Some("heat"))), block([3; 3], [0; 3], |_| 2.0));
    assert_eq!(voxels(&grid("transforms.vdb", Some("density[1]"))), steps());
    let file = bytes("transforms.vdb");
    refused(&file, Some("smoke"), r#"has no grid "smoke""#);
    // Of four grids one is in a frustum, and cannot be named.
    refused(&file, Some("smoke"), r#"name one of "turned", "density[0]", "density[1]""#);
    refused(&file, None, r#"has 4 grids, none of them "density""#);
    let others = bytes("others.vdb");
    // All that is there is named, with what is in the way of each.
    for name in [None, Some("double")] {
        refused(&others, name, "save a grid of densities in it: none of those that it has can be read; ");
        refused(&others, name, r#""velocity": has values of type vec3s, not float; "mask": has values of type bool"#);
        refused(&others, name, r#": is a level set: its values are distances, not densities"#);
    }
    refused(&bytes("two.vdb"), Some("smoke"), r#"name one of "heat", "density""#);
    let mixed = replaced(&bytes("two.vdb"), 0, b"Tree_float_5_4_3", b"Tree_int32_5_4_3");
    refused(&mixed, Some("smoke"), r#"name "density", the only one that can be read"#);
}

#[test]
fn grids_are_found_by_number() {
    let by_number = |number| read_listed(&path("two.vdb"), number, &|_, _| {});
    assert_eq!(by_number(0).expect("a grid").index_bounds(), Some([[0; 3], [2; 3]]));
    assert_eq!(by_number(1).expect("a grid").name, "density");
    assert!(by_number(2).expect_err("no grid").finding.contains("has 2 grids"));
}

#[test]
fn voxels_may_be_shared() {
    let [first, second] = ["density", "copy"].map(|name| grid("shared.vdb", Some(name)));
    assert_eq!(first.leaves, second.leaves);
    assert_eq!(voxels(&second), steps());
    assert_eq!([first.index_to_world, second.index_to_world].map(|map| map.matrix3.x_axis.x), [1.0, 0.5]);
}

#[test]
fn transforms_lead_from_voxels_to_metres() {
    let placed = grid("blob.vdb", None).index_to_world;
    assert_eq!(placed.transform_point3(DVec3::new(4.0, 8.0, 12.0)), DVec3::new(2.0, 4.0, 6.0));
    let heat = grid("two.vdb", Some("heat")).index_to_world;
    let columns = DMat3::from_cols_array_2d(&[[0.0, 2.0, 0.0], [-3.0, 0.0, 0.0], [1.0, 0.0, 4.0]]);
    assert_eq!((heat.matrix3, heat.translation), (columns, DVec3::new(5.0, 6.0, 7.0)));
    let turned = grid("transforms.vdb", Some("turned")).index_to_world;
    assert!(turned.transform_point3(DVec3::X).distance(DVec3::new(1.0, 3.0, 3.0)) < 1e-12, "{turned:?}");
}

#[test]
fn a_list_says_what_is_in_a_file() {
    let grids = list(&path("others.vdb")).expect("a list");
    let said: Vec<_> = grids.iter().map(|grid| [&*grid.name, &*grid.value_type, &*grid.class]).collect();
    let expected = [["velocity", "vec3s", "unknown"], ["mask", "bool", "unknown"], ["sphere", "float", "level set"]];
    assert_eq!(said, expected);
    let half = &list(&path("half.vdb")).expect("a list")[0];
    assert!(half.is_half && half.compression == "blosc + active values", "{half:?}");
    assert_eq!((half.active_voxels, half.index_bounds), (Some(10056), Some([[0; 3], [135, 23, 23]])));
    let placed = &list(&path("blob.vdb")).expect("a list")[0];
    assert_eq!(placed.voxel_size(), Some([0.25; 3]));
    assert_eq!(placed.world_bounds(), Some([[0.125, 1.875, 12.875], [6.125, 7.875, 18.875]]));
    let frustum = &list(&path("transforms.vdb")).expect("a list")[0];
    assert_eq!((frustum.transform.as_str(), frustum.index_to_world), ("NonlinearFrustumMap", None));
    let obstacle = |grid: &GridSummary| grid.obstacle.clone().unwrap_or_default();
    assert_eq!(obstacle(frustum), r#"its transform "NonlinearFrustumMap" is a frustum"#);
    assert_eq!(obstacle(&grids[0]), "has values of type vec3s, not float");
    assert!(obstacle(&grids[2]).starts_with("is a level set") && placed.obstacle.is_none());
    let bits =
        |file: &str| list(&path(file)).expect("a list").iter().map(GridSummary::bits_per_voxel).collect::<Vec<_>>();
    assert_eq!(bits("others.vdb"), [Some(96), Some(1), Some(32)]);
    assert_eq!(bits("types.vdb"), [Some(32), Some(64), Some(64), Some(1)]);
}

#[test]
fn progress_ends_with_all_leaves() {
    let last = Cell::new((0, 0));
    let report = |done, total| {
        assert!(last.get().0 <= done && done <= total);
        last.set((done, total));
    };
    read(&path("tiles.vdb"), None, &report).expect("a grid");
    assert_eq!(last.get(), (4100, 4100));
}

/// Where Debian's OpenVDB for Python is. Other versions of it and of numpy may round and pack differently, so that not the
/// bytes are compared but what is in them.
#[test]
fn volumes_of_scenes_are_what_their_script_writes() {
    let python = || Command::new("/usr/bin/python3");
    if !python().args(["-c", "import pyopenvdb"]).output().is_ok_and(|output| output.status.success()) {
        return not_run("there is no pyopenvdb for /usr/bin/python3 (apt-get install python3-openvdb python3-numpy)");
    }
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let written = tempfile::tempdir().expect("a folder");
    let script = python().arg(project.join("scenes/generator/volumes.py")).arg(written.path()).output().expect("a run");
    assert!(script.status.success(), "{}", String::from_utf8_lossy(&script.stderr));
    for file in ["cloud-box/cloud.vdb", "cloud-sky/cumulus.vdb", "smoke-fire/fire.vdb"] {
        let [committed, fresh] = [project, written.path()].map(|root| root.join("scenes").join(file));
        let names = |path: &Path| list(path).expect("a list").into_iter().map(|grid| grid.name).collect::<Vec<_>>();
        assert_eq!(names(&committed), names(&fresh), "{file}");
        for name in names(&committed) {
            let read = |path: &Path| read(path, Some(&name), &|_, _| {}).unwrap_or_else(|error| panic!("{error}"));
            let [committed, fresh] = [read(&committed), read(&fresh)];
            assert_eq!(committed.index_to_world, fresh.index_to_world, "{file}, {name}");
            let [committed, fresh] = [voxels(&committed), voxels(&fresh)];
            let off = fresh.iter().filter(|(place, value)| committed.get(*place) != Some(value)).count();
            let lost = committed.keys().filter(|place| !fresh.contains_key(*place)).count();
            assert!(1000 * (off + lost) < committed.len(), "{file}, {name}: {off} and {lost} of {}", committed.len());
        }
    }
}

/// Four bytes each, in a file: flames, thin as they are, too.
#[test]
fn no_grid_of_a_scene_takes_much_more_than_its_active_voxels() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for file in ["cloud-box/cloud.vdb", "cloud-sky/cumulus.vdb", "smoke-fire/fire.vdb"].map(|file| scenes.join(file)) {
        for (index, summary) in list(&file).expect("a list").iter().enumerate() {
            let grid = read_listed(&file, index, &|_, _| {}).expect("a grid");
            let ratio =
                Bricks::new(&grid.leaves).bytes() as f64 / (4.0 * summary.active_voxels.expect("voxels") as f64);
            assert!((0.5..=1.3).contains(&ratio), "{}, {}: {ratio}", file.display(), summary.name);
        }
    }
}

/// Files of tests that are too large to be kept.
#[test]
fn what_tests_write_is_read() {
    let leaf = |origin: [i32; 3]| {
        let value = |index: usize| if index.is_multiple_of(3) { 0.0 } else { (index as i32 + origin[0]) as f32 };
        Leaf { origin, values: Arc::new(core::array::from_fn(value)) }
    };
    let leaves = [[0; 3], [0, 8, 120], [136, 4088, 16], [4088; 3]].map(leaf);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.vdb");
    volume_writer::write(&path, 0.25, &leaves);
    let grid = read(&path, None, &|_, _| {}).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((grid.leaves.as_slice(), grid.name.as_str()), (&leaves[..], "density"));
    assert_eq!(grid.index_to_world.transform_point3(DVec3::ONE), DVec3::splat(0.25));
    let active = leaves.iter().flat_map(|leaf| leaf.values.iter()).filter(|value| **value != 0.0).count();
    assert_eq!(grid.active_voxels, active as u64);
}

#[test]
fn what_holds_no_densities_is_refused() {
    let (others, types, transforms) = (bytes("others.vdb"), bytes("types.vdb"), bytes("transforms.vdb"));
    refused(&others, Some("velocity"), r#"grid "velocity": has values of type vec3s, not float"#);
    refused(&others, Some("mask"), "has values of type bool, not float");
    refused(&others, Some("sphere"), r#"grid "sphere": is a level set"#);
    refused(&types, Some("count"), "has values of type int32, not float");
    refused(&types, Some("large"), "has values of type int64, not float");
    refused(&types, Some("double"), "has values of type double, not float");
    refused(&types, Some("mask"), "has values of type mask, not float");
    refused(&transforms, Some("frustum"), r#"its transform "NonlinearFrustumMap" is a frustum"#);
}

#[test]
fn values_that_are_no_densities_are_refused_with_their_voxel() {
    let file = bytes("plain.vdb");
    // The first leaf has voxels -5 to -1 along x, so the first of 15/16 is the one at 5, 2, 7 of the block.
    let value = |new: f32| replaced(&file, transform(&file), &(15.0_f32 / 16.0).to_le_bytes(), &new.to_le_bytes());
    let message = |what: &str| format!(r#"x.vdb: grid "density", voxel [-5, 3, 6]: has the value {what}"#);
    refused(&value(f32::NAN), None, &message("NaN"));
    refused(&value(f32::INFINITY), None, &message("inf"));
    read_bytes("x", &value(1e36), None).expect("the largest density");
    refused(&value(f32::MAX), None, &message("3.4028235e38, more than 1e36"));
    refused(&value(-0.25), None, &message("-0.25, which is negative"));
    let background = 15 * 8 + 4;
    refused(&edited(background, &1.5_f32.to_le_bytes()), None, "has the background 1.5 instead of 0");
    refused(&edited(background, &f32::NAN.to_le_bytes()), None, "has the background NaN instead of 0");
}

#[test]
fn transforms_without_use_are_refused() {
    let scale = |x: f64| edited(0, &x.to_le_bytes());
    refused(&scale(0.0), None, "its voxels have edges of [0.0, 1.0, 1.0] m; 1e-9 to 1e9 m can be read");
    refused(&scale(f64::NAN), None, "its voxels have edges of [NaN, 1.0, 1.0] m");
    refused(&scale(1e100), None, "its voxels have edges of [1e100, 1.0, 1.0] m");
    refused(&scale(1e-7), None, "its voxels have edges of [1e-7, 1.0, 1.0] m; one may be 1e6 times another at most");
    read_bytes("x", &edited(0, &1e-5_f64.to_le_bytes()), None).expect("thin voxels");
    let file = bytes("two.vdb");
    let number = |old: f64, new: f64| replaced(&file, 0, &old.to_le_bytes(), &new.to_le_bytes());
    refused(&number(5.0, 1e12), Some("heat"), "its transform puts voxel [0, 0, 0] at [1000000000000.0, 6.0, 7.0] m");
    refused(&number(5.0, f64::NAN), Some("heat"), "its transform puts voxel [0, 0, 0] at [NaN, 6.0, 7.0] m");
    let flat = replaced(&number(4.0, 0.0), 0, &(-3.0_f64).to_le_bytes(), &3.0_f64.to_le_bytes());
    refused(&flat, Some("heat"), "its transform is singular");
    let one = [7.0_f64, 1.0].map(f64::to_le_bytes).concat();
    let two = [7.0_f64, 2.0].map(f64::to_le_bytes).concat();
    refused(&replaced(&file, 0, &one, &two), Some("heat"), "its transform is not affine");
}

#[test]
fn what_is_no_file_of_this_kind_is_refused() {
    refused(b"", None, "is not an OpenVDB file");
    refused(b"VDB", None, "is not an OpenVDB file");
    refused(&vec![b' '; 10_000], None, "is not an OpenVDB file");
    let header = |at: usize, byte: u8| {
        let mut file = bytes("zip.vdb");
        file[at] = byte;
        file
    };
    refused(&header(8, 218), None, "has version 218 of the OpenVDB format; 222 to 224 can be read");
    refused(&header(20, 0), None, "was written as a stream");
    let missing = read(Path::new("missing.vdb"), None, &|_, _| {}).expect_err("no file").to_string();
    assert!(missing.starts_with("error: missing.vdb: cannot be read: "), "{missing}");
    let folder = list(&path("")).expect_err("no file").to_string();
    assert!(folder.contains("is not a regular file"), "{folder}");
}

#[test]
fn a_small_file_cannot_claim_all_memory() {
    let file = bytes("plain.vdb");
    // A constant region at the root, in the place of the node that is there.
    let at = transform(&file) + 15 * 8 + 8;
    let tile = [&1_u32.to_le_bytes()[..], &[0; 4], &[0; 12], &1.0_f32.to_le_bytes(), &[1]].concat();
    let file = [&file[..at], &tile, &file[at + tile.len()..]].concat();
    refused(&file, None, "has 68719476736 voxels or more, constant regions included; the limit is 2147483648");
}

#[test]
fn files_that_end_early_are_refused() {
    for file in FILES {
        let bytes = bytes(file);
        let step = if file == "zip.vdb" { 1 } else { 97 };
        for len in (0..bytes.len()).step_by(step) {
            let error = list_bytes("x", &bytes[..len]).map(|grids| grids.len()).expect_err("too short");
            assert!(!error.remedy.is_empty(), "{error:?}");
        }
    }
}

#[test]
fn parts_of_grids_that_are_missing_are_errors() {
    // Places of parts are as before, but bytes in the middle are gone: no part ends where it should.
    let mut outcomes = Outcomes::default();
    for file in FILES {
        let bytes = bytes(file);
        for at in (0..bytes.len()).step_by(211) {
            outcomes.add(&[&bytes[..at], &bytes[(at + 4).min(bytes.len())..]].concat());
        }
    }
    assert!(outcomes.refused > 500, "{outcomes:?}");
}

#[test]
fn damaged_files_are_grids_or_errors() {
    let outcomes = damage(0, CASES);
    assert!(outcomes.read > CASES / 10 && outcomes.refused > CASES / 10, "{outcomes:?}");
}
