//! From JSON to the keys of [`Root`], and whether this version and these extensions can be read.

use super::container::Container;
use super::fault::{Checked, Fault, quoted, require};
use super::schema::Root;
use super::warnings::Warnings;
use crate::error::{Error, Result};

/// Extensions that are read.
const SUPPORTED: [&str; 4] = [LIGHTS, "KHR_materials_emissive_strength", "KHR_texture_transform", MESH_QUANTIZATION];
/// Lights of the scene.
const LIGHTS: &str = "KHR_lights_punctual";
/// Compressed attributes and indices.
pub const DRACO: &str = "KHR_draco_mesh_compression";
/// Positions and texture coordinates of small integers.
const MESH_QUANTIZATION: &str = "KHR_mesh_quantization";

/// The keys of `container`, the content of `file`.
pub fn read(file: &str, container: &Container<'_>) -> Result<Root> {
    let mut json = serde_json::Deserializer::from_slice(container.json);
    let root = serde_path_to_error::deserialize(&mut json);
    let root = root.map_err(|error| malformed(file, container, &error.path().to_string(), error.inner()))?;
    json.end().map_err(|error| malformed(file, container, ".", &error))?;
    Ok(root)
}

/// The error that the JSON cannot be read at `path`.
fn malformed(file: &str, container: &Container<'_>, path: &str, error: &serde_json::Error) -> Error {
    let position = format!(" at line {} column {}", error.line(), error.column());
    let message = error.to_string();
    let message = message.strip_suffix(&position).unwrap_or(&message);
    let place = match container.is_text {
        true => format!("{file}:{}:{}", error.line(), error.column()),
        false => format!("{file}: JSON, line {}, column {}", error.line(), error.column()),
    };
    let path = path.trim_end_matches(['.', '?']);
    let finding = if path.is_empty() { message.to_string() } else { format!("{path}: {message}") };
    let remedy = match error.classify() {
        serde_json::error::Category::Data => "correct the value, which does not fit glTF 2.0, or export the file again",
        serde_json::error::Category::Eof => "copy or export the file again: its JSON ends too early",
        _ => "correct the JSON, or export the file again",
    };
    Error::failure(place, finding, remedy)
}

/// Whether the file is of a version and has extensions that can be read; `is_played` if its animations are.
pub fn check(root: &Root, is_played: bool, warnings: &mut Warnings) -> Checked<()> {
    version(root)?;
    for name in &root.extensions_required {
        require(SUPPORTED.contains(&name.as_str()), || format!("requires {}", quoted(name)), remedy(name))
            .map_err(|fault| fault.at("extensionsRequired"))?;
    }
    for name in root.extensions_used.iter().filter(|name| !SUPPORTED.contains(&name.as_str())) {
        warnings.note("extensions that are not supported are ignored", || format!("extension {}", quoted(name)));
    }
    if !root.animations.is_empty() && !is_played {
        let finding = "animations play only with --frames; without it, nodes stay where the file puts them";
        warnings.note(finding, || "animation 0");
    }
    Ok(())
}

/// Whether positions and texture coordinates may be small integers.
pub fn is_quantized(root: &Root) -> bool {
    let mut names = root.extensions_used.iter().chain(&root.extensions_required);
    names.any(|name| name == MESH_QUANTIZATION)
}

fn version(root: &Root) -> Checked<()> {
    let remedy = "export the model as glTF 2.0";
    let Some(asset) = &root.asset else {
        return Err(Fault::new("is missing, and with it the version of glTF", remedy).at("asset"));
    };
    let major = asset.version.split_once('.').map_or(asset.version.as_str(), |(major, _)| major);
    let finding = || format!("version is {}", quoted(&asset.version));
    require(major == "2", finding, remedy).map_err(|fault| fault.at("asset"))?;
    let least = asset.min_version.as_deref().unwrap_or("2.0");
    let finding = || format!("minVersion is {}", quoted(least));
    require(least == "2.0", finding, remedy).map_err(|fault| fault.at("asset"))
}

/// What to do about a file that requires the extension `name`.
pub fn remedy(name: &str) -> &'static str {
    match name {
        DRACO | "EXT_meshopt_compression" | "KHR_meshopt_compression" => "export the model without mesh compression",
        "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" | "MSFT_texture_dds" => {
            "export the model with textures in PNG or JPEG"
        }
        "KHR_materials_pbrSpecularGlossiness" => "export the model with metallic-roughness materials",
        "EXT_mesh_gpu_instancing" => "export the model with a node for every instance",
        _ => "export the model without this extension",
    }
}
