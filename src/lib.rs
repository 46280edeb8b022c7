//! fogbow renders light in dense, forward-scattering media.
//!
//! [`Scene`] is the quickest way from a scene to its pixels:
//!
//! ```
//! use fogbow::{Scene, Target};
//!
//! # fn main() -> fogbow::error::Result<()> {
//! let mut scene = Scene::load("scenes/fog-facing")?;
//! scene.set("medium.absorption", 0.5)?;
//! scene.set("render.max_segments", 32)?;
//! scene.set("film.size", vec![32, 32])?;
//!
//! let image = scene.render(Target::Samples(16))?;
//! let middle = image.pixel(16, 16);
//! println!("{:?} +- {:?} W/(m^2 sr)", middle.mean, middle.standard_error);
//! for warning in image.warnings() {
//!     eprintln!("warning: {warning}");
//! }
//! image.write(std::env::temp_dir().join("fog.png"))?;
//! # assert!(middle.mean[0] > 0.1 && middle.samples == 16);
//! # assert!(!image.warnings().iter().any(|warning| warning.contains("left out")), "{:?}", image.warnings());
//! # Ok(())
//! # }
//! ```
//!
//! [`session`] is the longer way, which lets you choose and watch everything; [`wavefront`] is the loop that runs the
//! stages one after another, and [`kernels`] has the stages themselves, each with a scalar twin.
//!
//! Light that is neither absorbed nor gets away may take thousands of turns. Paths have any length, unless
//! `render.max_segments` is a number; how much light that leaves out is among the warnings.
//!
//! # Speed
//!
//! **Build with `--release`**: without optimisation a render takes minutes instead of seconds. If your own code has to
//! be built for debugging, have its dependencies optimised all the same, by these lines in the `Cargo.toml` of your
//! workspace:
//!
//! ```toml
//! [profile.dev.package."*"]
//! opt-level = 3
//! ```
//!
//! Stages work on eight numbers at a time, as AVX2 does. Unless told otherwise, Rust builds for the oldest processors,
//! and a dependency cannot change that: **put these lines into `.cargo/config.toml`** next to the `Cargo.toml` of your
//! workspace. Without them every render takes up to twice as long (and [`Scene::warnings`] says so, before the first
//! one).
//!
//! ```toml
//! [target.'cfg(target_arch = "x86_64")']
//! rustflags = ["-Ctarget-cpu=x86-64-v3"]
//! ```

pub mod adaptive;
pub mod cli;
pub mod compare;
pub mod cpu;
pub mod denoise;
pub mod error;
mod figures;
pub mod film;
pub mod frame;
pub mod gltf;
pub mod image;
mod library;
pub mod live;
pub mod merge;
pub mod metering;
pub mod output;
pub mod paper;
pub mod paths;
pub mod pilot;
pub mod plot;
pub mod reference;
pub mod render;
pub mod scene;
pub mod session;
pub mod stats;
pub mod truncation;
pub mod volume;
pub mod warning;
pub mod wavefront;

pub use fogbow_kernels as kernels;
pub use library::{Rendered, Scene};
pub use session::{Limits, Target};
