//! Media: what fills space, as rows of a table, each of a kind that is asked and not known.
//!
//! Stages match on the kind once, outside their loops, with [`with_medium!`](crate::with_medium), and run a kernel that
//! is generic over [`MediumX8`]: how far flights go, how thick a segment is, how dense a point. A new kind is its
//! folder, a row of [`Kind`] and one of [`with_medium!`](crate::with_medium).
//!
//! Extinction may differ between channels. A path's flights are drawn for one of them, its *hero*, and weights count
//! all of them: see [`spectral`].

pub mod grid;
pub mod homogeneous;
mod lanes;
pub mod reference;
pub mod spectral;

use core::ops::Index;
use std::sync::Arc;

use self::grid::reference::GridTwin;
use crate::phase::PhaseFunction;
pub use grid::Grid;
pub use homogeneous::Homogeneous;
pub use lanes::{Crowding, MediumLanes, MediumX8};

/// The media of a scene. The first fills all space.
#[derive(Clone, Debug, PartialEq)]
pub struct Media {
    rows: Vec<Medium>,
}

/// A row of the table: one medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// How dense it is, and where.
    pub kind: Kind,
    /// Single-scattering albedo mu_s / mu_t per channel, in [0, 1]; the same everywhere, 0 in vacuum.
    pub albedo: [f32; 3],
    /// Where a scattering event sends light.
    pub phase: PhaseFunction,
}

/// How a medium's extinction is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// The same everywhere.
    Homogeneous(Homogeneous),
    /// In proportion to the densities of a grid, grey.
    Grid(Arc<Grid>),
}

impl Media {
    /// The row of the medium around everything.
    pub const AROUND: u32 = 0;

    /// One medium everywhere.
    pub fn everywhere(medium: Medium) -> Self {
        Self { rows: vec![medium] }
    }
}

impl Index<u32> for Media {
    type Output = Medium;

    fn index(&self, row: u32) -> &Medium {
        &self.rows[row as usize]
    }
}

impl Medium {
    /// A homogeneous medium of grey `extinction` [1/m], >= 0.
    pub const fn homogeneous(extinction: f32, albedo: [f32; 3], phase: PhaseFunction) -> Self {
        Self { kind: Kind::Homogeneous(Homogeneous::grey(extinction)), albedo, phase }
    }

    /// A homogeneous medium of this `extinction` per channel [1/m], each >= 0.
    pub fn coloured(extinction: [f32; 3], albedo: [f32; 3], phase: PhaseFunction) -> Self {
        Self { kind: Kind::Homogeneous(Homogeneous::coloured(extinction)), albedo, phase }
    }

    /// A medium of the densities of `grid`.
    pub fn grid_of(grid: Grid, albedo: [f32; 3], phase: PhaseFunction) -> Self {
        Self { kind: Kind::Grid(Arc::new(grid)), albedo, phase }
    }

    /// Nothing.
    pub const fn vacuum() -> Self {
        Self::homogeneous(0.0, [0.0; 3], PhaseFunction::isotropic())
    }

    /// As the twins ask it, in one channel.
    pub fn twin(&self, channel: usize) -> reference::Twin<'_> {
        let phase = self.phase.twin();
        match &self.kind {
            Kind::Homogeneous(_) => reference::Twin::Homogeneous(self.homogeneous_twin(channel)),
            Kind::Grid(grid) => reference::Twin::Grid(GridTwin { grid, phase }),
        }
    }

    /// As the twins of stages ask it that only homogeneous media have, in one channel.
    ///
    /// # Panics
    /// If it is not homogeneous.
    pub fn homogeneous_twin(&self, channel: usize) -> reference::Homogeneous<'_> {
        match &self.kind {
            Kind::Homogeneous(medium) => {
                reference::Homogeneous { extinction: f64::from(medium.extinction[channel]), phase: self.phase.twin() }
            }
            Kind::Grid(_) => unreachable!("a grid is not homogeneous"),
        }
    }

    /// Its grid, if it has one: flights are tracked there, and transmittances estimated.
    pub fn grid(&self) -> Option<&Grid> {
        match &self.kind {
            Kind::Homogeneous(_) => None,
            Kind::Grid(grid) => Some(grid),
        }
    }

    /// What is left of light after `events` scattering events, per channel.
    pub fn albedos(&self, events: usize) -> [f32; 3] {
        self.albedo.map(|albedo| albedo.powi(events as i32))
    }

    /// Largest extinction anywhere, per channel [1/m].
    pub fn extinctions(&self) -> [f32; 3] {
        match &self.kind {
            Kind::Homogeneous(medium) => medium.extinction,
            Kind::Grid(grid) => [grid.cells().most; 3],
        }
    }

    /// Largest extinction anywhere, in any channel [1/m].
    pub fn largest_extinction(&self) -> f32 {
        self.extinctions().into_iter().fold(0.0, f32::max)
    }

    /// Longest mean free path of a channel `[m]`, in which limits on distances count: what they leave out would be
    /// missed most where light goes far. Infinite in a grid, where limits are on optical depths.
    pub fn mean_free_path(&self) -> f64 {
        match &self.kind {
            Kind::Homogeneous(medium) => 1.0 / f64::from(medium.extinction.into_iter().fold(f32::INFINITY, f32::min)),
            Kind::Grid(_) => f64::INFINITY,
        }
    }

    /// A limit on expected segments as one on optical depths: infinite where it is one on distances.
    pub fn longest_depth(&self, expected_segments: f64) -> f32 {
        if self.grid().is_some() { expected_segments as f32 } else { f32::INFINITY }
    }

    /// Whether extinction differs between channels.
    pub fn is_coloured(&self) -> bool {
        match &self.kind {
            Kind::Homogeneous(medium) => !medium.is_grey(),
            Kind::Grid(_) => false,
        }
    }

    /// Whether no path has more than its camera segment: light is never scattered.
    pub fn never_scatters(&self) -> bool {
        self.largest_extinction() == 0.0 || self.albedo == [0.0; 3]
    }
}

/// Runs `$body` with `$lanes` as the [`MediumLanes`] of a [`Medium`]: once per kind in the program, and twice for
/// homogeneous media, for grey and for coloured extinction; one of them at a time.
#[macro_export]
macro_rules! with_medium {
    ($medium:expr, |$lanes:ident| $body:expr) => {
        match &$medium.kind {
            $crate::media::Kind::Grid(grid) => {
                let $lanes = $crate::media::grid::GridLanes::new(grid);
                $body
            }
            $crate::media::Kind::Homogeneous(_) => $crate::with_homogeneous!($medium, |$lanes| $body),
        }
    };
}

/// The same for stages that only homogeneous media have.
#[macro_export]
macro_rules! with_homogeneous {
    ($medium:expr, |$lanes:ident| $body:expr) => {
        match &$medium.kind {
            $crate::media::Kind::Homogeneous(medium) if medium.is_grey() => {
                let $lanes = $crate::media::homogeneous::GreyLanes::new(medium);
                $body
            }
            $crate::media::Kind::Homogeneous(medium) => {
                let $lanes = $crate::media::homogeneous::ColouredLanes::new(medium);
                $body
            }
            $crate::media::Kind::Grid(_) => unreachable!("a grid is not homogeneous"),
        }
    };
}
