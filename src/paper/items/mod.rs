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

use super::bench::{Bench, Times};
use super::measure::Measured;
use super::ratio::{Channels, Ratio, Verdict, Worth};
use super::reference::{self, Reference};
use super::run::{Contender, LeftOut, Run};
use super::section::{Claim, Column, Plot, Show, Table};
use super::size::{Size, fitting};
use super::turns::{Renders, equal_time, slowest_step};
use crate::error::Result;
use crate::figures::number;
use crate::plot::{self, Axis, Chart, Curve, Look};

/// Source of numbers that are not in the paper.
const PROGRAM: &str = "the published program (-O3 -march=native, 2 threads), as we measured it; not in the paper";

/// Claims of the paper are given in words of our own.
const PAPER: &str = "the paper, in our words";

/// What the published program does on a scene: samples per second, in thousands, and the variance of green of one, as
/// far as that is known.
type Published = (&'static Technique, f64, Option<f64>);

/// What the published program does beside what is found.
fn beside_published(published: &[Published], measured: &[Measured], note: &str) -> Table {
    let row = |(technique, rate, variance): &Published| {
        let own = of(measured, technique);
        let own = [own.map(Measured::rate), own.map(|own| own.variance(Channels::Green))];
        vec![technique.name.into(), (1e3 * rate).into(), own[0].into(), (*variance).into(), own[1].into()]
    };
    Table {
        caption: format!("Beside {PROGRAM}. Rates depend on the machine, variances do not. {note}").trim_end().into(),
        columns: Column::all([
            ("technique", Show::Digits(1)),
            ("published rate [1/s]", Show::Rate),
            ("our rate [1/s]", Show::Rate),
            ("published variance of green", Show::Digits(3)),
            ("our variance of green", Show::Digits(3)),
        ]),
        rows: published.iter().map(row).collect(),
    }
}

/// Only other programs fail.
const NO_FAILURE: &str = "our own renders do not fail";

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
    fn contender(&self, bench: &Bench<'_>, scene: &str, size: Size, changes: &[(&str, Value)]) -> Result<Contender> {
        let scene = bench.scene(scene, size, &[self.changes().as_slice(), changes].concat())?;
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

/// Renders of one scene by several techniques that take turns, and their reference.
struct Contest<'a> {
    bench: &'a Bench<'a>,
    scene: &'a str,
    /// Keys of the scene that are changed.
    changes: &'a [(&'a str, Value)],
    techniques: &'a [Technique],
    /// The technique of the reference, one of them.
    best: &'a Technique,
    times: Times,
    /// How large they are, once they have begun.
    size: Size,
    left_out: LeftOut,
}

/// What came of it.
struct Match {
    measured: Vec<Measured>,
    reference: Reference,
}

impl<'a> Contest<'a> {
    fn new(
        bench: &'a Bench<'a>,
        (scene, changes): (&'a str, &'a [(&'a str, Value)]),
        techniques: &'a [Technique],
        best: &'a Technique,
        times: Times,
    ) -> Self {
        let (size, left_out) = (Size::for_seconds(times.each), LeftOut::new());
        Self { bench, scene, changes, techniques, best, times, size, left_out }
    }

    /// Every technique, prepared, in pictures of this size.
    fn prepared(&self, size: Size) -> Result<Vec<Run>> {
        let Self { bench, scene, changes, techniques, left_out, .. } = self;
        let contenders: Result<Vec<_>> =
            techniques.iter().map(|technique| technique.contender(bench, scene, size, changes)).collect();
        bench.begin(contenders?, left_out)
    }

    /// Every technique, with its first samples, in pictures of a size at which all can have the same time.
    fn begin(&mut self) -> Result<Vec<Run>> {
        let Self { bench, scene, times: Times { each, .. }, mut size, .. } = *self;
        let step = |runs: &mut Vec<Run>| Ok(slowest_step(&mut turn_takers(runs), each, bench.tell).expect(NO_FAILURE));
        let begin = |size| self.prepared(size);
        let runs = fitting(&mut size, bench.full_size(scene)?, each, begin, step, || bench.tell.stops())?;
        self.size = size;
        Ok(runs)
    }

    /// What `runs` are measured against.
    fn reference(&self, runs: &[Run]) -> Result<Reference> {
        let seed = [("render.seed", Value::from(SEED_OF_REFERENCES))];
        let changes = [self.changes, &seed].concat();
        let contender = self.best.contender(self.bench, self.scene, self.size, &changes)?;
        let judge = runs.iter().find(|run| run.name == self.best.name).expect("the best technique is one of them");
        let left_out = LeftOut::from(judge.session().preparation().left_out);
        self.bench.reference(contender.scene, &left_out, reference::goal(runs, judge), self.times.reference)
    }

    /// What `runs` came to; least errors first.
    fn measured(&self, runs: Vec<Run>, reference: &Reference) -> Vec<Measured> {
        let measure = |(technique, run): (&Technique, Run)| self.bench.measure(technique.file, run, Some(reference));
        sorted(self.techniques.iter().zip(runs).map(measure).collect())
    }

    /// All of them at equal time.
    fn equal_times(&mut self) -> Result<Match> {
        let mut runs = self.begin()?;
        equal_time(&mut turn_takers(&mut runs), self.times.each, self.bench.tell).expect(NO_FAILURE);
        let reference = self.reference(&runs)?;
        Ok(Match { measured: self.measured(runs, &reference), reference })
    }
}

/// Runs as those that take turns.
fn turn_takers(runs: &mut [Run]) -> Vec<&mut dyn Renders> {
    runs.iter_mut().map(|run| run as &mut dyn Renders).collect()
}

/// Those with the least error first.
fn sorted(mut measured: Vec<Measured>) -> Vec<Measured> {
    let error = |one: &Measured| one.error().unwrap_or(f64::INFINITY);
    measured.sort_by(|a, b| error(a).total_cmp(&error(b)));
    measured
}

/// The one called `name`.
fn of<'a>(measured: &'a [Measured], technique: &Technique) -> Option<&'a Measured> {
    measured.iter().find(|one| one.name == technique.name)
}

/// What `technique` is worth over what `base` is; unknown if one is not there.
fn over(measured: &[Measured], (worth, channels): (Worth, Channels), technique: &Technique, base: &Technique) -> Ratio {
    match (of(measured, technique), of(measured, base)) {
        (Some(a), Some(b)) => a.over(worth, channels, b),
        _ => Ratio::UNKNOWN,
    }
}

/// How many times the rate of `base` that of `technique` is.
fn speed(measured: &[Measured], technique: &Technique, base: &Technique) -> Ratio {
    over(measured, (Worth::Rate, Channels::All), technique, base)
}

/// How many times the efficiency of `base` that of `technique` is.
fn gain(measured: &[Measured], technique: &Technique, base: &Technique) -> Ratio {
    over(measured, (Worth::Second, Channels::All), technique, base)
}

/// The same in green, of which there are published numbers.
fn gain_of_green(measured: &[Measured], technique: &Technique, base: &Technique) -> Ratio {
    over(measured, (Worth::Second, Channels::Green), technique, base)
}

/// The table of `measured`, efficiencies relative to `base`.
fn table(caption: &str, measured: &[Measured], base: &Technique, reference: &Reference) -> Table {
    let unit = of(measured, base);
    Table {
        caption: format!("{caption} {}", reference.note(measured)),
        columns: Measured::columns(base.name),
        rows: measured.iter().map(|one| one.row(unit)).collect(),
    }
}

/// RMSE against seconds, of what each of `measured` has and would have: it falls with the root of time.
fn convergence(bench: &Bench<'_>, item: &str, name: &str, title: &str, measured: &[Measured]) -> Result<Plot> {
    let seconds = measured.iter().map(|one| one.seconds).fold(0.0, f64::max).max(1e-3);
    let curves = |(index, one): (usize, &Measured)| {
        let law = |seconds: f64| (seconds, (one.variance(Channels::All) * one.pixels / one.rate() / seconds).sqrt());
        let colour = plot::colour(&one.name, index);
        let line = [-4, 4].map(|k| law(seconds * 2.0_f64.powi(k))).to_vec();
        [
            Curve::new(&one.name, line, Look::Line, colour),
            Curve::new(&one.name, one.course.clone(), Look::Marks, colour),
        ]
    };
    let chart = Chart {
        title: title.into(),
        x: Axis::logarithmic("rendering time [s]"),
        y: Axis::logarithmic("RMSE"),
        curves: measured.iter().enumerate().flat_map(curves).collect(),
        from_zero: false,
    };
    let caption = "RMSE against rendering time. Marks are measured, after every turn; lines are the law that errors \
                   fall with the root of time, through the last mark.";
    bench.plot(item, name, caption, &chart)
}

/// A published claim beside what is found, and why that is not the same, should it not be.
fn claim(published: &str, source: &str, verdict: Verdict, found: String, why: &str) -> Claim {
    let why = match verdict {
        Verdict::Agrees => String::new(),
        Verdict::InPart | Verdict::Differs => why.into(),
        Verdict::Undecided => format!("The interval covers both answers; a longer --budget narrows it. {why}"),
    };
    Claim { published: published.into(), source: source.into(), found, verdict, why: why.trim_end().into() }
}

/// A factor with its interval: `4.1 (3.5 to 4.9) times`.
fn factor(ratio: Ratio) -> String {
    let Ratio { value, interval: [low, high] } = ratio;
    if !value.is_finite() {
        return "an unknown number of times".into();
    }
    if !high.is_finite() {
        return format!("about {} times", number(value, 2));
    }
    format!("{} ({} to {}) times", number(value, 2), number(low, 2), number(high, 2))
}
