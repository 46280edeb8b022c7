//! Scenes that are wrong are refused before anything is rendered, with the place and what to do.

use fogbow_testing::suite::some;

use super::support::{Folder, SCENE};

/// The scene with `from` replaced by `to` is refused at `to`, with `finding`.
#[track_caller]
fn refused(from: &str, to: &str, finding: &str) {
    let folder = Folder::with_edited_scene(from, to);
    // Errors name the place of the key, which is the last line of the replacement.
    let key = to.lines().last().expect("a line");
    let beginning = format!("{}: {finding}", folder.place(key));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
}

#[test]
fn an_unknown_key_is_reported_with_line_and_remedy() {
    refused("radius = 1.5", "raduis = 1.5", "light[0].raduis: unknown key `raduis`, expected one of `type`");
    refused("size = [8, 8]", "sise = [8, 8]", "film.sise: unknown key `sise`, expected one of `size`");
    refused("g = 0.5", "G = 0.5", "medium.phase.G: unknown key `G`");
}

#[test]
fn a_missing_key_is_reported_with_its_table() {
    let folder = Folder::with_edited_scene("radius = 1.5\n", "");
    let finding = "light[0].radius is missing, but the light is a disk";
    let beginning = format!("{}: {finding}", folder.place("[[light]]"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
}

#[test]
fn a_wrong_type_is_reported_in_plain_words() {
    let cases = [
        ("radius = 1.5", "radius = \"big\"", "light[0].radius: this is the string \"big\", expected a number"),
        ("radius = 1.5", "radius = true", "light[0].radius: this is the boolean `true`, expected a number"),
        ("samples = 4", "samples = 1.5", "render.samples: this is the number `1.5`, expected a whole number from 1 to"),
        (
            "samples = 4",
            "samples = -1",
            "render.samples: -1 is out of range\n  help: give a whole number from 1 to 2147483648",
        ),
        ("normal = [0, 0, -1]", "normal = [0, -1]", "light[0].normal has 2 entries, not 3\n"),
        ("normal = [0, 0, -1]", "normal = [0, 0, -1, 0, 0]", "light[0].normal has 5 entries, not 3\n"),
        (
            "center = [0, 0, 3]",
            "center = 3",
            "light[0].center: this is the whole number `3`, expected a list of 3 numbers\n",
        ),
        ("look_at = [0, 0, 1]", "look_at = [0]", "camera.look_at has 1 entry, not 3\n"),
        ("size = [8, 8]", "size = [8, 8, 8]", "film.size has 3 entries, not 2\n"),
        ("scattering = 0.7", "scattering = [1, 2]", "medium.scattering has 2 entries, not 3\n"),
        ("scattering = 0.7", "scattering = [1, 2, 3, \"a\"]", "medium.scattering has 4 entries, not 3\n"),
        ("technique = \"mvnee\"", "technique = 3", "render.technique: this is the whole number `3`, expected the name"),
        ("type = \"disk\"", "type = \"cube\"", "light[0].type: unknown name `cube`, expected one of `disk`"),
        (
            "technique = \"mvnee\"",
            "technique = \"bdpt\"",
            "render.technique: unknown name `bdpt`, expected one of `path`",
        ),
    ];
    for (from, to, finding) in cases {
        refused(from, to, finding);
    }
}

#[test]
fn a_single_table_for_a_list_of_lights_is_explained() {
    let folder = Folder::with_edited_scene("[[light]]", "[light]");
    let beginning = format!("{}: light: this is a table, expected a list", folder.place("light]"));
    let run = folder.refused(&["render", "scene.toml"], 1, &beginning);
    assert!(run.stderr.contains("help: write [[light]]"), "{run}");
}

#[test]
fn a_mean_cosine_outside_the_open_interval_is_refused() {
    for (written, shown) in
        [("1", "1.0"), ("-1", "-1.0"), ("1.5", "1.5"), ("inf", "inf"), ("nan", "NaN"), ("0.99991", "0.99991")]
    {
        let folder = Folder::with_edited_scene("g = 0.5", &format!("g = {written}"));
        let beginning = format!("{}: medium.phase.g is {shown}\n", folder.place(&format!("g = {written}")));
        folder.refused(&["render", "scene.toml"], 1, &beginning);
    }
}

#[test]
fn coefficients_are_finite_and_not_negative() {
    let cases =
        [("-1", "-1.0"), ("nan", "NaN"), ("inf", "inf"), ("1e308", "1e308"), ("[1, -1, 1]", "[1.0, -1.0, 1.0]")];
    for (written, shown) in cases {
        let scattering = format!("scattering = {written}");
        refused("scattering = 0.7", &scattering, &format!("medium.scattering is {shown}\n"));
        let absorption = format!("absorption = {written}");
        refused("absorption = 0.3", &absorption, &format!("medium.absorption is {shown}\n"));
        let radiance = format!("radiance = {written}");
        refused("radiance = 10", &radiance, &format!("light[0].radiance is {shown}\n"));
    }
    let finding =
        "medium.scattering is 1000000000.0, which makes an extinction of 1000000000.3/m with the absorption\n";
    refused("scattering = 0.7", "scattering = 1e9", finding);
}

#[test]
fn extinction_may_differ_between_channels() {
    let folder = Folder::with_edited_scene("scattering = 0.7", "scattering = [1, 2, 3]");
    let run = folder.done(&["info", "scene.toml"]);
    assert!(run.stdout.contains("mean free path 0.7692 | 0.4348 | 0.3030 m"), "{run}");
}

#[test]
fn a_light_has_a_normal_and_a_size() {
    refused("normal = [0, 0, -1]", "normal = [0, 0, 0]", "light[0].normal is [0.0, 0.0, 0.0]\n");
    refused("normal = [0, 0, -1]", "normal = [0, nan, 1]", "light[0].normal is [0.0, NaN, 1.0]\n");
    refused("radius = 1.5", "radius = 0", "light[0].radius is 0.0\n");
    refused("radius = 1.5", "radius = -2", "light[0].radius is -2.0\n");
    refused("radius = 1.5", "radius = 1e300", "light[0].radius is 1e300\n");
}

#[test]
fn path_lengths_have_limits() {
    for segments in ["0", "65537", "4294967295"] {
        let to = format!("max_segments = {segments}");
        let finding = format!("{segments} is out of range\n  help: give a whole number from 1 to 65536 or \"auto\"\n");
        refused("max_segments = 24", &to, &format!("render.max_segments: {finding}"));
    }
    refused("max_segments = 24", "max_segments = 24\nmin_segments = 25", "render.min_segments is 25\n");
    let finding = "render.min_segments: 0 is out of range\n  help: give a whole number from 1 to 65536\n";
    refused("max_segments = 24", "max_segments = 24\nmin_segments = 0", finding);
    refused("mesc = 4", "mesc = 0", "render.mesc is 0.0\n");
    refused("mesc = 4", "mesc = nan", "render.mesc is NaN\n");
}

#[test]
fn a_camera_sees_something() {
    refused("look_at = [0, 0, 1]", "look_at = [0, 0, 0]", "camera.look_at is [0.0, 0.0, 0.0]\n");
    refused("look_at = [0, 0, 1]", "look_at = [0, 0, 1]\nup = [0, 0, 3]", "camera.up is [0.0, 0.0, 3.0]\n");
    refused("look_at = [0, 0, 1]", "look_at = [0, 0, 1]\nup = [0, 0, 0]", "camera.up is [0.0, 0.0, 0.0]\n");
    for (written, shown) in [("0", "0.0"), ("180", "180.0"), ("-1", "-1.0"), ("nan", "NaN")] {
        let to = format!("vertical_fov_deg = {written}");
        refused("vertical_fov_deg = 60", &to, &format!("camera.vertical_fov_deg is {shown}\n"));
    }
    refused("look_at = [0, 0, 1]", "look_at = [0, 0, 1]\nnear = -1", "camera.near is -1.0\n");
}

#[test]
fn a_film_has_pixels_but_not_more_than_fit() {
    refused("size = [8, 8]", "size = [20000, 20000]", "film.size is [20000, 20000]\n");
    for (size, key, side) in [
        ("[-1, 8]", "film.size[0]", "-1"),
        ("[0, 0]", "film.size[0]", "0"),
        ("[8, 0]", "film.size[1]", "0"),
        ("[1, 134217729]", "film.size[1]", "134217729"),
        ("[4294967296, 1]", "film.size[0]", "4294967296"),
    ] {
        let folder = Folder::with_edited_scene("size = [8, 8]", &format!("size = {size}"));
        let column =
            if key.ends_with("[0]") { "size = [".len() } else { size.find(", ").expect("two") + 2 + "size = ".len() };
        let line = folder.place("size = ").rsplit_once(':').expect("a column").0.to_string();
        let help = "give a whole number from 1 to 134217728\n";
        let beginning = format!("{line}:{}: {key}: {side} is out of range\n  help: {help}", column + 1);
        folder.refused(&["render", "scene.toml"], 1, &beginning);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_film_that_memory_cannot_hold_is_refused_and_not_a_crash() {
    let folder = Folder::with_scene();
    // The shell limits the address space of what it becomes.
    let render =
        format!("ulimit -v 1500000; exec {} render scene.toml --size 11000x11000", env!("CARGO_BIN_EXE_fogbow"));
    let mut shell = std::process::Command::new("sh");
    let output = shell.current_dir(folder.path(".")).args(["-c", &render]).output().expect("a shell");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.starts_with("error: scene.toml: a film of 121000000 pixels needs 3231 MiB: "), "{stderr}");
    assert!(stderr.contains("\n  help: render a smaller image with --size"), "{stderr}");
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn a_scene_needs_a_light() {
    let (before, rest) = SCENE.split_once("[[light]]").expect("a light");
    let (_, after) = rest.split_once("[render]").expect("a table after it");
    let folder = Folder::empty();
    folder.write("scene.toml", format!("{before}[render]{after}"));
    folder.refused(&["render", "scene.toml"], 1, "scene.toml: the scene has no light\n");
}

#[test]
fn files_that_are_no_scenes_are_told_apart() {
    let folder = Folder::empty();
    folder.write("empty.toml", "");
    folder.write("prose.toml", "# a title\nIt was a foggy day.\n");
    folder.write("latin1.toml", b"# fog\n# Stra\xdfe\n");
    folder.write("deep.toml", format!("x = {}", "[".repeat(100_000)));
    folder.write("huge.toml", "seed = 99999999999999999999\n");
    folder.write("here/readme.txt", "no scene");
    folder.refused(&["render", "missing.toml"], 1, "missing.toml: cannot be read: ");
    folder.refused(&["render", "empty.toml"], 1, "empty.toml: missing key `camera`\n");
    folder.refused(&["render", "prose.toml"], 1, "prose.toml:2:4: ");
    folder.refused(&["render", "latin1.toml"], 1, "latin1.toml:2:7: is not a UTF-8 text file\n");
    folder.refused(&["render", "deep.toml"], 1, "deep.toml:1:");
    folder.refused(&["render", "huge.toml"], 1, "huge.toml:1:8: 99999999999999999999 is out of range\n");
    folder.refused(&["render", "here"], 1, "here: is a folder without a scene.toml\n");
    folder.refused(&["render", "."], 1, ".: is a folder without a scene.toml\n");
}

#[test]
fn files_from_windows_are_read() {
    let folder = Folder::empty();
    folder.write("scene.toml", format!("\u{feff}{}", SCENE.replace('\n', "\r\n")));
    folder.done(&["render", "scene.toml"]);
}

#[test]
fn thousands_of_lights_load_at_once() {
    let folder = Folder::empty();
    let light = &SCENE[SCENE.find("[[light]]").expect("a light")..SCENE.find("[render]").expect("a table after it")];
    folder.write("scene.toml", format!("{SCENE}{}", light.repeat(5000)));
    let start = std::time::Instant::now();
    folder.refused(&["render", "scene.toml", "--set", "light[4999].radius=-1"], 2, "--set light[4999].radius=-1: ");
    assert!(start.elapsed().as_secs() < 10, "took {:?}", start.elapsed());
}

#[test]
fn strange_values_are_rendered_or_refused() {
    let keys = [
        "camera.position",
        "camera.look_at",
        "camera.up",
        "camera.vertical_fov_deg",
        "camera.near",
        "medium.scattering",
        "medium.absorption",
        "medium.phase.g",
        "light[0].center",
        "light[0].normal",
        "light[0].radius",
        "light[0].radiance",
        "render.technique",
        "render.max_segments",
        "render.roll",
        "render.bridge_mesc",
        "render.bridge_vertices",
        "render.starts",
        "render.survival",
        "render.roulette",
        "render.lis",
        "render.mesc",
        "render.seed",
        "film.size",
        "light",
        "medium",
        "camera",
        "punctual_radius",
    ];
    let values = [
        "0",
        "-0.0",
        "1",
        "1e308",
        "-1e308",
        "5e-324",
        "inf",
        "nan",
        "1e9",
        "-1e9",
        "1e-9",
        "1e30",
        "0.9999",
        "-0.9999",
        "179.9999",
        "1024",
        "[]",
        "{}",
        "[[]]",
        "[1e9, -1e9, 1e9]",
        "[1e-30, 0, 0]",
        "[5, 0, 0]",
        "[1, 1]",
        "[\"path\", \"nee\"]",
        "all",
        "auto",
        "1979-05-27",
    ];
    // Every key matters to some technique; no pilot, which would try every walk of up to 1024 segments.
    let settings = "technique = \"nee,mvnee,omnee,bridge,lis\"\nstarts = 2\nsurvival = 1";
    let folder = Folder::with_edited_scene("technique = \"mvnee\"", settings);
    for (turn, key) in keys.into_iter().enumerate() {
        for value in some(values, turn, 2) {
            let set = format!("{key}={value}");
            let args = ["render", "scene.toml", "-o", "a.exr", "--samples", "1", "--progress", "none", "--set", &set];
            let run = folder.run(&args);
            let told = match run.code {
                Some(0) => run.stderr.lines().all(|line| line.starts_with("warning: ")),
                Some(2) => {
                    run.stderr.starts_with(&format!("error: --set {set}: ")) && run.stderr.contains("\n  help: ")
                }
                // Default up vector and viewing direction may become parallel: the table is at fault, not a flag.
                Some(1) => run.stderr.contains("camera.up is [0.0, 1.0, 0.0]\n  help: "),
                _ => false,
            };
            assert!(told, "{run}");
        }
    }
}

#[test]
fn geometry_that_is_not_there_or_not_gltf_is_refused() {
    let folder = Folder::with_edited_scene("[camera]", "geometry = \"fog.glb\"\n[camera]");
    let beginning = format!("{}: geometry is \"fog.glb\", but there is no file", folder.place("geometry"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
    folder.refused(&["render", "scene.toml", "--set", "geometry=scene.toml"], 1, "scene.toml: is not glTF");
    folder.write("models/room.glb", "");
    let beginning = "--set geometry=models: geometry is \"models\", but models is a folder\n";
    folder.refused(&["render", "scene.toml", "--set", "geometry=models"], 2, beginning);
}

#[test]
fn a_spot_has_an_exponent_and_a_disk_has_none() {
    let refused = |change: &str, code: i32, beginning: &str| {
        Folder::with_scene().refused(&["render", "scene.toml", "--set", change], code, beginning);
    };
    refused("light[0].exponent=3", 2, "--set light[0].exponent=3: light[0].exponent is 3.0, but the light is a disk");
    let spot = |exponent: &str| format!("type = \"spot\"\nexponent = {exponent}");
    let folder = Folder::with_edited_scene("type = \"disk\"", &spot("-1"));
    let beginning = format!("{}: light[0].exponent is -1.0", folder.place("exponent"));
    folder.refused(&["render", "scene.toml"], 1, &beginning);
    let folder = Folder::with_edited_scene("type = \"disk\"", "type = \"spot\"");
    folder.refused(
        &["render", "scene.toml"],
        1,
        &format!("{}: light[0].exponent is missing", folder.place("[[light]]")),
    );
}

#[test]
fn a_disk_has_a_normal_and_a_sphere_has_neither_normal_nor_exponent() {
    let refused_there = |folder: &Folder, place: &str, finding: &str| {
        folder.refused(&["render", "scene.toml"], 1, &format!("{}: light[0].{finding}", folder.place(place)));
    };
    let folder = Folder::with_edited_scene("normal = [0, 0, -1]\n", "");
    refused_there(&folder, "[[light]]", "normal is missing, but the light is a disk\n");
    let folder = Folder::with_edited_scene("type = \"disk\"", "type = \"sphere\"");
    refused_there(&folder, "normal", "normal is [0.0, 0.0, -1.0], but the light is a sphere\n");
    let sphere = |line: &str| {
        let folder = Folder::with_edited_scene("type = \"disk\"", "type = \"sphere\"");
        let scene = std::fs::read_to_string(folder.path("scene.toml")).expect("a scene");
        folder.write("scene.toml", scene.replace("normal = [0, 0, -1]", line));
        folder
    };
    refused_there(&sphere("exponent = 3"), "exponent", "exponent is 3.0, but the light is a sphere\n");
    sphere("").done(&["render", "scene.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn inputs_without_end_or_too_large_are_refused_by_size() {
    let folder = Folder::with_scene();
    folder.refused(&["render", "/dev/zero"], 1, "/dev/zero: is larger than 64 MiB, too large for a scene\n");
    for (name, finding) in [
        ("big.toml", "is larger than 64 MiB, too large for a scene\n"),
        ("big.glb", "has 1099511627776 bytes, more than the limit of 4 GiB\n"),
    ] {
        // A hole: it takes no space.
        let file = std::fs::File::create(folder.path(name)).expect("a file");
        file.set_len(1 << 40).expect("a file system with holes");
        folder.refused(&["render", name], 1, &format!("{name}: {finding}"));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_large_file_that_is_no_model_is_refused_by_its_first_bytes() {
    let folder = Folder::with_edited_scene("[camera]", "geometry = \"big.glb\"\n[camera]");
    let file = std::fs::File::create(folder.path("big.glb")).expect("a file");
    file.set_len(3900 << 20).expect("a file system with holes");
    for scene in ["big.glb", "scene.toml"] {
        let mut shell = std::process::Command::new("sh");
        let render = format!("ulimit -v 1500000; exec {} render {scene}", env!("CARGO_BIN_EXE_fogbow"));
        let output = shell.current_dir(folder.path(".")).args(["-c", &render]).output().expect("a shell");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.starts_with("error: big.glb: is not glTF: it begins neither with "), "{stderr}");
    }
}
