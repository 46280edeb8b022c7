//! `fogbow info` of OpenVDB files.

use fogbow_testing::volumes::{bytes, path};

use super::support::Folder;

#[test]
fn the_grids_of_a_volume_are_listed() {
    let folder = Folder::empty();
    folder.write("two.vdb", bytes("two.vdb"));
    let run = folder.done(&["info", "two.vdb"]);
    let expected = [
        "two.vdb: 2 grids",
        r#"grid "heat": float, unknown class, blosc + active values"#,
        "  active voxels: 27, 108 bytes at 4 bytes each",
        "  voxel size: 2 x 3 x 4.12311 m",
        "  index bounds: [0, 0, 0] to [2, 2, 2]",
        "  world bounds: [-3, 5, 5] to [9, 11, 17] m",
        r#"grid "density": float, fog volume, blosc + active values"#,
        "  active voxels: 9544, 37.3 KiB at 4 bytes each",
        "  voxel size: 0.25 m",
        "  index bounds: [-3, 0, 40] to [20, 23, 63]",
        "  world bounds: [0.125, 1.875, 12.875] to [6.125, 7.875, 18.875] m",
    ];
    assert_eq!(run.stdout.lines().collect::<Vec<_>>(), expected, "{run}");
    assert_eq!(run.stderr, "", "{run}");
}

#[test]
fn what_is_not_known_of_a_grid_is_said() {
    let folder = Folder::empty();
    let info = |file: &str| folder.done(&["info", path(file).to_str().expect("UTF-8")]).stdout;
    assert!(info("half.vdb").contains("\ngrid \"density\": float saved as half floats, fog volume, "));
    assert!(info("shared.vdb").contains("\n  active voxels: the file does not say how many\n"));
    assert!(info("transforms.vdb").contains("\n  transform: \"NonlinearFrustumMap\", which cannot be used\n"));
    assert!(info("types.vdb").contains("\ngrid \"double\": double, unknown class, zip + active values\n"));
}

#[test]
fn the_cloud_is_in_its_box() {
    let cloud = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cloud-box/cloud.vdb");
    let run = Folder::empty().done(&["info", cloud]);
    assert!(run.stdout.contains("\n  voxel size: 0.015625 m\n"), "{run}");
    assert!(
        run.stdout.ends_with("  world bounds: [-0.875, -0.71875, -0.859375] to [0.921875, 0.796875, 0.859375] m\n")
    );
}

#[test]
fn what_is_no_volume_is_refused() {
    let folder = Folder::empty();
    folder.write("fake.vdb", "no volume");
    folder.write("short.VDB", &bytes("zip.vdb")[..9000]);
    folder.write("folder.vdb/file", "");
    folder.refused(&["info", "missing.vdb"], 1, "missing.vdb: cannot be read: ");
    folder.refused(&["info", "fake.vdb"], 1, "fake.vdb: is not an OpenVDB file\n");
    folder.refused(&["info", "short.VDB"], 1, "short.VDB: grid 0, \"density\": ends too early: it has 9000 bytes, ");
    folder.refused(&["info", "folder.vdb"], 1, "folder.vdb: is not a regular file\n");
}
