//! fogbow renders light in dense, forward-scattering media.

pub mod cli;
pub mod compare;
pub mod cpu;
pub mod error;
mod figures;
pub mod film;
pub mod frame;
pub mod gltf;
pub mod image;
pub mod metering;
pub mod output;
pub mod pilot;
pub mod reference;
pub mod render;
pub mod scene;
pub mod session;
pub mod stats;
pub mod truncation;
pub mod warning;
pub mod wavefront;
