//! The bar in a terminal: `script` of util-linux gives the program one.

#![cfg(target_os = "linux")]

use std::process::Command;

use fogbow_testing::not_run::not_run;

use super::support::Folder;

/// What a render of about a second writes to a terminal of so many columns, which has others after half of it.
fn drawn(columns: [u32; 2]) -> Option<String> {
    drawn_with("--time 900ms", columns)
}

/// The same of a render with these flags.
fn drawn_with(flags: &str, columns: [u32; 2]) -> Option<String> {
    let folder = Folder::with_scene();
    let [before, after] = columns;
    let script = format!(
        "stty cols {before} rows 24; '{}' render scene.toml -o a.exr {flags} --progress bar & \
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
    pieces.filter(|piece| piece.contains(" %") && piece.contains('[')).collect()
}

#[test]
fn a_bar_fits_any_width_from_20_columns_on() {
    for columns in [20, 33, 55, 56, 95, 133] {
        let Some(written) = drawn([columns; 2]) else {
            not_run("there is no script");
            return;
        };
        let bars = bars(&written);
        assert!(bars.len() > 3, "{columns} columns: {written:?}");
        let steps = ["preparing", "choosing how to connect", "metering", "looking at long paths"];
        let tells = |bar: &str| bar.contains("samples/s") || steps.iter().any(|step| bar.ends_with(step));
        // On a busy machine, one may be drawn before there are samples to tell a rate of.
        assert_eq!(bars.last().is_some_and(|bar| tells(bar)), columns >= 56, "{columns} columns: {bars:?}");
        for bar in bars {
            let width = bar.chars().count();
            assert!(width <= columns as usize, "{width} of {columns} columns: {bar:?}");
            assert!(!tells(bar) || columns >= 56, "{columns} columns: {bar:?}");
            assert!(!bar.contains("noise") || columns >= 80, "{columns} columns: {bar:?}");
        }
    }
}

/// The number before the first of `unit` in a bar.
fn before(bar: &str, unit: &str) -> Option<f64> {
    bar.split_once(unit)?.0.rsplit(' ').next()?.parse().ok()
}

#[test]
fn a_bar_and_the_time_behind_it_belong_together() {
    // The pilot takes a part of the time, so that the bar does not begin empty.
    let flags = "--time 2s --technique bridge --max-segments 32 --set medium.scattering=3 --size 64x64";
    let Some(written) = drawn_with(flags, [100; 2]) else {
        not_run("there is no script");
        return;
    };
    let bars = bars(&written);
    assert!(!bars.is_empty(), "{written:?}");
    for bar in bars {
        let Some((percent, left)) = before(bar, " %").zip(before(bar, " s left")) else { continue };
        // The time is rounded to a tenth of a second, the share to a hundredth.
        assert!((percent / 100.0 + left / 2.0 - 1.0).abs() < 0.04, "{bar:?} in {written:?}");
    }
}

#[test]
fn a_bar_says_how_noisy_it_is_and_when_it_is_done() {
    let Some(written) = drawn_with("--noise 1e-7 --samples 1000000000 --time 1500ms --size 32x32", [110; 2]) else {
        not_run("there is no script");
        return;
    };
    let last = *bars(&written).last().expect("a bar");
    assert!(last.contains(" samples/s  noise ") && last.ends_with(" left of 1.5 s"), "{last:?}");
}

#[test]
fn a_bar_follows_a_terminal_that_becomes_narrower() {
    let Some(written) = drawn([100, 30]) else {
        not_run("there is no script");
        return;
    };
    let widths: Vec<_> = bars(&written).into_iter().map(|bar| bar.chars().count()).collect();
    assert!(widths.iter().any(|width| *width > 90) && widths.last().is_some_and(|width| *width <= 30), "{widths:?}");
    // The old bar went over four rows: three above the last one are cleared with it.
    assert!(written.contains("\x1b[3A\r\x1b[0J"), "{written:?}");
}
