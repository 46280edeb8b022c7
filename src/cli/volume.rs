//! `fogbow info` of an OpenVDB file.

use std::path::Path;

use super::info::{MOST_NAMED, count};
use super::say;
use crate::error::Result;
use crate::figures::{length, number, point};
use crate::gltf::quoted;
use crate::volume::{self, GridSummary};

/// Bytes of a voxel in memory.
const VOXEL: u64 = 4;

/// Lists the grids in the file at `path`.
pub fn describe(path: &Path) -> Result<()> {
    let grids = volume::list(path)?;
    say(format!("{}: {}", path.display(), count(grids.len(), "grid")))?;
    grids.iter().take(MOST_NAMED).try_for_each(describe_grid)?;
    match grids.len().checked_sub(MOST_NAMED) {
        Some(more @ 1..) => say(format!("and {}", count(more, "more grid"))),
        _ => Ok(()),
    }
}

fn describe_grid(grid: &GridSummary) -> Result<()> {
    let half = if grid.is_half { " saved as half floats" } else { "" };
    let class = if grid.class == "unknown" { "unknown class" } else { &grid.class };
    let compression = if grid.compression == "none" { "not compressed" } else { &grid.compression };
    say(format!("grid {}: {}{half}, {class}, {compression}", quoted(&grid.name), grid.value_type))?;
    match grid.active_voxels {
        Some(voxels) => {
            say(format!("  active voxels: {voxels}, {} at {VOXEL} bytes each", memory(voxels.saturating_mul(VOXEL))))?
        }
        None => say("  active voxels: the file does not say how many")?,
    }
    match grid.voxel_size() {
        Some(edges) => say(format!("  voxel size: {} m", size(edges)))?,
        None => say(format!("  transform: {}, which cannot be used", quoted(&grid.transform)))?,
    }
    if let Some([first, last]) = grid.index_bounds {
        say(format!("  index bounds: {first:?} to {last:?}"))?;
    }
    if let Some([min, max]) = grid.world_bounds() {
        say(format!("  world bounds: {} to {} m", point(min), point(max)))?;
    }
    Ok(())
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
