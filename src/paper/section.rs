//! What an item says: everything that the report shows of it, as it stands in `data.json`.

use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use crate::figures::{duration, number};

use super::load::Load;
pub use super::ratio::Verdict;
pub use super::table::{Cell, Column, Show, Table};

/// An item of the report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// Its name.
    pub item: String,
    /// What stands above it.
    pub title: String,
    /// A hash of the settings and the program that made it.
    pub key: String,
    /// What was not there to make it with, so that it shows something older instead.
    pub lacks: Option<String>,
    /// Where and when that was.
    pub made: Making,
    /// What it is about, in paragraphs.
    pub text: Vec<String>,
    /// Published claims, and what is found here.
    pub claims: Vec<Claim>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Plots.
    pub plots: Vec<Plot>,
    /// Pictures that are compared with each other.
    pub galleries: Vec<Gallery>,
    /// Every turn of every render, from which intervals come; reports do not show it.
    pub turns: Table,
}

/// Where and when something was made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Making {
    /// Version of the program.
    pub version: String,
    /// Day and time, UTC.
    pub date: String,
    /// The processor.
    pub processor: String,
    /// Worker threads.
    pub threads: usize,
    /// How long it took, all in all.
    pub seconds: f64,
    /// Who had the processors meanwhile, as far as the system tells.
    pub load: Option<Load>,
}

impl Making {
    /// Here and now.
    pub fn now(threads: usize, elapsed: Duration, load: Option<Load>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            date: humantime::format_rfc3339_seconds(SystemTime::now())
                .to_string()
                .replace('T', " ")
                .replace('Z', " UTC"),
            processor: processor(),
            threads,
            seconds: elapsed.as_secs_f64(),
            load,
        }
    }

    /// All of it in a line.
    pub fn line(&self) -> String {
        let Self { version, date, processor, threads, seconds, load } = self;
        let load = load.map_or_else(String::new, |Load { processors, own, others }| {
            let [processors, own, others] = [processors, own, others].map(|count| number(count, 2));
            format!(" Of {processors} processors fogbow had {own}, everything else {others}.")
        });
        format!("fogbow {version}, {date}, {processor}, {threads} threads, {} in all.{load}", duration(*seconds))
    }

    /// A warning if the machine was busy.
    pub fn busy(&self) -> Option<String> {
        let Load { processors, others, .. } = self.load.filter(Load::is_busy)?;
        Some(format!(
            "the machine was busy: something else had {} of its {} processors, so that rates and times are not those \
             of this machine; make it again on one that does nothing else",
            number(others, 2),
            number(processors, 2)
        ))
    }
}

/// What the processor calls itself, as far as the system tells.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name));
    name.map_or_else(|| std::env::consts::ARCH.to_string(), |name| name.trim().to_string())
}

/// Something published, and what is found here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// What was published.
    pub published: String,
    /// Where that comes from.
    pub source: String,
    /// What is found here.
    pub found: String,
    /// Whether that agrees.
    pub verdict: Verdict,
    /// Why, where it does not.
    pub why: String,
}

/// A plot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// Its SVG file, in the item's folder.
    pub file: String,
    /// What it shows.
    pub caption: String,
}

/// Pictures of the same size that are compared with each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gallery {
    /// What they show.
    pub caption: String,
    /// In which exposure `[EV]`.
    pub exposure: f64,
    /// The pictures; a reference, if there is one, is the last.
    pub pictures: Vec<Picture>,
    /// Whether the last one is a reference.
    pub has_reference: bool,
}

/// A picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Its EXR file, in the folder of the report.
    pub file: String,
    /// What it is called.
    pub name: String,
    /// What is printed on it: its error and its samples.
    pub note: String,
    /// Its error, root mean square [W/(m^2 sr)], if that is known.
    pub rmse: Option<f64>,
}
