//! `fogbow paths`

use std::path::PathBuf;

use clap::Args;
use fogbow_kernels::connect::Technique;
use glam::DVec3;

use super::destinations::{self, Destination};
use super::outputs::{self, DrawingFormat, DrawingOutput};
use super::progress::Reporter;
use super::values::LightChoice;
use super::{loading, tell, values, warning_text};
use crate::error::{Error, Result};
use crate::figures::number;
use crate::image::png;
use crate::output;
use crate::paths::{self, Found, Request};
use crate::plot::{self, Panel};
use crate::scene::LoadedScene;
use crate::scene::document::Override;
use crate::scene::schema;

/// What the help page of paths says beyond flags.
const ABOUT_PATHS: &str = "\
A path leaves --from in the direction --dir, is traced for --walk vertices, and is then joined with a light by the
technique, as in a render. With path it is traced until it meets a light by itself, which takes many tries. Paths with
something in the way are not drawn. The drawing is to scale, on the plane of the start, the direction and the light.

With nee, --walk decides where the straight connection begins; for other techniques 1 is what a camera ray does. mvnee
and bridge connect no farther than the scene lets them, in expected segments: render.mesc and render.bridge_mesc.
--set render.mesc=20 raises the limit.";

#[derive(Debug, Args)]
#[command(after_help = ABOUT_PATHS)]
pub struct PathsArgs {
    /// The scene: a TOML file, a folder with a scene.toml, or a glTF file with a camera.
    scene: PathBuf,
    /// Where to draw to: a name that ends in .svg, .png (without letters) or .csv (a table of all vertices, in
    /// metres). May be repeated.
    #[arg(short, long = "output", value_name = "OUT.svg|OUT.png|OUT.csv", required = true)]
    #[arg(value_parser = outputs::drawing())]
    output: Vec<DrawingOutput>,
    /// Where paths begin, in metres. Default: the camera.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    from: Option<[f64; 3]>,
    /// The direction in which they leave. Default: that in which the camera looks.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::direction)]
    dir: Option<[f64; 3]>,
    /// Where they end: light for any light, or light[N] for that of this number, counted from 0.
    #[arg(long, value_name = "light|light[N]", default_value = "light", value_parser = values::target)]
    to: LightChoice,
    /// Number of paths.
    #[arg(long, value_name = "N", default_value = "10", value_parser = values::whole_number("--count", 1..=10_000_u32))]
    count: i64,
    /// What joins them with the light: path, nee, mvnee, omnee, bridge or lis. Default: the first technique of the
    /// scene.
    #[arg(long, value_name = "T")]
    technique: Option<String>,
    /// Vertices that path tracing makes before the connection.
    #[arg(long, value_name = "N", default_value = "1", value_parser = values::whole_number("--walk", 1..=1000_u32))]
    walk: i64,
    /// Seed for all random numbers.
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    #[arg(value_parser = values::whole_number("--seed", 0..=u32::MAX))]
    seed: Option<i64>,
    /// Override any key of the scene, for example medium.phase.g=0.6; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true, value_parser = Override::parse)]
    set: Vec<Override>,
    /// List every place that a warning is about, not only the first few.
    #[arg(short, long)]
    verbose: bool,
}

pub fn run(args: &PathsArgs) -> Result<()> {
    let Some(scene) = loading::load(&args.scene, overrides(args)?, None, &mut Reporter::for_terminals(), || false)?
    else {
        unreachable!("nothing interrupts it");
    };
    scene.warnings.iter().for_each(|warning| tell(format!("warning: {}", warning_text(warning, args.verbose))));
    let outputs: Vec<_> = args.output.iter().map(|out| Destination { flag: "--output", path: &out.path }).collect();
    destinations::check(&outputs, &scene.files)?;
    let request = request(args, &scene)?;
    let Some(target) = paths::middle(&scene.frame, request.light) else {
        let finding = "has no light with a place that paths could lead to";
        return Err(Error::failure(scene.name, finding, "add a [[light]] with a place, or name another scene"));
    };
    let found = paths::find(&scene.frame, &request);
    let name = request.technique.map_or("path", Technique::name);
    let count = match found.paths.len() {
        1 => "1 path".into(),
        count => format!("{count} paths"),
    };
    if found.paths.is_empty() {
        let finding = format!("none of {} paths by {name} reached the light", found.tried);
        let [more, remedy] = limit(&scene, &request, target).map_or_else(Default::default, |limit| limit.words());
        let remedy = format!("{remedy}choose another --technique, --from or --dir, or less --walk");
        return Err(Error::failure(&scene.name, finding + &more, remedy));
    }
    let title = format!("{}: {count} by {name}, of {} tried", scene.name, found.tried);
    if (found.paths.len() as i64) < args.count {
        tell(format!("warning: {title}; --count asks for {}", args.count));
    }
    let panel = paths::panel(&scene.frame, title, &found, target, plot::colour(name, 0));
    args.output.iter().try_for_each(|to| write(to, &panel, &found, scene.origin))
}

/// A limit of the scene on connections that is shorter than the way to the light.
struct Limit {
    key: &'static str,
    /// In expected segments, and in metres.
    segments: f64,
    length: f64,
    /// The way to the light `[m]`.
    distance: f64,
}

impl Limit {
    /// What it does, and what to do about it.
    fn words(&self) -> [String; 2] {
        let Self { key, segments, length, distance } = self;
        // Paths set out aside, so that some of the way is added to them.
        let enough = (2.0 * segments * distance / length).ceil();
        let finding = format!(
            ", which is {} m away: {key} = {segments} lets them connect over {} m",
            number(*distance, 3),
            number(*length, 3)
        );
        [finding, format!("raise the limit, for example with --set {key}={enough}; or ")]
    }
}

/// The limit that keeps the technique of `request` from reaching `target`, if there is one.
fn limit(scene: &LoadedScene, request: &Request, target: DVec3) -> Option<Limit> {
    let (render, techniques) = (&scene.scene.render, &scene.frame.techniques);
    let (key, segments, length) = match request.technique? {
        Technique::Mvnee => ("render.mesc", render.mesc?, techniques.mvnee.as_ref()?.max_distance),
        Technique::Bridge => ("render.bridge_mesc", render.bridge_mesc?, techniques.bridge.as_ref()?.max_distance),
        _ => return None,
    };
    let (length, distance) = (f64::from(length), target.distance(request.from));
    (distance > length).then_some(Limit { key, segments, length, distance })
}

/// The scene's keys that flags override, before those of `--set`.
fn overrides(args: &PathsArgs) -> Result<Vec<Override>> {
    let change =
        |key: &str, value: toml::Value, flag: String| Override { key: key.into(), value, flag, is_dedicated: true };
    if let Some(list) = args.technique.as_ref().filter(|technique| technique.contains(',')) {
        let finding = "names several techniques";
        return Err(Error::usage(format!("--technique {list}"), finding, "name one; draw the others by themselves"));
    }
    let technique =
        args.technique.as_ref().map(|t| change("render.technique", t.clone().into(), format!("--technique {t}")));
    let seed = args.seed.map(|seed| change("render.seed", seed.into(), format!("--seed {seed}")));
    Ok(technique.into_iter().chain(seed).chain(args.set.iter().cloned()).collect())
}

/// What the flags ask for; what they leave open is the camera's.
fn request(args: &PathsArgs, scene: &LoadedScene) -> Result<Request> {
    let camera = &scene.camera;
    let (position, view) = (DVec3::from(camera.position), DVec3::from(camera.look_at) - DVec3::from(camera.position));
    let from = args.from.map_or(position, DVec3::from) - DVec3::from(scene.origin);
    let direction = args.dir.map_or(view.normalize(), DVec3::from);
    let lights = scene.frame.lights.given().len();
    if let Some(light) = args.to.0.filter(|light| *light as usize >= lights) {
        let finding = match lights {
            0 => "the scene has no light with a place".into(),
            1 => "the scene has one light with a place".into(),
            _ => format!("the scene has {lights} lights with a place"),
        };
        return Err(Error::usage(
            format!("--to light[{light}]"),
            finding,
            "count from 0, or give light for any of them",
        ));
    }
    let technique = match scene.scene.render.technique.0.first() {
        None | Some(schema::Technique::Path) => None,
        Some(first) => Technique::ALL.into_iter().find(|technique| technique.name() == first.name()),
    };
    Ok(Request { from, direction, count: args.count as u32, technique, walk: args.walk as u32, light: args.to.0 })
}

fn write(to: &DrawingOutput, panel: &Panel, found: &Found, origin: [f64; 3]) -> Result<()> {
    let panels = core::slice::from_ref(panel);
    output::write(
        &to.path,
        || false,
        |file| {
            let failed = |error: std::io::Error| error.to_string();
            match to.format {
                DrawingFormat::Svg => file.write_all(plot::paths_svg(panels)?.as_bytes()).map_err(failed),
                DrawingFormat::Csv => file.write_all(paths::csv(found, origin).as_bytes()).map_err(failed),
                DrawingFormat::Png => {
                    let (pixels, size) = plot::paths_png(panels)?;
                    let rows = pixels.chunks(3 * size[0] as usize).map(|row| row.iter().copied());
                    png::write_rows(file, size, rows, &[("title", panel.title.clone())])
                }
            }
        },
    )
}
