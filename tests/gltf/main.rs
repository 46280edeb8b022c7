//! glTF files: what good ones become, what is said about malformed ones, and that no bytes make the reader panic.

mod animations;
mod cameras_and_lights;
mod hash;
mod hierarchy;
mod malformed;
mod materials;
mod meshes;
mod mutations;
mod origin;
mod storage;
mod support;
mod textures;
