//! `fogbow info` of an OpenVDB file.

use std::cell::RefCell;
use std::path::Path;
use std::time::Instant;

use super::info::{MOST_NAMED, count};
use super::loading::NOTICEABLE;
use super::progress::Reporter;
use super::say;
use crate::error::Result;
use crate::figures::{extent, length, number};
use crate::gltf::quoted;
use crate::scene::{Densities, Loading, too_far_apart};
use crate::volume::{self, GridSummary, VoxelGrid};

/// Lists the grids in the file at `path`.
///
/// # Errors
/// If the file cannot be read, or one of its grids, which is of a kind that can be: that after all have been listed.
pub fn describe(path: &Path) -> Result<()> {
    let grids = volume::list(path)?;
    let count_of_all = grids.len();
    say(format!("{}: {}", path.display(), count(count_of_all, "grid")))?;
    let mut fault = Ok(());
    for (number, grid) in grids.into_iter().take(MOST_NAMED).enumerate() {
        fault = fault.and(describe_grid(path, number, grid)?);
    }
    if let Some(more @ 1..) = count_of_all.checked_sub(MOST_NAMED) {
        say(format!("and {}", count(more, "more grid")))?;
    }
    fault
}

/// Says what is in a grid; inside, why it cannot be read.
fn describe_grid(path: &Path, index: usize, grid: GridSummary) -> Result<Result<()>> {
    let half = if grid.is_half { " saved as half floats" } else { "" };
    let class = if grid.class == "unknown" { "unknown class" } else { &grid.class };
    let compression = if grid.compression == "none" { "not compressed" } else { &grid.compression };
    say(format!("grid {}: {}{half}, {class}, {compression}", quoted(&grid.name), grid.value_type))?;
    let (grid, densities, fault) = completed(path, index, grid);
    match grid.active_voxels {
        Some(voxels) => say(format!("  active voxels: {voxels}{}", taken(voxels, grid.bits_per_voxel())))?,
        None => say("  active voxels: the file does not say how many")?,
    }
    match grid.voxel_size() {
        Some(edges) => {
            let slant = grid.slant().map_or_else(String::new, |slant| format!(", {slant}"));
            say(format!("  voxel size: {} m{slant}", size(edges)))?;
        }
        None => say(format!("  transform: {}", quoted(&grid.transform)))?,
    }
    if let Some([first, last]) = grid.index_bounds {
        say(format!("  index bounds: {first:?} to {last:?}"))?;
    }
    if let Some(bounds) = grid.world_bounds() {
        say(format!("  world bounds: {} m", extent(bounds)))?;
    }
    if let Some(densities) = densities {
        say(match densities.nothing() {
            Some(nothing) => format!("  renders as nothing: it {nothing}"),
            None => of_densities(&densities),
        })?;
    }
    if let Some(obstacle) = grid.obstacle {
        say(format!("  cannot be rendered: {obstacle}"))?;
    }
    Ok(fault)
}

/// Two lines about densities that count.
fn of_densities(Densities { mean, most, .. }: &Densities) -> String {
    let most = f64::from(*most);
    let [densest, average] = [1.0 / most, 1.0 / mean].map(|path| number(path, 4));
    let [most, mean] = [most, *mean].map(|density| number(density, 4));
    format!(
        "  densities: {most} at most, {mean} on average of active voxels\n  mean free path at an extinction of 1/m: \
         {densest} m where it is densest, {average} m at that average"
    )
}

/// The same with what the file does not say of a grid that can be read: what its voxels are, or why they cannot be read
/// after all.
fn completed(path: &Path, index: usize, grid: GridSummary) -> (GridSummary, Option<Densities>, Result<()>) {
    if grid.obstacle.is_some() {
        return (grid, None, Ok(()));
    }
    match read(path, index) {
        Ok(found) => {
            let densities = Densities::of(&found);
            let index_bounds = grid.index_bounds.or_else(|| found.index_bounds());
            let active_voxels = grid.active_voxels.or(Some(found.active_voxels));
            let obstacle = too_far_apart(&found).map(|far| format!("its {far}"));
            (GridSummary { active_voxels, index_bounds, obstacle, ..grid }, Some(densities), Ok(()))
        }
        Err(error) => {
            let place = error.place.strip_prefix(&format!("{}: ", path.display())).unwrap_or(&error.place).to_string();
            (GridSummary { obstacle: Some(format!("{place}: {}", error.finding)), ..grid }, None, Err(error))
        }
    }
}

/// Reads a grid, and says so where that takes long.
fn read(path: &Path, number: usize) -> Result<VoxelGrid> {
    let (start, reporter) = (Instant::now(), RefCell::new(Reporter::for_terminals()));
    let look = |done, total| {
        if start.elapsed() >= NOTICEABLE {
            reporter.borrow_mut().loading(&Loading::of(path, done, total), start.elapsed());
        }
    };
    let found = volume::read_listed(path, number, &look);
    reporter.borrow_mut().loaded();
    found
}

/// The memory of so many voxels of `bits` each, as the end of a line.
fn taken(voxels: u64, bits: Option<u64>) -> String {
    let Some(bits) = bits else { return String::new() };
    let each = match bits {
        1 => "1 bit".into(),
        bits => format!("{} bytes", bits / 8),
    };
    format!(", {} at {each} each", memory(voxels.saturating_mul(bits).div_ceil(8)))
}

/// An amount of memory, in the unit that suits it.
pub fn memory(bytes: u64) -> String {
    let bytes = bytes as f64;
    let (unit, power) = match bytes {
        ..1024.0 => ("bytes", 0),
        ..1048576.0 => ("KiB", 10),
        ..1073741824.0 => ("MiB", 20),
        _ => ("GiB", 30),
    };
    format!("{} {unit}", number(bytes / f64::from(1 << power), 3))
}

/// Edges of a voxel, one of them if they are equal.
fn size(edges: [f64; 3]) -> String {
    let edges = edges.map(length);
    if edges.iter().all(|edge| *edge == edges[0]) { edges[0].clone() } else { edges.join(" x ") }
}
