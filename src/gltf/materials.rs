//! Materials: what of them a diffuse surface shows.

use super::fault::{At, Checked, Fault, label, require};
use super::model::{Material, Triangle};
use super::primitives::UsedSets;
use super::schema;
use super::textures::Textures;
use super::vertices::is_reflectance;
use super::warnings::Warnings;
use fogbow_kernels::tables::textures::TextureRef;

/// All materials of a file; the textures that they use are noted in `textures`.
pub fn read(
    materials: &[schema::Material],
    textures: &mut Textures<'_>,
    warnings: &mut Warnings,
) -> Checked<Vec<Material>> {
    let read = |(index, material): (usize, &schema::Material)| {
        let label = || label("material", index, material.name.as_deref());
        if material.alpha_mode.as_deref().is_some_and(|mode| mode != "OPAQUE") {
            warnings.note("alpha is ignored; surfaces are opaque", label);
        }
        read_one(material, textures).at(label)
    };
    materials.iter().enumerate().map(read).collect()
}

/// Notes materials of `triangles` that are more than diffuse.
pub fn note_what_is_diffuse(materials: &[schema::Material], triangles: &[Triangle], warnings: &mut Warnings) {
    let mut used = vec![false; materials.len() + 1];
    triangles.iter().for_each(|triangle| used[triangle.material as usize] = true);
    for (index, material) in materials.iter().enumerate().filter(|(index, _)| used[*index]) {
        let label = || label("material", index, material.name.as_deref());
        let surface = &material.pbr_metallic_roughness;
        if surface.metallic_factor > 0.0 {
            warnings.note(
                "metallic materials are rendered as diffuse (metallicFactor is 1 unless the file sets it)",
                label,
            );
        } else if surface.roughness_factor < 1.0 || surface.metallic_roughness_texture.is_some() {
            warnings.note("glossy materials are rendered as diffuse, without highlights", label);
        }
        if material.normal_texture.is_some() {
            warnings.note("normal maps are ignored; surfaces are as flat as their triangles", label);
        }
    }
}

/// The sets of texture coordinates that `material` uses.
pub fn used_sets(material: &Material) -> UsedSets {
    let textures = [material.base_color_texture, material.emissive_texture];
    let uses = |set| textures.iter().flatten().any(|texture| texture.texcoords == set);
    [uses(0), uses(1)]
}

fn read_one(material: &schema::Material, textures: &mut Textures<'_>) -> Checked<Material> {
    let surface = &material.pbr_metallic_roughness;
    Ok(Material {
        name: material.name.clone(),
        base_color: base_color(surface.base_color_factor).at(|| "baseColorFactor")?,
        base_color_texture: texture(&surface.base_color_texture, textures).at(|| "baseColorTexture")?,
        double_sided: material.double_sided,
        emission: emission(material)?,
        emissive_texture: texture(&material.emissive_texture, textures).at(|| "emissiveTexture")?,
        extras: material.extras.clone(),
    })
}

fn base_color([r, g, b, _alpha]: [f64; 4]) -> Checked<[f32; 3]> {
    let color = [r, g, b];
    let remedy = "give factors from 0 to 1: larger ones would reflect more light than arrives";
    require(color.into_iter().all(is_reflectance), || format!("is {color:?}"), remedy)?;
    Ok(color.map(|channel| channel.clamp(0.0, 1.0) as f32))
}

fn emission(material: &schema::Material) -> Checked<[f32; 3]> {
    let factor = material.emissive_factor;
    let finding = || format!("is {factor:?}");
    let ok = factor.iter().all(|channel| *channel >= 0.0);
    require(ok, finding, "give factors of 0 or more").at(|| "emissiveFactor")?;
    let strength = material.extensions.emissive_strength.as_ref().map_or(1.0, |extension| extension.emissive_strength);
    let finding = || format!("is {strength:?}");
    require(strength >= 0.0, finding, "give a strength of 0 or more").at(|| "KHR_materials_emissive_strength")?;
    let emission = factor.map(|channel| (channel * strength) as f32);
    if !emission.iter().all(|channel| channel.is_finite()) {
        let finding = format!("is {factor:?} times {strength:?}, too large for 32-bit numbers");
        return Err(Fault::new(finding, "give a smaller emission").at("emission"));
    }
    Ok(emission)
}

fn texture(info: &Option<schema::TextureInfo>, textures: &mut Textures<'_>) -> Checked<Option<TextureRef>> {
    info.as_ref().map(|info| read_texture(info, textures)).transpose()
}

fn read_texture(info: &schema::TextureInfo, textures: &mut Textures<'_>) -> Checked<TextureRef> {
    let texture = textures.note(info.index)?;
    let identity = schema::TextureTransform::default();
    let transform = info.extensions.transform.as_ref().unwrap_or(&identity);
    let set = transform.tex_coord.unwrap_or(info.tex_coord);
    require(set < 2, || format!("its texCoord is {set}"), "use TEXCOORD_0 or TEXCOORD_1: no others are supported")?;
    let offset = transform.offset.map(|x| x as f32);
    let scale = transform.scale.map(|x| x as f32);
    let rotation = transform.rotation as f32;
    let finding = || format!("is {transform:?}, too large for 32-bit numbers");
    let ok = offset.iter().chain(&scale).chain([&rotation]).all(|x| x.is_finite());
    require(ok, finding, "give smaller numbers").at(|| "KHR_texture_transform")?;
    Ok(TextureRef { texture, texcoords: set as u32, offset, rotation, scale })
}
