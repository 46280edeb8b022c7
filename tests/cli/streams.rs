//! Results that go into what is not a regular file: straight there, and what it was it stays.

#![cfg(target_os = "linux")]

use std::fs;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::process::Command;

use fogbow_testing::not_run::not_run;
use serde_json::Value;

use super::support::{Folder, Run, program};

/// Runs `script` by `shell`, in which `$0` is the program, and gives standard output.
#[track_caller]
fn script(folder: &Folder, shell: &str, script: &str) -> Vec<u8> {
    let mut command = Command::new(shell);
    command.args(["-c", script, env!("CARGO_BIN_EXE_fogbow")]).current_dir(folder.path("."));
    let output = command.output().expect("a shell");
    assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Width and height of a PNG in memory.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    (reader.info().width, reader.info().height)
}

#[test]
fn devices_stay_devices() {
    let folder = Folder::with_scene();
    let finding = "cannot be written: No space left on device";
    symlink("/dev/full", folder.path("full.png")).expect("a link");
    for args in [["--stats", "/dev/full"], ["-o", "png:/dev/full"], ["-o", "exr:/dev/full"], ["-o", "full.png"]] {
        let run = folder.run(&[&["render", "scene.toml", "-o", "a.exr"][..], &args].concat());
        assert!(run.code == Some(1) && run.stderr.contains(finding), "{run}");
        assert!(fs::metadata("/dev/full").expect("a device").file_type().is_char_device());
        assert_eq!(folder.image("a.exr").width, 8);
    }
    assert_eq!(folder.names(), ["a.exr", "full.png", "scene.toml"]);
    folder.done(&["render", "scene.toml", "-o", "exr:/dev/null", "-o", "png:/dev/null", "--stats", "/dev/null"]);
}

#[test]
fn a_pipe_or_standard_output_takes_one_result() {
    let folder = Folder::with_scene();
    let made = Command::new("mkfifo").arg("pipe").current_dir(folder.path(".")).status().expect("mkfifo");
    assert!(made.success());
    let another = "names the same file as another output\n";
    for (outputs, finding) in [
        (["-o", "png:pipe", "-o", "exr:./pipe"], format!("--output ./pipe: {another}")),
        (["-o", "png:pipe", "--stats", "pipe"], format!("--stats pipe: {another}")),
        (["-o", "png:/dev/stdout", "-o", "exr:/dev/fd/1"], format!("--output /dev/fd/1: {another}")),
        (["-o", "png:/dev/stdout", "--stats", "/proc/self/fd/1"], format!("--stats /proc/self/fd/1: {another}")),
        (["-o", "png:/dev/full", "--stats", "/dev/full"], format!("--stats /dev/full: {another}")),
    ] {
        folder.refused(&[&["render", "scene.toml"][..], &outputs].concat(), 2, &finding);
    }
    for (flags, name) in
        [(["-o", "png:/dev/stdout"], "--output /dev/stdout"), (["--stats", "/dev/fd/1"], "--stats /dev/fd/1")]
    {
        for style in ["openjd", "alf"] {
            let run = folder.run(&[&["render", "scene.toml", "-o", "a.exr", "--progress", style], &flags[..]].concat());
            let finding = format!("{name}: names standard output, where --progress {style} writes its lines");
            assert!(run.code == Some(2) && run.stderr.starts_with(&format!("error: {finding}\n")), "{run}");
            assert_eq!(run.stdout.contains(&format!("openjd_fail: {finding}; ")), style == "openjd", "{run}");
        }
    }
    // What standard output leads to counts, not what it is called.
    let script = "\"$0\" render scene.toml -o png:/dev/stdout -o exr:b.exr > b.exr 2> message; test $? = 2";
    self::script(&folder, "sh", script);
    let message = fs::read_to_string(folder.path("message")).expect("a message");
    assert!(message.starts_with(&format!("error: --output b.exr: {another}")), "{message}");
}

#[test]
fn a_named_pipe_gets_the_image() {
    let folder = Folder::with_scene();
    let text = "mkfifo pipe.png && ln -s pipe.png link.png || exit 1
        for name in pipe.png link.png; do
            \"$0\" render scene.toml -o $name --progress none & cat pipe.png > $name.copy; wait $! || exit 1
        done";
    script(&folder, "sh", text);
    assert!(fs::metadata(folder.path("pipe.png")).expect("a pipe").file_type().is_fifo());
    for copy in ["pipe.png.copy", "link.png.copy"] {
        assert_eq!(png_size(&fs::read(folder.path(copy)).expect("a file")), (8, 8));
    }
}

#[test]
fn standard_output_gets_what_is_named_after_it() {
    let folder = Folder::with_scene();
    for name in ["/dev/stdout", "/proc/self/fd/1", "/dev/fd/1"] {
        let image = script(&folder, "sh", &format!("\"$0\" render scene.toml -o png:{name}"));
        assert_eq!(png_size(&image), (8, 8));
        let image = script(&folder, "sh", &format!("\"$0\" render scene.toml -o exr:{name} | cat"));
        assert!(image.starts_with(&[0x76, 0x2f, 0x31, 0x01]), "no EXR image");
        let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--stats", name]);
        assert!(serde_json::from_str::<Value>(&run.stdout).is_ok_and(|stats| stats["samples"] == 256), "{run}");
    }
    let run = folder.done(&["render", "scene.toml", "-o", "a.exr", "--stats", "/dev/stderr", "--progress", "none"]);
    assert!(run.stdout.is_empty() && run.stderr.starts_with('{'), "{run}");
}

#[test]
fn what_a_shell_has_open_is_added_to() {
    let folder = Folder::with_scene();
    script(&folder, "sh", "echo first > log; \"$0\" render scene.toml -o a.exr --stats /dev/stdout >> log");
    script(&folder, "sh", "\"$0\" render scene.toml -o a.exr --stats /dev/fd/3 3>> log");
    let log = fs::read_to_string(folder.path("log")).expect("a file");
    assert!(log.starts_with("first\n{") && log.matches("\"stages\"").count() == 2, "{log}");
}

#[test]
fn process_substitution_gets_its_part() {
    let folder = Folder::with_scene();
    if Command::new("bash").arg("--version").output().is_err() {
        not_run("there is no bash");
        return;
    }
    let text = "\"$0\" render scene.toml -o png:>(cat > a.png) --stats >(cat > s.json); wait; sleep 0.2";
    script(&folder, "bash", text);
    assert_eq!(png_size(&fs::read(folder.path("a.png")).expect("a file")), (8, 8));
    assert!(fs::read_to_string(folder.path("s.json")).expect("a file").starts_with('{'));
}

#[test]
fn a_reader_that_leaves_early_is_an_error_and_no_crash() {
    let folder = Folder::with_scene();
    let text = "{ \"$0\" render scene.toml --size 400x400 --samples 1 -o exr:/dev/stdout; echo $? > code; } | true";
    script(&folder, "sh", text);
    assert_eq!(fs::read_to_string(folder.path("code")).expect("a code"), "1\n");
}

#[test]
fn sockets_are_refused() {
    let folder = Folder::with_scene();
    let _socket = std::os::unix::net::UnixListener::bind(folder.path("a.exr")).expect("a socket");
    folder.refused(&["render", "scene.toml", "-o", "a.exr"], 1, "a.exr: is a socket\n");
    let run = Run::of(program(&folder).args(["compare", "b.exr", "b.exr", "--png", "a.exr"]));
    assert_eq!(run.code, Some(2), "{run}");
}

#[test]
fn disks_are_refused() {
    let folder = Folder::with_scene();
    let made = Command::new("mknod").args(["a.exr", "b", "7", "99"]).current_dir(folder.path(".")).output();
    if !made.is_ok_and(|made| made.status.success()) {
        not_run("only root may make a device");
        return;
    }
    folder.refused(&["render", "scene.toml", "-o", "a.exr"], 1, "a.exr: is a disk, whose contents would be lost\n");
}
