//! Ranges of all values, and the frame that valid values make.

use std::sync::Arc;

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset};
use fogbow_kernels::phase::HenyeyGreenstein;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_kernels::tables::media::Medium;
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{PathLengths, Walk};
use glam::DVec3;

use super::document::Document;
use super::schema::{self, LightKind, LightSelection, Perturbation, Scene, Spectrum, Starts, Technique};
use super::surfaces;
use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::gltf;

/// Largest length, coordinate and coefficient: squares of the longest flights between them, 16.6 mean free paths of the
/// thinnest medium, are still f32.
const LARGEST: f64 = 1e9;
/// Smallest radius: one over its area is still f32, and so is that times the square of the largest distance.
const SMALLEST_RADIUS: f64 = 1e-9;
/// Largest radiance: sums over paths stay far inside f32.
const LARGEST_RADIANCE: f64 = 1e30;
/// Share of the flights that are aimed if nothing else is asked for. Measured on the fog scenes: 0.02 to 0.1 are alike, 0
/// has fireflies, 0.3 costs a third.
const AIMED: f64 = 0.05;
/// Largest share of aimed flights.
const LARGEST_AIMED: f64 = 0.99;
/// Most lights at which flights are aimed by default: a camera ray looks at each of them.
const MOST_AIMED_LIGHTS: usize = 16;
/// Largest exponent of a spot: a cone of one degree.
const LARGEST_EXPONENT: f64 = 10_000.0;
/// Smallest probability of going on from a vertex.
const SMALLEST_SURVIVAL: f64 = 0.01;
/// Pixels of the largest film: it takes 12 GiB.
const LARGEST_FILM: u64 = 1 << 27;
/// Longest path: the random dimensions have room for as many inserted vertices.
const LONGEST_PATH: u32 = 1024;

/// A check of the values at some paths of a document.
struct Check<'a> {
    document: &'a Document,
}

/// The frame of `scene`, whose values stand in `document`, and what of its geometry is not rendered.
pub fn frame(scene: &Scene, document: &Document) -> Result<(Frame, Vec<String>)> {
    let check = Check { document };
    let camera = check.camera(scene)?;
    let medium = check.medium(scene)?;
    let (techniques, lengths) = check.render(&scene.render, &medium)?;
    let (seed, walk, roulette, aimed) = (scene.render.seed, Walk::ALL, 0.0, 0.0);
    let (surfaces, meshes, warnings) = check.surfaces(scene)?;
    let surfaces = Arc::new(surfaces);
    let lights = check.lights(scene, meshes)?;
    let techniques = if medium.never_scatters() { techniques.without_vertices() } else { techniques };
    let frame = Frame { camera, medium, lights, surfaces, techniques, walk, aimed, roulette, lengths, seed };
    Ok((check.walk(&scene.render, frame)?, warnings))
}

impl Check<'_> {
    fn wrong(&self, path: &str, finding: impl core::fmt::Display, remedy: &str) -> Error {
        self.document.error(path, format!("{path} is {finding}"), remedy)
    }

    fn require(&self, ok: bool, path: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<()> {
        if ok { Ok(()) } else { Err(self.wrong(path, finding, remedy)) }
    }

    fn position(&self, path: &str, value: [f64; 3]) -> Result<DVec3> {
        let ok = value.iter().all(|x| x.abs() <= LARGEST);
        self.require(ok, path, format!("{value:?}"), "give three finite coordinates of at most 1e9 m")?;
        Ok(DVec3::from(value))
    }

    fn direction(&self, path: &str, value: [f64; 3]) -> Result<DVec3> {
        let direction = self.position(path, value)?;
        let remedy = "give a direction, a vector that is not zero";
        self.require(direction.length() > 1e-30, path, format!("{value:?}"), remedy)?;
        Ok(direction)
    }

    fn camera(&self, scene: &Scene) -> Result<Camera> {
        let schema::Camera { position, look_at, up, vertical_fov_deg, near } = scene.camera;
        let [position, look_at] =
            [self.position("camera.position", position)?, self.position("camera.look_at", look_at)?];
        let forward = (look_at - position).try_normalize();
        let remedy = "give a point other than the camera's position";
        let forward =
            forward.ok_or_else(|| self.wrong("camera.look_at", format!("{:?}", look_at.to_array()), remedy))?;
        let upward = self.direction("camera.up", up)?.normalize();
        let remedy = "give a direction that is not parallel to the viewing axis";
        self.require(forward.cross(upward).length() > 1e-6, "camera.up", format!("{up:?}"), remedy)?;
        let ok = vertical_fov_deg > 0.0 && vertical_fov_deg < 180.0;
        let finding = format!("{vertical_fov_deg:?}");
        self.require(ok, "camera.vertical_fov_deg", finding, "give an angle between 0 and 180 degrees")?;
        let ok = (0.0..=LARGEST).contains(&near);
        self.require(ok, "camera.near", format!("{near:?}"), "give a distance from 0 m to 1e9 m")?;
        let size = self.film_size(scene.film.size)?;
        Ok(Camera::new(position, forward, upward, vertical_fov_deg.to_radians(), near, size))
    }

    fn film_size(&self, size: [u32; 2]) -> Result<[u32; 2]> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let remedy = format!("give a width and a height of 1 or more with at most {LARGEST_FILM} pixels");
        self.require((1..=LARGEST_FILM).contains(&pixels), "film.size", format!("{size:?}"), &remedy)?;
        Ok(size)
    }

    fn coefficient(&self, path: &str, value: Spectrum) -> Result<[f64; 3]> {
        let ok = value.0.iter().all(|x| (0.0..=LARGEST).contains(x));
        self.require(ok, path, value, "give finite coefficients of 0/m or more, at most 1e9/m")?;
        Ok(value.0)
    }

    fn medium(&self, scene: &Scene) -> Result<Medium> {
        let Some(medium) = &scene.medium else {
            return Ok(Medium { extinction: 0.0, albedo: [0.0; 3], phase: HenyeyGreenstein { g: 0.0 } });
        };
        let scattering = self.coefficient("medium.scattering", medium.scattering)?;
        let absorption = self.coefficient("medium.absorption", medium.absorption)?;
        let extinction: [f64; 3] = core::array::from_fn(|c| scattering[c] + absorption[c]);
        let grey = extinction.iter().all(|channel| (channel - extinction[0]).abs() <= 1e-6 * extinction[0]);
        if !grey {
            let coloured = if scattering == [scattering[0]; 3] { "medium.absorption" } else { "medium.scattering" };
            return Err(self.document.error(
                coloured,
                format!("extinction (scattering + absorption) is {extinction:?}, different between channels"),
                "make it the same in all channels: only grey extinction can be rendered so far",
            ));
        }
        let g = medium.phase.g;
        let remedy = "give a mean cosine above -1 and below 1, at most 0.9999999 in size";
        self.require((g as f32).abs() < 1.0, "medium.phase.g", format!("{g:?}"), remedy)?;
        let albedo = scattering.map(|s| if extinction[0] > 0.0 { (s / extinction[0]) as f32 } else { 0.0 });
        let phase = HenyeyGreenstein { g: g as f32 };
        Ok(Medium { extinction: extinction[0] as f32, albedo, phase })
    }

    fn lights(&self, scene: &Scene, meshes: Vec<Vec<Emitter>>) -> Result<Lights> {
        if scene.light.is_empty() && meshes.is_empty() {
            let remedy = "add a [[light]] table, or geometry that shines; without any the image is black";
            return Err(self.document.error("light", "the scene has no light", remedy));
        }
        let disk = |(index, light): (usize, &schema::Light)| self.light(&format!("light[{index}]"), light);
        let disks = scene.light.iter().enumerate().map(disk).collect::<Result<_>>()?;
        let selection = match scene.render.light_selection {
            LightSelection::Uniform => Selection::Uniform,
            LightSelection::Intensity => Selection::Intensity,
            LightSelection::IntensityDistance => Selection::IntensityDistance,
        };
        Ok(Lights::with_meshes(disks, meshes, selection))
    }

    /// The surfaces of the scene's geometry, those that shine, and what else is in its file.
    fn surfaces(&self, scene: &Scene) -> Result<(Surfaces, Vec<Vec<Emitter>>, Vec<String>)> {
        let Some(geometry) = &scene.geometry else {
            return Ok((Surfaces::none(), Vec::new(), Vec::new()));
        };
        let path = self.document.folder().join(geometry);
        if !path.is_file() {
            let remedy = "name a .gltf or .glb file, relative to the folder of the scene";
            return Err(self.wrong("geometry", format!("{geometry:?}: there is no file {}", path.display()), remedy));
        }
        let model = gltf::load(&path)?;
        let far = model.positions.iter().flatten().map(|x| f64::from(x.abs())).fold(0.0, f64::max);
        let remedy = "scale the model: coordinates may be 1e9 m at most";
        self.require(far <= LARGEST, "geometry", format!("{geometry:?}, with a vertex at {far:e} m"), remedy)?;
        let warnings = surfaces::not_rendered(&model).into_iter().chain(model.warnings.iter().cloned());
        let warnings = warnings.map(|warning| format!("{}: {warning}", path.display())).collect();
        let (surfaces, meshes) = surfaces::from_model(model);
        Ok((surfaces, meshes, warnings))
    }

    /// The exponent of a spot; none of a disk.
    fn exponent(&self, path: &str, light: &schema::Light) -> Result<Option<f64>> {
        let path = format!("{path}.exponent");
        match (light.kind, light.exponent) {
            (LightKind::Disk, None) => Ok(None),
            (LightKind::Disk, Some(exponent)) => {
                let remedy = "write type = \"spot\", or leave the exponent out: a disk shines alike in all directions";
                Err(self.wrong(&path, format!("{exponent:?}, of a disk"), remedy))
            }
            (LightKind::Spot, None) => Err(self.wrong(&path, "missing, of a spot", "give an exponent from 0 to 10000")),
            (LightKind::Spot, Some(exponent)) => {
                let ok = (0.0..=LARGEST_EXPONENT).contains(&exponent);
                self.require(ok, &path, format!("{exponent:?}"), "give an exponent from 0 to 10000")?;
                Ok(Some(exponent))
            }
        }
    }

    fn light(&self, path: &str, light: &schema::Light) -> Result<Emitter> {
        let center = self.position(&format!("{path}.center"), light.center)?;
        let normal = self.direction(&format!("{path}.normal"), light.normal)?;
        let ok = (SMALLEST_RADIUS..=LARGEST).contains(&light.radius);
        let remedy = "give a radius above 0 m, from 1e-9 to 1e9 m";
        self.require(ok, &format!("{path}.radius"), format!("{:?}", light.radius), remedy)?;
        let Spectrum(radiance) = light.radiance;
        let ok = radiance.iter().all(|x| (0.0..=LARGEST_RADIANCE).contains(x));
        let remedy = "give a finite radiance of 0 or more, at most 1e30 W/(m^2 sr)";
        self.require(ok, &format!("{path}.radiance"), light.radiance, remedy)?;
        let disk = Emitter::disk(center, normal, light.radius, radiance);
        Ok(self.exponent(path, light)?.map_or(disk, |exponent| disk.focused(exponent)))
    }

    fn render(&self, render: &schema::Render, medium: &Medium) -> Result<(Techniques, PathLengths)> {
        let lengths = PathLengths { min: render.min_segments, max: render.max_segments };
        let ok = (1..=LONGEST_PATH).contains(&lengths.max);
        self.require(ok, "render.max_segments", lengths.max, "give a number of segments from 1 to 1024")?;
        let remedy = "give a number of segments from 1 to max_segments";
        self.require((1..=lengths.max).contains(&lengths.min), "render.min_segments", lengths.min, remedy)?;
        let ok = (1..=1 << 31).contains(&render.samples);
        self.require(ok, "render.samples", render.samples, "give a number of samples from 1 to 2^31")?;
        Ok((self.techniques(render, medium)?, lengths))
    }

    fn techniques(&self, render: &schema::Render, medium: &Medium) -> Result<Techniques> {
        let mesc = self.expected_segments("render.mesc", render.mesc)?;
        let bridge_mesc = self.expected_segments("render.bridge_mesc", render.bridge_mesc)?;
        let names = &render.technique.0;
        let remedy = "name a technique: path, nee, mvnee, omnee, bridge";
        self.require(!names.is_empty(), "render.technique", "an empty list", remedy)?;
        let offset = match render.perturbation {
            Perturbation::Ggx => Offset::Ggx,
            Perturbation::Gaussian => Offset::Gaussian,
        };
        let roll = match render.roll {
            schema::Roll::Aligned => Roll::Aligned,
            schema::Roll::Uniform => Roll::Uniform,
        };
        let max_inserted = render.bridge_vertices.unwrap_or(u32::MAX);
        let bridge = Bridge { max_inserted, ..Bridge::new(roll).with_mesc(medium, bridge_mesc) };
        Ok(Techniques {
            nee: names.contains(&Technique::Nee),
            mvnee: names.contains(&Technique::Mvnee).then(|| Mvnee::new(medium, mesc, offset)),
            omnee: names.contains(&Technique::Omnee),
            bridge: names.contains(&Technique::Bridge).then_some(bridge),
        })
    }

    /// A limit on mu_t times distance; infinite if there is none.
    fn expected_segments(&self, path: &str, limit: Option<f64>) -> Result<f64> {
        let ok = limit.is_none_or(|limit| limit > 0.0 && limit.is_finite());
        let limit = limit.unwrap_or(f64::INFINITY);
        let remedy = "give a number of segments above 0, or leave it out for no limit";
        self.require(ok, path, format!("{limit:?}"), remedy)?;
        Ok(limit)
    }

    /// The frame with the walk of the scene; what is left to the pilot stays at its default.
    fn walk(&self, render: &schema::Render, frame: Frame) -> Result<Frame> {
        let starts = match render.starts {
            Starts::First(count) => {
                let remedy = "give a number from 1 to 1024, \"all\" or \"auto\"";
                self.require((1..=LONGEST_PATH).contains(&count), "render.starts", count, remedy)?;
                count
            }
            Starts::All | Starts::Auto => u32::MAX,
        };
        let survival = render.survival.0.unwrap_or(1.0);
        let ok = (SMALLEST_SURVIVAL..=1.0).contains(&survival);
        let remedy = "give a probability from 0.01 to 1, or \"auto\"";
        self.require(ok, "render.survival", format!("{survival:?}"), remedy)?;
        let small = frame.techniques.bridge.is_some() && frame.lights.lights().len() <= MOST_AIMED_LIGHTS;
        let aimed = render.aimed.0.unwrap_or(if small { AIMED } else { 0.0 });
        let ok = (0.0..=LARGEST_AIMED).contains(&aimed);
        self.require(ok, "render.aimed", format!("{aimed:?}"), "give a share from 0 to 0.99, or \"auto\"")?;
        let roulette = render.roulette;
        let ok = (0.0..=LARGEST_RADIANCE).contains(&roulette);
        let remedy = "give a radiance of 0 or more, at most 1e30 W/(m^2 sr)";
        self.require(ok, "render.roulette", format!("{roulette:?}"), remedy)?;
        Ok(Frame { aimed: aimed as f32, roulette: roulette as f32, ..frame }.with_walk(starts, survival as f32))
    }
}
