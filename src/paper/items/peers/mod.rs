//! The same scenes in Mitsuba 3, in turn with fogbow.

mod mitsuba;
mod recorded;

use mitsuba::Mitsuba;
pub use mitsuba::is_there;

use super::{ALIGNED, Contest, MVNEE_4, NEE, PATH, sorted, turn_takers};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::{Bench, Times};
use crate::paper::measure::Measured;
use crate::paper::ratio::Worth;
use crate::paper::section::{Cell, Column, Section, Show, Table};
use crate::paper::turns::{Renders, equal_time};

const NAME: &str = "peers";
/// What both programs render.
pub const SCENES: [&str; 5] = ["fog-facing", "fog-perpendicular", "fog-small", "dense-plate", "cornell-fog"];

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let mut section = Section::default();
    for scene in SCENES {
        if bench.tell.stops() {
            return Ok(section);
        }
        bench.tell.line(&format!("  {scene}"));
        if let Err(reason) = beside(bench, scene, &mut section)? {
            return Ok(recorded::section(&reason));
        }
    }
    section.text.push(
        "Mitsuba 3 renders the same scenes with its volumetric path tracer (volpath: next event estimation with \
         multiple importance sampling), in turn with fogbow, on as many threads. It renders at least 16 samples of \
         every pixel at a time, so that its turns may take longer; errors are for the same time. All errors are \
         against fogbow's converged reference, the mean of all channels; efficiency is one over squared error times \
         time."
            .into(),
    );
    Ok(section)
}

/// Renders `scene` with both programs. The reason, if Mitsuba is not there.
fn beside(bench: &Bench<'_>, scene: &str, section: &mut Section) -> Result<core::result::Result<(), String>> {
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let times = bench.times(1.0 / SCENES.len() as f64, techniques.len() + 1);
    let file = format!("{scene}-mitsuba");
    let loaded = bench.scene(scene, times.each, &[])?;
    let mut peer = match Mitsuba::start(bench, scene, &loaded, &format!("{file}.exr")) {
        Ok(peer) => peer,
        Err(reason) => return Ok(Err(reason)),
    };
    let contest = Contest { bench, scene, changes: &[], techniques: &techniques, best: &ALIGNED, times };
    let mut runs = contest.begin()?;
    let mut all = turn_takers(&mut runs);
    all.insert(0, &mut peer as &mut dyn Renders);
    if let Err(reason) = equal_time(&mut all, times.each, bench.tell) {
        return Ok(Err(reason));
    }
    if bench.tell.stops() {
        return Ok(Ok(())); // perhaps before there was an image
    }
    let reference = contest.reference(&runs)?;
    let (pixels, common) = (reference.pixels.len() as f64, Some(times.each));
    let theirs = Measured::of_log(peer.name.clone(), file, pixels, &peer.log, Some(&reference.pixels));
    let mut ours = contest.measured(runs, &reference, common);
    ours.iter_mut().for_each(|one| one.file = format!("{scene}-{}", one.file));
    let caption = format!("{scene}, {} s each. {}", number(times.each, 2), reference.note());
    let measured = sorted(core::iter::once(Measured { common, ..theirs }).chain(ours).collect());
    section.tables.push(table(&caption, &measured, &peer.name, times));
    section.galleries.push(bench.gallery(NAME, caption, &measured, Some(&reference))?);
    Ok(Ok(()))
}

/// The table of `measured`, of which Mitsuba is the one called `peer`.
fn table(caption: &str, measured: &[Measured], peer: &str, times: Times) -> Table {
    let theirs = measured.iter().find(|one| one.name == peer);
    let row = |one: &Measured| {
        let faster = theirs.map(|theirs| one.over(Worth::Rate, theirs).value);
        let mut row = one.row(theirs);
        row.insert(RATE + 2, Cell::from(faster));
        row
    };
    let mut columns = Measured::columns(peer, Some(times.each));
    columns.insert(RATE + 2, Column { title: format!("rate over {peer}"), show: Show::Digits(2) });
    columns[0].title = "program or technique".into();
    Table { caption: caption.into(), columns, rows: measured.iter().map(row).collect() }
}

/// Column of the rate; the next one is its error.
const RATE: usize = 5;
