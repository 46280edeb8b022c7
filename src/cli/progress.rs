//! Progress of a render: a bar, lines, or messages for other programs.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::json;

use super::bar::Bar;
use super::{Progress, say, tell};
use crate::figures::{duration, rate};
use crate::scene::Loading;
use crate::session::State;

/// Time between plain lines and between messages.
const INTERVAL: Duration = Duration::from_secs(2);

/// What is going on: rate and time left, for people.
fn outlook(state: &State) -> String {
    if state.preparing {
        return "preparing".into();
    }
    let left =
        state.seconds_left.map_or_else(|| "estimating the time".into(), |left| format!("{} left", duration(left)));
    format!("{}  {left}", rate(state.rate()))
}

/// Where progress goes.
pub struct Reporter {
    style: Progress,
    bar: Bar,
    last: Option<Instant>,
    /// The file that is being read.
    file: Option<PathBuf>,
}

/// What a file is called in a bar or a line.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

impl Reporter {
    /// A reporter without a bar, so far.
    pub fn new(style: Progress) -> Self {
        let style = match style {
            Progress::Auto if std::io::stderr().is_terminal() => Progress::Bar,
            Progress::Auto => Progress::Plain,
            chosen => chosen,
        };
        Self { style, bar: Bar::hidden(), last: None, file: None }
    }

    /// A reporter that has nothing to say but to people at a terminal.
    pub fn for_terminals() -> Self {
        Self::new(if std::io::stderr().is_terminal() { Progress::Bar } else { Progress::None })
    }

    /// From now on it is about a render called `name`.
    pub fn begin(&mut self, name: &str) {
        if self.style == Progress::Bar {
            self.bar = Bar::new(name);
        }
    }

    /// Shows how far a file has been read, `elapsed` after loading began.
    pub fn loading(&mut self, loading: &Loading, elapsed: Duration) {
        let Loading { file, fraction } = loading;
        let is_new = self.file.as_ref() != Some(file);
        if is_new {
            self.loaded();
            self.begin(&file_name(file));
            self.file = Some(file.clone());
        }
        // Once all of it has been read, its densities are looked through.
        let doing = if *fraction < 1.0 { "loading" } else { "preparing" };
        if self.style == Progress::Bar {
            self.bar.update(*fraction, doing.into());
            return;
        }
        if !is_new && self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        let (name, percent) = (file_name(file), 100.0 * fraction);
        match self.style {
            Progress::Plain => tell(format!("{percent:5.1} %  {doing} {name}")),
            Progress::Json => tell(json!({
                "event": "progress",
                "phase": "loading",
                "file": name,
                "fraction": fraction,
                "seconds": elapsed.as_secs_f64(),
            })),
            Progress::Openjd if is_new => inform(format!("openjd_status: loading {name}")),
            Progress::Openjd | Progress::Auto | Progress::Bar | Progress::None => {}
        }
    }

    /// Ends what is shown of files.
    pub fn loaded(&mut self) {
        self.bar.finish();
        (self.bar, self.last, self.file) = (Bar::hidden(), None, None);
    }

    /// Shows `state`, not more often than is useful.
    pub fn update(&mut self, state: State) {
        if self.style == Progress::Bar {
            self.bar.update(state.fraction, outlook(&state));
            return;
        }
        let is_early = state.elapsed < INTERVAL || state.fraction >= 1.0;
        if is_early || self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        self.message(state);
    }

    /// Removes the bar; for other programs, says how the render ended.
    pub fn finish(&mut self, state: State) {
        self.bar.finish();
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

    /// A warning, also for those who asked for no progress.
    pub fn warn(&self, text: impl core::fmt::Display) {
        match self.style {
            Progress::Json => tell(json!({ "event": "warning", "message": text.to_string() })),
            _ => self.bar.above(|| tell(format!("warning: {text}"))),
        }
    }

    fn message(&self, state: State) {
        let percent = 100.0 * state.fraction;
        match self.style {
            Progress::Plain => tell(format!("{percent:5.1} %  {}", outlook(&state))),
            Progress::Json => {
                let message = json!({
                    "event": "progress",
                    "phase": if state.preparing { "preparing" } else { "rendering" },
                    "fraction": state.fraction,
                    "samples": state.samples,
                    "samples_per_second": state.rate(),
                    "seconds": state.elapsed.as_secs_f64(),
                    "seconds_left": state.seconds_left,
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
