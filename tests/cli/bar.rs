//! The bar in a terminal: `script` of util-linux gives the program one.

#![cfg(target_os = "linux")]

use std::process::Command;

use super::support::Folder;

/// What a render of about a second writes to a terminal of so many columns, which has others after half of it.
fn drawn(columns: [u32; 2]) -> Option<String> {
    let folder = Folder::with_scene();
    let [before, after] = columns;
    let script = format!(
        "stty cols {before} rows 24; '{}' render scene.toml -o a.exr --time 900ms --progress bar & \
         sleep 0.5; stty cols {after}; wait",
        env!("CARGO_BIN_EXE_fogbow")
    );
    let mut command = Command::new("script");
    command.args(["-qec", &script, "/dev/null"]).current_dir(folder.path("."));
    let output = command.stdin(std::process::Stdio::null()).output().ok()?;
    assert!(output.status.success(), "{output:?}");
    Some(String::from_utf8(output.stdout).expect("UTF-8"))
}

/// The bars among what was written: from the first bracket to the last column.
fn bars(written: &str) -> Vec<&str> {
    let pieces = written.split(['\r', '\n', '\x1b']).map(|piece| piece.trim_start_matches("[2K").trim_end());
    pieces.filter(|piece| piece.contains(" %") && piece.contains('[') && !piece.contains("noise")).collect()
}

#[test]
fn a_bar_fits_any_width_from_20_columns_on() {
    for columns in [20, 33, 55, 56, 95, 133] {
        let Some(written) = drawn([columns; 2]) else {
            println!("not run: there is no script");
            return;
        };
        let bars = bars(&written);
        assert!(bars.len() > 3, "{columns} columns: {written:?}");
        for bar in bars {
            let width = bar.chars().count();
            assert!(width <= columns as usize, "{width} of {columns} columns: {bar:?}");
            let tells = bar.contains("samples/s") || bar.ends_with("preparing");
            assert_eq!(tells, columns >= 56, "{columns} columns: {bar:?}");
        }
    }
}

#[test]
fn a_bar_follows_a_terminal_that_becomes_narrower() {
    let Some(written) = drawn([100, 30]) else {
        println!("not run: there is no script");
        return;
    };
    let widths: Vec<_> = bars(&written).into_iter().map(|bar| bar.chars().count()).collect();
    assert!(widths.iter().any(|width| *width > 90) && widths.last().is_some_and(|width| *width <= 30), "{widths:?}");
    // The old bar went over four rows: three above the last one are cleared with it.
    assert!(written.contains("\x1b[3A\r\x1b[0J"), "{written:?}");
}
