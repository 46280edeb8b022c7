//! What is solid: triangles, and how they look.

use crate::tables::geometry::Geometry;
use crate::trace::Hit;

/// How a surface looks: a Lambert reflector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflected share of the light per channel, [0, 1].
    pub albedo: [f32; 3],
    /// Whether the back reflects as the front does; otherwise it is black, and opaque.
    pub double_sided: bool,
}

/// All surfaces of the scene.
#[derive(Clone, Debug)]
pub struct Surfaces {
    geometry: Geometry,
    materials: Vec<Material>,
    material_of: Vec<u32>,
}

impl Surfaces {
    /// Triangles, each with the index of its material.
    ///
    /// # Panics
    /// If a triangle has no material.
    pub fn new(geometry: Geometry, materials: Vec<Material>, material_of: Vec<u32>) -> Self {
        assert_eq!(geometry.len(), material_of.len(), "a triangle has no material");
        assert!(material_of.iter().all(|material| (*material as usize) < materials.len()), "no such material");
        Self { geometry, materials, material_of }
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

    /// The material of a triangle.
    #[inline(always)]
    pub fn material(&self, triangle: u32) -> &Material {
        &self.materials[self.material_of[triangle as usize] as usize]
    }

    /// Reflected share of the light where a ray met a surface, per channel, [0, 1].
    #[inline(always)]
    pub fn albedo(&self, hit: &Hit) -> [f32; 3] {
        self.material(hit.triangle).albedo
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
            digest(&[u8::from(material.double_sided)]);
        }
    }

    /// Whether all surfaces are grey.
    pub fn are_grey(&self) -> bool {
        self.materials.iter().all(|material| material.albedo == [material.albedo[0]; 3])
    }
}

/// Two scenes have the same surfaces if they have the same triangles and materials: the tree follows from them.
impl PartialEq for Surfaces {
    fn eq(&self, other: &Self) -> bool {
        let corners =
            |surfaces: &Self| (0..surfaces.geometry.len()).map(|i| surfaces.geometry.corners(i)).collect::<Vec<_>>();
        self.materials == other.materials && self.material_of == other.material_of && corners(self) == corners(other)
    }
}
