//! What the tests and benchmarks of fogbow share.

pub mod agreement;
pub mod both_ways;
pub mod checked;
pub mod compare;
pub mod frames;
pub mod generated;
pub mod meshes;
pub mod not_run;
pub mod null_vertices;
pub mod quadrature;
pub mod random;
pub mod rays;
pub mod recorded;
pub mod render;
pub mod statistics;
pub mod suite;
pub mod tolerances;
pub mod truths;
pub mod volume_writer;
pub mod volumes;
pub mod walks;
pub mod weighing;
