//! The command line.

mod bar;
mod checkpoint_info;
mod checkpoints;
mod compare;
mod denoising;
mod depth;
mod destinations;
mod done;
mod finish;
mod frames;
mod info;
mod keeper;
mod loading;
mod merge;
mod onlookers;
mod outputs;
mod paper;
mod parts;
mod paths;
mod patience;
mod presets;
mod progress;
mod render;
mod signals;
mod values;
mod volume;

use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::error::{Error, Result};
use crate::scene::document::Override;
use crate::scene::schema::MOST_SAMPLES;
use crate::session::Reference;
use crate::warning::Warning;
use outputs::ImageOutput;
use values::{Checkpoints, FrameRange, SampleRange};

/// Renders light in fog, clouds, smoke, milk and wax, among lamps, fires and diffuse surfaces, under sun and sky.
#[derive(Debug, Parser)]
#[command(name = "fogbow", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// List every key of a scene file with its type, default and meaning.
    #[arg(long)]
    help_scene: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to EXR and PNG images.
    Render(Box<RenderArgs>),
    /// Compare two EXR images: how much they differ, and whether noise explains it.
    Compare(CompareArgs),
    /// Merge EXR images that are parts of one render (different samples or different pixels).
    Merge(MergeArgs),
    /// Describe a scene and what it costs to render, an image and its header, a checkpoint, or a volume and its grids.
    Info(InfoArgs),
    /// Make the tables and figures of the paper on multiple-vertex next event estimation again, as one HTML report.
    Paper(paper::PaperArgs),
    /// Draw paths that a technique makes from a point to the lights.
    Paths(paths::PathsArgs),
    /// List the media that a scene can name as its preset, with their coefficients and sources.
    Presets(PresetsArgs),
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Progress {
    /// A bar on a terminal, plain lines elsewhere.
    Auto,
    /// A bar.
    Bar,
    /// A line every few seconds.
    Plain,
    /// One JSON object per line, on standard error.
    Json,
    /// Lines for Open Job Description workers, on standard output.
    Openjd,
    /// Lines that Alfred and Tractor read, on standard output.
    Alf,
    /// Only warnings and errors.
    None,
}

/// What the help page says beyond flags.
const ABOUT_RENDERING: &str = "\
Surfaces come from glTF files. They reflect diffusely, with the base colour of their material. Metal, gloss,
transparency and normal maps are not rendered yet; a warning names the materials that use them. The back of a surface
is black unless its material is doubleSided.

A checkpoint is a file beside the first output, with .checkpoint after its name. It holds the exact sums so far, and is
removed once the render is done and its results are written. It is refused if it is damaged or of another scene, seed,
setting or crop. If there is one, a render that is neither told to --resume nor to --overwrite-checkpoint ends with an
error, unless checkpoints are off. SIGUSR1 has one written at once.

Exit codes: 0 success, 1 failure, 2 wrong command line, 75 interrupted, to be resumed. Where there are checkpoints,
SIGTERM or SIGHUP has a last one written, and fogbow exits with 75; run the same command with --resume to go on. Without
checkpoints fogbow writes the image so far, nothing if it has no samples yet, and exits with 143 or 129. Ctrl-C has the
image so far written, too, and leaves a checkpoint where there are any; the exit code is 130.";

#[derive(Debug, Args)]
#[command(after_help = ABOUT_RENDERING)]
struct RenderArgs {
    /// The scene: a TOML file, a folder with a scene.toml, or a glTF file with a camera.
    #[arg(required_unless_present = "help_scene")]
    scene: Option<PathBuf>,
    /// Where to write the image: a name that ends in .exr or .png, or exr:PATH or png:PATH for any other name. May be
    /// repeated. Default: the scene's name with .exr.
    #[arg(short, long = "output", value_name = "OUT.exr|OUT.png", value_parser = outputs::image())]
    output: Vec<ImageOutput>,
    /// Connection technique, or several separated by commas: path, nee, mvnee, omnee, bridge, lis.
    #[arg(long, value_name = "T[,T]")]
    technique: Option<String>,
    /// Layers of EXR images beside radiance, separated by commas: depth, normal, albedo, transmittance, and the radiance
    /// by technique and by length. See --help-scene, film.aov.
    #[arg(long, value_name = "A[,A]")]
    aov: Option<String>,
    /// Write images without noise as well, OUT.denoised.exr beside OUT.exr, if Intel's Open Image Denoise is installed.
    /// It is guided by the layers albedo and normal, which the image gets for that.
    #[arg(long)]
    denoise: bool,
    /// Longest MVNEE connection, in expected segments (extinction times distance, in the clearest channel, or in the
    /// mean of channels where media differ in colour).
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = values::mesc)]
    mesc: Option<f64>,
    /// Longest path, in segments, including the camera and light segments, or auto, where no number ends it.
    #[arg(long, value_name = "K|auto", allow_hyphen_values = true, value_parser = values::segments)]
    max_segments: Option<toml::Value>,
    /// Samples per pixel. Of --samples, --time and --noise, whichever comes first ends the render; without any of them
    /// it is render.samples of the scene.
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    #[arg(value_parser = values::whole_number("--samples", 1..=MOST_SAMPLES))]
    samples: Option<i64>,
    /// Render for this long, for example 60s or 2min, but at least one sample per pixel.
    #[arg(long, value_name = "DURATION", allow_hyphen_values = true, value_parser = values::time)]
    time: Option<Duration>,
    /// Render until the noise falls to this fraction, for example 0.01 for 1 %. Noise is the root mean square of the
    /// pixels' relative standard errors, leaving out the noisiest 1 % of the pixels.
    #[arg(long, value_name = "FRACTION", allow_hyphen_values = true, value_parser = values::noise)]
    noise: Option<f64>,
    /// Give noisy parts of the image more samples than others, from an eighth of the mean to about eight times it;
    /// --samples is then the number of samples of the mean pixel. The number is decided by samples that are not kept,
    /// so that the image stays unbiased. It pays where noise is uneven.
    #[arg(long)]
    adaptive: bool,
    /// Render samples A to B of every pixel, not including B, or as many of them as --time or --noise allow. Parts of
    /// the same render, made anywhere, are put together with fogbow merge. With --adaptive, A and B are samples of the
    /// mean pixel.
    #[arg(long, value_name = "A..B", conflicts_with = "samples", allow_hyphen_values = true)]
    #[arg(value_parser = values::sample_range)]
    sample_range: Option<SampleRange>,
    /// Size of the image in pixels, for example 1920x1080.
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Render only columns X0 to X1 and rows Y0 to Y1 of the image, not including X1 and Y1.
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true, value_parser = values::crop)]
    crop: Option<[u32; 4]>,
    /// Exposure of PNG images in stops, or auto, which makes the log-average luminance of the whole image middle grey,
    /// even if only a crop is rendered.
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true, value_parser = values::exposure)]
    exposure: Option<toml::Value>,
    /// Seed for all random numbers.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = values::whole_number("--seed", 0..=u32::MAX))]
    seed: Option<i64>,
    /// Render frames A to B, including B, or a single one, of the animations of the scene's glTF file: its cameras,
    /// lights and meshes move with their nodes. Names of outputs have #### where the number of the frame goes, as in
    /// a.####.exr. With --resume, frames are left out whose images are there.
    #[arg(long, value_name = "A-B", allow_hyphen_values = true, value_parser = values::frames)]
    frames: Option<FrameRange>,
    /// Frames per second: frame F is at F / FPS seconds of the animations. Default: 24.
    #[arg(long, value_name = "FPS", requires = "frames", allow_hyphen_values = true, value_parser = values::fps)]
    fps: Option<f64>,
    /// Number of worker threads; it does not change the image. Default: one per processor.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = values::threads)]
    threads: Option<u32>,
    /// Replace all stages, or only the one named, with their scalar f64 twins.
    #[arg(long, value_name = "STAGE", num_args = 0..=1, default_missing_value = "all", value_parser = values::stage)]
    reference: Option<Reference>,
    /// Write statistics as JSON, with counters and times for every stage.
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    progress: Progress,
    /// Show the render on a page for browsers while it runs: the image, its noise, progress, and statistics per stage
    /// and technique. Port 0 is any that is free; the address is printed. Only this machine can see it, unless an
    /// address to listen at is given, for example 0.0.0.0:8080.
    #[arg(long, value_name = "[ADDRESS:]PORT", value_parser = values::serve)]
    serve: Option<SocketAddr>,
    /// Show the image so far in a running tev, which listens at 127.0.0.1:14158 unless told otherwise.
    #[arg(long, value_name = "HOST:PORT", value_parser = values::preview)]
    preview: Option<String>,
    /// Override any key of the scene, for example medium.phase.g=0.6; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true, value_parser = Override::parse)]
    set: Vec<Override>,
    /// Write a checkpoint this often, for example 60s or 5min, or off. Default: every 60 s, unless the render is expected
    /// to take less than 2 minutes.
    #[arg(long, value_name = "DURATION|off", allow_hyphen_values = true, value_parser = values::checkpoints)]
    checkpoint: Option<Checkpoints>,
    /// Go on from the checkpoint, if there is one, to the same bits as if the render had not been interrupted. There
    /// may be more --samples than before, or less --noise; --time includes the time before. Without a checkpoint the
    /// render starts from the beginning, so that scripts can always give this flag, or is left out if all of its images
    /// are there, an EXR image among them that says so.
    #[arg(long)]
    resume: bool,
    /// Start from the beginning even if there is a checkpoint, which is replaced.
    #[arg(long, conflicts_with = "resume")]
    overwrite_checkpoint: bool,
    /// List every place that a warning is about, not only the first few.
    #[arg(short, long)]
    verbose: bool,
    /// List every key of a scene file with its type, default and meaning.
    #[arg(long)]
    help_scene: bool,
}

#[derive(Debug, Args)]
struct CompareArgs {
    /// The first image.
    a: PathBuf,
    /// The second image, the reference for relative figures.
    b: PathBuf,
    /// Print the comparison as JSON.
    #[arg(long)]
    json: bool,
    /// Write a picture of the difference: red where the first image is brighter, blue where it is darker. A name that
    /// ends in .png, a pipe, or png:PATH. If it is standard output, the comparison is on standard error.
    #[arg(long, value_name = "DIFF.png", value_parser = outputs::difference())]
    png: Option<PathBuf>,
}

/// What the help page of merge says beyond flags.
const ABOUT_MERGING: &str = "\
EXR images of fogbow hold exact sums of their samples. Parts made with --sample-range or --crop, in any order, on any
machines, merge to exactly the image of a single render, adaptive or not; in adaptive renders, each crop counts as a
render of its own. Parts of other scenes or settings, and samples that two parts have, are refused; a warning says which
samples are missing, or with --expect an error. What was merged can be merged again.";

#[derive(Debug, Args)]
#[command(after_help = ABOUT_MERGING)]
struct MergeArgs {
    /// The parts: EXR images, folders of them, or @LIST, a file with a path in every line (for an image called @a.exr
    /// give ./@a.exr). Images in a folder that this command writes are no parts.
    #[arg(required = true, value_name = "PART.exr|FOLDER|@LIST")]
    parts: Vec<PathBuf>,
    /// Where to write the image: a name that ends in .exr or .png, or exr:PATH or png:PATH for any other name. May be
    /// repeated.
    #[arg(short, long = "output", value_name = "OUT.exr|OUT.png", required = true, value_parser = outputs::image())]
    output: Vec<ImageOutput>,
    /// Exposure of PNG images in stops, or auto, which makes the log-average luminance of the merged image middle grey.
    /// Default: what the scene of the parts says.
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true, value_parser = values::exposure)]
    exposure: Option<toml::Value>,
    /// Fail, and write nothing, unless the parts together have samples A to B of every pixel, not including B, and no
    /// others. Of adaptive parts, A and B are samples of the mean pixel, as they are for render.
    #[arg(long, value_name = "A..B", conflicts_with = "weighted", allow_hyphen_values = true)]
    #[arg(value_parser = values::expected)]
    expect: Option<SampleRange>,
    /// Pixels that --expect is about, if not all of the image: columns X0 to X1 and rows Y0 to Y1, not including X1 and
    /// Y1.
    #[arg(long, value_name = "X0,Y0,X1,Y1", requires = "expect", allow_hyphen_values = true)]
    #[arg(value_parser = values::crop)]
    crop: Option<[u32; 4]>,
    /// Write the merged image without noise as well, as render does; its parts need the layers albedo and normal.
    #[arg(long, conflicts_with = "weighted")]
    denoise: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    progress: Progress,
    /// Merge images without exact sums, of equal size, by the mean of their pixels: weighted by the number of samples
    /// (channel N) if all have such a channel, alike otherwise. Nothing else is checked.
    #[arg(long)]
    weighted: bool,
}

#[derive(Debug, Args)]
struct InfoArgs {
    /// A TOML file, a folder with a scene.toml, a glTF file, an EXR image, a checkpoint, or an OpenVDB file.
    path: PathBuf,
    /// Override any key of the scene, for example medium.phase.g=0.6; may be repeated; for scenes alone.
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true, value_parser = Override::parse)]
    set: Vec<Override>,
    /// List every place that a warning is about, not only the first few.
    #[arg(short, long)]
    verbose: bool,
}

#[derive(Debug, Args)]
struct PresetsArgs {
    /// Print the list as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the program with `args`, the program's name first.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => return explain(&error),
    };
    let outcome = match cli.command {
        _ if cli.help_scene => render::help_scene(),
        Some(Command::Render(args)) => Ok(render::run(&args).unwrap_or_else(|error| args.progress.fail(&error))),
        Some(Command::Compare(args)) => compare::run(&args).map(|()| ExitCode::SUCCESS),
        Some(Command::Merge(args)) => Ok(match merge::run(&args) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => args.progress.fail(&error),
        }),
        Some(Command::Info(args)) => info::run(&args).map(|()| ExitCode::SUCCESS),
        Some(Command::Paper(args)) => paper::run(&args),
        Some(Command::Paths(args)) => paths::run(&args).map(|()| ExitCode::SUCCESS),
        Some(Command::Presets(args)) => presets::run(&args).map(|()| ExitCode::SUCCESS),
        None => unreachable!("without arguments the parser prints help"),
    };
    outcome.unwrap_or_else(|error| fail(&error))
}

/// Prints what clap says, wrong values in the same form as all other errors, and gives the exit code.
fn explain(error: &clap::Error) -> ExitCode {
    let own = std::error::Error::source(error).and_then(|source| source.downcast_ref::<Error>());
    if let Some(error) = own.cloned().or_else(|| wrong_choice(error)) {
        return fail(&error);
    }
    // Help and version are errors to clap, but not to the shell.
    let _ = error.print();
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

/// The error that a value is none of those that its flag knows.
fn wrong_choice(error: &clap::Error) -> Option<Error> {
    let context = (error.get(ContextKind::InvalidArg)?, error.get(ContextKind::InvalidValue)?);
    let (ContextValue::String(flag), ContextValue::String(value)) = context else { return None };
    let ContextValue::Strings(choices) = error.get(ContextKind::ValidValue)? else { return None };
    if error.kind() != ErrorKind::InvalidValue || value.is_empty() {
        return None;
    }
    let flag = flag.split(' ').next().unwrap_or(flag);
    Some(Error::usage(
        format!("{flag} {value}"),
        "is not one of the choices",
        format!("choose one of {}", choices.join(", ")),
    ))
}

/// Prints `error` and gives its exit code.
pub fn fail(error: &Error) -> ExitCode {
    tell(error);
    ExitCode::from(error.exit_code())
}

/// A warning, with all its places or the first ones.
fn warning_text(warning: &Warning, verbose: bool) -> String {
    if verbose { format!("{warning:#}") } else { warning.to_string() }
}

/// Prints a line to standard error. If nobody can read it, there is nobody to tell.
fn tell(line: impl core::fmt::Display) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Prints a line to standard output; a reader that has gone away is not an error.
fn say(line: impl core::fmt::Display) -> Result<()> {
    use std::io::Write;
    match writeln!(std::io::stdout().lock(), "{line}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            let finding = format!("cannot be written: {error}");
            Err(Error::failure(
                "standard output",
                finding,
                "check where standard output goes and whether there is free space",
            ))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
