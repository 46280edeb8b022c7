//! Progress of a render: a bar, lines, or messages for other programs.

use std::io::IsTerminal;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use super::bar::{Bar, Outlooks};
use super::{Progress, say, tell};
use crate::error::Error;
use crate::figures::{duration, percent, rate};
use crate::live::Turn;
use crate::scene::Loading;
use crate::session::{State, Step, Target};

/// Time between plain lines and between messages.
const INTERVAL: Duration = Duration::from_secs(2);

/// What is going on, for people: which frame, rate, noise, time left, and what that is until.
fn outlooks(state: &State, turn: Option<Turn>) -> Outlooks {
    let frame = turn.map_or_else(String::new, |turn| format!("{turn}  "));
    if state.preparing {
        let step = state.step.map_or("preparing", Step::name);
        let long = if state.step.is_some() { format!("{frame}preparing: {step}") } else { format!("{frame}{step}") };
        return Outlooks { short: format!("{frame}{step}"), long };
    }
    let noise = state.noise.map_or_else(String::new, |noise| format!("noise {}  ", percent(noise)));
    let rate = state.rate().map_or_else(String::new, |of| format!("{}  ", rate(of)));
    let left = state.seconds_left.map(|left| format!("{} left", duration(left)));
    let is_told = |target: &Target| state.limits.are_several() || matches!(target, Target::Noise(_));
    let until = state.expected.filter(|target| left.is_some() && is_told(target)).map_or_else(String::new, until);
    let left = left.unwrap_or_else(|| "estimating the time".into());
    let short = if turn.is_some() { format!("{frame}{left}") } else { format!("{rate}{left}") };
    Outlooks { short, long: format!("{frame}{rate}{noise}{left}{until}") }
}

/// What a render goes on until.
fn until(target: Target) -> String {
    match target {
        Target::Samples(samples) => format!(" to {samples} samples"),
        Target::Time(time) => format!(" of {}", duration(time.as_secs_f64())),
        Target::Noise(noise) => format!(" to {}", percent(noise)),
    }
}

/// Where progress goes.
pub struct Reporter {
    style: Progress,
    bar: Bar,
    last: Option<Instant>,
    /// When what is shown began.
    start: Instant,
    /// The file that is being read.
    file: Option<PathBuf>,
    /// Which frame it is about, if it is one of several.
    turn: Option<Turn>,
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
        Self { style, bar: Bar::hidden(), last: None, start: Instant::now(), file: None, turn: None }
    }

    /// A reporter that has nothing to say but to people at a terminal.
    pub fn for_terminals() -> Self {
        Self::new(if std::io::stderr().is_terminal() { Progress::Bar } else { Progress::None })
    }

    /// From now on it is about this frame.
    pub fn turn(&mut self, turn: Option<Turn>) {
        self.turn = turn;
    }

    /// From now on it is about a render called `name`.
    pub fn begin(&mut self, name: &str) {
        self.start = Instant::now();
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
            self.bar.update(*fraction, Outlooks::of(doing));
            return;
        }
        if !is_new && self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        let (name, percent) = (file_name(file), 100.0 * fraction);
        match self.style {
            Progress::Plain | Progress::Alf => tell(format!("{percent:5.1} %  {doing} {name}")),
            Progress::Json => tell(json!({
                "event": "progress",
                "phase": "loading",
                "file": name,
                "fraction": fraction,
                "seconds": elapsed.as_secs_f64(),
            })),
            Progress::Openjd if is_new => inform_openjd("status", format_args!("loading {name}")),
            Progress::Openjd | Progress::Auto | Progress::Bar | Progress::None => {}
        }
    }

    /// Ends what is shown of files or parts.
    pub fn loaded(&mut self) {
        self.bar.finish();
        (self.bar, self.last, self.file) = (Bar::hidden(), None, None);
    }

    /// Shows `state`, not more often than is useful.
    pub fn update(&mut self, state: State) {
        if self.style == Progress::Bar {
            self.bar.update(state.fraction, outlooks(&state, self.turn));
            return;
        }
        // What was resumed has taken its time before.
        let is_early = self.start.elapsed() < INTERVAL || state.fraction >= 1.0;
        if is_early || self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        self.message(state);
    }

    /// Shows that `done` of `all` parts are merged, `elapsed` after that began.
    pub fn merging(&mut self, done: usize, all: usize, elapsed: Duration) {
        let fraction = done as f64 / all as f64;
        if self.style == Progress::Bar {
            self.bar.update(fraction, Outlooks::of(&format!("{done} of {all} parts")));
            return;
        }
        let is_early = elapsed < INTERVAL || self.last.is_some_and(|last| last.elapsed() < INTERVAL);
        if is_early && done < all {
            return;
        }
        self.last = Some(Instant::now());
        let percent = 100.0 * fraction;
        match self.style {
            Progress::Plain if done < all => tell(format!("{percent:5.1} %  {done} of {all} parts")),
            Progress::Json => tell(json!({
                "event": "progress",
                "phase": "merging",
                "fraction": fraction,
                "parts": done,
                "seconds": elapsed.as_secs_f64(),
            })),
            Progress::Openjd | Progress::Alf if done < all => self.percent(percent),
            Progress::Openjd | Progress::Alf | Progress::Plain | Progress::Auto | Progress::Bar | Progress::None => {}
        }
    }

    /// So much is done, for programs that read no more than that.
    fn percent(&self, percent: f64) {
        match self.style {
            Progress::Openjd => inform_openjd("progress", format_args!("{percent:.2}")),
            // Whole numbers, of which 100 is the end.
            Progress::Alf => inform(format!("ALF_PROGRESS {}%", percent.floor())),
            _ => {}
        }
    }

    /// Removes the bar; for other programs, says how far the render is now that there will be no more samples. Where
    /// all is told in percent, 100 of them are told by [`written()`](Self::written).
    pub fn finish(&mut self, state: State) {
        self.bar.finish();
        match self.style {
            Progress::Json => self.message(state),
            Progress::Openjd | Progress::Alf if state.fraction < 1.0 => self.message(state),
            _ => {}
        }
    }

    /// All results are there.
    pub fn written(&self) {
        self.percent(100.0 * self.of_all(1.0));
    }

    /// A line for people, unless they asked for none; wrapped up for other programs.
    pub fn line(&self, text: impl core::fmt::Display) {
        match self.style {
            Progress::None => {}
            Progress::Json => tell(json!({ "event": "status", "message": text.to_string() })),
            Progress::Openjd => inform_openjd("status", text),
            Progress::Auto | Progress::Bar | Progress::Plain | Progress::Alf => tell(text),
        }
    }

    /// Where the render can be seen: from this machine, if at all of its addresses.
    pub fn serving(&self, address: SocketAddr) {
        let (is_everywhere, port) = (address.ip().is_unspecified(), address.port());
        let here = match address.ip() {
            IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
            IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
            ip => ip,
        };
        let url = format!("http://{}/", SocketAddr::new(here, port));
        let others =
            if is_everywhere { format!(", from elsewhere at port {port} of this machine") } else { String::new() };
        match self.style {
            Progress::Json => {
                tell(json!({ "event": "serving", "url": url, "listens_at": address.to_string() }));
            }
            _ => self.line(format!("the render can be seen at {url}{others}")),
        }
    }

    /// A warning, also for those who asked for no progress.
    pub fn warn(&self, text: impl core::fmt::Display) {
        match self.style {
            Progress::Json => tell(json!({ "event": "warning", "message": text.to_string() })),
            _ => self.bar.above(|| tell(format!("warning: {text}"))),
        }
    }

    /// An error, also for those who asked for no progress.
    pub fn error(&self, error: &Error) {
        self.style.error(error);
    }

    fn message(&self, state: State) {
        match self.style {
            Progress::Plain => {
                tell(format!("{:5.1} %  {}", 100.0 * state.fraction, outlooks(&state, self.turn).long));
            }
            Progress::Json => {
                let mut message = Map::from_iter([("event".to_string(), json!("progress"))]);
                message.extend(state.figures());
                message.extend(self.turn.map(|turn| ("frame".to_string(), turn.figures())));
                tell(Value::Object(message));
            }
            Progress::Openjd | Progress::Alf => self.percent(100.0 * self.of_all(state.fraction)),
            Progress::Auto | Progress::Bar | Progress::None => {}
        }
    }

    /// Share of all frames that is done, where this share of the one at hand is.
    fn of_all(&self, fraction: f64) -> f64 {
        let of_turn = |Turn { place, count, .. }: Turn| (f64::from(place - 1) + fraction) / f64::from(count);
        self.turn.map_or(fraction, of_turn)
    }
}

impl Progress {
    /// Prints `error`, also for other programs.
    fn error(self, error: &Error) {
        let Error { place, finding, remedy, .. } = error;
        match self {
            Progress::Json => tell(json!({ "event": "error", "place": place, "message": finding, "help": remedy })),
            Progress::Openjd => {
                tell(error);
                inform_openjd("fail", format_args!("{place}: {finding}; {remedy}"));
            }
            _ => tell(error),
        }
    }

    /// Prints `error` and gives its exit code.
    pub fn fail(self, error: &Error) -> ExitCode {
        self.error(error);
        ExitCode::from(error.exit_code())
    }
}

/// A message of Open Job Description, which is one line whatever `text` is.
fn inform_openjd(kind: &str, text: impl core::fmt::Display) {
    let text = text.to_string();
    let lines: Vec<_> = text.lines().map(str::trim).collect();
    inform(format!("openjd_{kind}: {}", lines.join(" ")));
}

/// A line to standard output for a program that watches; whether it reads it is its own affair.
fn inform(line: String) {
    let _ = say(line);
}
