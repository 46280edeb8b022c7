//! Surfaces from a glTF model.

use fogbow_kernels::tables::geometry::Geometry;
use fogbow_kernels::tables::surfaces::{Material, Surfaces};

use crate::gltf::Model;

/// The triangles of `model`, with the base colours of their materials.
pub fn from_model(model: &Model) -> Surfaces {
    let corners = model.triangles.iter().map(|triangle| triangle.corners).collect();
    let material_of = model.triangles.iter().map(|triangle| triangle.material).collect();
    let material = |material: &crate::gltf::Material| Material {
        albedo: material.base_color,
        double_sided: material.double_sided,
    };
    let materials = model.materials.iter().map(material).collect();
    Surfaces::new(Geometry::new(model.positions.clone(), corners), materials, material_of)
}

/// What `model` has that surfaces do not show, a line each.
pub fn not_rendered(model: &Model) -> Vec<String> {
    let used = |is: fn(&crate::gltf::Material) -> bool| model.materials.iter().filter(|material| is(material)).count();
    let found = [
        (used(|material| material.base_color_texture.is_some()), "textures of base colours: the factor alone counts"),
        (usize::from(!model.colors.is_empty()), "colours of vertices: the factor alone counts"),
        (used(|material| material.emission != [0.0; 3]), "emissive materials: they do not shine"),
        (model.lights.len(), "lights: those of the scene file count"),
        (model.cameras.len(), "cameras: that of the scene file counts"),
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
        model.colors = vec![[1.0; 3]];
        let told = not_rendered(&model).join("\n");
        assert!(told.contains("vertices") && told.contains("emissive") && !told.contains("cameras"), "{told}");
    }
}
