//! `fogbow paper`

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::support::{Folder, Run};

/// The scenes of the repository.
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");

/// Makes `items` in the folder `out`.
#[track_caller]
fn made(folder: &Folder, items: &[&str], more: &[&str]) -> Run {
    let fixed = ["--budget", "1s", "--scenes", SCENES, "--threads", "1", "-o", "out"];
    folder.done(&[&["paper"], items, &fixed, more].concat())
}

/// What `item` found.
#[track_caller]
fn data(folder: &Folder, item: &str) -> Value {
    let text = fs::read_to_string(folder.path(&format!("out/{item}/data.json"))).expect("data");
    serde_json::from_str(&text).expect("JSON")
}

/// The report.
#[track_caller]
fn report(folder: &Folder) -> String {
    fs::read_to_string(folder.path("out/index.html")).expect("a report")
}

/// When a file was last written.
#[track_caller]
fn written(path: &Path) -> std::time::SystemTime {
    path.metadata().and_then(|metadata| metadata.modified()).expect("a file")
}

#[test]
fn table1_stands_beside_the_published_values() {
    let folder = Folder::empty();
    made(&folder, &["table1"], &[]);
    let rows = data(&folder, "table1")["tables"][0]["rows"].as_array().expect("rows").clone();
    assert_eq!(rows.len(), 13);
    assert_eq!(rows[9].as_array().expect("cells")[..2], ["0.90", "0.0830828"]);
    assert_eq!(rows[12].as_array().expect("cells")[..2], ["0.99", "-"]);
    let claims = data(&folder, "table1")["claims"].as_array().expect("claims").clone();
    assert!(claims.len() == 2 && claims.iter().all(|claim| claim["agrees"] == true), "{claims:?}");
    let table = fs::read_to_string(folder.path("out/table1/table1.csv")).expect("a table");
    assert!(table.starts_with("g,\"published sigma, MFP 1 m\",ours,") && table.lines().count() == 14, "{table}");
    let page = report(&folder);
    assert!(page.contains("0.0830828") && page.contains("<section id=\"table1\">"));
}

#[test]
fn a_report_has_everything_in_it() {
    let folder = Folder::empty();
    made(&folder, &["fig7", "fig3"], &[]);
    let page = report(&folder);
    let positions = ["<section id=\"fig3\">", "<section id=\"fig7\">"].map(|section| page.find(section));
    assert!(positions[0].is_some() && positions[0] < positions[1], "in the order of the paper, whatever is asked for");
    for source in page.match_indices("src=\"").map(|(place, _)| &page[place + 5..place + 16]) {
        assert!(source.starts_with("data:image/"), "{source}");
    }
    assert!(!page.contains("http://") && !page.contains("https://"), "nothing is asked of the network");
    for file in ["nee.exr", "mvnee-4.exr", "halves.exr", "difference.png", "histogram.svg", "data.json", "table1.csv"] {
        assert!(folder.path(&format!("out/fig7/{file}")).is_file(), "{file} is missing");
    }
    assert_eq!(data(&folder, "fig7")["galleries"][0]["pictures"].as_array().map(Vec::len), Some(3));
}

#[test]
fn what_is_there_is_not_made_again() {
    let folder = Folder::empty();
    made(&folder, &["fig7", "table1"], &[]);
    let image = folder.path("out/fig7/nee.exr");
    let first = written(&image);
    let again = made(&folder, &["fig7"], &[]);
    assert!(again.stderr.contains("  is there\n"), "{again}");
    assert_eq!(written(&image), first);
    assert!(report(&folder).contains("<section id=\"table1\">"), "items that are not named stay");
    // Other settings, or an incomplete item: it is made.
    fs::remove_file(folder.path("out/fig7/histogram.svg")).expect("a file");
    let missing = made(&folder, &["fig7"], &[]);
    assert!(!missing.stderr.contains("is there"), "{missing}");
    let other = folder.done(&["paper", "fig7", "--budget", "2s", "--scenes", SCENES, "--threads", "1", "-o", "out"]);
    assert!(!other.stderr.contains("is there"), "{other}");
}

#[test]
fn references_are_made_once() {
    let folder = Folder::empty();
    let run = made(&folder, &["fig11"], &[]);
    assert_eq!(run.stderr.matches("reference of spotlight").count(), 1, "{run}");
    fs::remove_file(folder.path("out/fig11/data.json")).expect("a file");
    let again = made(&folder, &["fig11"], &[]);
    assert!(again.stderr.contains("made in") && !again.stderr.contains("reference of"), "{again}");
    let pictures = data(&folder, "fig11")["galleries"][0]["pictures"].as_array().expect("pictures").clone();
    assert_eq!(pictures.len(), 6);
    let notes: Vec<_> = pictures.iter().map(|picture| picture["note"].as_str().expect("a note")).collect();
    assert!(notes[..5].iter().all(|note| note.starts_with("RMSE ") && note.ends_with(" samples")), "{notes:?}");
    let rmse = |note: &str| note[5..].split(',').next().and_then(|text| text.parse::<f64>().ok()).expect("a number");
    assert!(notes[..5].is_sorted_by(|a, b| rmse(a) <= rmse(b)), "{notes:?}");
}

#[test]
fn a_summary_is_markdown_with_small_pictures() {
    let folder = Folder::empty();
    made(&folder, &["table1", "fig3"], &["--summary", "docs"]);
    let text = fs::read_to_string(folder.path("docs/README.md")).expect("a summary");
    assert!(
        text.contains("| 0.90 | 0.0830828 |") && text.contains("![") && text.contains("--summary docs/paper"),
        "{text}"
    );
    for line in text.lines().filter_map(|line| line.strip_prefix("![")) {
        let file = line.rsplit_once('(').and_then(|(_, file)| file.strip_suffix(')')).expect("a file");
        let size = folder.path(&format!("docs/{file}")).metadata().expect("a picture").len();
        assert!(size < 300_000, "{file} has {size} bytes");
    }
}

#[test]
fn what_cannot_be_made_is_refused() {
    let folder = Folder::empty();
    let unknown = folder.refused(&["paper", "fig4", "-o", "out"], 2, "ITEM fig4: is not an item of the paper\n");
    assert!(
        unknown.stderr.contains("fig1, table1, fig3, fig7, fig8, fig9, fig10, fig11, fig12, peers, scaling"),
        "{unknown}"
    );
    folder.refused(&["paper", "table1", "--budget", "soon", "-o", "out"], 2, "--budget soon: is not a duration\n");
    folder.write("file", "in the way");
    folder.refused(&["paper", "table1", "-o", "file/out"], 1, "file/out/references: cannot be made: ");
    let run = folder.run(&["paper", "fig7", "--scenes", "nowhere", "-o", "out"]);
    assert_eq!(run.code, Some(1), "{run}");
    assert!(
        run.stderr.contains("error: --scenes nowhere: there is no scene cornell-fog in nowhere\n  help: "),
        "{run}"
    );
}
