//! Indexed triangles.

use glam::DVec3;

/// Triangles over shared vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices `[m]`.
    pub positions: Vec<DVec3>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The parallelogram with a corner and two edges from it; its normal is `along` x `across`.
    pub fn parallelogram(corner: DVec3, along: DVec3, across: DVec3) -> Self {
        let positions = vec![corner, corner + along, corner + along + across, corner + across];
        let mut mesh = Self { positions, triangles: vec![] };
        mesh.quad([0, 1, 2, 3]);
        mesh
    }

    /// Adds a convex, plane quadrilateral, given counter-clockwise.
    pub fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// Adds all of `other`.
    pub fn append(&mut self, other: &Self) {
        let first = u32::try_from(self.positions.len()).expect("a mesh has fewer than 2^32 vertices");
        self.positions.extend_from_slice(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|index| first + index)));
    }

    /// All of `meshes`.
    pub fn union(meshes: impl IntoIterator<Item = Self>) -> Self {
        meshes.into_iter().fold(Self::default(), |mut all, mesh| {
            all.append(&mesh);
            all
        })
    }

    /// The mesh, moved.
    #[must_use]
    pub fn moved(self, by: DVec3) -> Self {
        self.mapped(|position| position + by)
    }

    /// The mesh after a quarter turn about the vertical axis through the origin: what pointed along +x points along -z.
    #[must_use]
    pub fn quarter_turned(self) -> Self {
        self.mapped(|p| DVec3::new(p.z, p.y, -p.x))
    }

    /// The mesh after a half turn about the vertical axis through `pivot`.
    #[must_use]
    pub fn half_turned(self, pivot: DVec3) -> Self {
        self.mapped(|p| DVec3::new(2.0 * pivot.x - p.x, p.y, 2.0 * pivot.z - p.z))
    }

    /// The mesh turned about the vertical axis through the origin, from +z towards +x.
    #[must_use]
    pub fn turned(self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        self.mapped(|p| DVec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x))
    }

    /// The mesh stretched along the axes.
    ///
    /// # Panics
    /// If a factor is not positive: mirrors turn triangles inside out.
    #[must_use]
    pub fn stretched(self, by: DVec3) -> Self {
        assert!(by.cmpgt(DVec3::ZERO).all(), "a mesh stretched by {by}");
        self.mapped(|position| position * by)
    }

    /// The mesh with its vertices put elsewhere by a proper rigid motion: mirrors would turn triangles inside out.
    fn mapped(mut self, motion: impl Fn(DVec3) -> DVec3) -> Self {
        for position in &mut self.positions {
            *position = motion(*position);
        }
        self
    }
}
