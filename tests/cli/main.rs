//! Tests of the built program.

mod adaptive;
mod aovs;
mod bar;
mod bare;
mod checkpoints;
#[cfg(unix)]
mod children;
mod clouds;
mod compare;
mod contests;
mod exposure;
mod farm;
mod files;
mod flags;
mod flames;
mod frames;
#[cfg(unix)]
mod full_disks;
mod help;
mod images;
mod info;
mod lamps;
mod left_out;
mod limits;
mod merge;
mod models;
mod paper;
mod paths;
mod phases;
mod presets;
mod preview;
mod progress;
mod render;
mod scenes;
mod serve;
mod settings;
mod skies;
mod stats;
mod stop;
mod streams;
mod support;
mod volumes;
mod warnings;
