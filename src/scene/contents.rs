//! What a scene's geometry holds, for whoever asks.

use super::schema;

/// A light of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the glTF file that it comes from.
    pub name: Option<String>,
    /// Its values; those of a sphere or disk of the same intensity, if it is a punctual light of glTF.
    pub values: schema::Light,
}
