//! Surfaces, and what of them shines, from a glTF model.

use fogbow_kernels::tables::geometry::Geometry;
use fogbow_kernels::tables::lights::Emitter;
use fogbow_kernels::tables::surfaces::{Material, Paint, Surfaces};

use super::model::Loaded;
use super::punctual;
use crate::gltf::{self, Model, label, quoted};
use crate::warning::Warning;

/// Area from which on a triangle shines `[m^2]`, about that of the smallest disk: one over it is far inside f32.
const SMALLEST_AREA: f64 = 1e-18;
/// Points per side of the grid over which the texture of a triangle's emission is averaged.
const GRID: u16 = 8;

/// The triangles of `model`, with the base colours of their materials: factors, textures, colours of vertices; and,
/// mesh by mesh, those that shine.
pub fn from_model(model: Model) -> (Surfaces, Vec<Vec<Emitter>>) {
    let material_of = model.triangles.iter().map(|triangle| triangle.material).collect();
    let material = |material: &gltf::Material| Material {
        albedo: material.base_color,
        texture: material.base_color_texture,
        double_sided: material.double_sided,
    };
    let materials = model.materials.iter().map(material).collect();
    let Model { positions, colors, texcoords, textures, images, triangles, instances, materials: looks, .. } = model;
    let paint = Paint { colors, texcoords, textures, images };
    let shining = |instance: &gltf::Instance| -> Vec<Emitter> {
        let emitter = |index: u32| {
            let gltf::Triangle { corners, material } = triangles[index as usize];
            let corners = corners.map(|corner| corner as usize);
            let radiance = radiance(&looks[material as usize], &paint, corners);
            let positions = corners.map(|corner| positions[corner]);
            let shines = radiance != [0.0; 3] && area(positions) >= SMALLEST_AREA;
            shines.then(|| Emitter::triangle(positions, index, looks[material as usize].double_sided, radiance))
        };
        instance.triangles.clone().filter_map(emitter).collect()
    };
    let meshes = instances.iter().map(shining).filter(|mesh| !mesh.is_empty()).collect();
    let corners = triangles.iter().map(|triangle| triangle.corners).collect();
    (Surfaces::new(Geometry::new(positions, corners), materials, material_of).painted(paint), meshes)
}

/// Emitted radiance of a triangle [W/(m^2 sr)]: the factor times the mean of the texture over the triangle.
fn radiance(material: &gltf::Material, paint: &Paint, corners: [usize; 3]) -> [f32; 3] {
    let Some(texture) = material.emissive_texture.filter(|_| material.emission != [0.0; 3]) else {
        return material.emission;
    };
    let steps = || (0..GRID).map(|i| (f32::from(i) + 0.5) / f32::from(GRID));
    let mut mean = [0.0; 3];
    for (u, v) in steps().flat_map(|u| steps().map(move |v| (u, v))) {
        // Uniform over the triangle.
        let weights = [1.0 - u.sqrt(), u.sqrt() * (1.0 - v), u.sqrt() * v];
        let texel = paint.texel(&texture, corners, weights);
        mean = core::array::from_fn(|channel| mean[channel] + texel[channel] / f32::from(GRID * GRID));
    }
    core::array::from_fn(|channel| material.emission[channel] * mean[channel])
}

fn area(corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| glam::DVec3::from(corner.map(f64::from)));
    (b - a).cross(c - a).length() / 2.0
}

/// What a model holds that is not rendered, and what was passed over in reading it; `has_suns` tells whether light
/// arrives from infinity.
pub fn warnings(Loaded { file, model }: &Loaded, has_suns: bool) -> Vec<Warning> {
    let suns = model.lights.iter().filter(|light| punctual::is_sun(light) && !has_suns);
    let suns: Vec<_> = suns.map(|light| format!("light {}", quoted(&light.name))).collect();
    let averaged = |(index, look): (usize, &gltf::Material)| {
        let varies = look.emission != [0.0; 3] && look.emissive_texture.is_some();
        varies.then(|| label("material", index, look.name.as_deref()))
    };
    let averaged: Vec<_> = model.materials.iter().enumerate().filter_map(averaged).collect();
    let own = [
        (suns, "directional lights are left out: nothing arrives from infinity through a medium without end"),
        (averaged, "textures of emission are averaged; each triangle emits the mean"),
    ];
    let own = own.into_iter().filter(|(places, _)| !places.is_empty());
    let own = own.map(|(places, finding)| Warning { places, ..Warning::new(file, finding) });
    own.chain(model.warnings.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fogbow_kernels::tables::textures::{Filter, Image, Texture, TextureRef, Wrap};

    /// Two triangles with area and one without, in one instance; the material shines red through a texture that is
    /// white on the left half and black on the right.
    fn model() -> Model {
        let texture = TextureRef { texture: 0, texcoords: 0, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] };
        let triangle = |corners: [u32; 3]| gltf::Triangle { corners, material: 0 };
        Model {
            positions: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0]],
            texcoords: [vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], Vec::new()],
            triangles: vec![triangle([0, 1, 2]), triangle([1, 1, 2]), triangle([1, 3, 2])],
            instances: vec![gltf::Instance { node: 0, name: "lamp".into(), mesh: None, triangles: 0..3 }],
            materials: vec![gltf::Material {
                emission: [8.0, 0.0, 0.0],
                emissive_texture: Some(texture),
                ..Default::default()
            }],
            textures: vec![Texture { image: 0, wrap: [Wrap::Clamp; 2], filter: Filter::Nearest }],
            images: vec![Image { width: 2, height: 1, texels: vec![[255; 3], [0; 3]] }],
            ..Default::default()
        }
    }

    #[test]
    fn triangles_shine_in_the_mean_of_their_texture() {
        let (surfaces, meshes) = from_model(model());
        assert_eq!(surfaces.geometry().len(), 3);
        let [mesh] = meshes.as_slice() else { panic!("one mesh") };
        let found: Vec<_> = mesh.iter().map(|emitter| (emitter.triangle, emitter.radiance)).collect();
        let [(0, first), (2, second)] = found[..] else { panic!("{found:?}") };
        // Three quarters of the first triangle, one of the second, lie on the left.
        assert!((first[0] - 6.0).abs() < 0.3 && (second[0] - 2.0).abs() < 0.3, "{first:?} {second:?}");
        assert_eq!([first[1], second[2]], [0.0; 2]);
    }

    #[test]
    fn dark_meshes_are_not_lights() {
        let mut model = model();
        model.materials[0].emission = [0.0; 3];
        assert!(from_model(model).1.is_empty());
    }
}
