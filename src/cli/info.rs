//! `fogbow info`

use std::path::Path;
use std::time::{Duration, Instant};

use fogbow_kernels::WalkLimits;
use fogbow_kernels::pipeline::WIDEST;

use super::frames::FRAMES_PER_SECOND;
use super::progress::Reporter;
use super::{InfoArgs, checkpoint_info, depth, loading, say, volume, warning_text};
use crate::error::{Error, Result};
use crate::figures::{duration, extent, number, rate, starts, survival_in_words};
use crate::film::{self, Film, Region};
use crate::gltf::{Animated, quoted};
use crate::image::{self, Format};
use crate::pilot;
use crate::render::{Monitor, Renderer, Workers};
use crate::scene::schema::{Grid, LightKind, Medium};
use crate::scene::{ANGULAR_RADIUS, Contents, Densities, Filling, Light, LoadedScene};
use crate::session::checkpoint::is_checkpoint;
use crate::truncation::{self, Truncation};
use crate::volume::is_volume;

/// How long the rate is measured.
const PILOT: Duration = Duration::from_millis(300);
/// About how many pixels the rate is measured on.
const PILOT_PIXELS: u32 = 1 << 14;
/// Optical depth of nothing: weights are given at least that much.
const NO_DEPTH: f32 = 1e-8;
/// Meshes and lights of a scene, and grids of a volume, that are named.
pub const MOST_NAMED: usize = 20;

pub fn run(args: &InfoArgs) -> Result<()> {
    let path = args.path.as_path();
    let format = Format::of(path);
    if format == Some(Format::Png) {
        let remedy = "give a scene, or the EXR image of the same render";
        return Err(Error::failure(path.display(), "is a PNG image, which holds no radiance", remedy));
    }
    if is_checkpoint(path) {
        without_settings(args, "a checkpoint")?;
        checkpoint_info::describe(path)
    } else if is_volume(path) {
        without_settings(args, "an OpenVDB file")?;
        volume::describe(path)
    } else if format == Some(Format::Exr) {
        without_settings(args, "an image")?;
        describe_image(path)
    } else {
        describe_scene(&load(args)?, args.verbose)
    }
}

/// Whether no key of a scene is set; `what` is what is described in its place.
fn without_settings(args: &InfoArgs, what: &str) -> Result<()> {
    let Some(set) = args.set.first() else { return Ok(()) };
    let finding = format!("is for scenes, but {} is {what}", args.path.display());
    Err(Error::usage(&set.flag, finding, "leave it out, or give a scene"))
}

/// The scene; no signal is waited for, so that one ends the program as usual.
fn load(args: &InfoArgs) -> Result<LoadedScene> {
    let loaded = loading::load(&args.path, args.set.clone(), None, &mut Reporter::for_terminals(), || false)?;
    Ok(loaded.expect("nothing interrupts it"))
}

fn describe_image(path: &Path) -> Result<()> {
    let image = image::exr::read_image(path)?;
    say(format!("{}: {}x{} pixels", path.display(), image.width, image.height))?;
    for (name, values) in &image.channels {
        let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
        say(format!("  {name:5} mean {}", number(mean, 6)))?;
    }
    for (name, text) in &image.header {
        let name = name.strip_prefix(image::exr::PREFIX).unwrap_or(name);
        match text.trim_end().split_once('\n') {
            None => say(format!("{name}: {text}"))?,
            Some(_) => say(format!("{name}:\n{}", indented(text)))?,
        }
    }
    Ok(())
}

fn indented(text: &str) -> String {
    let lines = text.trim_end().lines();
    let lines = lines.map(|line| if line.is_empty() { String::new() } else { format!("  {line}") });
    lines.collect::<Vec<_>>().join("\n")
}

/// A value per channel: one number if it is grey.
fn spectrum(channels: [f32; 3]) -> String {
    let channels = channels.map(|channel| number(f64::from(channel), 4));
    if channels.iter().all(|channel| *channel == channels[0]) { channels[0].clone() } else { channels.join(" | ") }
}

/// Mean free path and albedo of a medium of density 1 times `scale`; none in vacuum.
fn coefficients(medium: &Medium, scale: f64) -> Option<(String, String)> {
    let [scattering, absorption] =
        [medium.scattering.0, medium.absorption.0].map(|of| of.map(|channel| scale * channel));
    let extinction = [0, 1, 2].map(|c: usize| scattering[c] + absorption[c]);
    let free_path = spectrum(extinction.map(|extinction| (1.0 / extinction) as f32));
    let albedo =
        [0, 1, 2].map(|c: usize| if extinction[c] > 0.0 { (scattering[c] / extinction[c]) as f32 } else { 0.0 });
    (extinction != [0.0; 3]).then(|| (free_path, spectrum(albedo)))
}

/// What a grid is called, of which these are the densities.
fn title(grid: &Grid, densities: Option<&Densities>) -> String {
    let name = densities.map(|densities| &densities.grid).or(grid.name.as_ref());
    let name = name.map_or_else(String::new, |name| format!("grid {} of ", quoted(name)));
    name + &quoted(&grid.file)
}

/// What a medium emits times `scale`, as the end of a line about it; `grid` is what multiplies it.
fn glow(medium: &Medium, scale: f64, grid: Option<String>) -> String {
    if medium.emission.is_black() {
        return String::new();
    }
    let of = grid.map_or_else(String::new, |grid| format!(" times {grid}"));
    format!(", emission {} W/(m^3 sr){of}", spectrum(medium.emission.0.map(|channel| (scale * channel) as f32)))
}

fn describe_volumes(loaded: &LoadedScene) -> Result<()> {
    for (volume, filling) in loaded.scene.volume.iter().zip(&loaded.fillings) {
        let name = volume.name.as_ref().map_or_else(String::new, |name| format!(" {}", quoted(name)));
        let shape = volume.shape.as_ref().map(|shape| format!("a {}", shape.kind.name()));
        let densities = filling.as_ref().and_then(|filling| filling.densities.as_ref());
        let grid = volume.grid.as_ref().map(|grid| title(grid, densities));
        let what = [shape, grid].into_iter().flatten().collect::<Vec<_>>().join(" with ");
        let what = if what.is_empty() { "a flame".into() } else { what };
        let glowing = filling.as_ref().and_then(|filling| filling.glowing.as_ref());
        let emission = volume.emission_grid.as_ref();
        let title_of_glow = emission.map(|grid| title(grid, glowing));
        let glow = glow(&volume.medium(), emission.map_or(1.0, |grid| grid.scale), title_of_glow);
        let of = if volume.grid.is_some() { " at density 1" } else { "" };
        let scale = volume.grid.as_ref().map_or(1.0, |grid| grid.scale);
        let inside = coefficients(&volume.medium(), scale).map_or_else(
            || "vacuum".into(),
            |(free_path, albedo)| {
                let turns = filling.as_ref().map_or_else(String::new, |filling| {
                    format!(", {} of mean cosine {}", volume.phase.kind.name(), number(filling.mean_cosine, 4))
                });
                format!("mean free path {free_path} m{of}, albedo {albedo}{turns}")
            },
        );
        say(format!("volume{name}: {what}, {inside}{glow}"))?;
        match filling {
            Some(filling) => describe_filling(filling, &volume.medium(), scale)?,
            None => say("  nothing: its grid has no density that counts")?,
        }
    }
    let Some(field) = loaded.frame.medium.field() else { return Ok(()) };
    let medium = &loaded.frame.medium;
    let free_path = match medium.extinctions() {
        [0.0, 0.0, 0.0] => "no extinction".into(),
        extinctions => {
            format!("mean free path at least {} m", spectrum(extinctions.map(|extinction| 1.0 / extinction)))
        }
    };
    let [x, y, z] = field.cells().dims();
    let size = medium.bytes() >> 10;
    say(format!("volumes: {free_path}; {x}x{y}x{z} cells, shared grids counted once, {size} KiB"))
}

/// Where a volume of `medium` is and what it takes; of its grid, whose densities are multiplied by `scale`, what is in it.
fn describe_filling(filling: &Filling, medium: &Medium, scale: f64) -> Result<()> {
    let Filling { bounds, densities, glowing, bytes, .. } = filling;
    let voxels = |grid: &Densities| format!("{} active voxels", grid.active_voxels);
    let grids = [
        densities.as_ref().map(voxels),
        glowing.as_ref().map(|grid| format!("{} of emission", voxels(grid))),
        (*bytes > 0).then(|| volume::memory(*bytes as u64)),
    ];
    let grids = grids.into_iter().flatten().map(|text| format!(", {text}")).collect::<String>();
    say(format!("  from {} m{grids}", extent(*bounds)))?;
    let Some(densities) = densities else { return Ok(()) };
    let [densest, mean] =
        [f64::from(densities.most), densities.mean].map(|density| coefficients(medium, density * scale));
    let Some(((densest, _), (mean, _))) = densest.zip(mean) else { return Ok(()) };
    say(format!("  mean free path {densest} m where it is densest, {mean} m at the mean of its active voxels"))
}

fn describe_scene(loaded: &LoadedScene, verbose: bool) -> Result<()> {
    let LoadedScene { name, scene, frame, contents, warnings, .. } = loaded;
    let [width, height] = scene.film.size;
    let render = &scene.render;
    say(format!("{name}: {width}x{height} pixels, {} samples each, seed {}", render.samples, render.seed))?;
    describe_volumes(loaded)?;
    match &scene.medium {
        Some(medium) if coefficients(medium, 1.0).is_some() => {
            let (free_path, albedo) = coefficients(medium, 1.0).expect("there is something");
            let (phase, g) = (medium.phase.kind.name(), number(frame.medium.phase_around().mean_cosine(), 4));
            let glow = glow(medium, 1.0, None);
            say(format!("fog: mean free path {free_path} m, albedo {albedo}, {phase} of mean cosine {g}{glow}"))?;
        }
        _ if frame.varies() => {}
        _ if frame.surfaces.is_empty() => say("vacuum: only directly visible light counts")?,
        _ => say("vacuum")?,
    }
    if !frame.surfaces.is_empty() {
        let (geometry, materials) = (frame.surfaces.geometry(), frame.surfaces.materials().len());
        say(format!(
            "surfaces: {}, {}, {} KiB",
            count(geometry.len(), "triangle"),
            count(materials, "material"),
            geometry.bytes() >> 10
        ))?;
    }
    describe_contents(contents)?;
    describe_animations(contents)?;
    warnings.iter().try_for_each(|warning| say(format!("warning: {}", warning_text(warning, verbose))))?;
    describe_environment(loaded)?;
    loaded.lights.iter().take(MOST_NAMED).try_for_each(|light| describe_light(light, loaded))?;
    if let Some(more @ 1..) = loaded.lights.len().checked_sub(MOST_NAMED) {
        say(format!("and {}", count(more, "more light")))?;
    }
    if let shining @ 1.. = frame.lights.given().len() - frame.lights.bodies().len() {
        let triangles = frame.lights.first_distant() as usize - frame.lights.bodies().len();
        say(format!("emissive meshes: {shining}, with {}", count(triangles, "triangle")))?;
    }
    let names: Vec<_> = render.technique.0.iter().map(|technique| technique.name()).collect();
    say(format!(
        "technique {}, paths of {} to {} segments",
        names.join(","),
        render.min_segments,
        render.max_segments
    ))?;

    let pixels = u64::from(width) * u64::from(height);
    let (measured, walk, left_out) = measure(loaded)?;
    left_out
        .iter()
        .filter(|left_out| left_out.matters())
        .try_for_each(|left_out| say(format!("warning: {left_out}")))?;
    if frame.techniques.any() {
        say(format!(
            "vertices that connect: {}, {}",
            starts(walk.starts),
            survival_in_words(&walk.survival, frame.lengths.max)
        ))?;
    }
    let samples = pixels * u64::from(render.samples);
    say(format!(
        "cost: {samples} samples, {} at {}; film {} MiB",
        duration(samples as f64 / measured),
        rate(measured),
        (Film::bytes(&film::layers(frame), pixels) >> 20).max(1),
    ))
}

/// A number of things that are called `one` where there is one.
pub fn count(number: usize, one: &str) -> String {
    format!("{number} {one}{}", if number == 1 { "" } else { "s" })
}

/// Meshes and cameras of the scene's glTF file.
fn describe_contents(contents: &Contents) -> Result<()> {
    for (name, triangles) in contents.meshes.iter().take(MOST_NAMED) {
        say(format!("mesh {}: {}", quoted(name), count(*triangles, "triangle")))?;
    }
    if let Some(more @ 1..) = contents.meshes.len().checked_sub(MOST_NAMED) {
        say(format!("and {more} more {}", if more == 1 { "mesh" } else { "meshes" }))?;
    }
    for (index, name) in contents.cameras.iter().enumerate() {
        let renders = if contents.camera == Some(index) { ", used for the render" } else { "" };
        say(format!("camera {}{renders}", quoted(name)))?;
    }
    Ok(())
}

/// Animations of the scene's glTF file, and the frames that they have where nobody asks for other ones.
fn describe_animations(contents: &Contents) -> Result<()> {
    for Animated { name, duration, cameras, nodes } in contents.animations.iter().take(MOST_NAMED) {
        let duration = duration.map_or_else(
            || "cannot be played".into(),
            |seconds| {
                // Times are single precision: a frame that they miss by less than that is the last one.
                let last = (seconds * FRAMES_PER_SECOND - 1e-3).ceil().max(0.0);
                format!("{} s, frames 0-{last} at {FRAMES_PER_SECOND} per second", number(seconds, 4))
            },
        );
        let cameras = cameras.iter().map(|name| format!("camera {}", quoted(name)));
        let moved: Vec<_> = cameras.chain(nodes.iter().cloned()).collect();
        let more = moved.len().saturating_sub(MOST_NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let moved = moved[..moved.len().min(MOST_NAMED)].join(", ");
        let moved = if moved.is_empty() { "nothing".into() } else { moved };
        say(format!("{name}: {duration}; moves {moved}{more}"))?;
    }
    if let Some(more @ 1..) = contents.animations.len().checked_sub(MOST_NAMED) {
        say(format!("and {}", count(more, "more animation")))?;
    }
    Ok(())
}

/// The sky.
fn describe_environment(loaded: &LoadedScene) -> Result<()> {
    let Some(environment) = &loaded.scene.environment else { return Ok(()) };
    if let Some(radiance) = environment.radiance {
        return say(format!("environment: radiance {radiance} W/(m^2 sr)"));
    }
    let images = loaded.frame.lights.distant().iter().filter_map(|light| light.panorama.as_ref());
    for (image, file) in images.zip(&environment.image) {
        let ([width, height], largest) = (image.size(), number(f64::from(image.largest()), 4));
        let mean = number(image.flux() / (4.0 * core::f64::consts::PI), 4);
        let kib = image.bytes() >> 10;
        say(format!("environment: {}, {width}x{height} pixels, {kib} KiB", quoted(file)))?;
        say(format!("  radiance {mean} W/(m^2 sr) in the mean of all directions, {largest} at most"))?;
    }
    Ok(())
}

fn describe_light(light: &Light, loaded: &LoadedScene) -> Result<()> {
    let Light { name, values } = light;
    let name = name.as_ref().map_or_else(String::new, |name| format!(" {}", quoted(name)));
    let (Some(center), Some(radius)) = (values.center, values.radius) else {
        let degrees = number(values.angular_radius_deg.unwrap_or(ANGULAR_RADIUS), 4);
        let irradiance = values.irradiance.unwrap_or_default();
        return say(format!(
            "light{name}: sun of irradiance {irradiance} W/m^2 and {degrees} degrees about its centre"
        ));
    };
    let [camera, light] = [loaded.camera.position, center].map(glam::DVec3::from);
    let (distance, origin) = (camera.distance(light), glam::DVec3::from(loaded.origin));
    let depth = match depth::between(&loaded.frame.medium, camera - origin, light - origin).map(|depth| depth as f32) {
        depths if depths.iter().all(|depth| *depth <= NO_DEPTH) => "no medium in between".into(),
        depths => format!("{} mean free paths", spectrum(depths)),
    };
    let distance = number(distance, 4);
    let kind = match (values.kind, values.cone, values.exponent) {
        (LightKind::Spot, Some(cone), _) => {
            let [inner, outer] = cone.map(|angle| number(angle.to_degrees(), 4));
            format!("spot with a cone of {inner} to {outer} degrees and")
        }
        (LightKind::Spot, None, Some(exponent)) => format!("spot of exponent {} and", number(exponent, 4)),
        (kind, ..) => format!("{} of", kind.name()),
    };
    say(format!("light{name}: {kind} radius {radius:?} m at {distance} m from the camera ({depth})"))
}

/// Samples per second of this scene on this machine, from a short render, the walk that it will take, and what its
/// limit on the length of paths leaves out.
fn measure(loaded: &LoadedScene) -> Result<(f64, WalkLimits, Option<Truncation>)> {
    let renderer = Renderer::new(Workers { threads: 0, lanes: None, detailed_stats: false })
        .map_err(|error| Error::failure("fogbow", format!("threads cannot be started: {error}"), "free some memory"))?;
    let [width, height] = loaded.scene.film.size;
    // A strip through the middle is a fair sample of the image.
    let columns = width.min(PILOT_PIXELS);
    let rows = PILOT_PIXELS.div_ceil(columns).min(height);
    let (left, top) = ((width - columns) / 2, (height - rows) / 2);
    let region = Region { x0: left, y0: top, x1: left + columns, y1: top + rows };
    let monitor = Monitor::default();
    let (frame, _) = pilot::choose(&loaded.frame, loaded.scene.film.size, loaded.choices(), &renderer, &monitor);
    let film = Film::new(&frame, region, film::tile_size(region));
    let (start, mut samples, mut done) = (Instant::now(), 0, 0);
    while start.elapsed() < PILOT && done < 1 << 20 {
        let next = (2 * done).clamp(1, done + 16);
        samples += renderer.render(&frame, &WIDEST, &film, done..next, &monitor).samples;
        done = next;
    }
    let rate = samples as f64 / start.elapsed().as_secs_f64();
    Ok((rate, frame.walk, truncation::estimate(&frame, loaded.scene.film.size, &renderer, &monitor)))
}
