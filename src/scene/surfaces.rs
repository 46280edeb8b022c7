//! Surfaces from a glTF model.

use fogbow_kernels::tables::geometry::Geometry;
use fogbow_kernels::tables::surfaces::{Material, Paint, Surfaces};

use super::model::Loaded;
use crate::gltf::{LightKind, Model};

/// The triangles of `model`, with the base colours of their materials: factors, textures, colours of vertices.
pub fn from_model(model: Model) -> Surfaces {
    let corners = model.triangles.iter().map(|triangle| triangle.corners).collect();
    let material_of = model.triangles.iter().map(|triangle| triangle.material).collect();
    let material = |material: &crate::gltf::Material| Material {
        albedo: material.base_color,
        texture: material.base_color_texture,
        double_sided: material.double_sided,
    };
    let materials = model.materials.iter().map(material).collect();
    let Model { positions, colors, texcoords, textures, images, .. } = model;
    let paint = Paint { colors, texcoords, textures, images };
    Surfaces::new(Geometry::new(positions, corners), materials, material_of).painted(paint)
}

/// What a model holds that is not rendered, and what was passed over in reading it, a line each.
pub fn warnings(Loaded { file, model }: &Loaded) -> Vec<String> {
    let lines = not_rendered(model).into_iter().chain(model.warnings.iter().cloned());
    lines.map(|line| format!("{file}: {line}")).collect()
}

fn not_rendered(model: &Model) -> Vec<String> {
    let used = |is: fn(&crate::gltf::Material) -> bool| model.materials.iter().filter(|material| is(material)).count();
    let directional = model.lights.iter().filter(|light| light.kind == LightKind::Directional).count();
    let found = [
        (used(|material| material.emission != [0.0; 3]), "emissive materials: they do not shine"),
        (directional, "directional lights: they do not shine"),
    ];
    let line = |(_, what): (usize, &str)| format!("not rendered so far: {what}");
    found.into_iter().filter(|(count, _)| *count > 0).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_is_told() {
        let mut model = Model::default();
        assert!(not_rendered(&model).is_empty());
        model.materials = vec![crate::gltf::Material { emission: [0.0, 1.0, 0.0], ..Default::default() }];
        let told = not_rendered(&model).join("\n");
        assert!(told.contains("emissive") && !told.contains("directional"), "{told}");
    }
}
