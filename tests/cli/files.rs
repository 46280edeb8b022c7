//! Where images go: refused in time if they cannot, whole or not at all if they can.

use std::fs;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use super::models::with_model;
use super::support::{Folder, SCENE, header, plane};

#[test]
fn outputs_that_cannot_be_written_are_refused_before_rendering() {
    let folder = Folder::with_scene();
    fs::create_dir(folder.path("folder.exr")).expect("a folder");
    let long = format!("{}.exr", "x".repeat(300));
    let cases = [
        ("nowhere/a.exr", "nowhere/a.exr: no file can be created in nowhere: "),
        ("folder.exr", "folder.exr: is a folder\n"),
        ("a.exr/", "a.exr/: is a folder\n"),
        ("scene.toml/a.exr", "scene.toml/a.exr: cannot be used as a file: "),
        (&long, &format!("{long}: cannot be used as a file: ")),
    ];
    for (output, beginning) in cases {
        // So many samples would take hours.
        let run = folder.refused(&["render", "scene.toml", "-o", output, "--samples", "1000000000"], 1, beginning);
        assert!(!run.stderr.contains(".part"), "{run}");
    }
    folder.refused(&["render", "scene.toml", "-o", "a.exr", "--stats", "nowhere/s.json"], 1, "nowhere/s.json: ");
    folder.refused(&["render", "scene.toml", "-o", "a.exr", "-o", "nowhere/b.png"], 1, "nowhere/b.png: ");
}

#[test]
fn an_output_names_its_format() {
    let folder = Folder::with_scene();
    for output in ["png:", "EXR:"] {
        let beginning = format!("--output {output}: does not name a file\n");
        folder.refused(&["render", "scene.toml", "-o", output], 2, &beginning);
    }
    for output in ["a", "a.jpg", ".exr", "scene.toml", "jpg:a", "/dev/null"] {
        let beginning = format!("--output {output}: does not name an image format\n");
        folder.refused(&["render", "scene.toml", "-o", output], 2, &beginning);
    }
    folder.refused(&["render", "scene.toml", "-o", "a.exr", "-o", "b"], 2, "--output b: ");
}

#[test]
fn statistics_do_not_replace_the_image_or_the_scene() {
    let folder = Folder::with_scene();
    for (stats, finding) in
        [("a.exr", "names the same file as another output"), ("scene.toml", "names a file that this command reads")]
    {
        let beginning = format!("--stats {stats}: {finding}\n");
        folder.refused(&["render", "scene.toml", "-o", "a.exr", "--stats", stats], 2, &beginning);
    }
}

#[test]
fn no_image_replaces_what_the_scene_is_read_from() {
    let mut data = Vec::new();
    let folder = with_model(|model| {
        let uri = model["buffers"][0]["uri"].as_str().and_then(|uri| uri.split_once(',')).expect("a data URI");
        data = STANDARD.decode(uri.1).expect("base64");
        model["buffers"][0]["uri"] = json!("data/room.bin");
        // Of no material, so that nobody reads it.
        model["images"] = json!([{ "uri": "rough%20wall.png" }]);
    });
    folder.write("data/room.bin", data);
    folder.write("rough wall.png", "a texture");
    folder.write("scene.toml", "geometry = \"room.gltf\"\n");
    let content = |name: &str| fs::read(folder.path(name)).expect("a file");
    let files = ["scene.toml", "room.gltf", "data/room.bin", "rough wall.png"];
    let before = files.map(content);
    for file in files {
        for output in [format!("png:{file}"), format!("exr:data/../{file}")] {
            let path = &output[4..];
            let beginning =
                format!("--output {path}: names a file that this command reads\n  help: give the result a file");
            folder.refused(&["render", "scene.toml", "-o", "a.exr", "-o", &output], 2, &beginning);
        }
        let beginning = format!("--stats {file}: names a file that this command reads\n");
        folder.refused(&["render", ".", "-o", "a.exr", "--stats", file], 2, &beginning);
    }
    for file in &files[1..] {
        let beginning = format!("--output {file}: names a file that this command reads\n");
        folder.refused(&["render", "room.gltf", "-o", &format!("png:{file}")], 2, &beginning);
    }
    assert_eq!(files.map(content), before);
}

#[cfg(unix)]
#[test]
fn a_folder_without_write_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with_scene();
    fs::create_dir(folder.path("locked")).expect("a folder");
    fs::set_permissions(folder.path("locked"), fs::Permissions::from_mode(0o555)).expect("own folder");
    if fs::write(folder.path("locked/probe"), "").is_ok() {
        return; // root may write anywhere
    }
    folder.refused(
        &["render", "scene.toml", "-o", "locked/a.exr"],
        1,
        "locked/a.exr: no file can be created in locked: ",
    );
}

#[test]
fn every_output_is_written() {
    let folder = Folder::with_scene();
    let args = ["render", "scene.toml", "-o", "a.exr", "-o", "b.PNG", "-o", "exr:c", "--stats", "s.json"];
    let run = folder.done(&args);
    assert_eq!(folder.names(), ["a.exr", "b.PNG", "c", "s.json", "scene.toml"]);
    assert!(run.stderr.starts_with("a.exr, b.PNG, c: mvnee, 4 samples per pixel in "), "{run}");
    assert_eq!(run.stdout, "");
    assert_eq!(folder.image("a.exr").channels, folder.image("c").channels);
}

#[test]
fn a_file_is_named_once() {
    let folder = Folder::with_scene();
    folder.write("sub/a.exr", "");
    for other in ["a.exr", "./a.exr", "sub/../a.exr", "png:a.exr"] {
        let beginning =
            format!("--output {}: names the same file as another output\n", other.trim_start_matches("png:"));
        folder.refused(&["render", "scene.toml", "-o", "a.exr", "-o", other], 2, &beginning);
    }
    for (stats, finding) in [
        ("sub/../a.exr", "names the same file as another output"),
        ("sub/../scene.toml", "names a file that this command"),
    ] {
        let beginning = format!("--stats {stats}: {finding}");
        folder.refused(&["render", ".", "-o", "a.exr", "--stats", stats], 2, &beginning);
    }
}

#[test]
fn without_an_output_the_scene_names_the_image() {
    let folder = Folder::empty();
    folder.write("fog.v2.toml", SCENE);
    folder.write("thick.v3/scene.toml", SCENE);
    folder.write("mist/scene.toml", SCENE);
    folder.write("scene/scene.toml", SCENE);
    folder.done(&["render", "scene"]);
    folder.done(&["render", "fog.v2.toml"]);
    folder.done(&["render", "thick.v3"]);
    folder.done(&["render", "mist/scene.toml"]);
    let scenes = ["fog.v2.toml", "mist", "scene", "thick.v3"];
    let images = folder.names().into_iter().filter(|name| !scenes.contains(&name.as_str()));
    assert_eq!(images.collect::<Vec<_>>(), ["fog.v2.exr", "mist.exr", "scene.exr", "thick.v3.exr"]);
    assert_eq!(header(&folder.image("thick.v3.exr"), "scene"), "thick.v3");
}

#[test]
fn a_scene_in_the_current_folder_is_called_after_the_folder() {
    let outside = Folder::empty();
    outside.write("dale/scene.toml", SCENE);
    for scene in [".", "scene.toml", "../dale/scene.toml", "./scene.toml"] {
        let run = super::support::Run::of(
            super::support::program(&outside).current_dir(outside.path("dale")).args(["render", scene]),
        );
        assert_eq!(run.code, Some(0), "{run}");
        fs::remove_file(outside.path("dale/dale.exr")).unwrap_or_else(|error| panic!("{error}: {run}"));
    }
}

#[test]
fn names_may_be_long_and_in_any_script() {
    let name = format!("Nebelstraße-雾-{}", "y".repeat(200));
    let folder = Folder::empty();
    folder.write(&format!("{name}.toml"), SCENE);
    folder.done(&["render", &format!("{name}.toml")]);
    assert_eq!(header(&folder.image(&format!("{name}.exr")), "scene"), name);
}

#[test]
fn an_existing_image_is_replaced_as_a_whole() {
    let folder = Folder::with_scene();
    folder.write("a.exr", "the image of yesterday");
    let mut reader = fs::File::open(folder.path("a.exr")).expect("a file");
    folder.done(&["render", "scene.toml", "-o", "a.exr"]);
    assert_eq!(plane(&folder.image("a.exr"), "R").len(), 64);
    #[cfg(unix)] // who had the old one open still reads it to its end
    {
        let mut old = String::new();
        reader.read_to_string(&mut old).expect("text");
        assert_eq!(old, "the image of yesterday");
    }
    assert_eq!(folder.names(), ["a.exr", "scene.toml"]);
}

#[cfg(unix)]
#[test]
fn images_have_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with_scene();
    let mut shell = std::process::Command::new("sh");
    let script = "umask 027; exec \"$0\" render scene.toml -o a.exr -o b.png --stats s.json --progress none";
    shell.args(["-c", script, env!("CARGO_BIN_EXE_fogbow")]).current_dir(folder.path("."));
    let status = shell.status().expect("a shell");
    assert!(status.success());
    for name in ["a.exr", "b.png", "s.json"] {
        let mode = fs::metadata(folder.path(name)).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o640, "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_is_overwritten_keeps_its_mode() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with_scene();
    for mode in [0o600, 0o644, 0o664, 0o755] {
        folder.write("a.exr", "");
        fs::set_permissions(folder.path("a.exr"), fs::Permissions::from_mode(mode)).expect("own file");
        folder.done(&["render", "scene.toml", "-o", "a.exr"]);
        let kept = fs::metadata(folder.path("a.exr")).expect("a file").permissions().mode() & 0o777;
        assert_eq!(kept, mode, "{kept:o} instead of {mode:o}");
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_its_owner_made_read_only_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with_scene();
    for name in ["a.exr", "s.json"] {
        folder.write(name, "precious");
        fs::set_permissions(folder.path(name), fs::Permissions::from_mode(0o444)).expect("own file");
    }
    std::os::unix::fs::symlink("a.exr", folder.path("link.exr")).expect("a link");
    folder.refused(&["render", "scene.toml", "-o", "a.exr"], 1, "a.exr: is read-only\n");
    folder.refused(&["render", "scene.toml", "-o", "link.exr"], 1, "link.exr: is read-only\n");
    folder.refused(&["render", "scene.toml", "-o", "b.exr", "--stats", "s.json"], 1, "s.json: is read-only\n");
    assert_eq!(fs::read_to_string(folder.path("a.exr")).expect("a file"), "precious");
}

#[cfg(unix)]
#[test]
fn a_file_of_somebody_else_in_a_folder_like_tmp_is_refused() {
    use std::os::unix::fs::{PermissionsExt, chown};
    use std::os::unix::process::CommandExt;

    use fogbow_testing::not_run::not_run;
    let folder = Folder::with_scene();
    folder.write("a.exr", "precious");
    let allow = |name: &str, mode: u32| {
        fs::set_permissions(folder.path(name), fs::Permissions::from_mode(mode)).expect("own file");
    };
    allow("a.exr", 0o666);
    allow("scene.toml", 0o644);
    allow(".", 0o1777);
    let (other, nobody) = (65_533, 65_534);
    if chown(folder.path("."), Some(other), None).and(chown(folder.path("a.exr"), Some(other), None)).is_err() {
        not_run("only root may give files away");
        return;
    }
    // Where others may not run what this user has built, they may run a copy.
    fs::copy(env!("CARGO_BIN_EXE_fogbow"), folder.path("fogbow")).expect("a copy");
    let render = |output: &str| {
        let mut command = std::process::Command::new(folder.path("fogbow"));
        command.current_dir(folder.path(".")).uid(nobody).gid(nobody).stdin(std::process::Stdio::null());
        let pipe = std::process::Stdio::piped;
        command.args(["render", "scene.toml", "-o", output, "--progress", "none"]).stdout(pipe()).stderr(pipe());
        super::support::Run::of(&mut command)
    };
    let run = render("a.exr");
    let message = "error: a.exr: belongs to another user, and its folder lets only owners replace files\n  help: ";
    assert!(run.code == Some(1) && run.stderr.starts_with(message), "{run}");
    assert_eq!(fs::read(folder.path("a.exr")).expect("a file"), b"precious");
    let run = render("b.exr");
    assert_eq!(run.code, Some(0), "{run}");
    assert_eq!(render("b.exr").code, Some(0), "one's own file may be replaced");
}

#[cfg(unix)]
#[test]
fn symbolic_links_are_followed_and_stay() {
    use std::os::unix::fs::symlink;
    let folder = Folder::with_scene();
    folder.write("elsewhere/a.exr", "");
    symlink("elsewhere/a.exr", folder.path("link.exr")).expect("a link");
    symlink("elsewhere/b.exr", folder.path("dangling.exr")).expect("a link");
    symlink("dangling.exr", folder.path("second.exr")).expect("a link");
    for (link, target) in [("link.exr", "a.exr"), ("dangling.exr", "b.exr"), ("second.exr", "b.exr")] {
        folder.done(&["render", "scene.toml", "-o", link]);
        assert!(folder.path(link).is_symlink());
        assert_eq!(plane(&folder.image(&format!("elsewhere/{target}")), "R").len(), 64);
    }
    symlink("circle.exr", folder.path("circle.exr")).expect("a link");
    folder.refused(
        &["render", "scene.toml", "-o", "circle.exr"],
        1,
        "circle.exr: cannot be used as a file: its symbolic links",
    );
    let beginning = "--output link.exr: names the same file as another output\n";
    folder.refused(&["render", "scene.toml", "-o", "elsewhere/a.exr", "-o", "link.exr"], 2, beginning);
}
