//! Grids of volumes: what a file of voxels is in its place.

use fogbow_kernels::media::field::{Interpolation, ToIndex, Volume as Placed, Voxels};
use glam::{DAffine3, DQuat, DVec3, EulerRot};

use super::Volume;
use super::files::{GridOfFile, MOST_BRICKS, far_apart};
use crate::error::Result;
use crate::figures::extent;
use crate::gltf::quoted;
use crate::scene::filling::Densities;
use crate::scene::loading::Loading;
use crate::scene::ranges::{LARGEST, LARGEST_EMISSION};
use crate::scene::schema::{self, ShapeKind, Spectrum};
use crate::volume;

/// Largest factor of densities or sizes.
const LARGEST_SCALE: f64 = 1e9;
/// Most mean free paths from a voxel to the next: more make a wall of it, and rays beside it take as many steps.
const MOST_PER_VOXEL: f64 = 1e4;
/// As many of which nothing is said: with more, next to no light gets beyond the outermost voxels.
const MANY_PER_VOXEL: f64 = 30.0;

/// What the densities of a grid multiply.
pub(super) struct Quantity {
    /// What it is called.
    name: &'static str,
    /// The key of the volume that gives most of it, and what that key is.
    given: (&'static str, Spectrum),
    /// Its unit, as it stands behind a number.
    unit: &'static str,
    /// That of density 1.
    factor: f64,
    /// Largest one.
    largest: f64,
    /// Largest product with the length of a voxel's edge; and that beyond which there is a warning.
    most_per_voxel: f64,
    many_per_voxel: f64,
}

impl Quantity {
    /// The extinction of a volume with these `keys` [1/m].
    pub fn extinction(of_one: f32, keys: &schema::Volume) -> Self {
        let given = [("scattering", keys.scattering), ("absorption", keys.absorption)];
        Self {
            name: "extinction",
            given: given
                .into_iter()
                .max_by(|a, b| largest_channel(a.1).total_cmp(&largest_channel(b.1)))
                .expect("two coefficients"),
            unit: "/m",
            factor: f64::from(of_one),
            largest: LARGEST,
            most_per_voxel: MOST_PER_VOXEL,
            many_per_voxel: MANY_PER_VOXEL,
        }
    }

    /// The emission of a volume with these `keys`.
    pub fn emission(keys: &schema::Volume) -> Self {
        Self {
            name: "emission",
            given: ("emission", keys.emission),
            unit: " W/(m^3 sr)",
            factor: largest_channel(keys.emission),
            largest: LARGEST_EMISSION,
            most_per_voxel: f64::INFINITY,
            many_per_voxel: f64::INFINITY,
        }
    }
}

/// The largest of its channels.
fn largest_channel(spectrum: Spectrum) -> f64 {
    spectrum.0.into_iter().fold(0.0, f64::max)
}

/// One of the numbers that a product is made of.
struct Factor {
    /// The key of the volume that says it.
    key: String,
    /// What that key is.
    is: String,
    value: f64,
    /// What makes it smaller.
    remedy: &'static str,
}

impl Volume<'_> {
    /// The grid of a file, at `table` of the volume, in its place; its densities multiply `quantity`. None where there are
    /// no voxels.
    pub(super) fn voxels(
        &self,
        table: &str,
        grid: &schema::Grid,
        quantity: &Quantity,
        origin: DVec3,
    ) -> Result<Option<(Voxels, Densities)>> {
        self.check_keys(table, grid)?;
        let key = |name: &str| format!("{table}.{name}");
        let path = self.document.folder().join(&grid.file);
        let remedy = "give the path of an OpenVDB file, relative to the folder of the scene";
        self.require(!grid.file.is_empty(), &key("file"), "empty", remedy)?;
        let finding = format!("{}, but there is no file {}", quoted(&grid.file), path.display());
        self.require(path.exists(), &key("file"), finding, remedy)?;
        let look = |done, total| (self.look)(Loading::of(&path, done, total));
        let file = self.files.read(&path, grid.name.as_deref(), &look).map_err(|error| {
            let is_misnamed = grid.name.as_ref().is_some_and(|name| volume::lacks(&path, name));
            let key = key(if is_misnamed { "name" } else { "file" });
            self.document.error_of_file(&format!("{}.{key}", self.table), error)
        })?;
        let spanned = file.bricks_spanned;
        let finding = format!("{}, a grid whose {}", quoted(&grid.file), far_apart(spanned));
        let remedy = format!("crop or resample the grid to at most {MOST_BRICKS} bricks");
        self.require(spanned <= MOST_BRICKS, &key("file"), finding, &remedy)?;
        let interpolation = match grid.interpolation {
            schema::Interpolation::Trilinear => Interpolation::Trilinear,
            schema::Interpolation::Nearest => Interpolation::Nearest,
        };
        let to_world = to_world(grid, &file, origin);
        let to_index = self.to_index(table, grid, &to_world)?;
        let densities = file.densities.placed(&to_world);
        if let Some(nothing) = densities.nothing() {
            let finding = format!("{}, whose grid {} {nothing}", quoted(&grid.file), quoted(&densities.grid));
            self.warn(&key("file"), format!("{finding}, so that nothing is there: name another grid or file"));
            return Ok(None);
        }
        let bricks = file.bricks.clone().expect("bricks where densities count and are not too far apart");
        self.check_densities(table, grid, &densities, quantity, (&file, origin))?;
        self.warn_if_blurred(table, grid, densities.bounds, shortest_edge(&to_world));
        Ok(Some((Voxels::of(bricks, &to_index, interpolation), densities)))
    }

    /// The keys at `table` by which a grid is placed and scaled, on their own.
    fn check_keys(&self, table: &str, grid: &schema::Grid) -> Result<()> {
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
        Ok(())
    }

    /// Whether `densities` are in reach in their place, and how dense they are there times `quantity`. If they are too
    /// far away or too dense, the key to blame is the one that does most about it.
    fn check_densities(
        &self,
        table: &str,
        grid: &schema::Grid,
        densities: &Densities,
        quantity: &Quantity,
        (file, origin): (&GridOfFile, DVec3),
    ) -> Result<()> {
        self.must_be_near(table, grid, densities.bounds.map(|corner| corner + origin))?;
        let key = |name: &str| format!("{table}.{name}");
        let of_key = |key: String, value: f64, is: String| Factor { key, is, value, remedy: "give a smaller number" };
        let of_file = |value: f64, is: String, remedy| Factor {
            key: key("file"),
            is: format!("{}, {is}", quoted(&grid.file)),
            value,
            remedy,
        };
        let Quantity { name, given: (given, coefficient), unit, factor, largest, most_per_voxel, many_per_voxel } =
            quantity;
        let most = f64::from(densities.most) * f64::from((factor * grid.scale) as f32);
        let mut factors = vec![
            of_key((*given).into(), *factor, coefficient.to_string()),
            of_key(key("scale"), grid.scale, format!("{:?}", grid.scale)),
            of_file(
                f64::from(densities.most),
                format!("whose largest density is {:.3e}", densities.most),
                "give a smaller scale",
            ),
        ];
        let limit = format!("{name} goes up to {largest:e}{unit}");
        self.must_be_at_most(*largest, most, &format!("an {name} of {most:.3e}{unit}"), &factors, &limit)?;
        let edge = longest_edge(&file.index_to_world);
        factors.push(of_key(key("scale_by"), grid.scale_by, format!("{:?}", grid.scale_by)));
        factors.push(of_file(edge, format!("whose voxels are {edge:.3e} m apart"), "resample the grid"));
        let per_voxel = most * edge * grid.scale_by;
        let made = format!("{per_voxel:.3e} mean free paths from a voxel to the next");
        let limit = format!("{most_per_voxel} is the most");
        self.must_be_at_most(*most_per_voxel, per_voxel, &made, &factors, &limit)?;
        if per_voxel > *many_per_voxel {
            let finding = format!("so dense that there are {per_voxel:.0} mean free paths from a voxel to the next");
            self.warn(table, format!("{finding}: flights take long in it; a smaller scale may look the same"));
        }
        Ok(())
    }

    /// An error about the largest of `factors`, of which `product` is made, if that is more than `most`; `made` says how
    /// much.
    fn must_be_at_most(&self, most: f64, product: f64, made: &str, factors: &[Factor], limit: &str) -> Result<()> {
        let Some(Factor { key, is, remedy, .. }) = factors.iter().max_by(|a, b| a.value.total_cmp(&b.value)) else {
            return Ok(());
        };
        self.require(product <= most, key, format!("{is}, which makes {made}"), &format!("{remedy}: {limit}"))
    }

    /// An error if a grid that reaches from `low` to `high` reaches too far.
    fn must_be_near(&self, table: &str, grid: &schema::Grid, [low, high]: [DVec3; 2]) -> Result<()> {
        let reach = |moved: DVec3| (low - moved).abs().max((high - moved).abs()).max_element();
        let (key, is, remedy) = if reach(DVec3::from(grid.translate)) <= LARGEST {
            ("translate", format!("{:?}", grid.translate), "move it less")
        } else if grid.scale_by > 1.0 {
            ("scale_by", format!("{:?}", grid.scale_by), "give a smaller number")
        } else {
            ("file", quoted(&grid.file), "give a smaller scale_by")
        };
        let file =
            if key == "file" { "its densities".into() } else { format!("the densities of {}", quoted(&grid.file)) };
        let finding = format!("{is}, which puts {file} at {} m", extent([low, high].map(|corner| corner.to_array())));
        let remedy = format!("{remedy}: coordinates go from -1e9 to 1e9 m");
        self.require(reach(DVec3::ZERO) <= LARGEST, &format!("{table}.{key}"), finding, &remedy)
    }

    /// To index coordinates, which lead `to_world`.
    fn to_index(&self, table: &str, grid: &schema::Grid, to_world: &DAffine3) -> Result<ToIndex> {
        let to_index = to_world.inverse();
        let finding = format!(
            "{:?}, which makes voxels of {:.3e} m, too small for single precision",
            grid.scale_by,
            longest_edge(to_world)
        );
        let sound = to_index.is_finite() && to_index.matrix3.to_cols_array().iter().all(|entry| entry.abs() < 1e12);
        self.require(sound, &format!("{table}.scale_by"), finding, "give a larger number")?;
        let columns = to_index.matrix3.to_cols_array_2d();
        let moved = to_index.translation.to_array();
        Ok([0, 1, 2].map(|row| [columns[0][row], columns[1][row], columns[2][row], moved[row]]))
    }

    /// Whether the densities of the grid at `table` are where it is, `placed`. If they are not, that is an error, but for a
    /// mesh, which animations may have moved away, a warning.
    pub(super) fn must_meet(
        &self,
        table: &str,
        grid: Option<(&Voxels, &Densities)>,
        placed: &Placed,
        origin: DVec3,
    ) -> Result<()> {
        let [low, high] = placed.bounds();
        let tell = |bounds: [DVec3; 2]| extent(bounds.map(|corner| (corner + origin).to_array()));
        // To look at all voxels takes long.
        let meets = |(voxels, densities): &(&Voxels, &Densities)| {
            let [first, last] = densities.bounds;
            (first.cmpge(low).all() && last.cmple(high).all()) || voxels.extent(low, high).most > 0.0
        };
        let Some((_, densities)) = grid.filter(|grid| !meets(grid)) else { return Ok(()) };
        let finding = format!(
            "outside of the volume, which is from {} m: densities above 0 are from {} m",
            tell([low, high]),
            tell(densities.bounds)
        );
        let remedy = "move the grid to the volume with translate, or the volume to the grid";
        if self.keys.shape.as_ref().is_some_and(|shape| shape.kind == ShapeKind::Mesh) {
            self.warn(table, format!("{finding}; {remedy}"));
            return Ok(());
        }
        self.require(false, table, finding, remedy)
    }
}

/// Distance from a voxel to the next along the axis where it is longest `[m]`.
fn longest_edge(to_world: &DAffine3) -> f64 {
    edges(to_world).into_iter().fold(0.0, f64::max)
}

/// The same where it is shortest.
fn shortest_edge(to_world: &DAffine3) -> f64 {
    edges(to_world).into_iter().fold(f64::INFINITY, f64::min)
}

/// The same along every axis.
fn edges(to_world: &DAffine3) -> [f64; 3] {
    let axes = to_world.matrix3;
    [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length)
}

/// From index coordinates of a grid of a file, placed as `grid` says, to positions counted from `origin`.
fn to_world(grid: &schema::Grid, file: &GridOfFile, origin: DVec3) -> DAffine3 {
    let [x, y, z] = grid.rotate_deg.map(f64::to_radians);
    let turned = DQuat::from_euler(EulerRot::XYZEx, x, y, z);
    let moved = DVec3::from(grid.translate) - origin;
    DAffine3::from_scale_rotation_translation(DVec3::splat(grid.scale_by), turned, moved) * file.index_to_world
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a position of the file is, counted from (10, 20, 30), if its grid has these keys.
    fn placed(at: [f64; 3], scale_by: f64, rotate_deg: [f64; 3], translate: [f64; 3]) -> DVec3 {
        let densities =
            Densities { grid: String::new(), active_voxels: 0, mean: 0.0, most: 0.0, bounds: [DVec3::ZERO; 2] };
        let index_to_world =
            DAffine3::from_scale_rotation_translation(DVec3::splat(0.25), DQuat::IDENTITY, DVec3::new(0.5, 1.0, 1.5));
        let file = GridOfFile { index_to_world, densities, bricks_spanned: 0, bricks: None };
        let grid = schema::Grid {
            file: "a.vdb".into(),
            name: None,
            scale: 7.0,
            interpolation: schema::Interpolation::Nearest,
            scale_by,
            rotate_deg,
            translate,
        };
        let index = index_to_world.inverse().transform_point3(DVec3::from(at));
        to_world(&grid, &file, DVec3::new(10.0, 20.0, 30.0)).transform_point3(index)
    }

    #[track_caller]
    fn assert_near(found: DVec3, expected: [f64; 3]) {
        assert!(found.abs_diff_eq(DVec3::from(expected), 1e-12), "{found} instead of {expected:?}");
    }

    #[test]
    fn a_quarter_turn_leads_each_axis_to_the_next() {
        let origin = [10.0, 20.0, 30.0];
        for (axis, turned) in [[1.0, -3.0, 2.0], [3.0, 2.0, -1.0], [-2.0, 1.0, 3.0]].into_iter().enumerate() {
            let mut angles = [0.0; 3];
            angles[axis] = 90.0;
            assert_near(placed([1.0, 2.0, 3.0], 1.0, angles, origin), turned);
        }
    }

    #[test]
    fn grids_are_enlarged_then_turned_about_x_y_and_z_then_moved() {
        let angles = [3.0 / 5.0, 4.0 / 5.0, 5.0 / 13.0].map(|sine: f64| sine.asin().to_degrees());
        // Enlarged: (5, 10, 15). Turned about x: (5, 8 - 9, 6 + 12). About y: (3 + 14.4, -1, -4 + 10.8). About z:
        // (17.4 * 12 + 5, 17.4 * 5 - 12) / 13. Moved by (100, 200, 300), and counted from (10, 20, 30).
        let expected = [213.8 / 13.0 + 90.0, 75.0 / 13.0 + 180.0, 6.8 + 270.0];
        assert_near(placed([1.0, 2.0, 3.0], 5.0, angles, [100.0, 200.0, 300.0]), expected);
    }
}
