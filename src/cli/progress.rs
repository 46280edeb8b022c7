//! Progress of a render: a bar, lines, or messages for other programs.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::figures::{duration, rate};
use super::{Progress, say, tell};

/// Time between plain lines and between messages.
const INTERVAL: Duration = Duration::from_secs(2);
/// Steps of the bar.
const STEPS: u64 = 10_000;

/// How far a render is.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Share of the work that is done, in [0, 1].
    pub fraction: f64,
    /// Camera paths so far.
    pub samples: u64,
    /// Time since the start.
    pub elapsed: Duration,
}

impl State {
    fn rate(&self) -> f64 {
        self.samples as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }

    /// Time left, if anything is known about it `[s]`.
    fn seconds_left(&self) -> Option<f64> {
        (self.fraction > 0.0).then(|| self.elapsed.as_secs_f64() * (1.0 - self.fraction) / self.fraction)
    }
}

/// Where progress goes.
pub struct Reporter {
    style: Progress,
    bar: ProgressBar,
    last: Option<Instant>,
}

impl Reporter {
    /// A reporter for a render called `name`.
    pub fn new(style: Progress, name: &str) -> Self {
        let style = match style {
            Progress::Auto if std::io::stderr().is_terminal() => Progress::Bar,
            Progress::Auto => Progress::Plain,
            chosen => chosen,
        };
        let bar = if style == Progress::Bar { ProgressBar::new(STEPS) } else { ProgressBar::hidden() };
        let template = "{prefix} [{bar:30}] {percent:>3} %  {msg}";
        let look = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(look.progress_chars("=> "));
        bar.set_prefix(name.to_string());
        Self { style, bar, last: None }
    }

    /// Shows `state`, not more often than is useful.
    pub fn update(&mut self, state: State) {
        if self.style == Progress::Bar {
            self.bar.set_position((state.fraction * STEPS as f64) as u64);
            self.bar.set_message(format!("{}  {}", rate(state.rate()), left(state.seconds_left())));
            return;
        }
        if state.elapsed < INTERVAL || self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        self.message(state);
    }

    /// Removes the bar; for other programs, says how the render ended.
    pub fn finish(&mut self, state: State) {
        self.bar.finish_and_clear();
        if matches!(self.style, Progress::Json | Progress::Openjd) {
            self.message(state);
        }
    }

    /// A line for people, unless they asked for none; wrapped up for other programs.
    pub fn line(&self, text: impl core::fmt::Display) {
        match self.style {
            Progress::None => {}
            Progress::Json => tell(json!({ "event": "status", "message": text.to_string() })),
            Progress::Openjd => inform(format!("openjd_status: {text}")),
            Progress::Auto | Progress::Bar | Progress::Plain => tell(text),
        }
    }

    fn message(&self, state: State) {
        let percent = 100.0 * state.fraction;
        match self.style {
            Progress::Plain => {
                tell(format!("{percent:5.1} %  {}  {}", rate(state.rate()), left(state.seconds_left())));
            }
            Progress::Json => {
                let message = json!({
                    "event": "progress",
                    "fraction": state.fraction,
                    "samples": state.samples,
                    "samples_per_second": state.rate(),
                    "seconds": state.elapsed.as_secs_f64(),
                    "seconds_left": state.seconds_left(),
                });
                tell(message);
            }
            Progress::Openjd => inform(format!("openjd_progress: {percent:.2}")),
            Progress::Auto | Progress::Bar | Progress::None => {}
        }
    }
}

/// A line to standard output for a program that watches; whether it reads it is its own affair.
fn inform(line: String) {
    let _ = say(line);
}

fn left(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "starting".into(), |seconds| format!("{} left", duration(seconds)))
}
