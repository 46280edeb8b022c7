//! The items of the paper, one file each, and what they have in common.

pub mod fig1;
pub mod fig10;
pub mod fig11;
pub mod fig12;
pub mod fig3;
pub mod fig7;
pub mod fig8;
pub mod fig9;
pub mod peers;
pub mod scaling;
pub mod table1;

use toml::Value;

use super::bench::{Bench, Reference};
use super::measure::{Contender, Measured, Run, equal_time};
use super::section::{Claim, Plot, Table};
use crate::error::Result;
use crate::figures::number;
use crate::plot::{self, Axis, Chart, Corner, Curve, Look};

/// Source of numbers that are not in the paper.
const PROGRAM: &str = "the published program (-O3 -march=native, 2 threads), as we measured it; not in the paper";

/// Claims of the paper are given in words of our own.
const PAPER: &str = "the paper, in our words";

/// Share of an item's time that a reference gets.
const FOR_REFERENCE: f64 = 0.25;
/// Seed of references: other random numbers than those of what is measured against them.
const SEED_OF_REFERENCES: i64 = 0x5eed;

/// A technique with its settings.
struct Technique {
    /// What it is called.
    name: &'static str,
    /// What its files are called.
    file: &'static str,
    /// `render.technique`
    technique: &'static str,
    /// Other keys of `render`.
    keys: &'static [(&'static str, Key)],
}

/// A value of a key.
#[derive(Clone, Copy)]
enum Key {
    Word(&'static str),
    Number(f64),
}

impl Technique {
    const fn new(name: &'static str, file: &'static str, technique: &'static str) -> Self {
        Self { name, file, technique, keys: &[] }
    }

    const fn with(self, keys: &'static [(&'static str, Key)]) -> Self {
        Self { keys, ..self }
    }

    /// The keys of a scene that it changes.
    fn changes(&self) -> Vec<(&'static str, Value)> {
        let value = |key: &Key| match key {
            Key::Word(word) => Value::from(*word),
            Key::Number(number) => Value::from(*number),
        };
        let keys = self.keys.iter().map(|(name, key)| (*name, value(key)));
        core::iter::once(("render.technique", Value::from(self.technique))).chain(keys).collect()
    }

    /// `scene` rendered with it, with further changes.
    fn contender(&self, bench: &Bench<'_>, scene: &str, seconds: f64, changes: &[(&str, Value)]) -> Result<Contender> {
        let scene = bench.scene(scene, seconds, &[self.changes().as_slice(), changes].concat())?;
        Ok(Contender { name: self.name.into(), scene })
    }
}

const PATH: Technique = Technique::new("path tracing", "path", "path");
const NEE: Technique = Technique::new("NEE", "nee", "nee");
const MVNEE_2: Technique = Technique::new("MVNEE-2", "mvnee-2", "mvnee").with(&[("render.mesc", Key::Number(2.0))]);
const MVNEE_4: Technique = Technique::new("MVNEE-4", "mvnee-4", "mvnee").with(&[("render.mesc", Key::Number(4.0))]);
const MVNEE_6: Technique = Technique::new("MVNEE-6", "mvnee-6", "mvnee").with(&[("render.mesc", Key::Number(6.0))]);
const MVNEE_8: Technique = Technique::new("MVNEE-8", "mvnee-8", "mvnee").with(&[("render.mesc", Key::Number(8.0))]);
const OMNEE: Technique = Technique::new("OMNEE", "omnee", "nee,omnee");
const BRIDGES: Technique =
    Technique::new("bridges", "bridges", "bridge").with(&[("render.roll", Key::Word("uniform"))]);
const ALIGNED: Technique = Technique::new("bridges, aligned", "aligned", "bridge");

/// Renders of one scene by several techniques, of equal time, and their reference.
struct Match {
    measured: Vec<Measured>,
    reference: Reference,
}

/// Renders `scene` with `changes` by `techniques`, each in `seconds`, and a reference by the default technique, or by
/// `best`, in `for_reference`.
fn equal_times(
    bench: &Bench<'_>,
    scene: &str,
    changes: &[(&str, Value)],
    techniques: &[Technique],
    (seconds, for_reference): (f64, f64),
    best: &Technique,
) -> Result<Match> {
    let seed = [("render.seed", Value::from(SEED_OF_REFERENCES))];
    let of_reference = best.contender(bench, scene, seconds, &[changes, &seed].concat())?;
    let reference = bench.reference(of_reference.scene, for_reference)?;
    let contenders: Result<Vec<_>> =
        techniques.iter().map(|technique| technique.contender(bench, scene, seconds, changes)).collect();
    let mut runs = bench.begin(contenders?)?;
    equal_time(&mut runs, seconds, bench.tell);
    Ok(Match { measured: all_measured(bench, techniques, runs, &reference), reference })
}

/// What `runs` of `techniques` came to.
fn all_measured(bench: &Bench<'_>, techniques: &[Technique], runs: Vec<Run>, reference: &Reference) -> Vec<Measured> {
    let pairs = techniques.iter().zip(runs);
    pairs.map(|(technique, run)| bench.measure(technique.file, run, Some(reference))).collect()
}

/// Those with the least error first.
fn sorted(mut measured: Vec<Measured>) -> Vec<Measured> {
    measured.sort_by(|a, b| a.squared().total_cmp(&b.squared()));
    measured
}

/// The one called `name`.
fn of<'a>(measured: &'a [Measured], technique: &Technique) -> Option<&'a Measured> {
    measured.iter().find(|one| one.run.name == technique.name)
}

/// How many times the efficiency of `base` that of `technique` is; not a number if one is not there.
fn gain(measured: &[Measured], technique: &Technique, base: &Technique) -> f64 {
    match (of(measured, technique), of(measured, base)) {
        (Some(a), Some(b)) => a.efficiency() / b.efficiency(),
        _ => f64::NAN,
    }
}

/// The table of `measured`, efficiencies relative to `base`.
fn table(caption: impl Into<String>, measured: &[Measured], base: &Technique) -> Table {
    let unit = of(measured, base).map_or(f64::NAN, Measured::efficiency);
    Table {
        caption: caption.into(),
        columns: Measured::columns(base.name),
        rows: measured.iter().map(|one| one.row(unit)).collect(),
    }
}

/// RMSE against seconds, of what each of `measured` has and would have: it falls with the root of time.
fn convergence(bench: &Bench<'_>, item: &str, name: &str, title: &str, measured: &[Measured]) -> Result<Plot> {
    let seconds = measured.iter().map(|one| one.run.seconds).fold(0.0, f64::max).max(1e-3);
    let curve = |(index, one): (usize, &Measured)| {
        let at = |seconds: f64| (seconds, (one.efficiency() * seconds / pixels(one)).powf(-0.5));
        Curve {
            name: one.run.name.clone(),
            points: (-4..=4).map(|k| at(seconds * 2.0_f64.powi(k))).collect(),
            look: Look::MarkedLine,
            colour: plot::colour(&one.run.name, index),
        }
    };
    let chart = Chart {
        title: title.into(),
        x: Axis::logarithmic("rendering time [s]"),
        y: Axis::logarithmic("RMSE"),
        curves: measured.iter().enumerate().map(curve).collect(),
        from_zero: false,
        legend: Corner::LowerLeft,
    };
    let caption = format!(
        "RMSE against rendering time. Measured at {} s; the rest is the law that it falls with the root of time.",
        number(seconds, 2)
    );
    bench.plot(item, name, caption, &chart)
}

/// Pixels of an image.
fn pixels(measured: &Measured) -> f64 {
    measured.run.film().region().pixels() as f64
}

/// A published claim beside what is found: whether that agrees, and why it does not, should it not.
fn claim(published: &str, source: &str, agrees: bool, found: String, why: &str) -> Claim {
    let why = if agrees { String::new() } else { why.to_string() };
    Claim { published: published.into(), source: source.into(), found, agrees, why }
}

/// A factor as people read it.
fn times(factor: f64) -> String {
    format!("{} x", number(factor, 2))
}
