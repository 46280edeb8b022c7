//! Mitsuba 3, as a program that renders a few samples when it is told to.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::json;

use super::NAME;
use super::dense::Dense;
use crate::image::exr;
use crate::paper::Tell;
use crate::paper::bench::Bench;
use crate::paper::size::STEPS;
use crate::paper::turns::{Log, Renders};
use crate::scene::LoadedScene;
use crate::scene::schema::{OneOrTwo, PhaseKind, Segments, Volume};
use crate::volume;

/// The script, beside the scenes.
const SCRIPT: &str = "beside_mitsuba.py";
/// What it says of its errors.
const LOG: &str = "mitsuba.log";
/// Calls in its time, at least: enough that they end near it, and not more, as calls of many paths are faster per path.
const CALLS: f64 = STEPS;
/// What runs it.
const PYTHON: &str = "python3";

/// A running script.
pub struct Mitsuba {
    child: Child,
    told: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// What it is called: version and variant.
    pub name: String,
    /// Its image, once it is written.
    image: PathBuf,
    /// What it has done.
    pub log: Log,
}

/// Whether Mitsuba can be imported.
pub fn is_there() -> bool {
    let mut command = Command::new(PYTHON);
    command.args(["-c", "import mitsuba, numpy"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

impl Mitsuba {
    /// Starts it with a scene, of which it will leave an EXR image called `image` after `seconds` of rendering. Or says
    /// why that does not work.
    pub fn start(
        bench: &Bench<'_>,
        name: &str,
        scene: &LoadedScene,
        image: &str,
        seconds: f64,
    ) -> Result<Self, String> {
        let script = bench.scenes.folder(SCRIPT);
        if !script.is_file() {
            return Err(format!("there is no {}", script.display()));
        }
        let file = bench.folder.file(NAME, &format!("{name}.json")).map_err(|error| error.to_string())?;
        let text = keys(bench, name, scene, seconds / CALLS)?.to_string();
        bench.folder.write(&file, &text).map_err(|error| error.to_string())?;
        let mut command = Command::new(PYTHON);
        let log = file.with_file_name(LOG);
        let errors = File::create(&log).map_err(|error| format!("{} cannot be written: {error}", log.display()))?;
        command.arg(script).arg(&file).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(errors);
        if bench.workers > 0 {
            command.env("DRJIT_NUM_THREADS", bench.workers.to_string());
        }
        let mut child = command.spawn().map_err(|error| format!("{PYTHON} cannot be started: {error}"))?;
        let (Some(told), Some(stdout)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("{PYTHON} has no pipes"));
        };
        let answers = BufReader::new(stdout);
        let image = file.with_file_name(image);
        let mut peer = Self { child, told, answers, name: String::new(), image, log: Log::default() };
        let ready = peer.answer().unwrap_or_default();
        match ready.strip_prefix("ready ") {
            Some(version) => peer.name = format!("Mitsuba {}", version.trim()),
            None => {
                return Err(format!(
                    "{PYTHON} cannot import mitsuba and numpy, or they cannot run here; {NAME}/{LOG} has more"
                ));
            }
        }
        Ok(peer)
    }

    fn ask(&mut self, line: &str) -> Result<String, String> {
        writeln!(self.told, "{line}").map_err(|error| format!("Mitsuba has ended: {error}"))?;
        self.answer()
    }

    fn answer(&mut self) -> Result<String, String> {
        let mut line = String::new();
        match self.answers.read_line(&mut line) {
            Ok(length) if length > 0 => Ok(line.trim().to_string()),
            Ok(_) => Err("Mitsuba has ended".into()),
            Err(error) => Err(format!("Mitsuba cannot be read: {error}")),
        }
    }
}

impl Renders for Mitsuba {
    fn take(&mut self, samples: u32, _: &dyn Tell) -> Result<(f64, f64), String> {
        // It renders a few samples at a time, so these may be more.
        let told = self.ask(&format!("render {samples}"))?;
        let figures: Vec<f64> = told.split_whitespace().filter_map(|figure| figure.parse().ok()).collect();
        let [seconds, samples] = figures[..] else { return Err(format!("Mitsuba says {told:?}")) };
        Ok((samples, seconds))
    }

    fn means(&mut self) -> Result<Vec<[f32; 3]>, String> {
        self.ask(&format!("write {}", self.image.display()))?;
        let image = exr::read_image(&self.image).map_err(|error| error.to_string())?;
        let planes = ["R", "G", "B"].map(|name| image.channel(name).unwrap_or_default());
        let pixel = |i: usize| planes.map(|plane| plane.get(i).copied().unwrap_or(f32::NAN));
        Ok((0..image.width * image.height).map(pixel).collect())
    }

    fn log(&mut self) -> &mut Log {
        &mut self.log
    }
}

impl Drop for Mitsuba {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What the script has to know of a scene, of which a call is to take about `call` seconds.
fn keys(bench: &Bench<'_>, name: &str, loaded: &LoadedScene, call: f64) -> Result<serde_json::Value, String> {
    let scene = &loaded.scene;
    let medium = scene.medium.as_ref().map(|medium| {
        json!({
            "scattering": medium.scattering.0,
            "absorption": medium.absorption.0,
            "g": loaded.frame.medium.phase.mean_cosine(),
        })
    });
    let volumes = scene.volume.iter().enumerate().map(|(index, volume)| cloud(bench, name, index, volume));
    let volumes = volumes.collect::<Result<Vec<_>, _>>()?;
    let Segments::Most(segments) = scene.render.max_segments else { return Err(format!("{name} has no limit")) };
    let lights = loaded.lights.iter().map(|light| {
        let values = &light.values;
        let radiance = values.radiance.map(|spectrum| spectrum.0);
        json!({ "center": values.center, "normal": values.normal, "radius": values.radius, "radiance": radiance })
    });
    let geometry = scene.geometry.as_ref().map(|file| bench.scenes.folder(name).join(file));
    Ok(json!({
        "size": scene.film.size,
        "camera": {
            "position": loaded.camera.position,
            "look_at": loaded.camera.look_at,
            "up": loaded.camera.up,
            "vertical_fov_deg": loaded.camera.vertical_fov_deg,
            "near": loaded.camera.near,
        },
        "medium": medium,
        "volumes": volumes,
        "lights": lights.collect::<Vec<_>>(),
        "geometry": geometry,
        "max_segments": segments,
        "call": call,
    }))
}

/// What it has to know of a volume of voxels, whose densities are left in a file: little-endian f32.
fn cloud(bench: &Bench<'_>, name: &str, index: usize, volume: &Volume) -> Result<serde_json::Value, String> {
    let (Some(grid), None, None) = (&volume.grid, &volume.shape, &volume.emission_grid) else {
        return Err(format!("{name} has a volume that is not just a grid"));
    };
    let (PhaseKind::HenyeyGreenstein, Some(OneOrTwo::One(g))) = (volume.phase.kind, volume.phase.g) else {
        return Err(format!("{name} has a volume whose phase function is not that of Henyey and Greenstein"));
    };
    let vdb = bench.scenes.folder(name).join(&grid.file);
    let voxels = volume::read(&vdb, grid.name.as_deref(), &|_, _| {}).map_err(|error| error.to_string())?;
    let Dense { counts, corners, densities } = Dense::of(&voxels, grid)?;
    let file = bench.folder.file(NAME, &format!("{name}-{index}.f32")).map_err(|error| error.to_string())?;
    let bytes: Vec<u8> = densities.iter().flat_map(|density| density.to_le_bytes()).collect();
    fs::write(&file, bytes).map_err(|error| format!("{} cannot be written: {error}", file.display()))?;
    Ok(json!({
        "counts": counts,
        "corners": corners,
        "densities": file,
        "scattering": volume.scattering.0.map(|scattering| scattering * grid.scale),
        "absorption": volume.absorption.0.map(|absorption| absorption * grid.scale),
        "g": g,
    }))
}
