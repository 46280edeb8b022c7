//! Files: the same every time, and valid.

use fogbow_scenes::{glb, models};

use crate::{
    glb::{File, index},
    scene::{SCENES, folder, read},
};

#[test]
fn committed_files_are_what_is_generated() {
    for model in models() {
        let file = folder(model.name).join(format!("{}.glb", model.name));
        let committed = std::fs::read(&file).expect("a readable file");
        let generated = glb::encode(&model).expect("a file");
        assert!(committed == generated, "{}: run cargo run --release -p fogbow-scenes", file.display());
    }
}

#[test]
fn scenes_name_files_that_are_there() {
    for scene in SCENES {
        let table = read(scene);
        let geometry = table["geometry"].as_str().expect("a file name");
        assert!(folder(scene).join(geometry).is_file(), "{scene}: {geometry}");
    }
}

#[test]
fn bounds_are_those_of_the_numbers() {
    for model in models() {
        let file = File::read(model.name);
        let surfaces = file.surfaces();
        assert_eq!(surfaces.len(), model.objects.len());
        for (surface, mesh) in surfaces.iter().zip(file.json["meshes"].as_array().expect("meshes")) {
            let accessor = index(&mesh["primitives"][0]["attributes"]["POSITION"]);
            let bound = |name: &str, i: usize| file.json["accessors"][accessor][name][i].as_f64().expect("a number");
            let stated = |name: &str| [0, 1, 2].map(|i| bound(name, i) as f32);
            let [low, high] = surface.bounds().map(|bound| bound.as_vec3().to_array());
            assert_eq!((stated("min"), stated("max")), (low, high), "{}: {}", model.name, surface.name);
        }
    }
}

#[test]
fn the_buffer_is_covered_by_its_views() {
    for model in models() {
        let file = File::read(model.name);
        let views = file.json["bufferViews"].as_array().expect("views");
        let end = views.iter().fold(0, |end: usize, view| {
            assert_eq!(index(&view["byteOffset"]), end.next_multiple_of(4), "{}", model.name);
            index(&view["byteOffset"]) + index(&view["byteLength"])
        });
        assert_eq!(index(&file.json["buffers"][0]["byteLength"]), end.next_multiple_of(4));
        assert_eq!(file.bytes.len(), end.next_multiple_of(4));
    }
}

#[test]
fn every_vertex_is_used_and_every_triangle_has_an_area() {
    for model in models() {
        for surface in File::read(model.name).surfaces() {
            let mut used = vec![false; surface.positions.len()];
            surface.triangles.as_flattened().iter().for_each(|&index| used[index] = true);
            assert!(used.iter().all(|&used| used), "{}: {}", model.name, surface.name);
            let least = surface.areas().map(|area| area.length()).fold(f64::INFINITY, f64::min);
            assert!(least > 1e-5, "{}: {}: a triangle of {least} m^2", model.name, surface.name);
        }
    }
}
