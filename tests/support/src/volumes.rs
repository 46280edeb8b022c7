//! Volumes of tests, and what damage does to them.

use std::path::PathBuf;

use fogbow::scene::too_far_apart;
use fogbow::volume::{VoxelGrid, list_bytes, read_bytes};
use fogbow_kernels::media::field::Bricks;

use crate::random::Random;

/// Files that are damaged: of every compression, with half floats, several grids, shared voxels and other transforms.
pub const FILES: [&str; 8] =
    ["block.vdb", "half.vdb", "plain.vdb", "shared.vdb", "transforms.vdb", "two.vdb", "zip.vdb", "zip_half.vdb"];

/// Numbers that somebody may not have thought of.
const STRANGE: [u32; 12] =
    [0, 1, 2, 8, 0xff, 0xffff, 0x7fff_ffff, 0x8000_0000, u32::MAX, 0x7f80_0000, 0x7fc0_0000, 0x0001_0000];

/// Where the volumes are.
pub fn path(file: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../data/volumes")).join(file)
}

/// The bytes of the volume called `file`.
///
/// # Panics
/// If it cannot be read.
pub fn bytes(file: &str) -> Vec<u8> {
    let path = path(file);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Reads `cases` damaged files, beginning with number `first`. Whatever comes of it, it is a sound grid, which is not
/// empty, or an error.
///
/// # Panics
/// If it is neither.
pub fn damage(first: u64, cases: u64) -> Outcomes {
    let files = FILES.map(bytes);
    let mut outcomes = Outcomes::default();
    for case in first..first + cases {
        let _case = Case(case);
        let mut random = Random::new(case);
        let mut file = files[random.below(files.len())].clone();
        for _ in 0..=random.below(3) {
            hurt(&mut file, &mut random);
        }
        outcomes.add(&file);
    }
    outcomes
}

/// What became of damaged files.
#[derive(Debug, Default)]
pub struct Outcomes {
    /// How many could be read.
    pub read: u64,
    /// How many could not.
    pub refused: u64,
}

impl Outcomes {
    /// Reads `file`, by all names that it may have.
    ///
    /// # Panics
    /// If the outcome is neither a sound grid nor an error with words.
    pub fn add(&mut self, file: &[u8]) {
        let names: Vec<_> = list_bytes("x", file).into_iter().flatten().map(|grid| Some(grid.name)).collect();
        let names = if names.is_empty() { vec![None] } else { names };
        for name in names {
            match read_bytes("x", file, name.as_deref()) {
                Ok(grid) => {
                    assert_sound(&grid);
                    self.read += 1;
                    assert!(has_densities(&grid), "damage has left nothing");
                    assert_rendered_in_place(&grid);
                }
                Err(error) => {
                    assert!(!error.finding.is_empty() && !error.remedy.is_empty(), "{error:?}");
                    self.refused += 1;
                }
            }
        }
    }
}

/// Whether there is anything in it.
fn has_densities(grid: &VoxelGrid) -> bool {
    grid.leaves.iter().any(|leaf| leaf.values.iter().any(|density| *density > 0.0))
}

/// What all grids promise.
///
/// # Panics
/// If `grid` does not keep it.
pub fn assert_sound(grid: &VoxelGrid) {
    assert!(grid.index_to_world.inverse().is_finite(), "{:?}", grid.index_to_world);
    let mut origins: Vec<_> = grid.leaves.iter().map(|leaf| leaf.origin).collect();
    assert!(origins.as_flattened().iter().all(|coordinate| coordinate % 8 == 0));
    origins.sort_unstable();
    assert!(origins.windows(2).all(|two| two[0] != two[1]), "two leaves at the same place");
    let is_density = |value: &f32| *value >= 0.0 && value.is_finite();
    assert!(grid.leaves.iter().all(|leaf| leaf.values.iter().all(is_density)));
}

/// What is rendered has the densities of every leaf at its place, to a thousandth of their mean.
///
/// # Panics
/// If it has not.
fn assert_rendered_in_place(grid: &VoxelGrid) {
    if too_far_apart(grid).is_some() {
        return;
    }
    let bricks = Bricks::new(&grid.leaves);
    let filled = || grid.leaves.iter().flat_map(|leaf| leaf.values.iter()).filter(|value| **value != 0.0);
    let mean = filled().map(|value| f64::from(*value)).sum::<f64>() / filled().count() as f64;
    for leaf in &grid.leaves {
        for (index, value) in leaf.values.iter().enumerate().step_by(37) {
            let local = [index % 8, index / 8 % 8, index / 64];
            let place = [0, 1, 2].map(|axis| i64::from(leaf.origin[axis]) + local[axis] as i64 - bricks.origin[axis]);
            let (found, expected) = (bricks.value(place), f64::from(*value));
            let off = (found - expected).abs();
            assert!(off <= 1e-3 * mean + 1e-6 * expected + 1e-40, "{found} instead of {expected} at {place:?}, {mean}");
        }
    }
}

/// Changes one thing.
fn hurt(file: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(file.len());
    let strange = STRANGE[random.below(STRANGE.len())].to_le_bytes();
    match random.below(7) {
        0 => file[at] ^= 1 << random.below(8),
        1 => file[at] = random.next() as u8,
        2 => overwrite(file, at, &strange[..2]),
        3 => overwrite(file, at, &strange),
        // What is said at the beginning counts most.
        4 => overwrite(file, at % 1024, &strange),
        5 => overwrite(file, at % 1024, &[random.next() as u8]),
        _ if random.below(8) == 0 => file.truncate(at.max(1)),
        _ => drop(file.drain(at..(at + 1 + random.below(9)).min(file.len() - 1).max(at))),
    }
}

/// Puts `bytes` at `at`, as far as the file goes.
fn overwrite(file: &mut [u8], at: usize, bytes: &[u8]) {
    file.iter_mut().skip(at).zip(bytes).for_each(|(old, new)| *old = *new);
}

/// Says which case it was if reading panics.
struct Case(u64);

impl Drop for Case {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("case {}", self.0);
        }
    }
}
