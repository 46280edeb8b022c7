//! Media with bounds: from shapes and files of voxels, and what is around them, to what stages read.

use std::collections::BTreeMap;
use std::sync::Arc;

use fogbow_kernels::media::closed_mesh::ClosedMesh;
use fogbow_kernels::media::field::{Field, Interpolation, MOST_VOLUMES, Shape, ToIndex, Volume as Placed, Voxels};
use fogbow_kernels::media::glow::Source;
use fogbow_kernels::media::{Glow, Medium};
use fogbow_kernels::phase::PhaseFunction;
use glam::{DAffine3, DQuat, DVec3, EulerRot};

use super::boundaries::{self, Wanted};
use super::document::Document;
use super::filling::{Densities, Filling};
use super::loading::{Loading, Look};
use super::model::Loaded;
use super::ranges::{LARGEST, LARGEST_EMISSION, Owner};
use super::schema::{self, ShapeKind};
use crate::error::Result;
use crate::figures::point;
use crate::gltf::quoted;
use crate::volume::{self, Leaf, VoxelGrid};
use crate::warning::Warning;

/// Largest factor of densities or sizes.
const LARGEST_SCALE: f64 = 1e9;
/// Most bricks of 8^3 voxels, empty ones included, between voxels that are far apart: their table takes 1.5 GiB.
const MOST_BRICKS: u64 = 1 << 27;
/// Shortest edge of a box, and smallest radius of a sphere `[m]`.
const SMALLEST_EDGE: f64 = 1e-6;
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
    /// The mesh that bounds it, if one does.
    pub boundary: Option<Arc<ClosedMesh>>,
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
    Ok(indices.into_iter().zip(meshes.into_iter().map(Arc::new)).collect())
}

/// The medium of `volumes` in what is `around` them, of positions counted from `origin`, and what each of them holds, if
/// anything.
///
/// # Errors
/// If a key is out of range or missing, a file cannot be read, or the media differ in what all have in common.
pub fn medium(
    document: &Document,
    around: Medium,
    volumes: &[Volume<'_>],
    origin: DVec3,
) -> Result<(Medium, Vec<Option<Filling>>)> {
    if volumes.len() > MOST_VOLUMES {
        let finding = format!("there are {} volumes, but a scene has {MOST_VOLUMES} at most", volumes.len());
        return Err(document.error("volume", finding, "leave some out, or join grids"));
    }
    let hues = common_hues(&around, volumes)?;
    uncoloured(document, &around, volumes, hues)?;
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
    // The highest priority first, and of equal ones the last.
    placed.sort_by_key(|(priority, index, _)| core::cmp::Reverse((*priority, *index)));
    // Vacuum has no albedo: that of others spares asking who is there.
    let albedo = |medium: &Medium| if extinction(&medium) == 0.0 { densest.albedo } else { medium.albedo };
    let media = [&around].into_iter().chain(placed.iter().map(|(_, index, _)| &volumes[*index].medium));
    let albedos: Vec<[f32; 3]> = media.clone().map(albedo).collect();
    let phases = phases(media);
    let (bounds, sources) = placed.into_iter().map(|(.., (bounds, source))| (bounds, source)).unzip();
    let field = Field::new(bounds, around.largest_extinction()).coloured(hues);
    let glow =
        glows.then(|| Glow::of_field(&field, around.glow.as_ref().map_or([0.0; 3], |glow| glow.around()), sources));
    let medium = Medium::of_field(field, densest.albedo, densest.phase).with_albedos(&albedos).with_phases(&phases);
    Ok((if let Some(glow) = glow { medium.with_glow(glow) } else { medium }, fillings))
}

/// What the densities of a grid multiply.
struct Quantity {
    /// What it is called.
    name: &'static str,
    /// Its unit, as it stands behind a number.
    unit: &'static str,
    /// That of density 1.
    factor: f64,
    /// Largest one.
    largest: f64,
}

impl Quantity {
    /// An extinction [1/m].
    fn extinction(of_one: f32) -> Self {
        Self { name: "extinction", unit: "/m", factor: f64::from(of_one), largest: LARGEST }
    }

    /// An emission per channel.
    fn emission(of_one: [f32; 3]) -> Self {
        let factor = f64::from(of_one.into_iter().fold(0.0, f32::max));
        Self { name: "emission", unit: " W/(m^3 sr)", factor, largest: LARGEST_EMISSION }
    }
}

/// Extinction per channel over that of the channel in which it is largest, which `around` and `volumes` have in common;
/// the error that they do not.
fn common_hues(around: &Medium, volumes: &[Volume<'_>]) -> Result<[f32; 3]> {
    let is_there = |medium: &&Medium| medium.largest_extinction() > 0.0;
    let all = [around].into_iter().chain(volumes.iter().map(|volume| &volume.medium));
    let common = all.into_iter().find(is_there).map_or([1.0; 3], hues);
    for volume in volumes.iter().filter(|volume| is_there(&&volume.medium)) {
        let own = hues(&volume.medium);
        let close = (0..3).all(|c| (own[c] - common[c]).abs() <= SAME_HUE);
        let finding = "an extinction (scattering + absorption) that differs between channels by other factors than that \
                       of the media before, but so far all media of a scene share them";
        let remedy = "make scattering + absorption of all media the same multiple of each other in every channel; the \
                      shares of the two may differ";
        volume.require(close, "scattering", finding, remedy)?;
    }
    Ok(common)
}

/// The phase functions of `media`. Those that never scatter have none of their own.
fn phases<'a>(media: impl Iterator<Item = &'a Medium> + Clone) -> Vec<PhaseFunction> {
    let Some(first) = media.clone().find(|medium| !medium.never_scatters()) else { return Vec::new() };
    media.map(|medium| if medium.never_scatters() { first.phase.clone() } else { medium.phase.clone() }).collect()
}

/// The error that something emits where extinction is coloured.
fn uncoloured(document: &Document, around: &Medium, volumes: &[Volume<'_>], hues: [f32; 3]) -> Result<()> {
    let own = volumes.iter().map(|volume| (&volume.medium, volume.table.as_str()));
    let mut all = [(around, "medium")].into_iter().chain(own);
    let Some((_, table)) = all.find(|(medium, _)| medium.glow.is_some()).filter(|_| hues != [1.0; 3]) else {
        return Ok(());
    };
    let path = format!("{table}.emission");
    let finding = format!("{path} is given, but emission needs extinction that is the same in all channels, so far");
    let remedy = "make scattering + absorption of all media the same in all channels; the shares of the two may differ";
    Err(document.error(&path, finding, remedy))
}

/// Extinction per channel over that of the channel in which it is largest.
fn hues(medium: &Medium) -> [f32; 3] {
    let largest = medium.largest_extinction();
    medium.extinctions().map(|extinction| extinction / largest)
}

impl Volume<'_> {
    /// Where it is, of positions counted from `origin`, what it emits there, and what it holds; none if it is nowhere.
    fn placed(&self, origin: DVec3) -> Result<Option<(Placed, Source, Filling)>> {
        let extinction = self.medium.largest_extinction();
        let mut shape = self.keys.shape.as_ref().map(|shape| self.shape(shape, origin)).transpose()?;
        let (source, glowing) = self.source(origin)?;
        let mut densities = None;
        let (unit, voxels) = match &self.keys.grid {
            Some(grid) => {
                let quantity = Quantity::extinction(extinction);
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
                let remedy = "give it a shape, or a grid, which is bounded by its own densities";
                let finding = format!("{} has neither a shape nor a grid", self.table);
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
        self.must_meet("grid", placed.voxels.as_ref().zip(densities.as_ref()), &placed, origin)?;
        self.must_meet("emission_grid", source.voxels.as_ref().zip(glowing.as_ref()), &placed, origin)?;
        let bounds = own.unwrap_or_else(|| placed.bounds()).map(|corner| (corner + origin).to_array());
        let bytes = placed.bytes() + source.voxels.as_ref().map_or(0, Voxels::bytes);
        Ok(Some((
            placed,
            source,
            Filling { bounds, mean_cosine: self.medium.phase.mean_cosine(), densities, glowing, bytes },
        )))
    }

    /// Whether the densities of the grid at `table` are where it is, `placed`. If they are not, that is an error, but for a
    /// mesh, which animations may have moved away, a warning.
    fn must_meet(
        &self,
        table: &str,
        grid: Option<(&Voxels, &Densities)>,
        placed: &Placed,
        origin: DVec3,
    ) -> Result<()> {
        let ([low, high], tell) = (placed.bounds(), |corner: DVec3| point((corner + origin).to_array()));
        // To look at all voxels takes long.
        let meets = |(voxels, densities): &(&Voxels, &Densities)| {
            let [first, last] = densities.bounds;
            (first.cmpge(low).all() && last.cmple(high).all()) || voxels.extent(low, high).most > 0.0
        };
        let Some((_, densities)) = grid.filter(|grid| !meets(grid)) else { return Ok(()) };
        let [first, last] = densities.bounds.map(tell);
        let finding = format!(
            "outside of the volume, which is from {} to {} m: densities above 0 are from {first} to {last} m",
            tell(low),
            tell(high)
        );
        let remedy = "move the grid to the volume with translate, or the volume to the grid";
        if self.keys.shape.as_ref().is_some_and(|shape| shape.kind == ShapeKind::Mesh) {
            self.warn(table, format!("{finding}; {remedy}"));
            return Ok(());
        }
        self.require(false, table, finding, remedy)
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
        let quantity = Quantity::emission(emission);
        let found = self.voxels("emission_grid", grid, &quantity, origin)?;
        let Some((voxels, densities)) = found else { return Ok((Source::NONE, None)) };
        let emission = emission.map(|channel| (f64::from(channel) * grid.scale) as f32);
        Ok((Source { emission, voxels: Some(voxels) }, Some(densities)))
    }

    /// The shape of these keys.
    fn shape(&self, shape: &schema::Shape, origin: DVec3) -> Result<Shape> {
        let schema::Shape { kind, min, max, center, radius, name } = shape;
        let given = [
            ("min", min.is_some(), kind == &ShapeKind::Box),
            ("max", max.is_some(), kind == &ShapeKind::Box),
            ("center", center.is_some(), kind == &ShapeKind::Sphere),
            ("radius", radius.is_some(), kind == &ShapeKind::Sphere),
            ("name", name.is_some(), kind == &ShapeKind::Mesh),
        ];
        for (key, given, wanted) in given {
            let (what, remedy) = if wanted { ("missing", "give it") } else { ("given", "leave it out") };
            let finding = format!("{what}: the shape is a {}", kind.name());
            self.require(given == wanted, &format!("shape.{key}"), finding, remedy)?;
        }
        let remedy = "give three finite coordinates from -1e9 to 1e9 m";
        for (key, point) in [("shape.min", min), ("shape.max", max), ("shape.center", center)] {
            let ok = point.is_none_or(|point| point.iter().all(|x| x.abs() <= LARGEST));
            self.require(ok, key, format!("{:?}", point.unwrap_or_default()), remedy)?;
        }
        match kind {
            ShapeKind::Box => self.block(min.unwrap_or_default(), max.unwrap_or_default(), origin),
            ShapeKind::Sphere => {
                let owner = Owner::Table(self.document, format!("{}.shape", self.table));
                let radius = owner.radius("radius", radius.unwrap_or_default())?;
                self.require(radius >= SMALLEST_EDGE, "shape.radius", radius, "give a radius of 1e-6 m or more")?;
                Ok(Shape::Sphere { center: DVec3::from(center.unwrap_or_default()) - origin, radius })
            }
            ShapeKind::Mesh => Ok(Shape::Mesh(self.boundary.clone().expect("its name is given"))),
        }
    }

    /// A box.
    fn block(&self, min: [f64; 3], max: [f64; 3], origin: DVec3) -> Result<Shape> {
        let ok = (0..3).all(|axis| max[axis] - min[axis] >= SMALLEST_EDGE);
        let remedy = "make each of its coordinates larger than that of min by 1e-6 m or more";
        self.require(ok, "shape.max", format!("{max:?}, where min is {min:?}"), remedy)?;
        Ok(Shape::block([min, max].map(|corner| (DVec3::from(corner) - origin).to_array())))
    }

    /// The grid of a file, at `table` of the volume, in its place; its densities multiply `quantity`. None where there are
    /// no voxels.
    fn voxels(
        &self,
        table: &str,
        grid: &schema::Grid,
        quantity: &Quantity,
        origin: DVec3,
    ) -> Result<Option<(Voxels, Densities)>> {
        let key = |name: &str| format!("{table}.{name}");
        for (name, scale) in [("scale", grid.scale), ("scale_by", grid.scale_by)] {
            let ok = scale > 0.0 && scale <= LARGEST_SCALE;
            self.require(ok, &key(name), format!("{scale:?}"), "give a number above 0, up to 1e9")?;
        }
        let ok = grid.translate.iter().all(|x| x.abs() <= LARGEST);
        let finding = format!("{:?}", grid.translate);
        self.require(ok, &key("translate"), finding, "give three finite coordinates from -1e9 to 1e9 m")?;
        let ok = grid.rotate_deg.iter().all(|x| x.abs() <= 360.0);
        let finding = format!("{:?}", grid.rotate_deg);
        self.require(ok, &key("rotate_deg"), finding, "give three angles from -360 to 360 degrees")?;
        let path = self.document.folder().join(&grid.file);
        let look = |done, total| (self.look)(Loading::of(&path, done, total));
        let voxels = volume::read(&path, grid.name.as_deref(), &look)?;
        let bricks = bricks_spanned(&voxels.leaves);
        let finding = format!("a grid whose voxels are so far apart that {bricks} bricks of 8x8x8 lie between them");
        let remedy = format!("crop or resample the grid to at most {MOST_BRICKS} bricks");
        self.require(bricks <= MOST_BRICKS, &key("file"), finding, &remedy)?;
        let interpolation = match grid.interpolation {
            schema::Interpolation::Trilinear => Interpolation::Trilinear,
            schema::Interpolation::Nearest => Interpolation::Nearest,
        };
        let to_world = to_world(grid, &voxels, origin);
        let to_index = self.to_index(table, grid, &to_world)?;
        let densities = Densities::of(&voxels, &to_world);
        if densities.most == 0.0 {
            let name = quoted(&voxels.name);
            let finding = format!("{}, whose grid {name} has no density above 0", quoted(&grid.file));
            self.warn(&key("file"), format!("{finding}, so that nothing is there: name another grid or file"));
            return Ok(None);
        }
        let [low, high] = densities.bounds.map(|corner| corner + origin);
        let is_near = low.abs().max(high.abs()).max_element() <= LARGEST;
        let [low, high] = [low, high].map(|corner| point(corner.to_array()));
        let finding =
            format!("{:?}, which puts the densities of {} at {low} to {high} m", grid.scale_by, quoted(&grid.file));
        let remedy = "give a smaller scale_by or another translate: coordinates go from -1e9 to 1e9 m";
        self.require(is_near, &key("scale_by"), finding, remedy)?;
        let Quantity { name, unit, factor, largest } = quantity;
        let most = f64::from(densities.most) * f64::from((factor * grid.scale) as f32);
        let finding = format!("{:?}, which makes an {name} of {most:e}{unit}", grid.scale);
        let remedy = format!("give a smaller number: {name} goes up to {largest:e}{unit}");
        self.require(most <= *largest, &key("scale"), finding, &remedy)?;
        Ok(Some((Voxels::new(&voxels.leaves, &to_index, interpolation), densities)))
    }

    /// To index coordinates, which lead `to_world`.
    fn to_index(&self, table: &str, grid: &schema::Grid, to_world: &DAffine3) -> Result<ToIndex> {
        let to_index = to_world.inverse();
        let finding = format!("{:?} of the file and of its transform, too much or too little for f32", grid.scale_by);
        let sound = to_index.is_finite() && to_index.matrix3.to_cols_array().iter().all(|entry| entry.abs() < 1e12);
        self.require(sound, &format!("{table}.scale_by"), finding, "enlarge it by another factor")?;
        let columns = to_index.matrix3.to_cols_array_2d();
        let moved = to_index.translation.to_array();
        Ok([0, 1, 2].map(|row| [columns[0][row], columns[1][row], columns[2][row], moved[row]]))
    }

    fn require(&self, ok: bool, key: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<()> {
        let path = format!("{}.{key}", self.table);
        if ok { Ok(()) } else { Err(self.document.error(&path, format!("{path} is {finding}"), remedy)) }
    }
}

/// From index coordinates of `voxels`, placed as `grid` says, to positions counted from `origin`.
fn to_world(grid: &schema::Grid, voxels: &VoxelGrid, origin: DVec3) -> DAffine3 {
    let [x, y, z] = grid.rotate_deg.map(f64::to_radians);
    let turned = DQuat::from_euler(EulerRot::XYZEx, x, y, z);
    let moved = DVec3::from(grid.translate) - origin;
    DAffine3::from_scale_rotation_translation(DVec3::splat(grid.scale_by), turned, moved) * voxels.index_to_world
}

/// Bricks, empty ones included, from the first leaf to the last along every axis, with one more below.
fn bricks_spanned(leaves: &[Leaf]) -> u64 {
    let along = |axis: usize| {
        let brick = |leaf: &Leaf| i64::from(leaf.origin[axis].div_euclid(8));
        let (first, last) = (leaves.iter().map(brick).min(), leaves.iter().map(brick).max());
        first.zip(last).map_or(0, |(first, last)| (last - first + 2) as u64)
    };
    (0..3).map(along).fold(1, u64::saturating_mul)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_far_apart_span_more_bricks_than_there_are() {
        let leaf = |origin: [i32; 3]| Leaf { origin, values: Box::new([1.0; 512]) };
        assert_eq!(bricks_spanned(&[leaf([0; 3])]), 8);
        assert_eq!(bricks_spanned(&[leaf([-8, 0, 0]), leaf([8, 0, 16])]), 4 * 2 * 4);
        let [least, most] = [i32::MIN, i32::MAX - 7];
        assert!(bricks_spanned(&[leaf([least; 3]), leaf([most; 3])]) > MOST_BRICKS);
    }
}
