//! The same scenes in Mitsuba 3, in turn with fogbow.

mod mitsuba;

use mitsuba::Mitsuba;
use toml::Value;

use super::{ALIGNED, FOR_REFERENCE, MVNEE_4, NEE, PATH, SEED_OF_REFERENCES, Technique};
use crate::error::Result;
use crate::figures::{number, rate};
use crate::image::exr;
use crate::paper::bench::{Bench, Reference};
use crate::paper::measure::{Measured, Run};
use crate::paper::rmse::Rmse;
use crate::paper::section::{Picture, Section, Table};

const NAME: &str = "peers";
const SCENES: [&str; 4] = ["fog-facing", "fog-perpendicular", "dense-plate", "cornell-fog"];
/// Length of a turn [s].
const TURN: f64 = 1.0;

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let each = bench.budget.as_secs_f64() / SCENES.len() as f64;
    let mut section = Section::default();
    for scene in SCENES {
        if bench.tell.stops() {
            return Ok(section);
        }
        bench.tell.line(&format!("  {scene}"));
        if let Err(reason) = beside(bench, scene, each, &mut section)? {
            return Ok(recorded(&reason));
        }
    }
    section.text.push(
        "Mitsuba 3 renders the same scenes with its volumetric path tracer (volpath: next event estimation with \
         multiple importance sampling), in turn with fogbow, on as many threads. RMSE is against fogbow's converged \
         reference, efficiency is one over squared error times time."
            .into(),
    );
    Ok(section)
}

/// Renders `scene` with both programs for `seconds` in all. The reason, if Mitsuba is not there.
fn beside(
    bench: &Bench<'_>,
    scene: &str,
    seconds: f64,
    section: &mut Section,
) -> Result<core::result::Result<(), String>> {
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let each = (1.0 - FOR_REFERENCE) * seconds / (techniques.len() + 1) as f64;
    let loaded = bench.scene(scene, each, &[])?;
    let mut peer = match Mitsuba::start(bench, scene, &loaded) {
        Ok(peer) => peer,
        Err(reason) => return Ok(Err(reason)),
    };
    let seed = [("render.seed", Value::from(SEED_OF_REFERENCES))];
    let reference = ALIGNED.contender(bench, scene, each, &seed)?;
    let reference = bench.reference(reference.scene, FOR_REFERENCE * seconds)?;
    let contenders: Result<Vec<_>> =
        techniques.iter().map(|technique| technique.contender(bench, scene, each, &[])).collect();
    let mut runs = bench.begin(contenders?)?;
    if let Err(reason) = in_turn(bench, &mut peer, &mut runs, each) {
        return Ok(Err(reason));
    }
    let file = format!("{scene}-mitsuba.exr");
    let path = bench.folder.file(NAME, &file)?;
    if let Err(reason) = peer.write(&path) {
        return Ok(Err(reason));
    }
    let rmse = rmse_of(&exr::read_image(&path)?, &reference);
    let measured = measured(bench, scene, &techniques, runs, &reference);
    let pixels = reference.pixels.len() as f64;
    section.tables.push(table(scene, &peer, pixels, rmse, &measured));
    let caption = format!("{scene}, {} s each.", number(each, 2));
    let mut gallery = bench.gallery(NAME, caption, &measured, Some(&reference))?;
    let note = format!("RMSE {}, {} samples", number(rmse.root(), 3), number(peer.samples, 4));
    let picture = Picture { file: format!("{NAME}/{file}"), name: peer.name.clone(), note };
    gallery.pictures.insert(0, picture);
    section.galleries.push(gallery);
    Ok(Ok(()))
}

fn in_turn(bench: &Bench<'_>, peer: &mut Mitsuba, runs: &mut [Run], seconds: f64) -> core::result::Result<(), String> {
    let turns = (seconds / TURN).ceil().clamp(1.0, 16.0) as u32;
    for turn in 1..=turns {
        let until = seconds * f64::from(turn) / f64::from(turns);
        if bench.tell.stops() {
            return Ok(());
        }
        peer.until(until)?;
        for run in &mut *runs {
            run.until(until, bench.tell);
        }
    }
    Ok(())
}

fn measured(
    bench: &Bench<'_>,
    scene: &str,
    techniques: &[Technique],
    runs: Vec<Run>,
    reference: &Reference,
) -> Vec<Measured> {
    let pairs = techniques.iter().zip(runs);
    pairs.map(|(technique, run)| bench.measure(format!("{scene}-{}", technique.file), run, Some(reference))).collect()
}

/// The error of an image without standard errors.
fn rmse_of(image: &crate::image::Image, reference: &Reference) -> Rmse {
    let planes = ["R", "G", "B"].map(|name| image.channel(name).unwrap_or_default());
    let value = |plane: &[f32], i: usize| plane.get(i).copied().map_or(0.0, f64::from);
    let pixel = |i: usize| crate::film::Pixel {
        mean: planes.map(|plane| value(plane, i)),
        standard_error: [0.0; 3],
        samples: 1,
    };
    Rmse::of((0..reference.pixels.len()).map(pixel), reference.pixels.iter().copied())
}

fn table(scene: &str, peer: &Mitsuba, pixels: f64, rmse: Rmse, measured: &[Measured]) -> Table {
    let own_rate = peer.samples * pixels / peer.seconds;
    let base = own_rate / (rmse.squared.max(0.0) * peer.samples);
    let row = |name: &str, samples: f64, of: f64, rmse: Rmse, efficiency: f64| {
        vec![
            name.to_string(),
            number(samples, 4),
            rate(of),
            format!("{} x", number(of / own_rate, 2)),
            number(rmse.root(), 3),
            number(rmse.green.max(0.0) * samples, 3),
            format!("{} x", number(efficiency / base, 2)),
        ]
    };
    let own = measured.iter().map(|one| {
        let rmse = one.rmse.unwrap_or_default();
        row(&format!("fogbow, {}", one.run.name), one.run.samples(), one.run.rate(), rmse, one.efficiency())
    });
    let columns =
        ["", "samples per pixel", "rate", "over Mitsuba's", "RMSE", "variance of green", "efficiency over Mitsuba's"];
    Table {
        caption: format!("{scene}. {}.", peer.name),
        columns: columns.map(String::from).to_vec(),
        rows: core::iter::once(row(&peer.name, peer.samples, own_rate, rmse, base)).chain(own).collect(),
    }
}

/// What was measured once, where Mitsuba is not installed.
fn recorded(reason: &str) -> Section {
    let rows = [
        ["Mitsuba", "66 k/s", "1.34", "1 x"],
        ["path tracing", "1060 k/s", "1.18", "18 x"],
        ["NEE", "694 k/s", "0.124", "114 x"],
        ["MVNEE-4", "374 k/s", "0.056", "134 x"],
        ["bridges", "445 k/s", "0.059", "152 x"],
        ["lis", "201 k/s", "0.102", "40 x"],
    ];
    let columns = ["", "rate", "variance of green", "efficiency over Mitsuba's"];
    Section {
        text: vec![
            format!("Mitsuba was not run: {reason}. These are the figures of BENCHMARKS.md."),
            "With `pip install mitsuba` this item renders four scenes with both programs in turn. Where Mitsuba does \
             not find LLVM, the environment variable DRJIT_LIBLLVM_PATH names it."
                .into(),
        ],
        tables: vec![Table {
            caption: "cloud-box, 128 x 128 pixels; Mitsuba 3.9, llvm, volpath; 2-core Xeon, 2026-11-23.".into(),
            columns: columns.map(String::from).to_vec(),
            rows: rows.iter().map(|row| row.map(String::from).to_vec()).collect(),
        }],
        ..Section::default()
    }
}
