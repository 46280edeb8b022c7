//! Where the data is: in the file or beside it.

use std::fs;
use std::path::Path;

use fogbow::gltf;
use serde_json::json;
use tempfile::TempDir;

use super::support::{Builder, TRIANGLE, data_uri, glb, rgb, warnings};

/// A textured triangle.
fn textured() -> Builder {
    let mut file = Builder::new();
    let texture = file.texture(&rgb(1, 1, &[[9, 8, 7]]));
    file.add(
        "materials",
        json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorTexture": { "index": texture } } }),
    );
    let positions = file.floats(&TRIANGLE);
    let texcoords = file.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let attributes = json!({ "POSITION": positions, "TEXCOORD_0": texcoords });
    let mesh = file.mesh(json!({ "attributes": attributes, "material": 0 }));
    file.place(mesh);
    file
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn write(folder: &TempDir, name: &str, content: impl AsRef<[u8]>) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, content).expect("a file");
}

#[test]
fn data_is_the_same_wherever_it_is() {
    let file = textured();
    let expected = file.model();
    let folder = folder();
    write(&folder, "model.glb", file.glb());
    write(&folder, "embedded.gltf", file.gltf());
    write(&folder, "marked.gltf", [b"\xef\xbb\xbf\n ", file.gltf().as_slice()].concat());
    let mut external = file.json.clone();
    let image = rgb(1, 1, &[[9, 8, 7]]);
    external["buffers"] = json!([{ "uri": "data/b%C3%A4ch%20%25.bin", "byteLength": file.binary.len() }]);
    external["images"] = json!([{ "uri": "./data/rot.png" }]);
    write(&folder, "external.gltf", external.to_string());
    write(&folder, "data/bäch %.bin", [file.binary.as_slice(), b"and more"].concat());
    write(&folder, "data/rot.png", &image);
    external["buffers"] = json!([{ "uri": data_uri("x/y", &file.binary), "byteLength": file.binary.len() }]);
    external["images"] = json!([{ "uri": data_uri("image/png", &image) }]);
    write(&folder, "pictures.gltf", external.to_string());
    for name in ["model.glb", "embedded.gltf", "marked.gltf", "external.gltf", "pictures.gltf"] {
        let mut model = gltf::load(&folder.path().join(name)).unwrap_or_else(|error| panic!("{error}"));
        let files = std::mem::take(&mut model.files);
        assert_eq!(model, expected, "{name}");
        let beside = ["data/bäch %.bin", "./data/rot.png"].map(|file| folder.path().join(file));
        let named = if name == "external.gltf" { beside.to_vec() } else { Vec::new() };
        assert_eq!(files, named, "{name}");
    }
}

#[test]
fn containers_may_have_external_buffers_too() {
    let file = textured();
    let mut json = file.json.clone();
    let uri = data_uri("application/octet-stream", &file.binary);
    json["buffers"] = json!([{ "uri": uri, "byteLength": file.binary.len() }]);
    let bytes = glb(json.to_string().as_bytes(), b"not used");
    assert_eq!(gltf::parse("a.glb", &bytes, None), file.load());
}

#[test]
fn bytes_after_the_container_are_not_read() {
    let mut bytes = textured().glb();
    bytes.extend(b"junk");
    let model = gltf::parse("a.glb", &bytes, None).expect("valid");
    assert_eq!(warnings(&model), ["a.glb: container: bytes beyond the length that the header gives are ignored"]);
}

#[test]
fn a_file_that_many_objects_share_is_read_once() {
    let folder = folder();
    write(&folder, "same.bin", textured().binary);
    let uris = ["same.bin", "./same.bin", "s%61me.bin"].repeat(20_000);
    let buffers: Vec<_> = uris.iter().map(|uri| json!({ "uri": uri, "byteLength": 100 })).collect();
    write(&folder, "many.gltf", json!({ "asset": { "version": "2.0" }, "buffers": buffers }).to_string());
    assert!(gltf::load(&folder.path().join("many.gltf")).is_ok());
}

/// The error for a file whose buffer has this URI and length, without the folder's own name.
fn refused(folder: &TempDir, uri: &str, length: u64) -> String {
    let buffers = json!([{ "byteLength": 1 }, { "uri": uri, "byteLength": length }]);
    let json = json!({ "asset": { "version": "2.0" }, "buffers": buffers });
    write(folder, "a.glb", glb(json.to_string().as_bytes(), &[0; 4]));
    let path = folder.path().join("a.glb");
    let error = gltf::load(&path).expect_err(uri).to_string();
    assert!(error.starts_with(&format!("error: {}: buffer 1: ", path.display())), "{error}");
    error
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = folder();
    write(&folder, "folder/short.bin", [0; 5]);
    let cases = [
        ("no%20where.bin", 1, "its file \"no where.bin\" cannot be read: "),
        ("folder", 1, "its file \"folder\" is not a regular file"),
        ("folder/short.bin", 6, "its byteLength is 6, but there are 5 bytes of data"),
        ("folder/short.bin", u64::MAX, "its byteLength is 18446744073709551615, but there are 5 bytes of data"),
        ("https://nowhere.invalid/a.bin", 1, "has scheme \"https\", which is not supported"),
        ("file:///etc/hostname", 1, "has scheme \"file\""),
        ("C:/a.bin", 1, "has scheme \"C\""),
        ("/etc/hostname", 1, "is an absolute path"),
        ("../a.bin", 1, "leads out of the model's folder"),
        ("folder/%2E%2E/%2e%2E/a.bin", 1, "leads out of the model's folder"),
        ("..\\a.bin", 1, "leads out of the model's folder"),
        ("a%00b", 1, "cannot be read: "),
        ("%ff", 1, "is not UTF-8 when decoded"),
        ("", 1, "does not name a file"),
        ("data:text/plain,abc", 1, "its data URI of type \"text/plain\" is not base64"),
        ("data:;base64,a*c=", 1, "is not valid base64: "),
        ("data:;base64,AAAAA", 1, "is not valid base64: "),
        ("data:;base64", 1, "has no comma"),
        ("data:;base64,AAAA", 4, "its byteLength is 4, but there are 3 bytes of data"),
    ];
    for (uri, length, finding) in cases {
        let error = refused(&folder, uri, length);
        assert!(error.contains(finding) && error.contains("\n  help: "), "{uri}: {error}");
    }
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_rather_than_waited_for() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status();
    if made.is_ok_and(|status| status.success()) {
        assert!(refused(&folder, "pipe", 1).contains("its file \"pipe\" is not a regular file"));
        let path = folder.path().join("pipe");
        let error = gltf::load(&path).expect_err("a pipe").to_string();
        let says = format!("error: {}: is not a regular file\n  help: give the path of a readable ", path.display());
        assert!(error.starts_with(&says), "{error}");
    }
}

#[test]
fn models_that_are_not_there_are_named() {
    let error = gltf::load(Path::new("nowhere/a.glb")).expect_err("no file").to_string();
    assert!(error.starts_with("error: nowhere/a.glb: cannot be read: "), "{error}");
}

#[test]
fn models_from_memory_have_no_files_beside_them() {
    let mut file = Builder::new();
    file.json["buffers"] = json!([{ "uri": "a.bin", "byteLength": 1 }]);
    let bytes = file.json.to_string();
    let error = gltf::parse("a.gltf", bytes.as_bytes(), None).expect_err("no folder").to_string();
    assert!(
        error.starts_with("error: a.gltf: buffer 0: its file \"a.bin\" cannot be found: the model has no folder\n"),
        "{error}"
    );
}
