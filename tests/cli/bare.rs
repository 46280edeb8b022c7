//! glTF files that are scenes by themselves.

use serde_json::{Value, json};

use super::models::{SMALL, model, render, with_model, with_scene};
use super::support::{Folder, Run, header, mean, plane};

#[test]
fn a_bare_model_is_rendered_as_a_scene_that_names_it() {
    let folder = with_scene("geometry = \"room.gltf\"\n");
    let flags = ["--size", "6x4", "--technique", "nee", "--samples", "16", "--progress", "none"];
    folder.done(&[&["render", "room.gltf", "-o", "a.exr"], &flags[..]].concat());
    folder.done(&[&["render", "scene.toml", "-o", "b.exr"], &flags[..]].concat());
    let [bare, named] = ["a.exr", "b.exr"].map(|name| folder.image(name));
    assert_eq!(bare.channels, named.channels);
    assert_eq!(header(&bare, "scene_hash"), header(&named, "scene_hash"));
    // The cone of the spot ends within the second column.
    for row in plane(&bare, "R").chunks(6) {
        assert!(row[0] == 0.0 && row[2..].iter().all(|value| *value > 0.0), "{row:?}");
    }
    folder.write("settings.toml", header(&bare, "settings"));
    folder.done(&["render", "settings.toml", "-o", "c.exr"]);
    assert_eq!(folder.image("c.exr").channels, bare.channels, "settings are a scene that gives the same image");
}

#[test]
fn a_model_without_meshes_is_fog_alone() {
    let folder = with_model(|model| model["scenes"][0]["nodes"] = json!([1, 2]));
    render(&folder, &["--set", "medium.scattering=1"]);
    assert!(mean(&folder.image("a.exr"), "R") > 0.0);
}

#[test]
fn another_geometry_takes_the_place_of_a_bare_model() {
    let folder = with_model(|_| {});
    folder.write("other.gltf", model().to_string().replace("\"Eye\"", "\"Lens\""));
    render(&folder, &["--set", "geometry=other.gltf", "--set", "camera=Lens"]);
    folder.refused(
        &["render", "room.gltf", "--set", "geometry=x"],
        2,
        "--set geometry=x: geometry is \"x\", but there is",
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_bare_model_may_have_a_name_that_is_not_text() {
    use std::os::unix::ffi::OsStrExt;
    let folder = with_model(|_| {});
    let name = std::ffi::OsStr::from_bytes(b"Stra\xdfe.gltf");
    std::fs::copy(folder.path("room.gltf"), folder.path(".").join(name)).expect("a copy");
    let run = Run::of(super::support::program(&folder).arg("render").arg(name).args(["-o", "a.exr"]).args(SMALL));
    assert_eq!(run.code, Some(0), "{run}");
}

#[test]
fn a_film_that_nobody_describes_has_the_shape_of_the_camera() {
    let size = |model: Folder| {
        let run = model.done(&["info", "room.gltf"]);
        run.stdout.split(['\n', ' ']).nth(1).expect("a size").to_string()
    };
    assert_eq!(size(with_model(|_| {})), "768x512");
    let square = |model: &mut Value| {
        drop(model["cameras"][0]["perspective"].as_object_mut().expect("a lens").remove("aspectRatio"))
    };
    assert_eq!(size(with_model(square)), "512x512");
    let folder = with_model(|model| model["cameras"][0]["perspective"]["aspectRatio"] = json!(1e300));
    folder.refused(&["render", "room.gltf"], 1, "room.gltf: film.size is [4294967295, 512]\n");
}

#[test]
fn flags_change_a_bare_model() {
    let folder = with_model(|_| {});
    render(&folder, &[]);
    let clear = header(&folder.image("a.exr"), "scene_hash").to_string();
    let radius = |folder: &Folder, args: &[&str]| {
        render(folder, args);
        header(&folder.image("a.exr"), "scene_hash").to_string()
    };
    assert_ne!(radius(&folder, &["--set", "medium.scattering=0.5"]), clear);
    assert_eq!(radius(&folder, &["--set", "punctual_radius=0.02"]), clear, "its only light has a radius of its own");
    let plain = with_model(|model| {
        drop(model["extensions"]["KHR_lights_punctual"]["lights"][0].as_object_mut().expect("a light").remove("extras"))
    });
    assert_eq!(radius(&plain, &["--set", "punctual_radius=0.05"]), clear);
    assert_ne!(radius(&plain, &[]), clear);
    folder.refused(
        &["render", "room.gltf", "--set", "punctual_radius=0"],
        2,
        "--set punctual_radius=0: punctual_radius is 0.0\n",
    );
    folder.refused(&["render", "room.gltf", "--set", "medium.g=1"], 2, "--set medium.g=1: ");
}

#[test]
fn keys_in_extras_are_those_of_a_scene_file() {
    let own = json!({ "medium": { "scattering": 0.5, "phase": { "type": "henyey_greenstein", "g": 0.5 } }, "film": { "size": [6, 4] }, "render": { "technique": "nee", "samples": 16 } });
    let folder = with_model(|model| model["scenes"][0]["extras"] = json!({ "fogbow": own }));
    let scene = "geometry = \"room.gltf\"\nfilm.size = [6, 4]\nmedium = { scattering = 0.5, phase = { type = \"henyey_greenstein\", g = 0.5 } }\nrender = { technique = \"nee\", samples = 16 }\n";
    folder.write("scene.toml", scene);
    folder.done(&["render", "room.gltf", "-o", "a.exr"]);
    folder.done(&["render", "scene.toml", "-o", "b.exr"]);
    let [bare, written] = ["a.exr", "b.exr"].map(|name| folder.image(name));
    assert_eq!(bare.channels, written.channels);
    assert_eq!(header(&bare, "settings"), header(&written, "settings"));
    folder.done(&["render", "room.gltf", "-o", "a.exr", "--set", "medium.scattering=0"]);
    assert_ne!(folder.image("a.exr").channels, bare.channels, "flags override them");
}

#[test]
fn keys_in_extras_are_checked_like_a_scene_file() {
    let refused = |own: Value, finding: &str| {
        let folder = with_model(|model| model["scenes"][0]["extras"] = json!({ "fogbow": own }));
        folder.refused(&["render", "room.gltf"], 1, &format!("room.gltf: extras.fogbow of the scene{finding}"));
    };
    refused(json!({ "mist": 1 }), ": mist: unknown key `mist`, expected one of");
    refused(json!({ "medium": { "scattering": 1, "G": 0 } }), ": medium.G: unknown key `G`");
    refused(json!({ "medium": { "scattering": "much" } }), ": medium.scattering: this is the string \"much\"");
    refused(json!({ "medium": { "scattering": [1, 1] } }), ": medium.scattering has 2 entries, not 3\n");
    refused(json!({ "medium": { "scattering": -1 } }), ": medium.scattering is -1.0\n");
    refused(json!({ "render": { "samples": 1.5 } }), ": render.samples: this is the number `1.5`");
    refused(json!({ "camera": "Lens" }), ": camera is \"Lens\", but room.gltf has no camera of that name");
    refused(json!({ "geometry": "other.glb" }), " has the key geometry, but");
    refused(json!({ "medium": { "scattering": null } }), " has null at \"medium.scattering\"");
    refused(json!("fog"), " is \"fog\", not an object");
    refused(json!(null), " is null, not an object");
}

#[test]
fn a_bare_model_is_described_with_its_contents() {
    let folder = with_model(|model| {
        model["nodes"][2]["camera"] = json!(0);
        model["nodes"][2]["translation"] = json!([0, 2, 0]);
        model["materials"] = json!([{ "emissiveFactor": [1, 1, 1] }]);
        model["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    let run = folder.done(&["info", "room.gltf"]);
    let lines = [
        "room: 768x512 pixels, 64 samples each, seed 1",
        "vacuum",
        "mesh \"Wall\": 2 triangles",
        "camera \"Eye\", used for the render",
        "camera \"Lamp\"",
        "light \"Lamp\": spot with a cone of 0 to 28.65 degrees and radius 0.05 m at 2 m from the camera (no medium in between)",
        "emissive meshes: 1, with 2 triangles",
    ];
    for line in lines {
        assert!(run.stdout.lines().any(|found| found == line), "{line:?} is missing\n{run}");
    }
}

#[test]
fn what_is_called_a_model_but_is_none_is_refused() {
    let folder = Folder::with_scene();
    folder.write("fog.glb", super::support::SCENE);
    folder.write("scene.GLTF", "{}");
    folder.refused(&["render", "fog.glb"], 1, "fog.glb: is not glTF: ");
    folder.refused(&["render", "scene.GLTF"], 1, "scene.GLTF: asset: is missing");
    folder.refused(&["info", "missing.glb"], 1, "missing.glb: cannot be read: ");
}

#[test]
fn a_bare_model_names_its_image() {
    let folder = with_model(|_| {});
    folder.write("den/scene.gltf", model().to_string());
    for scene in ["room.gltf", "den/scene.gltf"] {
        folder.done(&[&["render", scene, "--samples", "1"], &SMALL[..]].concat());
    }
    assert_eq!(folder.names(), ["den", "den.exr", "room.exr", "room.gltf"]);
}
