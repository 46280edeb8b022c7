//! `fogbow paper`

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Args;

use super::signals::Signals;
use super::{tell, values};
use crate::cpu;
use crate::error::Result;
use crate::figures::duration;
use crate::paper::bench::Bench;
use crate::paper::folder::Folder;
use crate::paper::scenes::Scenes;
use crate::paper::{self, Made, Tell, report, summary};

/// What the help page of paper says beyond flags.
const ABOUT_PAPER: &str = "\
Items: fig1 (the colonnade, and ten paths by each technique), table1 and fig3 (widths of the perturbation), fig7
(correctness), fig8 (dense-plate at equal time), fig9 (phase functions and orientations), fig10 (a cloud), fig11 (a
spotlight), fig12 (paths of 100 vertices), peers (beside Mitsuba 3, if python3 can import it), scaling (what a sample
costs). All of them take about a quarter of an hour on two processors.

OUT/index.html is the report. It has everything in it and opens from disk. OUT/ITEM has the data of an item: data.json,
tables and turns as CSV, plots as SVG, images as EXR; OUT/references the converged images that errors are measured
against. An item that is there, made by the same program from the same scenes with the same settings, is not made again,
so that the command can be interrupted and repeated; the report shows all items that are there.

References are kept and added to: the next run that needs one goes on from what is there, until its error is less than a
third of the least that it judges. --references gives them more time at once. Of those that are there a few pixels are
rendered again; where a program takes other samples, its references begin anew.

Renders that are compared take turns, many times, so that whatever else the machine does slows all of them alike, and
pictures are so small that the slowest gets enough samples in its time. Where something else had more than a twentieth
of the processors, the report says so.";

#[derive(Debug, Args)]
#[command(after_help = ABOUT_PAPER)]
pub struct PaperArgs {
    /// What to make; everything if nothing is named.
    #[arg(value_name = "ITEM")]
    items: Vec<String>,
    /// The folder of the report and its data. It is made if it is not there.
    #[arg(short, long = "output", value_name = "DIR", required = true)]
    output: PathBuf,
    /// Rendering time of all items that are named, for example 60s or 5min; preparing scenes comes on top. Default:
    /// their part of 11 minutes for all items.
    #[arg(long, value_name = "DURATION", allow_hyphen_values = true, value_parser = values::budget)]
    budget: Option<Duration>,
    /// Time for references of all items that are named, on top of the budget, for example 1h.
    #[arg(long, value_name = "DURATION", allow_hyphen_values = true, value_parser = values::more_for_references)]
    references: Option<Duration>,
    /// The folder of the scenes that come with fogbow. Default: scenes in the current folder, or else in one above the
    /// program.
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
    /// Write a summary, README.md with small pictures, to this folder.
    #[arg(long, value_name = "DIR")]
    summary: Option<PathBuf>,
    /// Number of worker threads. Default: one per processor.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = values::threads)]
    threads: Option<u32>,
}

/// Lines on standard error, until a signal comes.
struct Teller<'a>(&'a Signals);

impl Tell for Teller<'_> {
    fn line(&self, text: &str) {
        tell(text);
    }

    fn stops(&self) -> bool {
        self.0.came()
    }
}

pub fn run(args: &PaperArgs) -> Result<ExitCode> {
    let items = paper::named(&args.items)?;
    let signals = Signals::watch()?;
    args.summary.iter().try_for_each(|path| summary::check(path))?;
    let folder = Folder::open(&args.output)?;
    let (scenes, teller) = (Scenes::find(args.scenes.as_deref()), Teller(&signals));
    cpu::advice().iter().for_each(|advice| tell(format!("warning: {advice}")));
    let workers = args.threads.unwrap_or(0) as usize;
    let references = paper::budgets(&items, Some(args.references.unwrap_or_default()));
    for ((item, budget), references) in items.iter().zip(paper::budgets(&items, args.budget)).zip(references) {
        if signals.came() {
            break;
        }
        let bench = Bench { folder: &folder, scenes: &scenes, budget, references, workers, tell: &teller };
        let start = Instant::now();
        tell(format!("{}: {}", item.name, item.title));
        match item.make(&bench)? {
            Made::Now => tell(format!("  made in {}", duration(start.elapsed().as_secs_f64()))),
            Made::Before => tell("  is there"),
            Made::Interrupted => tell("  interrupted; the same command makes it again"),
        }
        // What there is can be looked at while the rest is made.
        report::write(&folder)?;
    }
    report::write(&folder)?;
    if let Some(path) = &args.summary {
        summary::write(&folder, path)?;
        tell(format!("{}: summary", path.join("README.md").display()));
    }
    tell(format!("{}: open it in a browser", folder.report().display()));
    Ok(signals.exit_code().map_or(ExitCode::SUCCESS, ExitCode::from))
}
