//! The frame of an OpenVDB file: a header, and for every grid what kind it is and where its parts are.

use super::grid::obstacle;
use super::input::{DAMAGED, Input};
use super::metadata::Metadata;
use super::transform::Map;
use crate::gltf::fault::{At, Checked, Fault, quoted, require};

/// The first bytes of every file: `VDB` and a space, backwards, in eight bytes.
const MAGIC: u64 = 0x5644_4220;
/// The oldest version of the format that is read, of 2013: masks tell which values are stored.
const OLDEST: u32 = 222;
/// The newest version, written since 2017.
const NEWEST: u32 = 224;
/// Characters of the identifier in the header.
const IDENTIFIER: u64 = 36;
/// Stands between the name of a grid and its number, if several have that name.
const SEPARATOR: char = '\u{1e}';
/// End of the type of a grid that is saved as half floats.
const HALF: &str = "_HalfFloat";
/// Grids that messages name.
const MOST_NAMED: usize = 20;

/// All grids of a file.
pub struct Archive {
    pub grids: Vec<Entry>,
}

/// One grid, before its voxels are read.
pub struct Entry {
    /// As people know it.
    pub name: String,
    /// As other grids refer to it.
    unique: String,
    /// For example `Tree_float_5_4_3`, without the suffix of half floats.
    pub tree: String,
    /// The unique name of the grid that it shares its voxels with; mostly empty.
    parent: String,
    /// Whether values are saved as half floats.
    pub is_half: bool,
    /// Bits, of which [`Packing`](super::chunks::Packing) knows the meaning.
    pub compression: u32,
    pub metadata: Metadata,
    pub map: Map,
    pub places: Places,
}

/// Bytes of the file at which parts of a grid begin.
#[derive(Clone, Copy)]
pub struct Places {
    /// Nodes and masks. None if the transform cannot be read.
    pub nodes: Option<u64>,
    /// Values of leaves. Of no meaning if they are another grid's.
    pub leaves: u64,
    /// One past the last.
    pub end: u64,
}

impl Archive {
    /// Reads everything but voxels.
    pub fn read(input: &mut Input) -> Checked<Self> {
        header(input)?;
        let count = input.u32()?;
        let mut grids = Vec::new();
        for index in 0..count {
            grids.push(Entry::read(input).at(|| format!("grid {index}"))?);
        }
        Ok(Self { grids })
    }

    /// The grid called `name`, the only one, or the one called `density`.
    pub fn choose(&self, name: Option<&str>) -> Checked<&Entry> {
        let called = |name: &str| self.grids.iter().find(|grid| grid.name == name);
        match (name, self.grids.as_slice()) {
            (_, []) => Err(Fault::new("has no grids", "save a grid of densities in it")),
            (Some(name), _) => {
                called(name).ok_or_else(|| Fault::new(format!("has no grid {}", quoted(name)), self.what_to_name()))
            }
            (None, [only]) => Ok(only),
            (None, _) => called("density").ok_or_else(|| {
                let finding = format!("has {} grids, none of them \"density\"", self.grids.len());
                Fault::new(finding, self.what_to_name())
            }),
        }
    }

    /// The grid whose voxels those of `entry` are: mostly its own.
    pub fn owner<'a>(&'a self, entry: &'a Entry) -> Checked<&'a Entry> {
        if entry.parent.is_empty() {
            return Ok(entry);
        }
        let owner = self.grids.iter().find(|grid| grid.unique == entry.parent && grid.parent.is_empty());
        let finding = || format!("shares the voxels of {}, which is not there", quoted(&entry.parent));
        owner.ok_or_else(|| Fault::new(finding(), DAMAGED))
    }

    /// The names of the grids that can be read; if there are none, of the others, with what is in the way.
    fn what_to_name(&self) -> String {
        let names: Vec<_> =
            self.grids.iter().filter(|grid| obstacle(grid).is_none()).map(|grid| quoted(&grid.name)).collect();
        let more = if names.len() > MOST_NAMED { " and others" } else { "" };
        match names.as_slice() {
            [] => {
                format!("save a grid of densities in it: none of those that it has can be read; {}", self.obstacles())
            }
            [one] => format!("name {one}, the only one that can be read"),
            names => format!("name one of {}{more}", names[..names.len().min(MOST_NAMED)].join(", ")),
        }
    }

    /// Why the grids cannot be read that cannot.
    fn obstacles(&self) -> String {
        let told = |grid: &Entry| Some(format!("{}: {}", quoted(&grid.name), obstacle(grid)?.finding()));
        let all: Vec<_> = self.grids.iter().filter_map(told).collect();
        let more = if all.len() > MOST_NAMED { "; and others" } else { "" };
        all[..all.len().min(MOST_NAMED)].join("; ") + more
    }
}

/// Reads up to the number of grids.
fn header(input: &mut Input) -> Checked<()> {
    let is_vdb = input.len()? >= 8 && input.u64()? == MAGIC;
    require(is_vdb, || "is not an OpenVDB file", "give an OpenVDB file: its name mostly ends in .vdb")?;
    let version = input.u32()?;
    let finding = || format!("has version {version} of the OpenVDB format; {OLDEST} to {NEWEST} can be read");
    require(
        (OLDEST..=NEWEST).contains(&version),
        finding,
        "save it again with a program that writes version 224, as those based on OpenVDB 5 to 10 do",
    )?;
    let _library = [input.u32()?, input.u32()?];
    let finding = || "was written as a stream, which does not say where its grids are";
    require(input.u8()? == 1, finding, "save it as a file, not through a stream")?;
    input.skip(IDENTIFIER)?;
    Metadata::read(input).at(|| "metadata")?;
    Ok(())
}

impl Entry {
    /// Reads a grid up to its voxels, and passes over those.
    fn read(input: &mut Input) -> Checked<Self> {
        let [unique, kind, parent] = [input.text()?, input.text()?, input.text()?];
        let [start, leaves, end] = [input.u64()?, input.u64()?, input.u64()?];
        let has_leaves = parent.is_empty();
        let is_ordered = input.position() <= start && start <= end && (!has_leaves || (start..=end).contains(&leaves));
        require(is_ordered, || "has parts out of order", DAMAGED)?;
        let name = shown(&unique);
        let (compression, metadata, map) = Self::description(input, start).at(|| quoted(&name))?;
        let nodes = map.is_known().then(|| input.position());
        input.seek(end).at(|| quoted(&name))?;
        let (tree, is_half) = match kind.strip_suffix(HALF) {
            Some(tree) => (tree.into(), true),
            None => (kind, metadata.is_half),
        };
        let places = Places { nodes, leaves, end };
        Ok(Self { name, unique, tree, parent, is_half, compression, metadata, map, places })
    }

    /// Compression, metadata and transform.
    fn description(input: &mut Input, start: u64) -> Checked<(u32, Metadata, Map)> {
        input.seek(start)?;
        Ok((input.u32()?, Metadata::read(input)?, Map::read(input)?))
    }

    /// What the grid is called in messages.
    pub fn label(&self) -> String {
        format!("grid {}", quoted(&self.name))
    }

    /// The type of its values as people know it: `float` for `Tree_float_5_4_3`.
    pub fn value_type(&self) -> &str {
        let tree = self.tree.strip_prefix("Tree_").unwrap_or(&self.tree);
        tree.split('_').next().unwrap_or(tree)
    }
}

/// A unique name as OpenVDB shows it.
fn shown(unique: &str) -> String {
    match unique.split_once(SEPARATOR) {
        Some((name, number)) => format!("{name}[{number}]"),
        None => unique.into(),
    }
}
