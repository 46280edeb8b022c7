//! What renders came to: errors, rates, and what they are worth beside each other.

use super::ratio::{Channels, Ratio, Turn, Worth};
use super::rmse::{self, Rmse};
use super::run::Run;
use super::section::{Cell, Column, Show, Table};
use super::turns::{Log, Renders};
use crate::figures::number;
use crate::film::Pixel;

/// A render, and how far it is from the reference.
pub struct Measured {
    /// What it is called.
    pub name: String,
    /// What its file is called, without its ending.
    pub file: String,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Seconds that went before the first sample, if they were measured.
    pub preparation: Option<f64>,
    /// Samples per pixel.
    pub samples: f64,
    /// Pixels.
    pub pixels: f64,
    /// Its error, if there is a reference.
    pub rmse: Option<Rmse>,
    /// Its turns.
    pub turns: Vec<Turn>,
    /// Seconds and error of its image after every turn.
    pub course: Vec<(f64, f64)>,
    /// The render, if it is fogbow's own.
    pub run: Option<Run>,
}

impl Measured {
    /// What `run` came to, against `reference`.
    pub fn of_run(file: impl Into<String>, mut run: Run, reference: Option<&[Pixel]>) -> Self {
        let pixels = run.film().region().pixels() as f64;
        let rmse = reference.map(|reference| Rmse::of(run.film().pixels().map(|pixel| pixel.mean), reference));
        let own = Self::of_log(run.name.clone(), file.into(), pixels, run.log(), reference);
        Self { preparation: Some(run.preparation), rmse, run: Some(run), ..own }
    }

    /// What another program came to whose last image is in `log`.
    pub fn of_log(name: String, file: String, pixels: f64, log: &Log, reference: Option<&[Pixel]>) -> Self {
        let rmse = reference.map(|reference| Rmse::of(rmse::wide(&log.means), reference));
        let (turns, &Log { seconds, samples, .. }) = (log.turns(reference), log);
        let course = reference.map(|reference| log.course(reference)).unwrap_or_default();
        Self { name, file, seconds, preparation: None, samples, pixels, rmse, turns, course, run: None }
    }

    /// Camera paths per second.
    pub fn rate(&self) -> f64 {
        self.samples * self.pixels / self.seconds
    }

    /// Standard error of the rate, by its spread over turns.
    pub fn rate_error(&self) -> f64 {
        let rates: Vec<_> = self.turns.iter().map(|turn| turn.samples * self.pixels / turn.seconds).collect();
        let count = rates.len() as f64;
        let mean = rates.iter().sum::<f64>() / count;
        (rates.iter().map(|rate| (rate - mean).powi(2)).sum::<f64>() / (count * (count - 1.0))).sqrt()
    }

    /// What is printed on its picture.
    pub fn note(&self) -> String {
        let rmse = self.error().map_or_else(String::new, |error| format!("RMSE {}, ", number(error, 3)));
        let samples =
            if self.samples == 1.0 { "1 sample".into() } else { format!("{} samples", number(self.samples, 4)) };
        format!("{rmse}{samples} in {} s", number(self.seconds, 3))
    }

    /// The error of its image.
    pub fn error(&self) -> Option<f64> {
        self.rmse.map(|rmse| rmse.root())
    }

    /// Mean squared error of one sample per pixel: what its error would be after one.
    pub fn variance(&self, channels: Channels) -> f64 {
        let squared = |rmse: Rmse| if channels == Channels::Green { rmse.green } else { rmse.squared };
        rmse::positive(self.rmse.map_or(f64::NAN, squared)) * self.samples
    }

    /// One over the product of squared error and time per camera path: what a second is worth.
    pub fn efficiency(&self, channels: Channels) -> f64 {
        self.rate() / self.variance(channels)
    }

    /// Share of the time that it needed all in all, what it was prepared in included, in which it rendered.
    fn rendering(&self) -> f64 {
        self.seconds / (self.seconds + self.preparation.unwrap_or(0.0))
    }

    /// Its row in a table, beside `base`.
    pub fn row(&self, base: Option<&Self>) -> Vec<Cell> {
        let gain = base.map_or(Ratio::UNKNOWN, |base| self.over(Worth::Second, Channels::All, base));
        let all_in_all = base.map_or(f64::NAN, |base| gain.value * self.rendering() / base.rendering());
        // An interval without end says nothing.
        let [low, high] = if gain.interval[1].is_finite() { gain.interval } else { [f64::NAN; 2] };
        let numbers = [
            self.samples,
            self.seconds,
            self.preparation.unwrap_or(f64::NAN),
            self.turns.len() as f64,
            self.rate(),
            self.rate_error(),
            self.error().unwrap_or(f64::NAN),
            self.variance(Channels::All),
            gain.value,
            low,
            high,
            all_in_all,
        ];
        core::iter::once(Cell::from(self.name.as_str())).chain(numbers.map(Cell::from)).collect()
    }

    /// Columns of [`Self::row`].
    pub fn columns(base: &str) -> Vec<Column> {
        let gain = format!("efficiency over {base}");
        Column::all([
            ("technique".to_string(), Show::Digits(1)),
            ("samples per pixel".into(), Show::Digits(4)),
            ("time [s]".into(), Show::Digits(3)),
            ("preparation before it [s]".into(), Show::Digits(2)),
            ("turns".into(), Show::Digits(2)),
            ("rate [1/s]".into(), Show::Rate),
            ("standard error of the rate [1/s]".into(), Show::RatePlusMinus),
            ("RMSE".into(), Show::Digits(3)),
            ("variance of a sample".into(), Show::Digits(3)),
            (gain.clone(), Show::Digits(3)),
            (format!("{gain}, from"), Show::From(2)),
            (format!("{gain}, to"), Show::To(2)),
            ("with its preparation".into(), Show::Digits(3)),
        ])
    }

    /// Every turn of `all`, as a table.
    pub fn all_turns<'a>(all: impl IntoIterator<Item = &'a Self>) -> Table {
        let rows = |one: &'a Self| {
            let row = |(turn, found): (usize, &Turn)| {
                let Turn { seconds, samples, squared, green } = *found;
                let numbers = [turn as f64 + 1.0, seconds, samples, squared, green].map(Cell::from);
                core::iter::once(Cell::from(one.file.as_str())).chain(numbers).collect()
            };
            one.turns.iter().enumerate().map(row).collect::<Vec<_>>()
        };
        let squared = "mean squared error of its own image";
        Table {
            caption: "Turns of all renders.".into(),
            columns: Column::all([
                ("image".to_string(), Show::Digits(1)),
                ("turn".into(), Show::Digits(3)),
                ("time [s]".into(), Show::Digits(3)),
                ("samples per pixel".into(), Show::Digits(4)),
                (squared.into(), Show::Digits(3)),
                (format!("{squared}, in green"), Show::Digits(3)),
            ]),
            rows: all.into_iter().flat_map(rows).collect(),
        }
    }

    /// What it is worth over what `other` is, which took turns with it.
    pub fn over(&self, worth: Worth, channels: Channels, other: &Self) -> Ratio {
        let ratio = Ratio::of(worth, channels, &self.turns, &other.turns);
        // The whole image knows its error better than its parts know theirs; of these is the interval.
        let value = match worth {
            Worth::Rate => self.rate() / other.rate(),
            Worth::Sample => other.variance(channels) / self.variance(channels),
            Worth::Second => self.efficiency(channels) / other.efficiency(channels),
        };
        let shift = value / ratio.value;
        if !(shift.is_finite() && shift > 0.0) {
            return Ratio { value, ..Ratio::UNKNOWN };
        }
        Ratio { value, interval: ratio.interval.map(|end| end * shift) }
    }
}
