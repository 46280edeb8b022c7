//! Tests of the built program.

mod bar;
mod bare;
mod clouds;
mod compare;
mod exposure;
mod files;
mod flags;
mod help;
mod images;
mod info;
mod lamps;
mod left_out;
mod models;
mod phases;
mod presets;
mod progress;
mod render;
mod scenes;
mod settings;
mod stats;
mod stop;
mod streams;
mod support;
mod volumes;
mod warnings;
