//! Tests of the built program.

mod compare;
mod files;
mod flags;
mod help;
mod images;
mod info;
mod lamps;
mod models;
mod progress;
mod render;
mod scenes;
mod stats;
mod stop;
mod support;
