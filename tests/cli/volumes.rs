//! `fogbow info` of OpenVDB files.

use std::sync::Arc;

use fogbow::volume::Leaf;
use fogbow_testing::volume_writer;
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
        "  voxel size: 2 x 3 x 4.12311 m, sheared",
        "  index bounds: [0, 0, 0] to [2, 2, 2]",
        "  world bounds: [-3, 5, 5] to [9, 11, 17] m",
        "  densities: 2 at most, 2 on average of active voxels",
        "  mean free path at an extinction of 1/m: 0.5000 m where it is densest, 0.5000 m at that average",
        r#"grid "density": float, fog volume, blosc + active values"#,
        "  active voxels: 9544, 37.3 KiB at 4 bytes each",
        "  voxel size: 0.25 m",
        "  index bounds: [-3, 0, 40] to [20, 23, 63]",
        "  world bounds: [0.125, 1.875, 12.875] to [6.125, 7.875, 18.875] m",
        "  densities: 0.9766 at most, 0.1024 on average of active voxels",
        "  mean free path at an extinction of 1/m: 1.024 m where it is densest, 9.761 m at that average",
    ];
    assert_eq!(run.stdout.lines().collect::<Vec<_>>(), expected, "{run}");
    assert_eq!(run.stderr, "", "{run}");
}

#[test]
fn what_is_not_known_of_a_grid_is_said() {
    let folder = Folder::empty();
    let info = |file: &str| folder.done(&["info", path(file).to_str().expect("UTF-8")]).stdout;
    assert!(info("half.vdb").contains("\ngrid \"density\": float saved as half floats, fog volume, "));
    assert!(info("transforms.vdb").contains("\n  transform: \"NonlinearFrustumMap\"\n"));
    let written = plain_and(|_| 1.0, b"Tree_int32_5_4_3");
    let said = written.done(&["info", "a.vdb"]).stdout;
    assert!(said.contains("\n  active voxels: the file does not say how many\n"), "{said}");
    assert!(info("types.vdb").contains("\ngrid \"double\": double, unknown class, zip + active values\n"));
}

/// A folder with `a.vdb`, whose grid has no metadata, a leaf of these values by their index, and a tree of this kind.
fn plain_and(value: impl Fn(usize) -> f32, tree: &[u8; 16]) -> Folder {
    let folder = Folder::empty();
    let leaf = Leaf { origin: [8, 16, 0], values: Arc::new(core::array::from_fn(value)) };
    volume_writer::write(&folder.path("a.vdb"), 0.25, &[leaf]);
    let mut bytes = std::fs::read(folder.path("a.vdb")).expect("a file");
    let at = bytes.windows(16).position(|window| window == b"Tree_float_5_4_3").expect("a tree");
    bytes[at..at + 16].copy_from_slice(tree);
    folder.write("a.vdb", bytes);
    folder
}

#[test]
fn voxels_are_read_where_the_file_does_not_say_what_they_are() {
    const FLOAT: &[u8; 16] = b"Tree_float_5_4_3";
    let said = |value: fn(usize) -> f32| plain_and(value, FLOAT).done(&["info", "a.vdb"]).stdout;
    // Voxels 1 to 7 along x, of a row.
    let text = said(|index| if (1..8).contains(&index) { 0.5 } else { 0.0 });
    let expected = [
        "  active voxels: 7, 28 bytes at 4 bytes each",
        "  voxel size: 0.25 m",
        "  index bounds: [9, 16, 0] to [15, 16, 0]",
        "  world bounds: [2.125, 3.875, -0.125] to [3.875, 4.125, 0.125] m",
        "  densities: 0.5000 at most, 0.5000 on average of active voxels",
        "  mean free path at an extinction of 1/m: 2 m where it is densest, 2 m at that average",
    ];
    assert_eq!(text.lines().skip(2).collect::<Vec<_>>(), expected, "{text}");
    let text = said(|_| 0.0);
    assert!(
        text.contains("\n  active voxels: 0, ") && text.ends_with("  renders as nothing: it has no density above 0\n"),
        "{text}"
    );
    let run = plain_and(|index| if index == 1 { f32::NAN } else { 1.0 }, FLOAT).run(&["info", "a.vdb"]);
    let finding = "grid \"density\", voxel [9, 16, 0]: has the value NaN\n";
    assert!(run.code == Some(1) && run.stdout.ends_with(&format!("\n  cannot be rendered: {finding}")), "{run}");
    assert!(run.stderr.starts_with(&format!("error: a.vdb: {finding}  help: ")), "{run}");
    // Voxels of another grid.
    let text = Folder::empty().done(&["info", path("shared.vdb").to_str().expect("UTF-8")]).stdout;
    assert_eq!(text.matches("  active voxels: 1000, 3.91 KiB at 4 bytes each\n").count(), 2, "{text}");
    let ending = "  world bounds: [-2.75, -0.25, -0.25] to [2.25, 4.75, 4.75] m\n  densities: 0.9375 at most, 0.4688 on \
                  average of active voxels\n  mean free path at an extinction of 1/m: 1.067 m where it is densest, \
                  2.133 m at that average\n";
    assert!(text.ends_with(ending), "{text}");
}

#[test]
fn it_is_said_why_a_grid_cannot_be_rendered() {
    let folder = Folder::empty();
    let info = |file: &str| folder.done(&["info", path(file).to_str().expect("UTF-8")]).stdout;
    let others = info("others.vdb");
    assert!(others.contains("  active voxels: 64, 768 bytes at 12 bytes each\n"), "{others}");
    assert!(others.contains("  active voxels: 64, 8 bytes at 1 bit each\n"), "{others}");
    assert!(others.contains("\n  cannot be rendered: has values of type vec3s, not float\n"), "{others}");
    assert!(others.contains("\n  cannot be rendered: is a level set: its values are distances"), "{others}");
    assert!(info("types.vdb").contains("  active voxels: 64, 512 bytes at 8 bytes each\n"));
    assert!(!info("two.vdb").contains("cannot"));
    let mut bytes = bytes("plain.vdb");
    let name = b"UniformScaleMap";
    let at = bytes.windows(name.len()).position(|window| window == name).expect("a transform") + name.len();
    bytes[at..at + 24].copy_from_slice([1e-12_f64; 3].map(f64::to_le_bytes).as_flattened());
    folder.write("tiny.vdb", bytes);
    let finding = "its voxels have edges of [1e-12, 1e-12, 1e-12] m; 1e-9 to 1e9 m can be read";
    let text = folder.done(&["info", "tiny.vdb"]).stdout;
    assert!(text.ends_with(&format!("\n  cannot be rendered: {finding}\n")), "{text}");
}

#[test]
fn voxels_too_far_apart_are_told_with_and_without_a_scene() {
    let folder = Folder::empty();
    let leaf = |origin| Leaf { origin, values: [1.0; 512].into() };
    volume_writer::write(&folder.path("far.vdb"), 0.25, &[leaf([0; 3]), leaf([4088; 3])]);
    let finding = "voxels are so far apart that 135005697 bricks of 8x8x8 lie between them\n";
    let info = folder.done(&["info", "far.vdb"]);
    assert!(info.stdout.ends_with(&format!("\n  cannot be rendered: its {finding}")), "{info}");
    folder.write(
        "scene.toml",
        super::support::SCENE.to_owned() + "\n[[volume]]\nscattering = 1\ngrid = { file = \"far.vdb\" }\n",
    );
    let run = folder.refused(&["info", "scene.toml"], 1, "scene.toml:");
    assert!(run.stderr.contains(finding), "{run}");
}

#[cfg(unix)]
#[test]
fn nobody_waits_for_the_writer_of_a_pipe() {
    let folder = Folder::empty();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.vdb")).status();
    assert!(made.is_ok_and(|status| status.success()));
    folder.refused(&["info", "pipe.vdb"], 1, "pipe.vdb: is not a regular file\n");
}

#[test]
fn the_cloud_is_in_its_box() {
    let cloud = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cloud-box/cloud.vdb");
    let run = Folder::empty().done(&["info", cloud]);
    assert!(run.stdout.contains("\n  voxel size: 0.015625 m\n"), "{run}");
    let ending = "  world bounds: [-0.875, -0.71875, -0.859375] to [0.921875, 0.796875, 0.859375] m\n  densities: 1 at \
                  most, 0.7897 on average of active voxels\n  mean free path at an extinction of 1/m: 1 m where it is \
                  densest, 1.266 m at that average\n";
    assert!(run.stdout.ends_with(ending), "{run}");
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
