//! What shines: disks, spheres, triangles, and what is at infinity.

use core::f64::consts::PI;

use glam::DVec3;

/// The shape of an emitter, and with it the meaning of its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Flat and round: `origin` is the centre, tangent and bitangent are unit vectors in its plane.
    Disk,
    /// Shines outwards; black inside. `origin` is the centre, tangent and bitangent are the x and y axes.
    Sphere,
    /// Flat, part of a surface: `origin` is the first corner, tangent and bitangent are the edges from there to the
    /// second and third corner.
    Triangle,
    /// At infinity, in the sky: it has directions and no points, and shines towards whoever looks. All but the radiance
    /// and the index is 0.
    Distant,
}

/// One piece of a light. Disks and spheres are lights of their own, black and opaque where they do not shine; triangles
/// belong to meshes, and reflect like any other surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// What it is.
    pub shape: Shape,
    /// Centre or first corner `[m]`.
    pub origin: [f32; 3],
    /// Unit normal of the front; zero where it differs from point to point, on a sphere.
    pub normal: [f32; 3],
    /// First axis: a unit vector, or an edge `[m]`.
    pub tangent: [f32; 3],
    /// Second axis: a unit vector, or an edge `[m]`.
    pub bitangent: [f32; 3],
    /// Radius of a disk or sphere `[m]`, > 0; 0 of a triangle.
    pub radius: f32,
    /// One over the radius of a sphere [1/m]; 0 where the normal is the same everywhere.
    pub curvature: f32,
    /// Emitted radiance per channel [W/(m^2 sr)], >= 0; the same over the area, and over all angles where there is no
    /// exponent; of an image of the sky, the largest one.
    pub radiance: [f32; 3],
    /// n of a spotlight, whose radiance at the angle theta to the normal is `scale cos^n theta` times `radiance`; 0 if
    /// it is the same in all directions.
    pub exponent: f32,
    /// `(n + 1) / (2 pi)` of a spotlight, otherwise 1.
    pub scale: f32,
    /// Whether it is a spotlight.
    pub focused: bool,
    /// a and b of a spotlight with a cone, whose radiance at the cosine c to the normal is `clamp(a c + b, 0, 1)^2 / c`
    /// times `radiance`, so that its intensity is the square; its exponent only says where light is likely. `[0, 0]`
    /// without a cone.
    pub window: [f32; 2],
    /// Whether the back shines as the front does.
    pub double_sided: bool,
    /// Density of a point of the emitter where its light was chosen (area measure) [1/m^2]; 0 for what is dark in a
    /// mesh that shines.
    pub density: f32,
    /// Index of the light that it is part of; of no meaning at infinity.
    pub light: u32,
    /// Index of the triangle that shines; `u32::MAX` for all else.
    pub triangle: u32,
}

/// Least difference of cosines over which a cone's intensity falls: single precision knows cosines to 10^-7.
const SHARPEST_EDGE: f64 = 1e-4;

fn f32s(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

impl Emitter {
    /// A disk around `center` that shines to where `normal` points, a vector of any length but zero.
    pub fn disk(center: DVec3, normal: DVec3, radius: f64, radiance: [f64; 3]) -> Self {
        let normal = normal.normalize();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self {
            shape: Shape::Disk,
            origin: f32s(center),
            normal: f32s(normal),
            tangent: f32s(tangent),
            bitangent: f32s(bitangent),
            radius: radius as f32,
            curvature: 0.0,
            radiance: radiance.map(|channel| channel as f32),
            exponent: 0.0,
            scale: 1.0,
            focused: false,
            window: [0.0; 2],
            double_sided: false,
            density: (1.0 / (PI * radius * radius)) as f32,
            light: 0,
            triangle: u32::MAX,
        }
    }

    /// A sphere around `center`.
    pub fn sphere(center: DVec3, radius: f64, radiance: [f64; 3]) -> Self {
        Self {
            shape: Shape::Sphere,
            normal: [0.0; 3],
            curvature: (1.0 / radius) as f32,
            density: (1.0 / (4.0 * PI * radius * radius)) as f32,
            ..Self::disk(center, DVec3::Z, radius, radiance)
        }
    }

    /// A triangle of a surface, with its index there.
    ///
    /// # Panics
    /// If it has no area.
    pub fn triangle(corners: [[f32; 3]; 3], triangle: u32, double_sided: bool, radiance: [f32; 3]) -> Self {
        let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        let twice = (b - a).cross(c - a);
        assert!(twice.length() > 0.0, "triangle {triangle} has no area");
        Self {
            shape: Shape::Triangle,
            origin: corners[0],
            normal: f32s(twice.normalize()),
            tangent: f32s(b - a),
            bitangent: f32s(c - a),
            radius: 0.0,
            radiance,
            double_sided,
            density: (2.0 / twice.length()) as f32,
            triangle,
            ..Self::disk(a, DVec3::Z, 1.0, [0.0; 3])
        }
    }

    /// A light at infinity.
    pub(super) fn distant(radiance: [f64; 3]) -> Self {
        Self {
            shape: Shape::Distant,
            normal: [0.0; 3],
            tangent: [0.0; 3],
            bitangent: [0.0; 3],
            radius: 0.0,
            density: 0.0,
            ..Self::disk(DVec3::ZERO, DVec3::Z, 1.0, radiance)
        }
    }

    /// The same disk as a spotlight of `exponent` >= 0.
    pub fn focused(self, exponent: f64) -> Self {
        let scale = ((exponent + 1.0) / (2.0 * PI)) as f32;
        Self { exponent: exponent as f32, scale, focused: true, ..self }
    }

    /// The same disk as a spotlight with a cone: its intensity is the same up to the angle `inner` from the normal and
    /// falls to 0 at `outer`, as `KHR_lights_punctual` recommends; `0 <= inner <= outer <= pi / 2` `[rad]`. Light
    /// importance sampling samples it like one of `exponent`.
    pub fn with_cone(self, [inner, outer]: [f64; 2], exponent: f64) -> Self {
        let slope = 1.0 / (inner.cos() - outer.cos()).max(SHARPEST_EDGE);
        let window = [slope as f32, (-outer.cos() * slope) as f32];
        Self { exponent: exponent as f32, scale: 1.0, focused: true, window, ..self }
    }

    /// Shows all that makes it up to `digest`, in pieces.
    pub(super) fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        let vectors = [self.origin, self.normal, self.tangent, self.bitangent, self.radiance];
        digest(bytemuck::cast_slice(&vectors));
        digest(bytemuck::cast_slice(&[self.radius, self.exponent, self.scale, self.density]));
        digest(bytemuck::cast_slice(&self.window));
        digest(bytemuck::cast_slice(&[self.light, self.triangle, u32::from(self.double_sided)]));
    }

    /// Area that shines, one side of it `[m^2]`; 0 at infinity.
    pub fn area(&self) -> f64 {
        let radius = f64::from(self.radius);
        match self.shape {
            Shape::Disk => PI * radius * radius,
            Shape::Sphere => 4.0 * PI * radius * radius,
            Shape::Triangle => {
                let [e1, e2] = [self.tangent, self.bitangent].map(|edge| DVec3::from(edge.map(f64::from)));
                e1.cross(e2).length() / 2.0
            }
            Shape::Distant => 0.0,
        }
    }

    /// Intensity in the direction in which it is largest, mean over the channels [W/sr]; 0 at infinity.
    pub fn intensity(&self) -> f64 {
        let seen = if self.shape == Shape::Sphere { self.area() / 4.0 } else { self.area() };
        let mean = self.radiance.iter().map(|channel| f64::from(*channel)).sum::<f64>() / 3.0;
        seen * mean * f64::from(self.scale)
    }

    /// Centre of the smallest ball known to hold it, and its radius `[m]`.
    pub fn bounds(&self) -> (DVec3, f64) {
        let [origin, e1, e2] = [self.origin, self.tangent, self.bitangent].map(|v| DVec3::from(v.map(f64::from)));
        match self.shape {
            Shape::Disk | Shape::Sphere | Shape::Distant => (origin, f64::from(self.radius)),
            Shape::Triangle => {
                let centroid = (e1 + e2) / 3.0;
                let farthest = [DVec3::ZERO, e1, e2].map(|corner| (corner - centroid).length());
                (origin + centroid, farthest.into_iter().fold(0.0, f64::max))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intensities_are_those_of_the_closed_forms() {
        let radiance = [1.0, 2.0, 3.0];
        let disk = Emitter::disk(DVec3::ONE, DVec3::X, 0.5, radiance);
        assert!((disk.intensity() - 0.5 * PI).abs() < 1e-6);
        assert!((disk.focused(1.0).intensity() - 0.5).abs() < 1e-6);
        assert!((Emitter::sphere(DVec3::ONE, 0.5, radiance).intensity() - 0.5 * PI).abs() < 1e-6);
        let corners = [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 3.0, 0.0]];
        let triangle = Emitter::triangle(corners, 7, false, [2.0; 3]);
        assert!((triangle.intensity() - 6.0).abs() < 1e-6);
        assert_eq!((triangle.normal, triangle.triangle), ([0.0, 0.0, 1.0], 7));
    }

    #[test]
    fn bounds_hold_every_corner() {
        let corners = [[1.0, 0.0, 0.0], [3.0, 0.0, 1.0], [1.0, -3.0, 0.0]];
        let (center, radius) = Emitter::triangle(corners, 0, true, [1.0; 3]).bounds();
        for corner in corners {
            assert!((DVec3::from(corner.map(f64::from)) - center).length() <= radius * (1.0 + 1e-6));
        }
    }
}
