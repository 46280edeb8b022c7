//! The colonnade, and what paths of every technique look like.

use fogbow_kernels::connect::Technique as Kind;
use glam::DVec3;
use toml::Value;

use super::{ALIGNED, Contest, MVNEE_4, Match, NEE, PATH, claim, convergence, factor, gain, table};
use crate::error::Result;
use crate::figures::number;
use crate::frame::Frame;
use crate::paper::bench::Bench;
use crate::paper::measure::Measured;
use crate::paper::run::LeftOut;
use crate::paper::section::{Gallery, Plot, Section};
use crate::paper::size::Size;
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
/// Share of the time for the published scene; the rest is for the clearer picture.
const FOR_PUBLISHED: f64 = 0.8;
/// Vertices that NEE's paths walk before they connect: as many as MVNEE inserts on the average.
const WALK: u32 = 8;

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = [PATH, NEE, MVNEE_4, ALIGNED];
    let times = bench.times(FOR_PUBLISHED, techniques.len());
    let mut contest = Contest::new(bench, (SCENE, &[]), &techniques, &ALIGNED, times);
    let clear = clear(bench, (1.0 - FOR_PUBLISHED) * bench.budget.as_secs_f64())?;
    let Match { measured, reference } = contest.equal_times()?;
    let caption = format!("The published fog and lights, {} s each, sorted by RMSE.", number(times.each, 3));
    let published = bench.gallery(NAME, &caption, &measured, Some(&reference))?;
    let best = measured.first().map_or("-", |one| one.name.as_str()).to_string();
    let over_nee = gain(&measured, &MVNEE_4, &NEE);
    Ok(Section {
        text: vec![
            format!(
                "A court between two-storey arcades in fog of mean free path 5 m, lit by three coloured disks; a \
                 building of our own in the proportions of the Sponza palace. In the published fog arcades fade \
                 within a few bays. The first picture is the same building, camera and lights in fog of {CLEARER}/m \
                 instead of 0.2/m, with two pale disks above the court to fill the shadows, so that one sees what \
                 stands there."
            ),
            format!(
                "The drawings show {PATHS} paths of each technique that leave a point at 45 degrees to the way to a \
                 light, eight mean free paths away, in the same fog. NEE's walk for {WALK} vertices and then connect \
                 in a straight line. `fogbow paths` draws such pictures of any scene."
            ),
        ],
        claims: vec![claim(
            "In the same time MVNEE has RMSE 0.043, 0.028 and 0.061 in red, green and blue where NEE has 0.078, 0.057 \
             and 0.110: it is 3.4 times as efficient.",
            "Figure 1 of the paper, in the Sponza palace",
            over_nee.is_about(3.4),
            format!("MVNEE-4 is {} as efficient as NEE. The least error is that of {best}.", factor(over_nee)),
            "The building is another one: how far vertices are from the lights, and what is in between, decides how \
             much of the light connections of a few segments find.",
        )],
        tables: vec![table(&caption, &measured, &NEE, &reference)],
        plots: vec![drawing(bench)?, convergence(bench, NAME, "rmse", SCENE, &measured)?],
        galleries: vec![clear, published],
        turns: Measured::all_turns(&measured),
        ..Section::default()
    })
}

/// Disks above the court that fill the shadows, out of the picture: center, radius, radiance.
const FILL: [([f64; 3], f64, [f64; 3]); 2] =
    [([0.0, 26.0, -9.0], 9.0, [30.0, 28.0, 24.0]), ([0.0, 26.0, -1.0], 4.0, [24.0, 26.0, 32.0])];
/// Seconds over those from which on pictures have their full size: this one is smaller, and has less noise instead.
const SMALLER: f64 = 12.0;

/// The building, to be recognised.
fn clear(bench: &Bench<'_>, seconds: f64) -> Result<Gallery> {
    let disk = |(center, radius, radiance): ([f64; 3], f64, [f64; 3])| {
        let vector = |v: [f64; 3]| Value::from(v.to_vec());
        let keys = [
            ("type", Value::from("disk")),
            ("center", vector(center)),
            ("normal", vector([0.0, -1.0, 0.0])),
            ("radius", radius.into()),
            ("radiance", vector(radiance)),
        ];
        Value::Table(keys.into_iter().map(|(key, value)| (key.to_string(), value)).collect())
    };
    let own = bench.scenes.load(SCENE, &[])?.scene.light;
    let own = Value::try_from(own).expect("lights are made of names and numbers");
    let lights = own.as_array().into_iter().flatten().cloned().chain(FILL.map(disk)).collect();
    let changes = [("medium.scattering", Value::from(CLEARER)), ("light", Value::Array(lights))];
    // Light comes from surfaces here, which connect best in a straight line.
    let contender = NEE.contender(bench, SCENE, Size::for_seconds(seconds / SMALLER), &changes)?;
    let mut runs = bench.begin(vec![contender], &LeftOut::new())?;
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
    let caption = "To scale. The arrow is the direction in which paths set out from the start, 45 degrees off the way \
                   to the light, which is orange, seen from its edge.";
    bench.paths(NAME, "paths", caption, &panels?)
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
