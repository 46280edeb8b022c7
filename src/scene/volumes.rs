//! Media with bounds: from shapes and files of voxels, and what is around them, to what stages read.

mod files;
mod grids;
mod precision;
mod shapes;

use std::collections::BTreeMap;
use std::sync::Arc;

use fogbow_kernels::media::closed_mesh::ClosedMesh;
use fogbow_kernels::media::field::{Field, MOST_VOLUMES, Shape, Volume as Placed, bounds_of, bytes_of};
use fogbow_kernels::media::glow::Source;
use fogbow_kernels::media::homogeneous::CLEAREST;
use fogbow_kernels::media::{Glow, Medium};
use fogbow_kernels::phase::PhaseFunction;
use glam::DVec3;

use super::boundaries::{self, Wanted};
use super::document::Document;
use super::filling::{Densities, Filling};
use super::loading::Look;
use super::model::Loaded;
use super::schema::{self, ShapeKind};
use crate::error::Result;
use crate::figures::number;
use crate::warning::Warning;
pub use files::{GridFiles, too_far_apart};
use grids::Quantity;

/// Optical depth from one end of a volume to the other, below which it is as good as vacuum.
const THINNEST: f64 = 1e-6;
/// Optical depth of a channel that is meant to be clear above which it is told: light loses a thousandth.
const DIMMED: f64 = 1e-3;
/// By how much quotients of extinctions between channels may differ from volume to volume, for rounding.
const SAME_HUE: f32 = 1e-5;

/// A volume of the scene file, and where errors find its keys.
pub struct Volume<'a> {
    /// The file.
    pub document: &'a Document,
    /// Where the volume stands in it.
    pub table: String,
    /// Its keys.
    pub keys: &'a schema::Volume,
    /// Its medium, for densities of 1.
    pub medium: Medium,
    /// The mesh that bounds it, if one does and is not hidden.
    pub boundary: Option<Arc<ClosedMesh>>,
    /// The grids of files.
    pub files: &'a GridFiles,
    /// Who is told how far its files have been read.
    pub look: Look<'a>,
    /// Who is told what nobody may have meant.
    pub warn: &'a dyn Fn(Warning),
}

/// The meshes that bound volumes, by the index of the volume.
pub type Boundaries = BTreeMap<usize, Arc<ClosedMesh>>;

/// What volumes are made of besides their keys.
pub struct Sources<'a> {
    /// Meshes that bound them.
    pub boundaries: Boundaries,
    /// Grids of files.
    pub files: GridFiles,
    /// Who is told how far their files have been read.
    pub look: Look<'a>,
    /// Who is told what nobody may have meant.
    pub warn: &'a dyn Fn(Warning),
}

/// The boundaries that the volumes of `scene` name, which are taken out of `loaded`.
///
/// # Errors
/// As [`boundaries::take`].
pub fn boundaries(scene: &schema::Scene, document: &Document, loaded: Option<&mut Loaded>) -> Result<Boundaries> {
    let named = scene.volume.iter().enumerate().filter_map(|(index, volume)| {
        let shape = volume.shape.as_ref().filter(|shape| shape.kind == ShapeKind::Mesh)?;
        Some((index, Wanted { path: format!("volume[{index}].shape.name"), name: shape.name.as_deref()? }))
    });
    let (indices, wanted): (Vec<usize>, Vec<Wanted<'_>>) = named.unzip();
    let meshes = boundaries::take(loaded, document, &wanted)?;
    Ok(indices.into_iter().zip(meshes).filter_map(|(index, mesh)| Some((index, Arc::new(mesh?)))).collect())
}

/// The medium of `volumes` in what is `around` them, of positions counted from `origin`, and what each of them holds, if
/// anything.
///
/// # Errors
/// If a key is out of range or missing, or a file cannot be read.
pub fn medium(
    document: &Document,
    around: Medium,
    volumes: &[Volume<'_>],
    origin: DVec3,
) -> Result<(Medium, Vec<Option<Filling>>)> {
    warn_of_idle(&around, volumes);
    if volumes.len() > MOST_VOLUMES {
        let finding = format!("there are {} volumes, but a scene has {MOST_VOLUMES} at most", volumes.len());
        return Err(document.error("volume", finding, "leave some out, or join grids"));
    }
    let (mut placed, mut fillings) = (Vec::new(), Vec::new());
    for (index, volume) in volumes.iter().enumerate() {
        let filled = volume.placed(origin)?;
        fillings.push(filled.as_ref().map(|(.., filling)| filling.clone()));
        if let Some((bounds, source, _)) = filled {
            placed.push((volume.keys.priority, index, (bounds, source)));
        }
    }
    let all = placed.iter().map(|(_, index, _)| &volumes[*index].medium).chain([&around]);
    let glows = around.glow.is_some() || placed.iter().any(|(.., (_, source))| *source != Source::NONE);
    let extinction = |medium: &&Medium| medium.largest_extinction();
    let densest = all.max_by(|a, b| extinction(a).total_cmp(&extinction(b))).unwrap_or(&around).clone();
    if extinction(&&densest) == 0.0 && !glows {
        return Ok((Medium::vacuum(), fillings));
    }
    if placed.is_empty() {
        return Ok((around, fillings));
    }
    if placed.len() > 1 {
        let all = bounds_of(placed.iter().map(|(.., (volume, _))| volume));
        let check = |index: usize, volume: &Placed| volumes[index].must_be_resolved_within(all, volume, origin);
        placed.iter().try_for_each(|(_, index, (volume, _))| check(*index, volume))?;
    }
    // The highest priority first, and of equal ones the last.
    placed.sort_by_key(|(priority, index, _)| core::cmp::Reverse((*priority, *index)));
    // Vacuum has no albedo: that of others spares asking who is there.
    let albedo = |medium: &Medium| if extinction(&medium) == 0.0 { densest.albedo } else { medium.albedo };
    let media = [&around].into_iter().chain(placed.iter().map(|(_, index, _)| &volumes[*index].medium));
    let albedos: Vec<[f32; 3]> = media.clone().map(albedo).collect();
    let phases = phases(media.clone());
    let common = common_hues(media.clone());
    let all_hues: Vec<[f32; 3]> = media.skip(1).map(hues).collect();
    let (bounds, sources) = placed.into_iter().map(|(.., (bounds, source))| (bounds, source)).unzip();
    let field = match common {
        Some(hues) => Field::new(bounds, around.largest_extinction()).coloured(hues),
        None => Field::of_colours(bounds, &all_hues, around.extinctions()),
    };
    let glow =
        glows.then(|| Glow::of_field(&field, around.glow.as_ref().map_or([0.0; 3], |glow| glow.around()), sources));
    let medium = Medium::of_field(field, densest.albedo, densest.phase).with_albedos(&albedos).with_phases(&phases);
    Ok((if let Some(glow) = glow { medium.with_glow(glow) } else { medium }, fillings))
}

/// Warns of volumes that make no difference: where all is vacuum anyway, or densities multiply nothing.
fn warn_of_idle(around: &Medium, volumes: &[Volume<'_>]) {
    let acts = |medium: &Medium| medium.largest_extinction() > 0.0 || medium.glow.is_some();
    let all_idle = !acts(around) && !volumes.iter().any(|volume| acts(&volume.medium));
    for volume in volumes {
        let Volume { document, table, keys, medium, warn, .. } = volume;
        let tell = |path: &str, finding: String| warn(Warning::new(document.place(path), finding));
        if all_idle {
            let finding = "has neither scattering nor absorption nor emission, and there is no other medium";
            tell(table, format!("{table} {finding}, so that it does nothing"));
        } else if keys.grid.is_some() && medium.largest_extinction() == 0.0 {
            let path = format!("{table}.grid");
            let finding = format!("{path} is given, but {table} has neither scattering nor absorption to multiply");
            tell(&path, finding);
        }
    }
}

/// Extinction per channel over that of the channel in which it is largest, if `media` have it in common. Vacuum goes with
/// all.
fn common_hues<'a>(media: impl Iterator<Item = &'a Medium>) -> Option<[f32; 3]> {
    let mut common = None;
    for own in media.filter(|medium| medium.largest_extinction() > 0.0).map(hues) {
        let common = *common.get_or_insert(own);
        if (0..3).any(|c| (own[c] - common[c]).abs() > SAME_HUE * common[c]) {
            return None;
        }
    }
    Some(common.unwrap_or([1.0; 3]))
}

/// The phase functions of `media`. Those that never scatter have none of their own.
fn phases<'a>(media: impl Iterator<Item = &'a Medium> + Clone) -> Vec<PhaseFunction> {
    let Some(first) = media.clone().find(|medium| !medium.never_scatters()) else { return Vec::new() };
    media.map(|medium| if medium.never_scatters() { first.phase.clone() } else { medium.phase.clone() }).collect()
}

/// Extinction per channel over that of the channel in which it is largest; 1 in vacuum.
fn hues(medium: &Medium) -> [f32; 3] {
    let largest = medium.largest_extinction();
    medium.extinctions().map(|extinction| if largest > 0.0 { extinction / largest } else { 1.0 })
}

impl Volume<'_> {
    /// Where it is, of positions counted from `origin`, what it emits there, and what it holds; none if it is nowhere.
    fn placed(&self, origin: DVec3) -> Result<Option<(Placed, Source, Filling)>> {
        let extinction = self.medium.largest_extinction();
        let mut shape = None;
        if let Some(keys) = &self.keys.shape {
            shape = self.shape(keys, origin)?;
            if shape.is_none() {
                return Ok(None);
            }
        }
        let (source, glowing) = self.source(origin)?;
        let mut densities = None;
        let (unit, voxels) = match &self.keys.grid {
            Some(grid) => {
                let quantity = Quantity::extinction(extinction, self.keys);
                let unit = (f64::from(extinction) * grid.scale) as f32;
                let found = self.voxels("grid", grid, &quantity, origin)?;
                densities = found.as_ref().map(|(_, densities)| densities.clone());
                found.map_or((0.0, None), |(voxels, _)| (unit, Some(voxels)))
            }
            None if shape.is_none() && self.keys.emission_grid.is_some() => {
                shape = source.voxels.clone().map(|voxels| Shape::Voxels(Arc::new(voxels)));
                (extinction, None)
            }
            None if shape.is_none() => {
                let remedy = "add a shape, or a grid or an emission_grid, whose densities bound it";
                let finding = format!("{} has neither a shape nor a grid nor an emission_grid", self.table);
                return Err(self.document.error(&self.table, finding, remedy));
            }
            None => (extinction, None),
        };
        if shape.is_none() && voxels.is_none() {
            return Ok(None);
        }
        let own = densities
            .as_ref()
            .or(glowing.as_ref())
            .filter(|_| self.keys.shape.is_none())
            .map(|densities| densities.bounds);
        let placed = Placed { shape, voxels, extinction: unit };
        self.must_have_an_inside(&placed, origin)?;
        self.must_meet("grid", placed.voxels.as_ref().zip(densities.as_ref()), &placed, origin)?;
        self.must_meet("emission_grid", source.voxels.as_ref().zip(glowing.as_ref()), &placed, origin)?;
        let most = f64::from(placed.extinction) * densities.as_ref().map_or(1.0, |found| f64::from(found.most));
        self.warn_if_coarse(&placed, most);
        self.warn_if_thin(&placed, &source, most);
        self.warn_if_dimmed(&placed, most);
        let bounds = own.unwrap_or_else(|| placed.bounds()).map(|corner| (corner + origin).to_array());
        let bytes = bytes_of(placed.all_voxels().chain(&source.voxels)) + placed.bytes_besides_voxels();
        Ok(Some((
            placed,
            source,
            Filling { bounds, mean_cosine: self.medium.phase.mean_cosine(), densities, glowing, bytes },
        )))
    }

    /// Warns of a volume that emits nothing and is as good as vacuum, though it has an extinction of at `most` so much.
    fn warn_if_thin(&self, placed: &Placed, source: &Source, most: f64) {
        let [low, high] = placed.bounds();
        let depth = most * low.distance(high);
        if self.medium.largest_extinction() > 0.0 && depth < THINNEST && *source == Source::NONE {
            let path = &self.table;
            let finding =
                format!("{path} has an optical depth of {depth:.1e} at most, so that it is as good as vacuum");
            (self.warn)(Warning::new(self.document.place(path), finding));
        }
    }

    /// Warns of a volume, of an extinction of at `most` so much, that dims light of a channel in which it is meant to be
    /// clear: it is given [`CLEAREST`] of the densest one.
    fn warn_if_dimmed(&self, placed: &Placed, most: f64) {
        let [low, high] = placed.bounds();
        let depth = f64::from(CLEAREST) * most * low.distance(high);
        let (given, least) = (self.medium.extinctions(), CLEAREST * self.medium.largest_extinction());
        let asked = |c: usize| self.keys.scattering.0[c] + self.keys.absorption.0[c];
        // By less than a half, nobody has meant to say that it is clear.
        let is_clearer = |c: &usize| given[*c] == least && asked(*c) < 0.5 * f64::from(least);
        let clearer: Vec<_> = (0..3).filter(is_clearer).map(|c| ["red", "green", "blue"][c]).collect();
        if depth > DIMMED && !clearer.is_empty() {
            let (path, colours, depth) = (&self.table, clearer.join(" and "), number(depth, 2));
            let finding = format!(
                "{path} is clearer in {colours} than a millionth of its densest channel, and is given a millionth: up to \
                 {depth} mean free paths across; make its densest channel less dense"
            );
            (self.warn)(Warning::new(self.document.place(path), finding));
        }
    }

    fn warn(&self, key: &str, finding: impl core::fmt::Display) {
        let path = format!("{}.{key}", self.table);
        (self.warn)(Warning::new(self.document.place(&path), format!("{path} is {finding}")));
    }

    /// What it emits, and what is in the grid of its emission.
    fn source(&self, origin: DVec3) -> Result<(Source, Option<Densities>)> {
        let emission = self.medium.glow.as_ref().map_or([0.0; 3], |glow| glow.around());
        let Some(grid) = &self.keys.emission_grid else { return Ok((Source::constant(emission), None)) };
        let finding = format!("given, but {}.emission, which it multiplies, is 0", self.table);
        let remedy = "give the emission where the density of the grid is 1, or leave the grid out";
        self.require(emission != [0.0; 3], "emission_grid", finding, remedy)?;
        let found = self.voxels("emission_grid", grid, &Quantity::emission(self.keys), origin)?;
        let Some((voxels, densities)) = found else { return Ok((Source::NONE, None)) };
        let emission = emission.map(|channel| (f64::from(channel) * grid.scale) as f32);
        Ok((Source { emission, voxels: Some(voxels) }, Some(densities)))
    }

    fn require(&self, ok: bool, key: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<()> {
        let path = format!("{}.{key}", self.table);
        if ok { Ok(()) } else { Err(self.document.error(&path, format!("{path} is {finding}"), remedy)) }
    }
}
