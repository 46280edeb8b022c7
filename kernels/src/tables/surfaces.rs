//! What is solid: triangles, and how they look.

use crate::tables::geometry::Geometry;
use crate::tables::geometry::TriangleHit;
use crate::tables::textures::{Image, Texture, TextureRef};

/// How a surface looks: a Lambert reflector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflected share of the light per channel, [0, 1]; multiplied by the texture and the colours of vertices.
    pub albedo: [f32; 3],
    /// Texture of the albedo.
    pub texture: Option<TextureRef>,
    /// Whether the back reflects as the front does; otherwise it is black, and opaque.
    pub double_sided: bool,
}

impl Material {
    /// A material of one albedo.
    pub fn plain(albedo: [f32; 3], double_sided: bool) -> Self {
        Self { albedo, texture: None, double_sided }
    }
}

/// What varies over triangles. Lists of vertices are empty or as long as the positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paint {
    /// Linear factors of the albedo at the vertices, [0, 1].
    pub colors: Vec<[f32; 3]>,
    /// Texture coordinates of set 0 and set 1; (0, 0) everywhere where a set is empty.
    pub texcoords: [Vec<[f32; 2]>; 2],
    /// The textures that materials name.
    pub textures: Vec<Texture>,
    /// The images that textures name.
    pub images: Vec<Image>,
}

/// All surfaces of the scene.
#[derive(Clone, Debug)]
pub struct Surfaces {
    geometry: Geometry,
    materials: Vec<Material>,
    material_of: Vec<u32>,
    paint: Paint,
}

impl Surfaces {
    /// Triangles, each with the index of its material.
    ///
    /// # Panics
    /// If a triangle has no material.
    pub fn new(geometry: Geometry, materials: Vec<Material>, material_of: Vec<u32>) -> Self {
        assert_eq!(geometry.len(), material_of.len(), "a triangle has no material");
        assert!(material_of.iter().all(|material| (*material as usize) < materials.len()), "no such material");
        Self { geometry, materials, material_of, paint: Paint::default() }
    }

    /// The same with what varies over its triangles.
    pub fn painted(self, paint: Paint) -> Self {
        Self { paint, ..self }
    }

    /// No surface at all.
    pub fn none() -> Self {
        Self::new(Geometry::new(Vec::new(), Vec::new()), Vec::new(), Vec::new())
    }

    /// Whether there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.geometry.is_empty()
    }

    /// The triangles.
    #[inline(always)]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Index of the material of a triangle.
    pub fn material_index(&self, triangle: u32) -> usize {
        self.material_of[triangle as usize] as usize
    }

    /// The material of a triangle.
    #[inline(always)]
    pub fn material(&self, triangle: u32) -> &Material {
        &self.materials[self.material_of[triangle as usize] as usize]
    }

    /// Reflected share of the light where a ray met a surface, per channel, [0, 1].
    #[inline(always)]
    pub fn albedo(&self, hit: &TriangleHit) -> [f32; 3] {
        let material = self.material(hit.triangle);
        if material.texture.is_none() && self.paint.colors.is_empty() {
            return material.albedo;
        }
        self.painted_albedo(material, hit)
    }

    /// The product of factor, colours of vertices and texture.
    fn painted_albedo(&self, material: &Material, hit: &TriangleHit) -> [f32; 3] {
        let corners = self.geometry.indices(hit.triangle as usize).map(|corner| corner as usize);
        let [second, third] = hit.barycentric;
        let weights = [1.0 - second - third, second, third];
        let mut albedo = material.albedo;
        if !self.paint.colors.is_empty() {
            let color = mix(corners.map(|corner| self.paint.colors[corner]), weights);
            albedo = core::array::from_fn(|channel| albedo[channel] * color[channel].clamp(0.0, 1.0));
        }
        if let Some(texture) = &material.texture {
            let texel = self.paint.texel(texture, corners, weights);
            albedo = core::array::from_fn(|channel| albedo[channel] * texel[channel]);
        }
        albedo
    }

    /// Shows all that makes them up to `digest`, in pieces.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        for (triangle, material) in self.material_of.iter().enumerate() {
            let corners = self.geometry.corners(triangle);
            digest(bytemuck::cast_slice(&corners));
            digest(&material.to_le_bytes());
        }
        for material in &self.materials {
            digest(bytemuck::bytes_of(&material.albedo));
            digest(&[u8::from(material.double_sided), u8::from(material.texture.is_some())]);
            if let Some(texture) = &material.texture {
                texture.digest(digest);
            }
        }
        self.paint.digest(digest);
    }

    /// Whether all surfaces are grey.
    pub fn are_grey(&self) -> bool {
        let is_grey = |material: &Material| material.albedo == [material.albedo[0]; 3] && material.texture.is_none();
        self.paint.colors.is_empty() && self.materials.iter().all(is_grey)
    }
}

impl Paint {
    /// The linear value of a texture at the point of a triangle with these vertices and barycentric weights.
    pub fn texel(&self, texture: &TextureRef, corners: [usize; 3], weights: [f32; 3]) -> [f32; 3] {
        let texcoords = &self.texcoords[texture.texcoords as usize];
        let of_corner = |corner: usize| texcoords.get(corner).copied().unwrap_or_default();
        let at = mix(corners.map(of_corner), weights);
        let table = &self.textures[texture.texture as usize];
        table.sample(&self.images[table.image as usize], texture.transform(at))
    }

    fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        let [first, second] = &self.texcoords;
        let lengths = [self.colors.len(), first.len(), second.len(), self.textures.len()];
        lengths.iter().for_each(|length| digest(&(*length as u64).to_le_bytes()));
        digest(bytemuck::cast_slice(&self.colors));
        self.texcoords.iter().for_each(|set| digest(bytemuck::cast_slice(set)));
        self.textures.iter().for_each(|texture| texture.digest(digest));
        self.images.iter().for_each(|image| image.digest(digest));
    }
}

/// The mean of three vectors by barycentric weights.
fn mix<const N: usize>(values: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    core::array::from_fn(|i| (0..3).map(|corner| values[corner][i] * weights[corner]).sum())
}

/// Two scenes have the same surfaces if they have the same triangles and materials: the tree follows from them.
impl PartialEq for Surfaces {
    fn eq(&self, other: &Self) -> bool {
        let corners =
            |surfaces: &Self| (0..surfaces.geometry.len()).map(|i| surfaces.geometry.corners(i)).collect::<Vec<_>>();
        let same_look = self.materials == other.materials && self.material_of == other.material_of;
        same_look && self.paint == other.paint && corners(self) == corners(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::textures::{Filter, Wrap};

    /// A triangle whose corners are red, green and blue, under an image of two texels: white and black.
    fn painted(texture: Option<TextureRef>) -> Surfaces {
        let geometry = Geometry::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        let material = Material { albedo: [0.5, 1.0, 1.0], texture, double_sided: false };
        Surfaces::new(geometry, vec![material], vec![0]).painted(Paint {
            colors: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            texcoords: [vec![[0.0, 0.5], [1.0, 0.5], [0.0, 0.5]], Vec::new()],
            textures: vec![Texture { image: 0, wrap: [Wrap::Clamp; 2], filter: Filter::Nearest }],
            images: vec![Image { width: 2, height: 1, texels: vec![[255; 3], [0; 3]] }],
        })
    }

    fn albedo(surfaces: &Surfaces, barycentric: [f32; 2]) -> [f32; 3] {
        surfaces.albedo(&TriangleHit { triangle: 0, distance: 1.0, barycentric })
    }

    #[test]
    fn factor_colours_and_texture_multiply() {
        let plain = painted(None);
        assert_eq!(albedo(&plain, [0.0, 0.0]), [0.5, 0.0, 0.0]);
        assert_eq!(albedo(&plain, [0.25, 0.5]), [0.125, 0.25, 0.5]);
        let texture = TextureRef { texture: 0, texcoords: 0, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] };
        let textured = painted(Some(texture));
        assert_eq!(albedo(&textured, [0.25, 0.5]), [0.125, 0.25, 0.5], "on the white texel");
        assert_eq!(albedo(&textured, [0.75, 0.0]), [0.0; 3], "on the black one");
        let mut without = painted(Some(texture));
        without.paint.texcoords = [Vec::new(), Vec::new()];
        assert_eq!(albedo(&without, [0.75, 0.0]), [0.125, 0.75, 0.0], "one texel everywhere");
        let shifted = painted(Some(TextureRef { offset: [0.5, 0.0], ..texture }));
        assert_eq!(albedo(&shifted, [0.25, 0.5]), [0.0; 3]);
        assert!(!plain.are_grey() && plain != textured);
    }
}
