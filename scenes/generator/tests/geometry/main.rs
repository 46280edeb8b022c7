//! The geometry that is committed: is it what the program generates, is it valid, and does it look as it is described.
//! Everything but the first is read back from the files.

mod cloud_sky;
mod colonnade;
mod cornell_fog;
mod dense_plate;
mod files;
mod glb;
mod godrays;
mod scene;
mod smoke_fire;
mod spotlight;
mod surfaces;
mod wax;
