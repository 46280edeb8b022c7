//! `fogbow paper`

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::support::{Folder, Run, program};

/// The scenes of the repository.
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");

/// Makes `items` in the folder `out`.
#[track_caller]
fn made(folder: &Folder, items: &[&str], more: &[&str]) -> Run {
    made_in("1s", folder, items, more)
}

/// The same in another time.
fn made_in(budget: &str, folder: &Folder, items: &[&str], more: &[&str]) -> Run {
    let fixed = ["--budget", budget, "--scenes", SCENES, "--threads", "1", "-o", "out"];
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

/// Whether all cells of a table are numbers or empty, but for its first `named` columns.
#[track_caller]
fn numeric(table: &str, named: usize) {
    // Names have commas, and are quoted then.
    for line in table.lines().skip(1) {
        let numbers =
            line.rsplit('"').next().expect("a part").split(',').skip(if line.contains('"') { named } else { 0 });
        let numbers = numbers.skip(if line.contains('"') { 0 } else { named });
        for cell in numbers.filter(|cell| !cell.is_empty()) {
            assert!(cell.parse::<f64>().is_ok_and(f64::is_finite), "{cell} of {line} in\n{table}");
        }
    }
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
    assert_eq!(rows[9].as_array().expect("cells")[..2], [0.9, 0.083_082_8]);
    assert_eq!(rows[12].as_array().expect("cells")[..2], [json!(0.99), Value::Null]);
    let claims = data(&folder, "table1")["claims"].as_array().expect("claims").clone();
    assert!(claims.len() == 2 && claims.iter().all(|claim| claim["verdict"] == "agrees"), "{claims:?}");
    let table = fs::read_to_string(folder.path("out/table1/table1.csv")).expect("a table");
    assert!(table.starts_with("g,\"published sigma, MFP 1 m [m]\",our sigma [m],"), "{table}");
    numeric(&table, 0);
    assert_eq!(table.lines().count(), 14);
    let plot = fs::read_to_string(folder.path("out/table1/sigma.csv")).expect("the data of the plot");
    assert!(plot.starts_with("curve,look,mean cosine g,\"sigma [m], MFP 1 m\"\nours,line,0,"), "{plot}");
    numeric(&plot, 2);
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
fn references_are_kept_and_added_to() {
    let folder = Folder::empty();
    let samples = |more: &[&str]| {
        made(&folder, &["fig11"], more);
        let pictures = data(&folder, "fig11")["galleries"][0]["pictures"].as_array().expect("pictures").clone();
        assert_eq!(pictures.len(), 6);
        let notes: Vec<_> =
            pictures.iter().map(|picture| picture["note"].as_str().expect("a note").to_string()).collect();
        assert!(notes.iter().all(|note| note.starts_with("RMSE ") && note.contains(" samples")), "{notes:?}");
        let rmse = |note: &String| {
            note[5..].split([',', ' ']).next().and_then(|text| text.parse::<f64>().ok()).expect("a number")
        };
        assert!(notes[..5].is_sorted_by(|a, b| rmse(a) <= rmse(b)), "{notes:?}");
        let count = notes[5].split(' ').nth(2).and_then(|text| text.parse::<f64>().ok()).expect("a number");
        (count, pictures[5]["rmse"].as_f64().expect("an error"), rmse(&notes[0]))
    };
    let (few, error, least) = samples(&[]);
    let (more, smaller, _) = samples(&["--references", "3s"]);
    assert!(
        (more > few && smaller < error) || error < least / 3.0,
        "{few} samples, {error}; {more} samples, {smaller}"
    );
}

#[test]
fn rows_say_what_they_are_made_of() {
    let folder = Folder::empty();
    // The smallest pictures have to be small enough for some samples in every turn.
    made_in("4s", &folder, &["fig11"], &[]);
    let table = &data(&folder, "fig11")["tables"][0];
    assert!(table["caption"].as_str().expect("a caption").contains("its own error"), "{table}");
    let titles: Vec<_> =
        table["columns"].as_array().expect("columns").iter().map(|column| column["title"].clone()).collect();
    let place =
        |title: &str| titles.iter().position(|known| known == title).unwrap_or_else(|| panic!("{title}: {titles:?}"));
    for row in table["rows"].as_array().expect("rows") {
        let number = |title: &str| row[place(title)].as_f64().expect("a number");
        assert!(
            number("turns") >= 8.0 && number("time [s]") > 0.0 && number("preparation before it [s]") > 0.0,
            "{row}"
        );
        let [low, value, high] = [", from", "", ", to"].map(|end| number(&format!("efficiency over NEE{end}")));
        assert!(low <= value && value <= high, "{row}");
        let file = row[0].as_str().expect("a name").to_lowercase().replace("bridges, aligned", "aligned");
        let image = folder.image(&format!("out/fig11/{file}.exr"));
        let seconds: f64 = super::support::header(&image, "seconds").parse().expect("seconds");
        assert!((seconds - number("time [s]") - number("preparation before it [s]")).abs() < 2e-3, "{row}: {seconds}");
    }
    let times: Vec<f64> = table["rows"]
        .as_array()
        .expect("rows")
        .iter()
        .map(|row| row[place("time [s]")].as_f64().expect("a number"))
        .collect();
    let (least, most) = (times.iter().copied().fold(f64::MAX, f64::min), times.iter().copied().fold(0.0, f64::max));
    assert!(most < 1.5 * least, "equal time: {times:?}");
    let turns = fs::read_to_string(folder.path("out/fig11/turns.csv")).expect("turns");
    assert_eq!(turns.lines().filter(|line| line.starts_with("nee,")).count(), 8, "{turns}");
    numeric(&turns, 1);
    numeric(&fs::read_to_string(folder.path("out/fig11/table1.csv")).expect("a table"), 1);
    numeric(&fs::read_to_string(folder.path("out/fig11/rmse.csv")).expect("a plot"), 2);
}

/// Makes `items` of which each shows something, with plain numbers as data.
#[track_caller]
fn shown(items: &[&str]) {
    let folder = Folder::empty();
    made(&folder, items, &[]);
    let page = report(&folder);
    for item in items {
        assert!(page.contains(&format!("<section id=\"{item}\">")), "{item}");
        let section = data(&folder, item);
        let plots = section["plots"].as_array().expect("plots");
        assert!(!plots.is_empty() || *item == "peers", "{item}");
        for file in fs::read_dir(folder.path(&format!("out/{item}"))).expect("a folder") {
            let path = file.expect("a file").path();
            let name = path.file_name().and_then(|name| name.to_str()).expect("a name").to_string();
            if path.extension().is_some_and(|ending| ending == "csv") {
                let text = fs::read_to_string(&path).expect("data");
                let named = if text.starts_with("curve,look,") { 2 } else { 1 };
                assert!(text.lines().count() > 1, "{item}/{name}");
                numeric(&text, named);
            }
        }
        for gallery in section["galleries"].as_array().expect("galleries") {
            let error = |picture: &Value| picture["rmse"].as_f64();
            assert!(
                gallery["has_reference"] == false
                    || gallery["pictures"].as_array().expect("pictures").iter().all(|one| error(one).is_some())
            );
        }
    }
}

#[test]
fn pictures_at_equal_time_are_made() {
    shown(&["fig1"]);
}

/// These take longer than their budget: all of their renders are prepared, and every setting takes a few samples.
#[cfg(feature = "long")]
mod longer {
    use super::shown;

    #[test]
    fn techniques_are_compared_at_equal_time() {
        shown(&["fig12"]);
    }

    #[test]
    fn renders_of_a_plate_are_compared() {
        shown(&["fig8"]);
    }

    #[test]
    fn phase_functions_are_compared() {
        shown(&["fig9"]);
    }

    #[test]
    fn clouds_are_compared() {
        shown(&["fig10"]);
    }

    #[test]
    fn costs_are_measured() {
        shown(&["scaling"]);
    }
}

/// Without Mitsuba there are recorded figures, until Mitsuba is there.
#[cfg(unix)]
#[test]
fn peers_are_made_again_once_mitsuba_is_there() {
    let folder = Folder::empty();
    let make = |path: &Path| {
        let mut command = program(&folder);
        command.args(["paper", "peers", "--budget", "1s", "--scenes", SCENES, "-o", "out"]).env("PATH", path);
        let output = command.output().expect("the program starts");
        let text = String::from_utf8(output.stderr).expect("UTF-8");
        assert!(output.status.success(), "{text}");
        text
    };
    let nowhere = folder.path("nowhere");
    make(&nowhere);
    let section = data(&folder, "peers");
    assert!(
        section["lacks"].as_str().is_some_and(|reason| reason.starts_with("python3 cannot be started")),
        "{section}"
    );
    for scene in ["fog-facing", "fog-perpendicular", "fog-small", "dense-plate", "cornell-fog", "cloud-box"] {
        let table = section["tables"].as_array().expect("tables").iter().find(|table| {
            table["caption"]
                .as_str()
                .is_some_and(|caption| caption.starts_with(scene) && caption.contains("2026-11-28"))
        });
        assert!(table.is_some_and(|table| table["rows"].as_array().is_some_and(|rows| rows.len() == 5)), "{scene}");
    }
    assert!(make(&nowhere).contains("  is there\n"));
    // A python3 that can import whatever it is asked to, and nothing else.
    folder.write("bin/python3", "#!/bin/sh\ntest \"$1\" = -c\n");
    let script = folder.path("bin/python3");
    fs::set_permissions(&script, std::os::unix::fs::PermissionsExt::from_mode(0o755)).expect("permissions");
    let again = make(script.parent().expect("a folder"));
    assert!(!again.contains("is there"), "{again}");
}

/// Interrupts `items` some time after they have begun; the exit code and what is said.
#[cfg(unix)]
fn interrupted(folder: &Folder, items: &[&str], after: std::time::Duration) -> (Option<i32>, String) {
    use super::stop::{ended_by, wait_for_handlers};
    let mut command = program(folder);
    command.arg("paper").args(items).args(["--budget", "10min", "--scenes", SCENES, "--threads", "1", "-o", "out"]);
    let child = command.spawn().expect("the program starts");
    wait_for_handlers(&child);
    std::thread::sleep(after);
    let (code, _, stderr) = ended_by("-INT", child);
    (code, stderr)
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_what_is_made_and_the_command_goes_on() {
    let folder = Folder::empty();
    for (item, milliseconds) in [("fig7", 0), ("fig7", 300), ("fig11", 1500), ("peers", 100)] {
        let after = std::time::Duration::from_millis(milliseconds);
        let (code, stderr) = interrupted(&folder, &["table1", item], after);
        assert_eq!(code, Some(130), "{item}: {stderr}");
        assert!(!stderr.contains("error") && !stderr.contains("panicked"), "{item}: {stderr}");
        assert!(!folder.path(&format!("out/{item}/data.json")).exists() || item == "peers", "{item}: {stderr}");
    }
    let rest = made(&folder, &["fig7"], &[]);
    assert!(rest.stderr.contains("made in"), "{rest}");
    // What was made before the interruption is there.
    let rest =
        folder.done(&["paper", "table1", "--budget", "10min", "--scenes", SCENES, "--threads", "1", "-o", "out"]);
    assert!(rest.stderr.contains("  is there\n"), "{rest}");
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
    let none = ["paper", "table1", "--budget", "0s", "-o", "out"];
    folder.refused(&none, 2, "--budget 0s: is no time to render anything\n");
    folder.write("file", "in the way");
    folder.refused(&["paper", "table1", "-o", "file/out"], 1, "file/out/references: cannot be made: ");
    let late = folder.refused(&["paper", "table1", "-o", "out", "--summary", "file/docs"], 1, "--summary file/docs: ");
    assert!(!folder.path("out/table1").exists(), "before anything is made: {late}");
    let run = folder.run(&["paper", "fig7", "--scenes", "nowhere", "-o", "out"]);
    assert_eq!(run.code, Some(1), "{run}");
    assert!(
        run.stderr.contains("error: --scenes nowhere: there is no scene cornell-fog in nowhere\n  help: "),
        "{run}"
    );
}
