//! Extinction that differs from place to place: volumes with bounds or densities of their own, and what is around them.
//!
//! **Who is where.** Volumes are asked in the order of their priority, and the first that a point is in is its medium;
//! what none is in belongs to the medium around all. A volume is within its shape, or, without one, wherever its density
//! is not 0. Bounds are no vertices: they are nothing but places where extinction changes, so that nested, touching and
//! overlapping volumes, starts inside of them and connections across them need no thought.
//!
//! **What is known.** Nobody knows the integral of extinction along a segment, so that free flights are *tracked* and the
//! transmittance of connections is *estimated* ([`tracking`]). Both need bounds, which blocks of 2^3 cells have, and by
//! itself what is small and dense in them; and weights need an optical depth that is the same for a segment whoever asks:
//!
//! ```text
//! tau~ = sum of the cells' means at n points of the segment, evenly spread over its part within all cells and a little
//!        beyond, times that part's length / n, and what is around for the rest of it
//!        n = the cells it is long, rounded up, at most 16
//! ```
//!
//! and no more than 60, so that nothing overflows. Where a cell's mean is farther above its least extinction than one mean
//! free path along its edge, tau~ takes that much less for it.
//!
//! A ball or a box of one extinction is known: its tau~ is its optical depth, and nothing is estimated. So are segments
//! within a box of cells that are all alike.
//!
//! **Why images are right whatever tau~ is.** With T the transmittance of what a connection adds and T' any unbiased
//! estimate of it, a candidate counts
//!
//! ```text
//! C = Le throughput F / (reach(n) + sum_i reach(i) r~_i),      F = T' e^{tau~},      F = 1 for light that a walk met
//! ```
//!
//! where `r~_i` is the density of the connection from start i over that of path tracing if its transmittance were
//! e^{-tau~}. Connections do not depend on T, so their `r~_i` are known, and the weights `r~_i / (reach(n) + ..)` of
//! all techniques add up to 1 for every path. Extinctions at vertices are the true ones and cancel. The mean of F is
//! `T e^{tau~}`, so that the mean of C is what it would be if T were known. A bad tau~ makes noise, and nothing else.
//! The stage [`transmittance`](crate::transmittance) finds F.
//!
//! **Techniques.** Bridges look their counts up at tau~ of the axis. MVNEE's seeds are flights through the
//! means along the axis, of which density and count are exact ([`Seeds`](crate::connect::mvnee::Seeds)); so are flights
//! from lights, along rays ([`lis`](crate::connect::lis)).
//!
//! **Colour.** Extinctions in the three channels are multiples of each other, or fields of their own ([`Apart`]).

mod apart;
mod apron;
mod axis;
mod blocks;
mod boxes;
mod bricks;
mod cells;
mod cores;
mod even;
mod kept;
mod known;
mod lattice;
mod map;
mod masks;
pub mod reference;
mod shape;
mod shares;
mod simd;
mod span;
mod table;
pub mod tracking;
mod volume;
mod voxels;

use std::sync::Arc;

use glam::DVec3;
use wide::{f32x8, u32x8};

use super::spectral::CHANNELS;
use crate::vec3::Vec3x8;

pub use apart::{Apart, Unknown};
pub use blocks::Blocks;
pub use bricks::{Bricks, Leaf};
pub use cells::Cells;
pub use even::{EvenX8, Reach};
pub use lattice::bounds_of;
pub use map::Map;
pub use shape::Shape;
pub use simd::{ColouredFieldLanes, FieldLanes, FieldX8};
pub use volume::Volume;
pub use voxels::{Interpolation, ToIndex, Voxels, bytes_of};

pub(crate) use axis::within;

use known::{EvenPart, OneShape};
use lattice::Lattice;
use volume::Placed;

/// Most volumes of a field.
pub const MOST_VOLUMES: usize = 32;

/// Volumes, and what is around them.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The first that a point is in is its medium.
    volumes: Vec<Placed>,
    /// Extinction around all of them [1/m], >= 0.
    around: f32,
    /// Means of extinctions.
    cells: Cells,
    /// Their bounds.
    blocks: Blocks,
    /// From the world to cells, counted from the first one.
    to_cells: Map,
    /// Extinction per channel, over that of the channel in which it is largest.
    hues: [f32; CHANNELS],
    /// The fields of channels of which none is a multiple of another: then extinctions here are their means.
    apart: Option<Arc<Apart>>,
    /// All of it, if it is one shape of one extinction.
    one: Option<OneShape>,
    /// The largest box of cells that are all alike, if it is large.
    even: Option<EvenPart>,
}

impl Field {
    /// `volumes`, those of the highest priority first, in a medium of extinction `around` [1/m].
    ///
    /// # Panics
    /// If there are no volumes, or more than [`MOST_VOLUMES`], or one has neither a shape nor voxels.
    pub fn new(volumes: Vec<Volume>, around: f32) -> Self {
        let lattice = Lattice::best(&volumes, around);
        Self::on(&lattice, volumes, around)
    }

    /// `volumes`, those of the highest priority first, whose extinctions differ between channels, in a medium of the
    /// extinctions `around` [1/m]: those of a volume are its `hues`, each >= 0, of its own.
    ///
    /// # Panics
    /// As [`Self::new`], or if there are not as many hues as volumes.
    pub fn of_colours(volumes: Vec<Volume>, hues: &[[f32; CHANNELS]], around: [f32; CHANNELS]) -> Self {
        assert_eq!(volumes.len(), hues.len(), "every volume has hues");
        let scaled = |by: fn([f32; CHANNELS]) -> f32| {
            let scale = |(volume, hues): (&Volume, &[f32; CHANNELS])| Volume {
                extinction: volume.extinction * by(*hues),
                ..volume.clone()
            };
            (volumes.iter().zip(hues).map(scale).collect::<Vec<_>>(), by(around))
        };
        let (densest, densest_around) = scaled(|channels| channels.into_iter().fold(0.0, f32::max));
        let lattice = Lattice::best(&densest, densest_around);
        let (mean, mean_around) = scaled(|channels| channels.into_iter().sum::<f32>() / CHANNELS as f32);
        let apart = Apart::new(&volumes, hues, around, |volumes, around| Self::on(&lattice, volumes, around));
        // What is even here need not be so in every channel.
        Self { apart: Some(Arc::new(apart)), even: None, ..Self::on(&lattice, mean, mean_around) }
    }

    /// The densities of voxels, times `unit` [1/m].
    pub fn grid(voxels: Voxels, unit: f32) -> Self {
        Self::new(vec![Volume { shape: None, voxels: Some(voxels), extinction: unit }], 0.0)
    }

    /// One `extinction` [1/m] in a box from corner `low` to corner `high` `[m]`.
    ///
    /// # Panics
    /// If it has no inside.
    pub fn block(corners: [[f64; 3]; 2], extinction: f32) -> Self {
        Self::new(vec![Volume { shape: Some(Shape::block(corners)), voxels: None, extinction }], 0.0)
    }

    /// `volumes` in a grey medium of extinction `around`, in the cells of a lattice.
    fn on(lattice: &Lattice, volumes: Vec<Volume>, around: f32) -> Self {
        assert!((1..=MOST_VOLUMES).contains(&volumes.len()), "1 to {MOST_VOLUMES} volumes");
        let one = OneShape::of(&volumes);
        let to_cells = Map::new(&lattice.to_cells);
        let volumes = lattice.place(volumes);
        let survey = lattice.survey(&volumes, around);
        let (cells, blocks) = (Cells::new(&survey), Blocks::new(&survey, volumes.len() > 1));
        let blocks = blocks.with_cores(&survey, &volumes, &lattice.to_cells.inverse());
        let even = EvenPart::largest(&survey);
        Self { volumes, around, cells, blocks, to_cells, hues: [1.0; CHANNELS], apart: None, one, even }
    }

    /// The same with other cells: of 2^`log_side` voxels along each edge, where it is one grid, or else of so much
    /// smaller edges; with majorants times `factor` and means times `mean`. No mean of any image depends on them. One shape
    /// is tracked through them like any other field.
    pub fn with_cells(self, log_side: u32, factor: f32, mean: f32) -> Self {
        let apart = self.apart.map(|apart| Arc::new(apart.each(|field| field.with_cells(log_side, factor, mean))));
        let volumes: Vec<Volume> = self.volumes.into_iter().map(|placed| placed.volume).collect();
        let lattice = Lattice::other(&volumes, self.around, log_side);
        let field = Self { hues: self.hues, ..Self::on(&lattice, volumes, self.around) };
        let even = field.even.filter(|_| factor == 1.0 && mean == 1.0 && apart.is_none());
        let (cells, blocks) = match (factor, mean) {
            (1.0, 1.0) => (field.cells, field.blocks),
            _ => (field.cells.distorted(mean), field.blocks.distorted(factor, mean)),
        };
        Self { cells, blocks, even, apart, one: None, ..field }
    }

    /// The same with an extinction of `hues` in the three channels where it has been 1: each in (0, 1], and one of them 1.
    pub fn coloured(self, hues: [f32; CHANNELS]) -> Self {
        debug_assert!(hues.contains(&1.0) && hues.iter().all(|hue| *hue > 0.0 && *hue <= 1.0), "{hues:?}");
        debug_assert!(self.apart.is_none(), "it has colours already");
        Self { hues, ..self }
    }

    /// Extinction per channel, over that of the channel in which it is largest, where channels are multiples of each
    /// other; otherwise 1, for extinctions are those of their [own fields](Self::channel).
    pub fn hues(&self) -> [f32; CHANNELS] {
        self.hues
    }

    /// The field of a channel, and its extinction over that of this field.
    #[inline(always)]
    pub fn channel(&self, channel: usize) -> (&Self, f32) {
        match &self.apart {
            Some(apart) => (apart.channel(channel), 1.0),
            None => (self, self.hues[channel.min(CHANNELS - 1)]),
        }
    }

    /// The fields of channels of which none is a multiple of another.
    pub fn apart(&self) -> Option<&Apart> {
        self.apart.as_deref()
    }

    /// Running sums that paths keep of it: one for all channels, or one for each.
    pub fn sums(&self) -> usize {
        if self.apart.is_some() { CHANNELS } else { 1 }
    }

    /// The field of one of these sums.
    #[inline(always)]
    pub fn of_sum(&self, sum: usize) -> &Self {
        self.apart.as_ref().map_or(self, |apart| apart.channel(sum))
    }

    /// Largest extinction per channel [1/m].
    pub fn largest(&self) -> [f32; CHANNELS] {
        [0, 1, 2].map(|c| {
            let (field, hue) = self.channel(c);
            hue * field.blocks.most
        })
    }

    /// Least of the [hues](Self::hues).
    pub fn clearest(&self) -> f32 {
        self.hues.into_iter().fold(1.0, f32::min)
    }

    /// Whether extinction is the same in all channels.
    pub fn is_grey(&self) -> bool {
        self.hues == [1.0; CHANNELS] && self.apart.is_none()
    }

    /// Means of extinctions.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Bounds of extinctions.
    pub fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    /// Extinction around all volumes [1/m].
    pub fn around(&self) -> f32 {
        self.around
    }

    /// Whether the optical depth of every segment is known: a ball or a box of one extinction, and what is around it.
    pub fn is_known(&self) -> bool {
        self.one.is_some()
    }

    /// Length of the shortest edge of a cell `[m]`, about.
    pub fn cell_edge(&self) -> f64 {
        1.0 / self.to_cells.steepest()
    }

    /// Length of the diagonal of the box of all cells `[m]`, about.
    pub fn extent(&self) -> f64 {
        self.cells.dims().map(f64::from).into_iter().map(|count| count * count).sum::<f64>().sqrt()
            * self.to_cells.longest()
    }

    /// Hands everything that extinctions depend on to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(&self.around.to_le_bytes());
        self.hues.iter().for_each(|hue| digest(&hue.to_le_bytes()));
        self.volumes.iter().for_each(|placed| placed.volume.digest(digest));
        if let Some(apart) = &self.apart {
            apart.digest(digest);
        }
    }

    /// Corners of the boxes around its volumes, in their order `[m]`.
    pub fn volume_bounds(&self) -> impl Iterator<Item = [DVec3; 2]> {
        self.volumes.iter().map(|placed| placed.volume.bounds())
    }

    /// The voxels of all its volumes.
    pub fn voxels(&self) -> impl Iterator<Item = &Voxels> {
        self.volumes.iter().flat_map(|placed| placed.volume.all_voxels())
    }

    /// Bytes that it takes besides voxels.
    pub fn bytes_besides_voxels(&self) -> usize {
        let volumes = self.volumes.iter().map(|placed| placed.volume.bytes_besides_voxels()).sum::<usize>();
        volumes + self.bytes_of_cells()
    }

    /// Bytes of means and bounds.
    fn bytes_of_cells(&self) -> usize {
        self.cells.bytes() + self.blocks.bytes() + self.apart.as_ref().map_or(0, |apart| apart.bytes())
    }

    /// The part of rays of unit `direction` up to `length` within the box of all cells `[m]`; empty where the second is
    /// not larger.
    #[inline(always)]
    pub fn part(&self, origin: Vec3x8, direction: Vec3x8, length: f32x8) -> [f32x8; 2] {
        let counts = self.cells.dims().map(|dim| dim as f32);
        axis::within(self.in_cells(origin), self.to_cells.directions(direction), [0.0; 3], counts, length)
    }

    /// Points in cells from the first one on.
    #[inline(always)]
    fn in_cells(&self, at: Vec3x8) -> Vec3x8 {
        self.to_cells.points(at)
    }

    /// Extinction at points in cells [1/m], and who is there: 0 for what is around, or the number of the volume, from 1
    /// on.
    #[inline(always)]
    fn at(&self, at: Vec3x8) -> (f32x8, u32x8) {
        let mut present = u32x8::splat(1);
        if let volumes @ [_, ..] = self.blocks.volumes() {
            present = u32x8::new(self.blocks.indices(at).to_array().map(|block| volumes[block as usize]));
        }
        volume::extinction(&self.volumes, self.around, present, at)
    }

    /// Extinction at points of the world [1/m].
    #[inline(never)]
    fn extinction(&self, at: Vec3x8) -> f32x8 {
        let at = self.in_cells(at);
        let Some(even) = &self.even else { return self.at(at).0 };
        let (inside, known) = (even.holds(at), f32x8::splat(even.extinction));
        if inside.all() { known } else { inside.select(known, self.at(at).0) }
    }

    /// Who is at points of the world: 0 for what is around, or the number of the volume, from 1 on.
    #[inline(never)]
    pub fn who(&self, at: Vec3x8) -> u32x8 {
        self.at(self.in_cells(at)).1
    }
}

#[cfg(test)]
mod tests;
