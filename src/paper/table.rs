//! Tables of plain numbers, and how people read them.

use serde::{Deserialize, Serialize};

use crate::figures::{csv_line, number, percent, plain, rate};

/// A table. Data files have its numbers as they are; reports round them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// The columns; the first one names the rows.
    pub columns: Vec<Column>,
    /// The rows, a cell for every column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Its title, with the unit of its numbers in brackets where they have one.
    pub title: String,
    /// How reports show them.
    pub show: Show,
}

/// How numbers are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Show {
    /// With so many significant digits.
    Digits(usize),
    /// As a rate per second, with the prefix of its size.
    Rate,
    /// After `+-`, behind the number of the column before, as its standard error.
    PlusMinus(usize),
    /// The same for a rate: in percent of it.
    RatePlusMinus,
    /// The lower end of an interval, behind the number of the column before; the upper end is the next column.
    From(usize),
    /// The upper end.
    To(usize),
}

impl Show {
    /// Whether it stands behind the column before.
    fn follows(self) -> bool {
        matches!(self, Self::PlusMinus(_) | Self::RatePlusMinus | Self::From(_) | Self::To(_))
    }
}

/// A cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number.
    Number(f64),
    /// A word.
    Text(String),
    /// Nothing is known, or there is no number.
    Nothing,
}

impl From<f64> for Cell {
    /// What is not finite is no number.
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Number(value) } else { Self::Nothing }
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, Self::from)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl Column {
    /// Columns of these titles.
    pub fn all<T: Into<String>>(columns: impl IntoIterator<Item = (T, Show)>) -> Vec<Self> {
        columns.into_iter().map(|(title, show)| Self { title: title.into(), show }).collect()
    }
}

impl Table {
    /// Adds the rows of another one with the same columns.
    pub fn add(&mut self, other: Self) {
        let rows = core::mem::take(&mut self.rows);
        *self = Self { rows: rows.into_iter().chain(other.rows).collect(), ..other };
    }

    /// The table as CSV, of plain numbers.
    pub fn csv(&self) -> String {
        let titles: Vec<_> = self.columns.iter().map(|column| column.title.as_str()).collect();
        let cell = |cell: &Cell| match cell {
            Cell::Number(value) => plain(*value),
            Cell::Text(text) => text.clone(),
            Cell::Nothing => String::new(),
        };
        let rows = self.rows.iter().map(|row| csv_line(row.iter().map(cell)));
        core::iter::once(csv_line(titles)).chain(rows).collect()
    }

    /// Titles as reports show them.
    pub fn titles(&self) -> Vec<&str> {
        self.columns.iter().filter(|column| !column.show.follows()).map(|column| column.title.as_str()).collect()
    }

    /// Rows as reports show them.
    pub fn texts(&self) -> Vec<Vec<String>> {
        self.rows.iter().map(|row| self.texts_of(row)).collect()
    }

    fn texts_of(&self, row: &[Cell]) -> Vec<String> {
        let mut texts: Vec<String> = Vec::new();
        let before = core::iter::once(&Cell::Nothing).chain(row);
        for ((cell, before), Column { show, .. }) in row.iter().zip(before).zip(&self.columns) {
            let text = shown(cell, *show, before);
            match texts.last_mut() {
                Some(last) if show.follows() => last.push_str(&text),
                _ => texts.push(if text.is_empty() { "-".into() } else { text }),
            }
        }
        texts
    }
}

fn shown(cell: &Cell, show: Show, before: &Cell) -> String {
    match (cell, show) {
        (Cell::Text(text), _) => text.clone(),
        (Cell::Nothing, _) => String::new(),
        (Cell::Number(value), Show::Digits(digits)) => number(*value, digits),
        (Cell::Number(value), Show::Rate) => rate(*value).replace(" samples/s", "/s"),
        (Cell::Number(value), Show::PlusMinus(digits)) => format!(" +- {}", number(*value, digits)),
        (Cell::Number(value), Show::RatePlusMinus) => match before {
            Cell::Number(rate) => format!(" +- {}", percent(value / rate)),
            _ => String::new(),
        },
        (Cell::Number(value), Show::From(digits)) => format!(" ({}", number(*value, digits)),
        (Cell::Number(value), Show::To(digits)) => format!(" to {})", number(*value, digits)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let digits = Show::Digits(3);
        let columns = [
            ("technique", digits),
            ("time [s]", digits),
            ("rate [1/s]", Show::Rate),
            ("standard error of the rate [1/s]", Show::RatePlusMinus),
            ("gain", digits),
            ("gain, from", Show::From(2)),
            ("gain, to", Show::To(2)),
        ];
        let numbers = |numbers: [f64; 6]| numbers.map(Cell::from).to_vec();
        let rows = vec![
            [vec![Cell::from("nee, \"lis\"")], numbers([0.123_456, 1.5e6, 1e4, 4.125, 3.0, 5.0])].concat(),
            [vec![Cell::from("path")], numbers([1.0, 2e-9, f64::NAN, f64::INFINITY, f64::NAN, f64::NAN])].concat(),
        ];
        Table { caption: "not in it".into(), columns: Column::all(columns), rows }
    }

    #[test]
    fn data_are_plain_numbers() {
        let lines: Vec<_> = table().csv().lines().map(String::from).collect();
        assert_eq!(
            lines[0],
            "technique,time [s],rate [1/s],standard error of the rate [1/s],gain,\"gain, from\",\"gain, to\""
        );
        assert_eq!(lines[1], "\"nee, \"\"lis\"\"\",0.123456,1500000,10000,4.125,3,5");
        assert_eq!(lines[2], "path,1,2e-9,,,,");
        let json = serde_json::to_value(table()).expect("JSON");
        assert_eq!(json["rows"][0][2], 1.5e6);
        assert!(json["rows"][1][3].is_null());
        assert_eq!(serde_json::from_value::<Table>(json).expect("a table"), table());
    }

    #[test]
    fn reports_round_them_and_set_errors_beside_them() {
        let table = table();
        assert_eq!(table.titles(), ["technique", "time [s]", "rate [1/s]", "gain"]);
        let texts = table.texts();
        assert_eq!(texts[0], ["nee, \"lis\"", "0.123", "1.50 M/s +- 0.667 %", "4.12 (3 to 5)"]);
        assert_eq!(texts[1], ["path", "1", "0/s", "-"]);
    }
}
