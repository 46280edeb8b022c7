//! The colonnade, and what paths of every technique look like.

use fogbow_kernels::connect::Technique as Kind;
use glam::DVec3;
use toml::Value;

use super::{
    ALIGNED, FOR_REFERENCE, MVNEE_4, NEE, PAPER, PATH, claim, convergence, equal_times, gain, sorted, table, times,
};
use crate::error::Result;
use crate::figures::number;
use crate::frame::Frame;
use crate::paper::bench::Bench;
use crate::paper::section::{Plot, Section};
use crate::paths::{self, Request};
use crate::plot::{self, Panel};
use crate::scene;

const NAME: &str = "fig1";
const SCENE: &str = "colonnade";

/// Scattering of the scene that is lit to be recognised [1/m]: the published one is 0.2.
const CLEARER: f64 = 0.02;

/// The fog of the colonnade and one of its lights, eight mean free paths away, for paths to be drawn.
const FOG: &str = r#"
[camera]
position = [0, 0, 0]
look_at = [0, 0, 1]
vertical_fov_deg = 50
[medium]
scattering = 0.2
phase = { type = "henyey_greenstein", g = 0.9 }
[[light]]
type = "disk"
center = [0, 0, 40]
normal = [0, 0, -1]
radius = 2
radiance = 1
[render]
max_segments = 60
"#;
/// Paths of every technique.
const PATHS: u32 = 10;
/// Vertices that NEE's paths walk before they connect: as many as MVNEE inserts on the average.
const WALK: u32 = 8;

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let budget = bench.budget.as_secs_f64();
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let published = 0.75 * budget;
    let seconds = (1.0 - FOR_REFERENCE) * published / techniques.len() as f64;
    let result = equal_times(bench, SCENE, &[], &techniques, (seconds, FOR_REFERENCE * published), &ALIGNED)?;
    let measured = sorted(result.measured);
    let caption = format!("The published fog and lights, {} s each, sorted by RMSE.", number(seconds, 3));
    let mut galleries = vec![bench.gallery(NAME, &caption, &measured, Some(&result.reference))?];
    let clear = clear(bench, budget - published)?;
    galleries.insert(0, clear);
    let best = measured.first().map_or("-", |one| one.run.name.as_str()).to_string();
    let over_nee = gain(&measured, &MVNEE_4, &NEE);
    Ok(Section {
        text: vec![
            format!(
                "A court between two-storey arcades in fog of mean free path 5 m, lit by three coloured disks; a \
                 building of our own in the proportions of the Sponza palace. In the published fog arcades fade \
                 within a few bays. The first picture is the same building, camera and lights in fog of {CLEARER}/m \
                 instead of 0.2/m, with a pale disk above the court to fill the shadows, so that one sees what stands \
                 there."
            ),
            format!(
                "The drawings show {PATHS} paths of each technique that leave a point at 45 degrees to the way to a \
                 light, eight mean free paths away, in the same fog. NEE's walk for {WALK} vertices and then connect \
                 in a straight line. `fogbow paths` draws such pictures of any scene."
            ),
        ],
        claims: vec![claim(
            "MVNEE has less noise than NEE in the same time.",
            PAPER,
            over_nee > 1.0,
            format!("MVNEE-4 is {} as efficient as NEE. The least error is that of {best}.", times(over_nee)),
            "The camera is in the fog that the lights shine through: most vertices are farther from every light than \
             MVNEE-4 reaches, and their samples cost more than those of NEE.",
        )],
        tables: vec![table(&caption, &measured, &NEE)],
        plots: vec![drawing(bench)?, convergence(bench, NAME, "rmse", SCENE, &measured)?],
        galleries,
        ..Section::default()
    })
}

/// The building, to be recognised.
fn clear(bench: &Bench<'_>, seconds: f64) -> Result<crate::paper::section::Gallery> {
    let mut fill = toml::Table::new();
    let vector = |v: [f64; 3]| Value::from(v.to_vec());
    fill.insert("type".into(), "disk".into());
    for (key, value) in [("center", [0.0, 24.0, -2.0]), ("normal", [0.0, -1.0, 0.0]), ("radiance", [40.0, 37.0, 32.0])]
    {
        fill.insert(key.into(), vector(value));
    }
    fill.insert("radius".into(), 6.0.into());
    let own = bench.scenes.load(SCENE, &[])?.scene.light;
    let own = Value::try_from(own).expect("lights are made of names and numbers");
    let lights = own.as_array().into_iter().flatten().cloned().chain([Value::Table(fill)]).collect();
    let changes = [("medium.scattering", Value::from(CLEARER)), ("light", Value::Array(lights))];
    let contender = ALIGNED.contender(bench, SCENE, seconds, &changes)?;
    let mut runs = bench.begin(vec![contender])?;
    runs[0].until(seconds, bench.tell);
    let runs: Vec<_> = runs.into_iter().map(|run| bench.measure("clear", run, None)).collect();
    bench.gallery(NAME, "The building in clearer fog, with light from above.", &runs, None)
}

/// Paths of every technique.
fn drawing(bench: &Bench<'_>) -> Result<Plot> {
    let panels: Result<Vec<_>> = [
        ("path tracing", "path", None),
        ("NEE", "nee", Some(Kind::Nee)),
        ("MVNEE", "mvnee", Some(Kind::Mvnee)),
        ("bridges", "bridge", Some(Kind::Bridge)),
    ]
    .into_iter()
    .map(|(title, technique, kind)| panel(title, technique, kind))
    .collect();
    let caption = "To scale. The start is black, the light orange, seen from its edge.";
    bench.drawing(NAME, "paths", caption, plot::paths_svg(&panels?))
}

fn panel(title: &str, technique: &str, kind: Option<Kind>) -> Result<Panel> {
    let frame: Frame = scene::parse("paths.toml", &format!("{FOG}technique = \"{technique}\"\n"))?.frame;
    let walk = if kind == Some(Kind::Nee) { WALK } else { 1 };
    let direction = DVec3::new(0.0, 1.0, 1.0).normalize();
    let request = Request { from: DVec3::ZERO, direction, count: PATHS, technique: kind, walk, light: None };
    let found = paths::find(&frame, &request);
    let target = paths::middle(&frame, None).unwrap_or(DVec3::Z);
    let tried = if kind.is_none() { format!(", of {} tried", found.tried) } else { String::new() };
    let title = format!("{title}: {} paths{tried}", found.paths.len());
    Ok(paths::panel(&frame, title, &found, target, plot::colour(technique, 0)))
}
