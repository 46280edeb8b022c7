//! Phase functions from isotropic to strongly forward, with a light that faces the camera and one that is turned.

use toml::Value;

use super::{ALIGNED, Contest, MVNEE_4, Match, NEE, PAPER, PATH, PROGRAM, claim, gain, table, times};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::ratio::Ratio;
use crate::paper::section::{Claim, Plot, Section};
use crate::plot::{self, Axis, Chart, Corner, Curve, Look};

const NAME: &str = "fig9";
const SCENES: [(&str, &str); 2] =
    [("fog-facing", "faces the camera"), ("fog-perpendicular", "is turned away by 90 degrees")];
const COSINES: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let times = bench.times(1.0 / (SCENES.len() * COSINES.len()) as f64, techniques.len());
    let mut section = Section {
        text: vec![
            "A disk light in fog of mean free path 0.59 m, for mean cosines g of 0, 0.3, 0.6 and 0.9. It faces the \
             camera, or is turned by 90 degrees, so that no light leaves it towards the camera."
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
            let changes = [("medium.phase.g", Value::from(g))];
            let contest = Contest { bench, scene, changes: &changes, techniques: &techniques, best: &ALIGNED, times };
            add(bench, &mut section, (scene, light), g, contest.equal_times()?, &mut gains)?;
        }
    }
    section.claims = claims(&gains);
    section.plots.push(chart(bench, &gains)?);
    Ok(section)
}

/// Efficiencies over that of NEE.
struct Gain {
    scene: &'static str,
    g: f64,
    path: Ratio,
    mvnee: Ratio,
    bridges: Ratio,
    /// MVNEE-4 over path tracing.
    over_path: Ratio,
}

fn add(
    bench: &Bench<'_>,
    section: &mut Section,
    (scene, light): (&'static str, &str),
    g: f64,
    Match { mut measured, reference }: Match,
    gains: &mut Vec<Gain>,
) -> Result<()> {
    let over_nee = |technique| gain(&measured, technique, &NEE);
    let [path, mvnee, bridges] = [&PATH, &MVNEE_4, &ALIGNED].map(over_nee);
    let over_path = gain(&measured, &MVNEE_4, &PATH);
    gains.push(Gain { scene, g, path, mvnee, bridges, over_path });
    for one in &mut measured {
        one.file = format!("{scene}-g{}-{}", (10.0 * g).round(), one.file);
    }
    let seconds = number(measured[0].common.unwrap_or(0.0), 2);
    let caption = format!("g = {g}, the light {light}, {seconds} s each.");
    section.tables.push(table(&caption, &measured, &NEE, &reference));
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
        legend: Corner::UpperLeft,
    };
    bench.plot(NAME, "efficiency", "What a second is worth, over what it is worth with NEE; above 1 is better.", &chart)
}

fn claims(gains: &[Gain]) -> Vec<Claim> {
    let find = |scene: &str, g: f64| gains.iter().find(|gain| gain.scene == scene && gain.g == g);
    let mut claims = Vec::new();
    if let Some(gain) = find("fog-facing", 0.6) {
        claims.push(claim(
            "At g = 0.6 with the light facing the camera, MVNEE-4 is 2.0 times as efficient as NEE, where paths start 1 m \
             from the camera; here they start at the camera.",
            PROGRAM,
            gain.mvnee.is_above(1.0),
            format!("MVNEE-4 is {} as efficient as NEE.", times(gain.mvnee)),
            "At so wide a phase function a perturbation follows what scattering does only roughly, and NEE's sample \
             costs less.",
        ));
    }
    if let Some(gain) = find("fog-facing", 0.9) {
        claims.push(claim(
            "MVNEE has less error than path tracing in the same time.",
            PAPER,
            gain.over_path.is_above(1.0),
            format!(
                "At g = 0.9 and a light that faces the camera, MVNEE-4 is {} as efficient as path tracing, and {} as \
                 efficient as NEE.",
                times(gain.over_path),
                times(gain.mvnee)
            ),
            "Where the light faces the camera, forward scattering by itself takes paths to a light of this size, and \
             path tracing's sample is the cheapest. The published program agrees, where paths start 1 m from the \
             camera: 9.2 k of path tracing, 7.7 k of MVNEE-4, 7.5 k of NEE.",
        ));
    }
    if let Some(gain) = find("fog-perpendicular", 0.9) {
        claims.push(claim(
            "MVNEE beats NEE where light has to turn.",
            PAPER,
            gain.mvnee.is_above(1.0),
            format!("With the light turned, at g = 0.9, MVNEE-4 is {} as efficient as NEE.", times(gain.mvnee)),
            "At this distance few of MVNEE's connections reach the light.",
        ));
    }
    claims
}
