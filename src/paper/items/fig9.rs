//! Phase functions from isotropic to strongly forward, with a light that faces the camera and one that is turned.

use toml::Value;

use super::{
    ALIGNED, Contest, MVNEE_4, Match, NEE, PAPER, PATH, PROGRAM, Published, beside_published, claim, factor, gain,
    gain_of_green, table,
};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::{Bench, Times};
use crate::paper::measure::Measured;
use crate::paper::ratio::Ratio;
use crate::paper::section::{Claim, Plot, Section};
use crate::plot::{self, Axis, Chart, Curve, Look};

const NAME: &str = "fig9";
const SCENES: [(&str, &str); 2] =
    [("fog-facing", "faces the camera"), ("fog-perpendicular", "is turned away by 90 degrees")];
const COSINES: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

/// What the published program does at some mean cosines, the light facing the camera.
const PUBLISHED: [(f64, &[Published]); 2] = [
    (0.6, &[(&NEE, 944.0, Some(23.8)), (&MVNEE_4, 708.0, Some(9.0))]),
    (0.9, &[(&PATH, 1220.0, Some(132.0)), (&NEE, 870.0, Some(116.0)), (&MVNEE_4, 554.0, Some(72.0))]),
];

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let times = bench.times(1.0 / (SCENES.len() * COSINES.len()) as f64, techniques.len());
    let mut section = Section {
        text: vec![
            "A disk light in fog of mean free path 0.59 m, for mean cosines g of 0, 0.3, 0.6 and 0.9. It faces the \
             camera, or is turned by 90 degrees, so that no light leaves it towards the camera. Paths start on the \
             image plane, 1 m from the camera, as they do in the paper."
                .into(),
        ],
        ..Section::default()
    };
    let mut gains = Vec::new();
    for (scene, light) in SCENES {
        for g in COSINES {
            if bench.tell.stops() {
                return Ok(section);
            }
            bench.tell.line(&format!("  {scene}, g = {g}"));
            let changes = [("medium.phase.g", Value::from(g)), ("camera.near", Value::from(1.0))];
            let mut contest = Contest::new(bench, (scene, &changes), &techniques, &ALIGNED, times);
            let found = contest.equal_times()?;
            gains.push(Gain::of(scene, g, &found.measured));
            add(bench, &mut section, (scene, light), g, found, times)?;
        }
    }
    section.claims = claims(&gains);
    section.plots.push(chart(bench, &gains)?);
    Ok(section)
}

/// Efficiencies, one over the other.
struct Gain {
    scene: &'static str,
    g: f64,
    /// Over that of NEE.
    path: Ratio,
    mvnee: Ratio,
    bridges: Ratio,
    /// MVNEE-4 over path tracing.
    over_path: Ratio,
    /// MVNEE-4 over NEE and over path tracing, in green.
    green: [Ratio; 2],
}

impl Gain {
    fn of(scene: &'static str, g: f64, measured: &[Measured]) -> Self {
        let [path, mvnee, bridges] = [&PATH, &MVNEE_4, &ALIGNED].map(|technique| gain(measured, technique, &NEE));
        let green = [&NEE, &PATH].map(|base| gain_of_green(measured, &MVNEE_4, base));
        Self { scene, g, path, mvnee, bridges, over_path: gain(measured, &MVNEE_4, &PATH), green }
    }
}

fn add(
    bench: &Bench<'_>,
    section: &mut Section,
    (scene, light): (&'static str, &str),
    g: f64,
    Match { mut measured, reference }: Match,
    times: Times,
) -> Result<()> {
    for one in &mut measured {
        one.file = format!("{scene}-g{}-{}", (10.0 * g).round(), one.file);
    }
    let caption = format!("g = {g}, the light {light}, {} s each.", number(times.each, 2));
    section.tables.push(table(&caption, &measured, &NEE, &reference));
    if let Some((_, published)) = PUBLISHED.iter().find(|(cosine, _)| scene == SCENES[0].0 && *cosine == g) {
        section.tables.push(beside_published(published, &measured, &format!("g = {g}, the light {light}.")));
    }
    section.turns.add(Measured::all_turns(&measured));
    section.galleries.push(bench.gallery(NAME, caption, &measured, Some(&reference))?);
    Ok(())
}

fn chart(bench: &Bench<'_>, gains: &[Gain]) -> Result<Plot> {
    let series = |scene: &str, name: &str, index: usize, value: fn(&Gain) -> Ratio| {
        let points = gains.iter().filter(|gain| gain.scene == scene).map(|gain| (gain.g, value(gain).value)).collect();
        Curve::new(format!("{name}, {scene}"), points, Look::MarkedLine, plot::COLOURS[index])
    };
    let curves = SCENES.iter().enumerate().flat_map(|(place, (scene, _))| {
        let index = 3 * place;
        [
            series(scene, "path tracing", (index + 6) % 8, |gain| gain.path),
            series(scene, "MVNEE-4", index % 8, |gain| gain.mvnee),
            series(scene, "aligned bridges", (index + 2) % 8, |gain| gain.bridges),
        ]
    });
    let chart = Chart {
        title: "efficiency over NEE".into(),
        x: Axis::linear("mean cosine g"),
        y: Axis::logarithmic("efficiency over that of NEE"),
        curves: curves.collect(),
        from_zero: false,
    };
    bench.plot(NAME, "efficiency", "What a second is worth, over what it is worth with NEE; above 1 is better.", &chart)
}

fn claims(gains: &[Gain]) -> Vec<Claim> {
    let find = |(scene, _): (&str, &str), g: f64| gains.iter().find(|gain| gain.scene == scene && gain.g == g);
    let mut claims = Vec::new();
    if let Some(Gain { green: [over_nee, _], .. }) = find(SCENES[0], 0.6) {
        claims.push(claim(
            "At g = 0.6 with the light facing the camera, MVNEE-4 is 2.0 times as efficient as NEE.",
            PROGRAM,
            over_nee.is_about(2.0),
            format!("In green MVNEE-4 is {} as efficient as NEE.", factor(*over_nee)),
            "Variances are the same, as the table shows; what differs is what samples cost.",
        ));
    }
    let (Some(facing), Some(turned)) = (find(SCENES[0], 0.9), find(SCENES[1], 0.9)) else { return claims };
    claims.push(claim(
        "At g = 0.9 with the light facing the camera, path tracing is the best: MVNEE-4 is 0.83 times as efficient.",
        PROGRAM,
        facing.green[1].is_about(0.83),
        format!(
            "In green MVNEE-4 is {} as efficient as path tracing, and {} as efficient as NEE.",
            factor(facing.green[1]),
            factor(facing.green[0])
        ),
        "Variances are the same, as the table shows. A sample of path tracing needs no connections, and has gained \
         more than the others from being rendered eight at a time.",
    ));
    claims.push(claim(
        "MVNEE has less error than path tracing in the same time.",
        PAPER,
        facing.over_path.is_above(1.0).and(turned.over_path.is_above(1.0)),
        format!(
            "At g = 0.9 MVNEE-4 is {} as efficient as path tracing if the light faces the camera, and {} if it is \
             turned.",
            factor(facing.over_path),
            factor(turned.over_path)
        ),
        "Forward scattering by itself takes paths to a light of this size, even to one that is turned, and path \
         tracing's sample is the cheapest.",
    ));
    claims.push(claim(
        "MVNEE beats NEE where light has to turn.",
        PAPER,
        turned.mvnee.is_above(1.0),
        format!("With the light turned, at g = 0.9, MVNEE-4 is {} as efficient as NEE.", factor(turned.mvnee)),
        "At this distance few of MVNEE's connections reach the light.",
    ));
    claims
}
