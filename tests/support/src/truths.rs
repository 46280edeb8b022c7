//! Truths made by independent programs, from `tests/data`.

use std::path::{Path, PathBuf};

use fogbow::image::{Image, exr};
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// A folder of the project's tests.
fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(file)
}

/// What a JSON file says.
fn json<T: DeserializeOwned>(path: &Path) -> T {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The image called `name`.
pub fn image(name: &str) -> Image {
    exr::read_image(&data(&format!("{name}.exr"))).unwrap_or_else(|error| panic!("{error}"))
}

/// The mean of the image called `name` and its standard error, red, green and blue.
pub fn mean(name: &str) -> ([f64; 3], [f64; 3]) {
    let image = image(name);
    let plane = |channel: &str| image.channel(channel).expect("a plane").iter().map(|x| f64::from(*x));
    let pixels = (image.width * image.height) as f64;
    let mean = ["R", "G", "B"].map(|channel| plane(channel).sum::<f64>() / pixels);
    let error = ["SE.R", "SE.G", "SE.B"].map(|channel| plane(channel).map(|x| x * x).sum::<f64>().sqrt() / pixels);
    (mean, error)
}

/// An image of a scene as another camera direction sees it, by means of square blocks.
#[derive(Debug, Deserialize)]
pub struct Blocks {
    /// What the camera looks at, in the unit of the scene.
    pub look_at: [f64; 3],
    /// Its opening angle.
    pub vertical_fov_deg: f64,
    /// Pixels along each side of the image.
    pub size: u32,
    /// Pixels along each side of a block.
    pub block: u32,
    /// Mean radiance of the blocks, row by row from the top: red, green, blue.
    pub mean: Vec<[f64; 3]>,
    /// Their standard errors.
    pub standard_error: Vec<[f64; 3]>,
}

/// The blocks recorded as `name`.
pub fn blocks(name: &str) -> Blocks {
    json(&data(&format!("{name}.json")))
}

/// What a slab reflects and transmits of a beam along its normal.
#[derive(Clone, Copy, Debug)]
pub struct Slab {
    /// Albedo.
    pub albedo: f64,
    /// Mean cosine of its Henyey-Greenstein function.
    pub g: f64,
    /// Optical thickness.
    pub tau: f64,
    /// Share that is reflected.
    pub reflected: f64,
    /// Share that is transmitted, unscattered light included.
    pub transmitted: f64,
}

/// Slabs by adding and doubling.
pub fn slabs() -> Vec<Slab> {
    let table = std::fs::read_to_string(data("slabs.csv")).unwrap_or_else(|error| panic!("{error}"));
    let numbers = |line: &str| line.split(',').map(|number| number.parse().expect("a number")).collect::<Vec<f64>>();
    let row = |line: &str| match numbers(line)[..] {
        [albedo, g, tau, reflected, transmitted] => Slab { albedo, g, tau, reflected, transmitted },
        _ => panic!("{line}"),
    };
    table.lines().skip(1).map(row).collect()
}

/// What a sheet of 5 mm of a preset reflects and transmits of a beam along its normal, in three channels, by adding and
/// doubling.
pub fn sheet(preset: &str) -> [[f64; 3]; 2] {
    let table = std::fs::read_to_string(data("presets.csv")).unwrap_or_else(|error| panic!("{error}"));
    let row = |channel: usize| {
        let row = table.lines().find_map(|line| line.strip_prefix(&format!("{preset},{channel},"))).expect("a row");
        row.split(',').map(|number| number.parse().expect("a number")).collect::<Vec<f64>>()
    };
    let rows = [0, 1, 2].map(row);
    [0, 1].map(|column| [0, 1, 2].map(|channel: usize| rows[channel][column]))
}

/// Complete paths with density ratios.
#[derive(Debug, Deserialize)]
pub struct DensityRatios {
    /// The paths.
    pub cases: Vec<Case>,
}

/// A complete path from the camera to a light.
#[derive(Debug, Deserialize)]
pub struct Case {
    /// Mean cosine of the Henyey-Greenstein medium.
    pub g: f64,
    /// Extinction [1/m].
    pub mu_t: f64,
    /// Area of the light [m^2].
    pub light_area: f64,
    /// Unit normal of the light.
    pub light_normal: [f64; 3],
    /// x_0 .. x_n `[m]`.
    pub vertices: Vec<[f64; 3]>,
    /// Ratios for every start.
    pub starts: Vec<Start>,
}

/// The ratios of one start.
#[derive(Debug, Deserialize)]
pub struct Start {
    /// Index of the vertex.
    pub start: usize,
    /// Density of path tracing for the vertices behind it.
    pub path_tracing_density: f64,
    /// Next event estimation over path tracing.
    pub nee: f64,
    /// Multiple-vertex next event estimation over path tracing, without a limit on its length.
    pub mvnee: f64,
    /// Bridges rolled uniformly, Poisson counts, over path tracing.
    pub bridge: f64,
    /// Aligned bridges, Poisson counts, over path tracing.
    pub aligned_bridge: f64,
}

/// The recorded ratios, and those of the file that the environment variable `FOGBOW_DENSITY_RATIOS` names, if any.
pub fn density_ratios() -> Vec<Case> {
    let named = std::env::var_os("FOGBOW_DENSITY_RATIOS").map(PathBuf::from);
    let files = [Some(data("density_ratios.json")), named];
    files.into_iter().flatten().flat_map(|path| json::<DensityRatios>(&path).cases).collect()
}
