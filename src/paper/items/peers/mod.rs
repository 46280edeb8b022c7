//! The same scenes in Mitsuba 3, in turn with fogbow.

mod dense;
mod mitsuba;
mod recorded;

use mitsuba::Mitsuba;
pub use mitsuba::is_there;

use super::{ALIGNED, Contest, MVNEE_4, NEE, PATH, sorted, turn_takers};
use crate::error::{Error, Result};
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::measure::Measured;
use crate::paper::ratio::{Channels, Worth};
use crate::paper::run::Run;
use crate::paper::section::{Cell, Column, Section, Show, Table};
use crate::paper::size::{Size, fitting};
use crate::paper::turns::{Renders, equal_time, slowest_step};

const NAME: &str = "peers";
/// What both programs render.
pub const SCENES: [&str; 6] =
    ["fog-facing", "fog-perpendicular", "fog-small", "dense-plate", "cornell-fog", "cloud-box"];

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let mut section = Section::default();
    for scene in SCENES {
        if bench.tell.stops() {
            return Ok(section);
        }
        bench.tell.line(&format!("  {scene}"));
        match beside(bench, scene, &mut section) {
            Ok(()) => {}
            Err(Failure::Ours(error)) => return Err(error),
            Err(Failure::Theirs(reason)) => return Ok(recorded::section(&reason)),
        }
    }
    section.text.push(
        "Mitsuba 3 renders the same scenes with its volumetric path tracer (volpath: next event estimation with \
         multiple importance sampling), in turn with fogbow, on as many threads. Every call of Mitsuba takes as many \
         samples as fit into its turn, and pictures are so small that many calls do. Calls of many paths are faster \
         per path, so that Mitsuba's rate grows with the time that it is given. Starting it and compiling its kernels \
         is not counted. All errors are against fogbow's converged reference, the mean of all channels; \
         efficiency is one over squared error times time."
            .into(),
    );
    Ok(section)
}

/// Why something did not come about.
enum Failure {
    /// An error of fogbow's own.
    Ours(Error),
    /// What is wrong with Mitsuba.
    Theirs(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Ours(error)
    }
}

impl From<String> for Failure {
    fn from(reason: String) -> Self {
        Self::Theirs(reason)
    }
}

/// Renders `scene` with both programs.
fn beside(bench: &Bench<'_>, scene: &str, section: &mut Section) -> core::result::Result<(), Failure> {
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let times = bench.times(1.0 / SCENES.len() as f64, techniques.len() + 1);
    let file = format!("{scene}-mitsuba");
    let mut contest = Contest::new(bench, (scene, &[]), &techniques, &ALIGNED, times);
    let begin = |size| -> core::result::Result<_, Failure> {
        let loaded = bench.scene(scene, size, &[])?;
        let peer = Mitsuba::start(bench, scene, &loaded, &format!("{file}.exr"), times.each)?;
        Ok((peer, contest.prepared(size)?))
    };
    let step =
        |(peer, runs): &mut (Mitsuba, Vec<Run>)| Ok(slowest_step(&mut with_peer(peer, runs), times.each, bench.tell)?);
    // A call of Mitsuba is the faster per path the more paths it has: pictures begin with all their pixels.
    let (mut size, full) = (Size::default(), bench.full_size(scene)?);
    let (mut peer, mut runs) = fitting(&mut size, full, times.each, begin, step, || bench.tell.stops())?;
    contest.size = size;
    equal_time(&mut with_peer(&mut peer, &mut runs), times.each, bench.tell)?;
    if bench.tell.stops() {
        return Ok(()); // perhaps before there was an image
    }
    let reference = contest.reference(&runs)?;
    let pixels = reference.pixels.len() as f64;
    let theirs = Measured::of_log(peer.name.clone(), file, pixels, &peer.log, Some(&reference.pixels));
    let mut ours = contest.measured(runs, &reference);
    ours.iter_mut().for_each(|one| one.file = format!("{scene}-{}", one.file));
    let caption = format!("{scene}, {} s each.", number(times.each, 2));
    let measured = sorted(core::iter::once(theirs).chain(ours).collect());
    section.tables.push(table(&format!("{caption} {}", reference.note(&measured)), &measured, &peer.name));
    section.turns.add(Measured::all_turns(&measured));
    section.galleries.push(bench.gallery(NAME, caption, &measured, Some(&reference))?);
    Ok(())
}

/// All that take turns.
fn with_peer<'a>(peer: &'a mut Mitsuba, runs: &'a mut [Run]) -> Vec<&'a mut dyn Renders> {
    let mut all = turn_takers(runs);
    all.insert(0, peer);
    all
}

/// The table of `measured`, of which Mitsuba is the one called `peer`.
fn table(caption: &str, measured: &[Measured], peer: &str) -> Table {
    let theirs = measured.iter().find(|one| one.name == peer);
    let row = |one: &Measured| {
        let faster = theirs.map(|theirs| one.over(Worth::Rate, Channels::All, theirs).value);
        let mut row = one.row(theirs);
        row.insert(RATE + 2, Cell::from(faster));
        row
    };
    let mut columns = Measured::columns(peer);
    columns.insert(RATE + 2, Column { title: format!("rate over {peer}"), show: Show::Digits(2) });
    columns[0].title = "program or technique".into();
    Table { caption: caption.into(), columns, rows: measured.iter().map(row).collect() }
}

/// Column of the rate; the next one is its error.
const RATE: usize = 5;
