//! Memory of whole renders: the most that a process of its own ever has, as far as the system tells.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::{NAME, ground};
use crate::error::{Error, Result};
use crate::paper::bench::Bench;
use crate::paper::section::{Cell, Column, Plot, Show, Table};
use crate::plot::{self, Axis, Chart, Curve, Look};

/// Sides of images in pixels.
const SIDES: [u32; 5] = [64, 128, 256, 512, 1024];
/// Time between looks at a process.
const LOOK: Duration = Duration::from_millis(2);
/// Bytes of a megabyte.
const MEGABYTE: f64 = 1e6;
/// What every render has: one sample, and nothing is tried before.
const FLAGS: [&str; 10] = [
    "--samples",
    "1",
    "--progress",
    "none",
    "--set",
    "render.starts=1",
    "--set",
    "render.survival=1",
    "--set",
    "render.roulette=0",
];

/// What is varied, and the memory of each [MB].
struct Grown {
    what: &'static str,
    file: &'static str,
    points: Vec<(f64, f64)>,
}

/// Tables and plots of memory; none where the system does not tell it.
pub fn measure(bench: &Bench<'_>) -> Result<Vec<(Table, Plot)>> {
    let folder = tempfile::tempdir().map_err(|error| {
        let remedy = "free some room in the folder for temporary files, or name another one in TMPDIR";
        Error::failure("paper scaling", format!("no temporary folder can be made: {error}"), remedy)
    })?;
    let image = folder.path().join("image.exr");
    let render = |flags: &[String]| peak(&bench.scenes.folder("fog-facing"), flags, &image);
    let size = |side: u32| ["--size".to_string(), format!("{side}x{side}")];
    let of_pixels = SIDES.iter().filter_map(|side| Some((f64::from(*side).powi(2), render(&size(*side))?)));
    let of_pixels = Grown { what: "pixels", file: "memory-pixels", points: of_pixels.collect() };
    let mut of_triangles = Grown { what: "triangles", file: "memory-triangles", points: Vec::new() };
    for side in ground::SIDES {
        let file = ground::write(side)?;
        let geometry = ["--set".to_string(), format!("geometry={}", file.path().display())];
        let memory = render(&[size(SIDES[0]), geometry].concat());
        of_triangles.points.extend(memory.map(|memory| (f64::from(ground::triangles(side)), memory)));
    }
    let known = [of_pixels, of_triangles].into_iter().filter(|grown| !grown.points.is_empty());
    known.map(|grown| Ok((grown.table(), grown.chart(bench)?))).collect()
}

impl Grown {
    fn table(&self) -> Table {
        Table {
            caption: format!("Most memory of a render of fog-facing by bridges, against {}.", self.what),
            columns: Column::all([(self.what, Show::Digits(7)), ("memory [MB]", Show::Digits(3))]),
            rows: self.points.iter().map(|(x, memory)| vec![Cell::from(*x), Cell::from(*memory)]).collect(),
        }
    }

    fn chart(&self, bench: &Bench<'_>) -> Result<Plot> {
        let chart = Chart {
            title: format!("memory: {}", self.what),
            x: Axis::logarithmic(self.what),
            y: Axis::logarithmic("memory [MB]"),
            curves: vec![Curve::new("bridges", self.points.clone(), Look::MarkedLine, plot::colour("bridges", 0))],
            from_zero: false,
        };
        let caption = "Most memory of a process that renders one sample of fog-facing and writes an EXR image.";
        bench.plot(NAME, self.file, caption, &chart)
    }
}

/// Most memory of this program as it renders `scene` with `flags` to `image` [MB].
fn peak(scene: &Path, flags: &[String], image: &Path) -> Option<f64> {
    let program = std::env::current_exe().ok()?;
    let mut command = Command::new(program);
    command.arg("render").arg(scene).args(FLAGS).args(flags).arg("-o").arg(image);
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()?;
    let status = format!("/proc/{}/status", child.id());
    let mut most = None;
    let end = loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        most = text.lines().find_map(peak_in).or(most);
        match child.try_wait() {
            Ok(None) => std::thread::sleep(LOOK),
            Ok(Some(end)) => break end,
            Err(_) => return None,
        }
    };
    most.filter(|_| end.success())
}

/// The most memory of a process [MB], if that is what a line of its status says.
fn peak_in(line: &str) -> Option<f64> {
    let kilobytes: f64 = line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse().ok()?;
    Some(1024.0 * kilobytes / MEGABYTE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_from_the_status() {
        let text = "Name:\tfogbow\nVmPeak:\t  999 kB\nVmHWM:\t  125000 kB\nVmRSS:\t 3 kB\n";
        assert_eq!(text.lines().find_map(peak_in), Some(128.0));
    }
}
