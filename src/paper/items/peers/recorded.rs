//! What was measured once, for where Mitsuba is not installed.

use crate::paper::section::{Cell, Column, Section, Show, Table};

/// The figures, a table for every scene and day.
const RECORDED: &str = include_str!("recorded.csv");

/// The section that stands for what could not be made, for this `reason`.
pub fn section(reason: &str) -> Section {
    let rows: Vec<Vec<&str>> = RECORDED.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let tables = rows.chunk_by(|a, b| a[0] == b[0]).map(table).collect();
    Section {
        lacks: Some(reason.into()),
        text: vec![
            format!("Mitsuba was not run: {reason}. These are figures that were recorded before."),
            "With `pip install mitsuba numpy` this item renders six scenes with both programs in turn. Where Mitsuba \
             does not find LLVM, the environment variable DRJIT_LIBLLVM_PATH names it."
                .into(),
        ],
        tables,
        ..Section::default()
    }
}

/// The table of the rows of one scene.
fn table(rows: &[Vec<&str>]) -> Table {
    let number = |text: &str| text.parse::<f64>().map_or(Cell::Nothing, Cell::from);
    let row = |row: &Vec<&str>| {
        let [_, name, rate, variance, efficiency, absolute, _, _] = row[..] else { return Vec::new() };
        vec![Cell::from(name), number(absolute), number(rate), number(variance), number(efficiency)]
    };
    Table {
        caption: format!("{}; Mitsuba 3.9, llvm, volpath; {}, two threads; {}.", rows[0][0], rows[0][7], rows[0][6]),
        columns: Column::all([
            ("program or technique", Show::Digits(1)),
            ("rate [1/s]", Show::Rate),
            ("rate over Mitsuba's", Show::Digits(2)),
            ("variance of a sample", Show::Digits(3)),
            ("efficiency over Mitsuba's", Show::Digits(3)),
        ]),
        rows: rows.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::items::peers::SCENES;

    #[test]
    fn every_scene_that_is_rendered_has_figures() {
        let section = section("for a test");
        for scene in SCENES {
            let table = section.tables.iter().find(|table| table.caption.starts_with(scene)).expect("a table");
            assert_eq!(table.rows.len(), 5, "{scene}");
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{scene}");
            assert!(
                table.rows.iter().flatten().skip(1).all(|cell| *cell != Cell::Nothing),
                "{scene}: {:?}",
                table.rows
            );
        }
    }
}
