//! The arithmetic of fogbow: columns, read-only tables, and the stages that transform them.
//!
//! A stage is a folder: `mod.rs` states what it may read and fill, `simd.rs` does it for eight rows at a time in f32,
//! `reference.rs` does it for one row at a time in f64, written from the formulas and not from the kernel. [`pipeline`]
//! lists them all. Nothing here opens files, starts threads, reads clocks or allocates in a loop, but that the tree
//! over triangles is built on the threads of rayon.

pub mod accumulate;
pub mod columns;
pub mod connect;
pub mod emission;
pub mod extend;
pub mod features;
pub mod first_flight;
pub mod first_surface;
pub mod flight_hue;
pub mod flight_weight;
pub mod generate;
pub mod glow;
pub mod lanes;
pub mod light_hit;
pub mod media;
pub mod medium_sample;
pub mod mis_weight;
pub mod occlusion;
pub mod outline;
pub mod passage;
pub mod phase;
pub mod phase_quotient;
pub mod pipeline;
pub mod prune;
pub mod random;
pub mod real;
pub mod remember;
pub mod roulette;
pub mod scatter;
pub mod sift;
pub mod spectral_weight;
pub mod surface;
pub mod survival;
pub mod tables;
pub mod trace;
pub mod transcendental;
pub mod transmittance;
pub mod vec3;

use survival::Survival;

/// What every stage knows of the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Seed of the frame's random bits.
    pub seed: u32,
    /// Bounce clock: names the slot of the current vertices, and is the depth of a path plus its birth.
    pub clock: u32,
}

/// How far walks go, and where they connect from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkLimits {
    /// Segments after which walks end: more than the depth of the last start, so that every start is reached. Lights
    /// farther along are found by connections alone.
    pub segments: u32,
    /// Vertices that connect: the first ones after the camera or the last surface, >= 1; `u32::MAX` for all.
    pub starts: u32,
    /// Probability with which a walk goes on from a vertex after the camera.
    pub survival: Survival,
}

impl WalkLimits {
    /// Walks that go on, and connect from every vertex.
    pub const ALL: Self = Self { segments: u32::MAX, starts: u32::MAX, survival: Survival::CERTAIN };
}

/// The longest path that there is, in segments: random dimensions have room for vertices of so many depths.
pub const LONGEST_PATH: u32 = 1 << 16;

/// The longest path that a single connection may have to make: random dimensions have room for as many inserted
/// vertices.
/// On paths that may be longer, techniques insert no more than [`MOST_INSERTED`].
pub const LONGEST_BRIDGED_PATH: u32 = 1024;

/// Most vertices that connections insert into paths which may be longer than [`LONGEST_BRIDGED_PATH`]: what a worker
/// remembers of its paths, and what it takes to weigh one, depends on this and not on how long they are. Measured with
/// bridges on fog-facing and dense-plate, 14 take two to four times as long for the same noise, and 62 twice.
pub const MOST_INSERTED: u32 = 30;

/// Which path lengths count, in segments, camera and light segment included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathLengths {
    /// Shortest, >= 1.
    pub min: u32,
    /// Longest (K), >= `min`.
    pub max: u32,
}
