//! The long suite: statistics that take minutes.
//!
//! ```text
//! cargo test --release --features long --test long
//! ```

mod bridges;
mod limits;
mod means;
mod numbers;
mod rays;
mod volumes;
