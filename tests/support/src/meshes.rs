//! Triangles and rays to trace: closed meshes, soups, landscapes, and rays of every kind.

use std::collections::HashMap;

use fogbow_kernels::random::{uniform, words};
use fogbow_kernels::tables::geometry::Geometry;
use fogbow_kernels::trace::Ray;
use glam::DVec3;

/// Positions and the corners of triangles among them.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Corners' places.
    pub positions: Vec<[f32; 3]>,
    /// Three of them per triangle.
    pub corners: Vec<[u32; 3]>,
}

impl Mesh {
    /// The table that rays are traced in.
    pub fn geometry(&self) -> Geometry {
        Geometry::new(self.positions.clone(), self.corners.clone())
    }

    /// This mesh and another.
    pub fn and(mut self, other: &Self) -> Self {
        let first = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.corners.extend(other.corners.iter().map(|corners| corners.map(|corner| corner + first)));
        self
    }

    /// With every position moved.
    pub fn map(mut self, place: impl Fn(DVec3) -> DVec3) -> Self {
        for position in &mut self.positions {
            *position = place(point(*position)).as_vec3().to_array();
        }
        self
    }
}

/// A point in f64.
pub fn point(position: [f32; 3]) -> DVec3 {
    DVec3::from(position.map(f64::from))
}

/// Random numbers, one after the other.
#[derive(Clone, Debug)]
pub struct Random {
    seed: u32,
    next: u32,
}

impl Random {
    /// The sequence of this seed.
    pub fn new(seed: u32) -> Self {
        Self { seed, next: 0 }
    }

    /// Four uniform numbers in (0, 1).
    pub fn uniforms(&mut self) -> [f64; 4] {
        self.next += 1;
        words(self.next, 0, 0, self.seed).map(uniform)
    }

    /// A point in the cube from -1 to 1.
    pub fn in_cube(&mut self) -> DVec3 {
        let [x, y, z, _] = self.uniforms();
        2.0 * DVec3::new(x, y, z) - 1.0
    }

    /// A direction, all alike.
    pub fn direction(&mut self) -> DVec3 {
        let [u, v, ..] = self.uniforms();
        let (z, turn) = (2.0 * u - 1.0, std::f64::consts::TAU * v);
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * turn.cos(), across * turn.sin(), z)
    }

    /// An index below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        (self.uniforms()[0] * count as f64) as usize
    }
}

/// The ray from a point.
pub fn ray(origin: DVec3, direction: DVec3, max: f64) -> Ray {
    Ray { origin: origin.as_vec3().to_array(), direction: direction.as_vec3().to_array(), max: max as f32 }
}

/// The box from -1 to 1: twelve triangles, eight positions.
pub fn cube() -> Mesh {
    let positions = (0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 })).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh { positions, corners: faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect() }
}

/// The unit sphere: an icosahedron, every triangle cut into four `levels` times; 20 * 4^levels triangles.
pub fn sphere(levels: u32) -> Mesh {
    let golden = (1.0 + 5_f64.sqrt()) / 2.0;
    let mut places = Vec::new();
    for axis in 0..3 {
        for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
            let mut place = [0.0; 3];
            (place[axis], place[(axis + 1) % 3]) = (a, b);
            places.push(DVec3::from(place).normalize());
        }
    }
    let edge = places[0].distance(places[1]) * 1.01;
    let near = |a: usize, b: usize| places[a].distance(places[b]) < edge;
    let outward = |[a, b, c]: [usize; 3]| {
        let normal = (places[b] - places[a]).cross(places[c] - places[a]);
        if normal.dot(places[a]) > 0.0 { [a, b, c] } else { [a, c, b] }
    };
    let mut corners = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            let third = (b + 1..12).filter(|c| near(a, b) && near(b, *c) && near(a, *c));
            corners.extend(third.map(|c| outward([a, b, c])));
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                places.push((places[a] + places[b]).normalize());
                places.len() - 1
            })
        };
        let cut = |[a, b, c]: &[usize; 3]| {
            let (ab, bc, ca) = (middle(*a, *b), middle(*b, *c), middle(*c, *a));
            [[*a, ab, ca], [*b, bc, ab], [*c, ca, bc], [ab, bc, ca]]
        };
        corners = corners.iter().flat_map(cut).collect();
    }
    let positions = places.iter().map(|place| place.as_vec3().to_array()).collect();
    Mesh { positions, corners: corners.iter().map(|corners| corners.map(|corner| corner as u32)).collect() }
}

/// A sphere with bumps: closed, and not convex.
pub fn bumpy_sphere(levels: u32) -> Mesh {
    let bumps = |p: DVec3| (9.0 * p.x).sin() * (7.0 * p.y).sin() + 0.5 * (31.0 * p.z).sin() * (23.0 * p.x).cos();
    sphere(levels).map(|p| p * (0.8 + 0.1 * bumps(p)))
}

/// A square from -1 to 1 at height 0, cut into `side` x `side` squares of two triangles each.
pub fn grid(side: u32) -> Mesh {
    let at = |i: u32| (2.0 * f64::from(i) / f64::from(side) - 1.0) as f32;
    let positions = (0..=side).flat_map(|y| (0..=side).map(move |x| [at(x), at(y), 0.0])).collect();
    let mut corners = Vec::new();
    for y in 0..side {
        for x in 0..side {
            let a = y * (side + 1) + x;
            let (b, c, d) = (a + 1, a + side + 1, a + side + 2);
            corners.extend([[a, b, d], [a, d, c]]);
        }
    }
    Mesh { positions, corners }
}

/// A landscape: a grid with hills.
pub fn landscape(side: u32) -> Mesh {
    grid(side).map(|p| {
        let height = |f: f64| (f * p.x + 1.3 * f * p.y).sin() * (1.7 * f * p.y - 0.4 * f * p.x).cos() / f;
        p.with_z(0.5 * height(3.0) + 0.4 * height(11.0) + 0.4 * height(37.0) - 0.5)
    })
}

/// Triangles anywhere in the cube from -1 to 1, no two of which share a corner, with edges of up to `size`.
pub fn soup(count: usize, size: f64, seed: u32) -> Mesh {
    let mut random = Random::new(seed);
    let mut mesh = Mesh::default();
    for _ in 0..count {
        let first = mesh.positions.len() as u32;
        let center = random.in_cube();
        let places = [(); 3].map(|()| center + 0.5 * size * random.in_cube());
        mesh.positions.extend(places.map(|place| place.as_vec3().to_array()));
        mesh.corners.push([first, first + 1, first + 2]);
    }
    mesh
}

/// Triangles of a room: the walls of the cube from -1 to 1 but for one, and small triangles in it.
pub fn room(count: usize) -> Mesh {
    let walls = cube();
    let walls = Mesh { corners: walls.corners[..count.min(10)].to_vec(), ..walls };
    let rest = count - walls.corners.len();
    walls.and(&soup(rest, 2.0 / (rest as f64).sqrt(), 3))
}

/// A million triangles in the cube from -1 to 1: a landscape, a bumpy sphere, and small triangles everywhere.
pub fn million() -> Mesh {
    let mesh = landscape(500).and(&bumpy_sphere(7).map(|p| 0.6 * p));
    let rest = 1_000_000 - mesh.corners.len();
    mesh.and(&soup(rest, 0.01, 1))
}

/// Rays of a camera outside the cube from -1 to 1 that sees most of it, row by row.
pub fn camera_rays(side: u32) -> Vec<Ray> {
    let eye = DVec3::new(0.3, -3.0, 0.9);
    let forward = (DVec3::new(0.0, 0.0, -0.1) - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let at = |i: u32| ((f64::from(i) + 0.5) / f64::from(side) - 0.5) * 0.8;
    let pixel = |x: u32, y: u32| ray(eye, (forward + at(x) * right - at(y) * up).normalize(), f64::INFINITY);
    (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect()
}

/// Rays from anywhere in the cube to everywhere, as long as free flights of mean `flight`.
pub fn flights(count: usize, flight: f64, seed: u32) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let one = |_| ray(random.in_cube(), random.direction(), -flight * random.uniforms()[0].ln());
    (0..count).map(one).collect()
}
