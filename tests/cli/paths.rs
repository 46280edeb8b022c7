//! `fogbow paths`

use super::support::{Folder, Run};

/// Vertices of the paths in the table called `name`, path by path, with who made them.
#[track_caller]
fn table(folder: &Folder, name: &str) -> Vec<Vec<(String, [f64; 3])>> {
    let text = std::fs::read_to_string(folder.path(name)).expect("a table");
    let mut paths: Vec<Vec<(String, [f64; 3])>> = Vec::new();
    for line in text.lines().skip(1) {
        let cells: Vec<_> = line.split(',').collect();
        let [path, vertex, maker, x, y, z] = cells[..] else { panic!("{line}") };
        let place = |text: &str| text.parse::<f64>().expect("a number");
        if vertex == "0" {
            paths.push(Vec::new());
        }
        assert_eq!(path, (paths.len() - 1).to_string(), "{line}");
        paths[path.parse::<usize>().expect("a number")].push((maker.into(), [x, y, z].map(place)));
    }
    paths
}

/// Draws paths of the small scene, whose light is a disk of radius 1.5 at z = 3.
#[track_caller]
fn drawn(folder: &Folder, more: &[&str]) -> Run {
    let outputs = ["-o", "a.svg", "-o", "a.csv", "-o", "a.png"];
    folder.done(&[&["paths", "scene.toml", "--from", "0,0,0", "--dir", "1,0,1"], more, &outputs].concat())
}

#[test]
fn paths_leave_as_asked_and_end_on_the_light_whatever_the_technique() {
    let folder = Folder::with_scene();
    for technique in ["path", "nee", "mvnee", "omnee", "bridge", "lis"] {
        drawn(&folder, &["--technique", technique, "--count", "7"]);
        let paths = table(&folder, "a.csv");
        assert_eq!(paths.len(), 7, "{technique}");
        for path in paths {
            let [(_, first), (_, second), .., (maker, [x, y, z])] = &path[..] else { panic!("{technique}: {path:?}") };
            assert_eq!(*first, [0.0; 3]);
            assert!(
                (second[0] - second[2]).abs() < 1e-6 && second[0] > 0.0 && second[1] == 0.0,
                "{technique}: {path:?}"
            );
            assert!((z - 3.0).abs() < 1e-5 && x.hypot(*y) <= 1.5 + 1e-5, "{technique}: {path:?}");
            assert_eq!(maker, "connection");
        }
    }
}

#[test]
fn a_walk_is_as_long_as_asked() {
    let folder = Folder::with_scene();
    drawn(&folder, &["--technique", "nee", "--walk", "4", "--count", "3"]);
    for path in table(&folder, "a.csv") {
        let walked = path.iter().filter(|(maker, _)| maker == "walk").count();
        assert_eq!((path.len(), walked), (6, 5));
    }
}

#[test]
fn a_drawing_is_valid_and_has_every_path() {
    let folder = Folder::with_scene();
    drawn(&folder, &["--count", "6"]);
    let text = std::fs::read_to_string(folder.path("a.svg")).expect("a drawing");
    let drawing = roxmltree::Document::parse(&text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(drawing.root_element().tag_name().name(), "svg");
    let named = |name: &'static str| drawing.descendants().filter(move |node| node.has_tag_name(name));
    // The paths, the light, the arrow, and the scale bar.
    assert_eq!(named("polyline").count(), 6 + 1 + 1 + 1);
    assert!(named("text").any(|node| node.text().is_some_and(|text| text.contains("6 paths by mvnee"))), "{text}");
    let (info, pixels) = folder.png("a.png");
    assert_eq!(pixels.len() as u32, 3 * info.width * info.height);
    assert!(pixels.iter().any(|channel| *channel < 100));
}

#[test]
fn the_same_seed_draws_the_same_paths() {
    let folder = Folder::with_scene();
    let text = |seed: &str| {
        drawn(&folder, &["--seed", seed]);
        std::fs::read_to_string(folder.path("a.csv")).expect("a table")
    };
    assert_eq!(text("1"), text("1"));
    assert_ne!(text("1"), text("2"));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = Folder::with_scene();
    let cases: [(&[&str], i32, &str); 8] = [
        (&["-o", "a.jpg"], 2, "--output a.jpg: names neither a drawing nor a table\n"),
        (&["-o", "a.svg", "--from", "1,2"], 2, "--from 1,2: is no point\n"),
        (&["-o", "a.svg", "--dir", "0,0,0"], 2, "--dir 0,0,0: is no direction\n"),
        (&["-o", "a.svg", "--to", "lamp"], 2, "--to lamp: is no light\n"),
        (&["-o", "a.svg", "--to", "light[1]"], 2, "--to light[1]: the scene has one light with a place\n"),
        (&["-o", "a.svg", "--technique", "nee,mvnee"], 2, "--technique nee,mvnee: names several techniques\n"),
        (&["-o", "nowhere/a.svg"], 1, "nowhere/a.svg: no file can be created in nowhere: "),
        (&["-o", "a.svg", "--from", "0,0,9", "--dir", "0,0,1", "--technique", "nee"], 1, ""),
    ];
    for (more, code, beginning) in cases {
        folder.refused(&[&["paths", "scene.toml"], more].concat(), code, beginning);
    }
}

/// A light beyond what the scene lets a technique connect over.
#[test]
fn a_limit_that_no_connection_overcomes_is_named() {
    let folder = Folder::with_scene();
    let short = ["paths", "scene.toml", "--from", "0,0,0", "--dir", "0,1,0", "--count", "1", "-o", "a.svg"];
    for (technique, key) in [("mvnee", "render.mesc"), ("bridge", "render.bridge_mesc")] {
        let limit = format!("{key}=0.01");
        let run = folder.run(&[&short[..], &["--technique", technique, "--set", &limit]].concat());
        assert_eq!(run.code, Some(1), "{run}");
        let limits = format!("which is 3 m away: {key} = 0.01 lets them connect over ");
        assert!(run.stderr.contains(&limits), "{run}");
        let (_, remedy) = run.stderr.split_once("  help: raise the limit, for example with --set ").expect("a remedy");
        let enough = remedy.split(';').next().expect("a key with its value");
        assert!(enough.starts_with(key), "{run}");
        folder.done(&[&short[..], &["--technique", technique, "--set", enough]].concat());
    }
}
