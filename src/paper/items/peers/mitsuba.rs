//! Mitsuba 3, as a program that renders a few samples when it is told to.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::json;

use super::NAME;
use crate::paper::bench::Bench;
use crate::scene::LoadedScene;
use crate::scene::schema::Segments;

/// The script, beside the scenes.
const SCRIPT: &str = "beside_mitsuba.py";
/// What it says of its errors.
const LOG: &str = "mitsuba.log";
/// What runs it.
const PYTHON: &str = "python3";

/// A running script.
pub struct Mitsuba {
    child: Child,
    told: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// What it is called: version and variant.
    pub name: String,
    /// Samples per pixel so far.
    pub samples: f64,
    /// Seconds that they took.
    pub seconds: f64,
}

impl Mitsuba {
    /// Starts it with a scene. Or says why that does not work.
    pub fn start(bench: &Bench<'_>, name: &str, scene: &LoadedScene) -> Result<Self, String> {
        let script = bench.scenes.folder(SCRIPT);
        if !script.is_file() {
            return Err(format!("there is no {}", script.display()));
        }
        let file = bench.folder.file(NAME, &format!("{name}.json")).map_err(|error| error.to_string())?;
        let text = keys(bench, name, scene)?.to_string();
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
        let mut peer = Self { child, told, answers, name: String::new(), samples: 0.0, seconds: 0.0 };
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

    /// Goes on until it has had `seconds`, at least for one sample of every pixel.
    pub fn until(&mut self, seconds: f64) -> Result<(), String> {
        while self.seconds < seconds || self.samples == 0.0 {
            let samples = 0.9 * (seconds - self.seconds) * self.samples / self.seconds;
            let samples = if samples.is_finite() { samples.clamp(1.0, 1e5) as u32 } else { 1 };
            let told = self.ask(&format!("render {samples}"))?;
            // It renders a few samples at a time, so they may be more.
            let figures: Vec<f64> = told.split_whitespace().filter_map(|figure| figure.parse().ok()).collect();
            let [seconds, samples] = figures[..] else { return Err(format!("Mitsuba says {told:?}")) };
            self.seconds += seconds;
            self.samples += samples;
        }
        Ok(())
    }

    /// Writes the image so far.
    pub fn write(&mut self, path: &Path) -> Result<(), String> {
        self.ask(&format!("write {}", path.display())).map(drop)
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

impl Drop for Mitsuba {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What the script has to know of a scene.
fn keys(bench: &Bench<'_>, name: &str, loaded: &LoadedScene) -> Result<serde_json::Value, String> {
    let scene = &loaded.scene;
    let Some(medium) = &scene.medium else { return Err(format!("{name} has no medium")) };
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
        "medium": {
            "scattering": medium.scattering.0,
            "absorption": medium.absorption.0,
            "g": loaded.frame.medium.phase.mean_cosine(),
        },
        "lights": lights.collect::<Vec<_>>(),
        "geometry": geometry,
        "max_segments": segments,
    }))
}
