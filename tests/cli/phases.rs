//! `medium.phase`: every kind of phase function, and what is wrong with its keys.

use crate::support::{Folder, header, mean};

/// Sets the phase function of the test scene.
fn with_phase(phase: &str) -> Folder {
    Folder::with_edited_scene("phase = { type = \"henyey_greenstein\", g = 0.5 }", &format!("phase = {phase}"))
}

#[test]
fn every_kind_renders() {
    for phase in [
        "\"isotropic\"",
        "\"rayleigh\"",
        "{ g = 0.3 }",
        "{ type = \"two_lobe\", g = [0.9, -0.3], weight = 0.8 }",
        "{ type = \"draine\", g = 0.7, alpha = 1 }",
        "{ type = \"droplets\", diameter_um = 20 }",
        "{ type = \"tabulated\", file = \"phase.csv\" }",
    ] {
        let folder = with_phase(phase);
        folder.write("phase.csv", "cosine, value\n-1, 1\n0, 1\n1, 5\n");
        folder.done(&["render", "scene.toml", "--size", "8x8", "--samples", "4", "-o", "a.exr"]);
        assert!(mean(&folder.image("a.exr"), "G") > 0.0, "{phase} is black");
    }
}

#[test]
fn a_name_is_the_same_as_a_table_with_a_type() {
    let hash = |phase: &str| {
        let folder = with_phase(phase);
        folder.done(&["render", "scene.toml", "--size", "4x4", "--samples", "1", "-o", "a.exr"]);
        header(&folder.image("a.exr"), "scene_hash").to_string()
    };
    assert_eq!(hash("\"rayleigh\""), hash("{ type = \"rayleigh\" }"));
    assert_ne!(hash("\"rayleigh\""), hash("\"isotropic\""));
}

#[test]
fn the_content_of_a_table_is_part_of_the_hash_and_its_file_is_safe() {
    let folder = with_phase("{ type = \"tabulated\", file = \"phase.csv\" }");
    let hashes = ["-1, 1\n1, 5\n", "-1, 1\n1, 6\n"].map(|table| {
        folder.write("phase.csv", table);
        folder.done(&["render", "scene.toml", "--size", "4x4", "--samples", "1", "-o", "a.exr"]);
        header(&folder.image("a.exr"), "scene_hash").to_string()
    });
    assert_ne!(hashes[0], hashes[1]);
    folder.refused(&["render", "scene.toml", "-o", "png:phase.csv"], 2, "");
}

#[test]
fn faulty_keys_say_what_is_wrong() {
    for (phase, finding) in [
        ("{ type = \"rayleigh\", g = 0.5 }", "medium.phase.g is given, but the phase function is rayleigh"),
        ("{ type = \"droplets\" }", "medium.phase.diameter_um is missing, but the phase function is droplets"),
        ("{ type = \"droplets\", diameter_um = 3 }", "medium.phase.diameter_um is 3.0"),
        ("{ type = \"two_lobe\", g = 0.5, weight = 0.5 }", "medium.phase.g is 0.5, one lobe"),
        ("{ type = \"two_lobe\", g = [0.5, 1.5], weight = 0.5 }", "medium.phase.g is [0.5, 1.5]"),
        ("{ type = \"two_lobe\", g = [0.5, 0.1], weight = 1.5 }", "medium.phase.weight is 1.5"),
        ("{ type = \"draine\", g = [0.5, 0.1], alpha = 1 }", "medium.phase.g is [0.5, 0.1], two lobes"),
        ("{ type = \"draine\", g = 0.5, alpha = -1 }", "medium.phase.alpha is -1.0"),
        ("{ type = \"tabulated\" }", "medium.phase.file is missing, but the phase function is tabulated"),
        ("\"mie\"", "medium.phase: unknown name `mie`"),
    ] {
        let folder = with_phase(phase);
        let run = folder.refused(&["render", "scene.toml"], 1, "scene.toml:13:");
        assert!(run.stderr.contains(finding), "{phase}: {run}");
    }
}

#[test]
fn faulty_tables_name_their_line() {
    let folder = with_phase("{ type = \"tabulated\", file = \"phase.csv\" }");
    let place = format!("{}: medium.phase.file: ", folder.place("file ="));
    folder.refused(&["render", "scene.toml"], 1, &format!("{place}phase.csv: cannot be read"));
    let endless = with_phase("{ type = \"tabulated\", file = \"/dev/zero\" }");
    let finding = format!("{}: medium.phase.file: /dev/zero: is larger than 16 MiB", endless.place("file ="));
    endless.refused(&["render", "scene.toml"], 1, &finding);
    folder.write("phase.csv", "cosine, value\n-1, 1\n0.5\n");
    folder.refused(&["render", "scene.toml"], 1, &format!("{place}phase.csv:3: \"0.5\" is not a pair of numbers"));
    for (table, finding) in [("-1, 1\n", "at least two rows"), ("-1, 0\n1, 0\n", "zero"), ("1, 1\n-1, 1\n", "ascend")] {
        folder.write("phase.csv", table);
        let run = folder.refused(&["render", "scene.toml"], 1, &format!("{place}phase.csv: "));
        assert!(run.stderr.contains(finding), "{table}: {run}");
    }
}
