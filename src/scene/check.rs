//! Ranges of all values, and the frame that valid values make.

use std::sync::Arc;

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::lis::{Connector, Lis};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset, Seeds};
use fogbow_kernels::media::{Glow, Medium};
use fogbow_kernels::survival::{FIRST_FADING, Survival};
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection, Source};
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{LONGEST_BRIDGED_PATH, MOST_INSERTED, PathLengths, WalkLimits};
use glam::DVec3;

use super::cameras::Chosen;
use super::document::Document;
use super::environment;
use super::filling::Filling;
use super::lights::{self, Placed, Shining};
use super::model;
use super::phase;
use super::punctual;
use super::ranges::{LARGEST, LARGEST_EMISSION, LARGEST_RADIANCE, Owner};
use super::schema::{
    self, LARGEST_FILM, LightSelection, LisConnector, NumberOrAuto, Perturbation, Scene, Spectrum, Starts, Technique,
};
use super::surfaces;
use super::volumes::{self, Sources, Volume};
use crate::error::{Error, Result};
use crate::film::aov::Aovs;
use crate::frame::Frame;
use crate::gltf::Model;

/// Share of the flights that are aimed if nothing else is asked for. Measured on the fog scenes: 0.02 to 0.1 are alike,
/// 0 has fireflies, 0.3 costs a third.
const AIMED: f64 = 0.05;
/// Largest share of aimed flights.
const LARGEST_AIMED: f64 = 0.99;
/// Most lights at which flights are aimed by default: a camera ray looks at each of them.
const MOST_AIMED_LIGHTS: usize = 16;
/// Smallest probability of going on from a vertex.
const SMALLEST_SURVIVAL: f64 = 0.01;
/// Largest exposure in stops either way: factors of 10^30.
const MOST_STOPS: f64 = 100.0;

/// A check of the values at some paths of a document.
struct Check<'a> {
    document: &'a Document,
}

/// The frame of `scene`, whose values stand in `document`, with this camera, what is `shining`, the surfaces of `model`
/// and the `sources` of volumes; and what these hold. Positions are counted from `origin`.
pub fn frame(
    scene: &Scene,
    document: &Document,
    camera: &Chosen<'_>,
    shining: &Shining<'_>,
    model: Option<Model>,
    sources: &Sources<'_>,
    origin: DVec3,
) -> Result<(Frame, Vec<Option<Filling>>)> {
    let check = Check { document };
    check.film_size(scene.film.size)?;
    check.exposure(scene.film.exposure)?;
    check.once("film.aov", "layer", &scene.film.aov.0.iter().map(|aov| aov.name()).collect::<Vec<_>>())?;
    let start = camera.start();
    let camera = camera.pinhole(&scene.film, origin)?;
    let (medium, fillings) = check.medium_of(scene, sources, origin)?;
    let (techniques, lengths) = check.render(&scene.render, &medium)?;
    let (seed, walk, roulette, aimed) = (scene.render.seed, WalkLimits::ALL, 0.0, 0.0);
    let left_out = model.as_ref().filter(|_| scene.has_endless_medium()).map_or_else(Vec::new, suns);
    let (surfaces, meshes) = model.map_or_else(|| (Surfaces::none(), Vec::new()), surfaces::from_model);
    // Where there are surfaces, they make most of the variance, and more walks to choose from cost more than they bring.
    let techniques = if surfaces.is_empty() { techniques } else { techniques.with_walks_as_drawn() };
    let surfaces = Arc::new(surfaces);
    let dark = shining.placed.is_empty() && shining.sky.is_none() && meshes.is_empty() && medium.glow.is_none();
    if dark {
        return Err(check.no_light(&left_out));
    }
    let lights = check.lights(scene, shining, meshes, origin)?;
    shining.placed.iter().try_for_each(|light| outside(light, start))?;
    let techniques = if medium.never_scatters() { techniques.without_vertices() } else { techniques };
    // With nothing to connect with, nothing connects.
    let nowhere = lights.lights().is_empty() && !lights.has_distant();
    let techniques = if nowhere { Techniques::default() } else { techniques };
    let (outlines, aovs) = (None, Aovs::of(&scene.film.aov.0));
    let frame =
        Frame { camera, medium, lights, surfaces, techniques, walk, aimed, roulette, lengths, seed, outlines, aovs };
    Ok((check.walk(&scene.render, frame)?.with_outlines(scene.film.size), fillings))
}

/// An error if `start`, where the camera's rays start, is inside a sphere: black within, it would hide all else.
fn outside(light: &Placed<'_>, start: DVec3) -> Result<()> {
    let schema::Light { kind: schema::LightKind::Sphere, center: Some(center), radius: Some(radius), .. } = light.light
    else {
        return Ok(());
    };
    let distance = start.distance(DVec3::from(center));
    let finding = format!(
        "{center:?}, which puts the camera inside: its rays start {distance:?} m from there, and the radius is \
         {radius:?} m"
    );
    let remedy = "move the light or the camera, give the light a smaller radius, or set the camera's near beyond it; a \
                  sphere is black inside";
    light.owner.require(distance >= radius, "center", finding, remedy)
}

/// Names of the lights that shine from infinity.
fn suns(model: &Model) -> Vec<String> {
    let directional = model.lights.iter().filter(|light| punctual::is_sun(light));
    directional.map(|light| light.name.clone()).collect()
}

impl Check<'_> {
    fn wrong(&self, path: &str, finding: impl core::fmt::Display, remedy: &str) -> Error {
        self.document.error(path, format!("{path} is {finding}"), remedy)
    }

    /// An error if the list at `path` has one of its `names`, those of `what`, more than once.
    fn once(&self, path: &str, what: &str, names: &[&str]) -> Result<()> {
        match names.iter().enumerate().find(|(index, name)| names[..*index].contains(name)) {
            None => Ok(()),
            Some((_, name)) => {
                let finding = format!("a list that names {name} twice");
                Err(self.wrong(path, finding, &format!("name each {what} only once")))
            }
        }
    }

    fn require(&self, ok: bool, path: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<()> {
        if ok { Ok(()) } else { Err(self.wrong(path, finding, remedy)) }
    }

    fn film_size(&self, size: [u32; 2]) -> Result<()> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let remedy = format!("give a width and a height of 1 or more, and at most {LARGEST_FILM} pixels in all");
        self.require((1..=u64::from(LARGEST_FILM)).contains(&pixels), "film.size", format!("{size:?}"), &remedy)
    }

    fn exposure(&self, exposure: NumberOrAuto) -> Result<()> {
        let ok = exposure.0.is_none_or(|stops| stops.abs() <= MOST_STOPS);
        let finding = format!("{:?}", exposure.0.unwrap_or(0.0));
        self.require(ok, "film.exposure", finding, "give a number of stops from -100 to 100, or \"auto\"")
    }

    fn coefficient(&self, path: &str, value: Spectrum) -> Result<[f64; 3]> {
        let ok = value.0.iter().all(|x| (0.0..=LARGEST).contains(x));
        self.require(ok, path, value, "give finite coefficients from 0/m to 1e9/m")?;
        Ok(value.0)
    }

    /// What fills space: the medium around everything, and volumes in it, with positions counted from `origin`; and what
    /// these hold.
    fn medium_of(&self, scene: &Scene, sources: &Sources<'_>, origin: DVec3) -> Result<(Medium, Vec<Option<Filling>>)> {
        let around = scene.medium.as_ref().map_or(Ok(Medium::vacuum()), |medium| self.medium("medium", medium))?;
        if let Some(medium) = &scene.medium {
            self.ends(medium)?;
        }
        if scene.volume.is_empty() {
            return Ok((around, Vec::new()));
        }
        let volume = |(index, keys): (usize, _)| {
            let keys: &schema::Volume = keys;
            let table = format!("volume[{index}]");
            let medium = self.medium(&table, &keys.medium())?;
            let boundary = sources.boundaries.get(&index).cloned();
            let Sources { files, look, warn, .. } = sources;
            Ok(Volume { document: self.document, table, keys, medium, boundary, files, look: *look, warn: *warn })
        };
        let volumes: Vec<Volume<'_>> = scene.volume.iter().enumerate().map(volume).collect::<Result<_>>()?;
        volumes::medium(self.document, around, &volumes, origin)
    }

    /// An error if rays through `medium`, which is around everything and has no end, meet infinite light.
    fn ends(&self, medium: &schema::Medium) -> Result<()> {
        let extinction = |c: usize| medium.scattering.0[c] + medium.absorption.0[c];
        let Some(channel) = (0..3).find(|c| medium.emission.0[*c] > 0.0 && extinction(*c) == 0.0) else {
            return Ok(());
        };
        let everywhere = (0..3).all(|c| extinction(c) == 0.0);
        let place = if everywhere { String::new() } else { format!(" in {}", ["red", "green", "blue"][channel]) };
        let finding = format!(
            "given, but the medium has no extinction{place}, so that the light along an endless ray would be infinite"
        );
        let remedy = "give scattering or absorption, or put the emission into a [[volume]], which needs none";
        Err(self.wrong("medium.emission", finding, remedy))
    }

    /// The homogeneous medium of the keys at `table`.
    fn medium(&self, table: &str, medium: &schema::Medium) -> Result<Medium> {
        let scattering = self.coefficient(&format!("{table}.scattering"), medium.scattering)?;
        let absorption = self.coefficient(&format!("{table}.absorption"), medium.absorption)?;
        let extinction: [f64; 3] = core::array::from_fn(|c| scattering[c] + absorption[c]);
        self.must_be_possible(table, medium, extinction)?;
        let grey = extinction.iter().all(|channel| (channel - extinction[0]).abs() <= 1e-6 * extinction[0]);
        let extinction = if grey { [extinction[0]; 3] } else { extinction };
        let albedo = |c: usize| if extinction[c] > 0.0 { (scattering[c] / extinction[c]) as f32 } else { 0.0 };
        let phase = phase::function(self.document, &format!("{table}.phase"), &medium.phase)?;
        let found = Medium::coloured(extinction.map(|channel| channel as f32), [0, 1, 2].map(albedo), phase);
        self.emission(table, medium.emission, found)
    }

    /// An error if `extinction`, the sum of the coefficients at `table`, is too large [1/m]. The key to blame is the one
    /// that does most about it where it is largest.
    fn must_be_possible(&self, table: &str, medium: &schema::Medium, extinction: [f64; 3]) -> Result<()> {
        let worst = (1..3).fold(0, |worst, c| if extinction[c] > extinction[worst] { c } else { worst });
        let (scattering, absorption) = (medium.scattering, medium.absorption);
        let [(key, value), (other, _)] = if scattering.0[worst] > absorption.0[worst] {
            [("scattering", scattering), ("absorption", absorption)]
        } else {
            [("absorption", absorption), ("scattering", scattering)]
        };
        let finding = format!("{value}, which makes an extinction of {:?}/m with the {other}", extinction[worst]);
        let remedy = "give smaller coefficients: scattering and absorption together go up to 1e9/m";
        self.require(extinction[worst] <= LARGEST, &format!("{table}.{key}"), finding, remedy)
    }

    /// `medium` with the emission of the keys at `table`.
    fn emission(&self, table: &str, emission: Spectrum, medium: Medium) -> Result<Medium> {
        if emission.is_black() {
            return Ok(medium);
        }
        let path = format!("{table}.emission");
        let ok = emission.0.iter().all(|x| (0.0..=LARGEST_EMISSION).contains(x));
        self.require(ok, &path, emission, "give a finite emission from 0 to 1e20 W/(m^3 sr)")?;
        Ok(medium.with_glow(Glow::everywhere(emission.0.map(|channel| channel as f32))))
    }

    /// The error that nothing shines; `suns` are names of directional lights that were left out.
    fn no_light(&self, suns: &[String]) -> Error {
        let remedy = match self.document.is_model() {
            true => {
                "add a point light, a spot light or an emissive material to the file, write a scene.toml with a \
                 [[light]] table and this file as geometry, or add a light with --set 'light=[{ type = \"sphere\", \
                 center = [0, 3, 0], radius = 0.1, radiance = 100 }]'"
            }
            false => {
                "add a [[light]] table, an [environment], geometry with a point light, a spot light or an emissive \
                 material, or the emission of a medium; without a light the image is black"
            }
        };
        let finding = match suns {
            [] => "the scene has no light".into(),
            suns => {
                let names = model::list(suns.iter().map(String::as_str));
                format!(
                    "the scene has no light: nothing arrives from directional lights (suns) through a medium without \
                     end: {names}"
                )
            }
        };
        self.document.error("light", finding, remedy)
    }

    /// All lights, with positions counted from `origin`.
    fn lights(&self, scene: &Scene, shining: &Shining<'_>, meshes: Vec<Vec<Emitter>>, origin: DVec3) -> Result<Lights> {
        let of_kind = |suns: bool| {
            let is_sun = |placed: &Placed<'_>| placed.light.kind == schema::LightKind::Sun;
            shining.placed.iter().filter(move |placed| is_sun(placed) == suns)
        };
        let body = |placed: &Placed<'_>| lights::emitter(&placed.owner, &placed.light, origin);
        let bodies = of_kind(false).map(body).collect::<Result<_>>()?;
        let suns = of_kind(true).map(|placed| self.sun(scene, placed)).collect::<Result<Vec<_>>>()?;
        let distant: Vec<Source> = shining.sky.iter().cloned().chain(suns).collect();
        let selection = match scene.render.light_selection {
            LightSelection::Uniform => Selection::Uniform,
            LightSelection::Intensity => Selection::Intensity,
            LightSelection::IntensityDistance => Selection::IntensityDistance,
        };
        Ok(Lights::with_meshes(bodies, meshes, selection).with_distant(&distant, selection))
    }

    /// A sun, where light arrives from infinity.
    fn sun(&self, scene: &Scene, placed: &Placed<'_>) -> Result<Source> {
        match &placed.owner {
            Owner::Table(_, path) if scene.has_endless_medium() => {
                Err(environment::refused(self.document, path, "a sun"))
            }
            owner => lights::sun(owner, &placed.light),
        }
    }

    fn render(&self, render: &schema::Render, medium: &Medium) -> Result<(Techniques, PathLengths)> {
        let lengths = PathLengths { min: render.min_segments, max: render.max_segments.most() };
        let remedy = "give a number of segments from 1 to max_segments";
        self.require(lengths.min <= lengths.max, "render.min_segments", lengths.min, remedy)?;
        Ok((self.techniques(render, medium)?, lengths))
    }

    fn techniques(&self, render: &schema::Render, medium: &Medium) -> Result<Techniques> {
        let mesc = self.expected_segments("render.mesc", render.mesc)?;
        let bridge_mesc = self.expected_segments("render.bridge_mesc", render.bridge_mesc)?;
        let names = &render.technique.0;
        let remedy = "name at least one technique: path, nee, mvnee, omnee, bridge, lis";
        self.require(!names.is_empty(), "render.technique", "an empty list", remedy)?;
        self.once("render.technique", "technique", &names.iter().map(|name| name.name()).collect::<Vec<_>>())?;
        let offset = match render.perturbation {
            Perturbation::Ggx => Offset::Ggx,
            Perturbation::Gaussian => Offset::Gaussian,
        };
        let seeds = match render.seeds {
            schema::Seeds::Coarse => Seeds::Coarse,
            schema::Seeds::Fast => Seeds::Fast,
        };
        let roll = match render.roll {
            schema::Roll::Aligned => Roll::Aligned,
            schema::Roll::Uniform => Roll::Uniform,
        };
        let active = |technique: Technique| names.contains(&technique);
        let wanders = render.max_segments.most() > LONGEST_BRIDGED_PATH;
        let [max_inserted, max_seeds] = match (wanders, render.bridge_vertices) {
            (false, vertices) => [vertices.unwrap_or(u32::MAX), u32::MAX],
            (true, vertices) => {
                [vertices.map_or(MOST_INSERTED, |most| most.min(LONGEST_BRIDGED_PATH - 2)), MOST_INSERTED]
            }
        };
        let bridge = (active(Technique::Bridge) || active(Technique::Lis)).then(|| {
            // No bridge is longer than from the first vertex behind the camera to the last.
            let longest =
                if wanders { u32::MAX } else { render.max_segments.most().min(max_inserted.saturating_add(2)) };
            Bridge { max_inserted, ..Bridge::new(roll, medium, longest).with_mesc(medium, bridge_mesc) }
        });
        let mvnee = Mvnee { max_inserted: max_seeds, seeds, ..Mvnee::new(medium, mesc, offset) };
        let connector = match render.lis {
            LisConnector::Bridge => bridge.clone().map(Connector::Bridge),
            LisConnector::Mvnee => Some(Connector::Mvnee(mvnee)),
        };
        Ok(Techniques {
            nee: active(Technique::Nee),
            mvnee: active(Technique::Mvnee).then_some(mvnee),
            omnee: active(Technique::Omnee),
            bridge: bridge.filter(|_| active(Technique::Bridge)),
            lis: connector.filter(|_| active(Technique::Lis)).map(|connector| Lis::new(medium, connector)),
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
                self.require((1..=LONGEST_BRIDGED_PATH).contains(&count), "render.starts", count, remedy)?;
                count
            }
            Starts::All | Starts::Auto => u32::MAX,
        };
        let survival = render.survival.0.unwrap_or(1.0);
        let ok = (SMALLEST_SURVIVAL..=1.0).contains(&survival);
        let remedy = "give a probability from 0.01 to 1, or \"auto\"";
        self.require(ok, "render.survival", format!("{survival:?}"), remedy)?;
        let few = frame.techniques.bridge.is_some() && frame.lights.given().len() <= MOST_AIMED_LIGHTS;
        let aimed = render.aimed.0.unwrap_or(if few && frame.may_aim() { AIMED } else { 0.0 });
        let ok = (0.0..=LARGEST_AIMED).contains(&aimed);
        self.require(ok, "render.aimed", format!("{aimed:?}"), "give a fraction from 0 to 0.99, or \"auto\"")?;
        let roulette = render.roulette.0.unwrap_or(0.0);
        let ok = (0.0..=LARGEST_RADIANCE).contains(&roulette);
        let remedy = "give a radiance from 0 to 1e30 W/(m^2 sr), or \"auto\"";
        self.require(ok, "render.roulette", format!("{roulette:?}"), remedy)?;
        let certain = Survival::Constant(survival as f32);
        let survival =
            if frame.wanders() && render.survival.0.is_none() { Survival::fading(FIRST_FADING) } else { certain };
        Ok(Frame { aimed: aimed as f32, roulette: roulette as f32, ..frame }.with_walk(starts, survival))
    }
}
