//! Help.

use super::support::Folder;

#[test]
fn help_for_scenes_lists_every_key() {
    let run = Folder::empty().done(&["render", "--help-scene"]);
    for key in [
        "[camera]",
        "vertical_fov_deg = number  (required)",
        "[[light]]",
        "phase.g = number",
        "mesc = number",
        "punctual_radius = number  (default 0.01)",
        "\"sphere\": ",
    ] {
        assert!(run.stdout.contains(key), "{key} is missing\n{run}");
    }
    assert_eq!(run.stderr, "", "{run}");
    let short = Folder::empty().done(&["--help-scene"]);
    assert_eq!(short.stdout, run.stdout);
}

#[test]
fn the_page_of_keys_says_the_ranges_that_hold() {
    let page = Folder::empty().done(&["--help-scene"]).stdout;
    for (set, range) in [
        ("medium.phase.g=0.99991", "from -0.9999 to 0.9999"),
        ("render.max_segments=65537", "1 to 65536"),
        ("render.samples=0", "1 to 2147483648"),
        ("render.seed=-1", "0 to 4294967295"),
    ] {
        let run = Folder::with_scene().run(&["render", "scene.toml", "--set", set]);
        assert!(run.code == Some(2) && run.stderr.contains(range), "{run}");
        assert!(page.contains(range), "{range} is not on\n{page}");
    }
}

#[test]
fn the_page_of_keys_says_what_media_have_of_their_own() {
    let page = Folder::empty().done(&["--help-scene"]).stdout;
    let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("Each has an albedo and a phase function of its own."), "{page}");
    assert!(!words.contains("same phase function") && !words.contains("in the same way"), "{page}");
    assert!(page.contains("\"fast\": "), "{page}");
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).expect("a README");
    assert!(readme.contains("`seeds = \"fast\"`"));
}

#[test]
fn help_lists_every_flag_that_scripts_rely_on() {
    let run = Folder::empty().done(&["render", "--help"]);
    let flags = [
        "--output",
        "--technique",
        "--mesc",
        "--max-segments",
        "--samples",
        "--sample-range",
        "--time",
        "--noise",
        "--adaptive",
        "--size",
        "--crop",
        "--seed",
        "--threads",
        "--reference",
        "--stats",
        "--progress",
        "--checkpoint",
        "--resume",
        "--overwrite-checkpoint",
        "--set",
        "--help-scene",
    ];
    for flag in flags {
        assert!(run.stdout.contains(flag), "{flag} is missing\n{run}");
    }
    let run = Folder::empty().done(&["--help"]);
    assert!(
        run.stdout.starts_with("Renders light in fog, clouds, smoke, milk and wax"),
        "no more than it can do\n{run}"
    );
    for command in ["render", "compare", "merge", "info", "presets"] {
        assert!(run.stdout.contains(&format!("\n  {command} ")), "{command} is missing\n{run}");
    }
}

#[test]
fn the_version_is_that_of_the_package() {
    let run = Folder::empty().done(&["--version"]);
    assert_eq!(run.stdout, concat!("fogbow ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[cfg(unix)]
#[test]
fn help_into_a_closed_pipe_is_no_error() {
    let mut shell = std::process::Command::new("sh");
    let script = "{ \"$0\" render --help-scene; echo $? >&2; } | true";
    let output = shell.args(["-c", script, env!("CARGO_BIN_EXE_fogbow")]).output().expect("a shell");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "0\n");
}
