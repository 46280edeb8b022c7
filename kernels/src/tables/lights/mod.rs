//! Lights: what shines, and the rule by which a connection picks one.
//!
//! A connection first chooses a light, by the rule, and then an emitter of it. Disks and spheres are lights with one
//! emitter; a mesh has as many as it has triangles that shine, and chooses among them by area times radiance in
//! constant time, so that their number does not matter. Many disks and spheres are put together in groups of
//! neighbours, which choose as meshes do ([`BodyTree`]).
//!
//! Lights at infinity are chosen among themselves, by connections of their own, so that what has a place and what has
//! none do not compete. Their emitters are the last ones.

mod alias;
mod bodies;
mod distant;
mod emitter;
mod fronts;
mod light;
mod meshes;
mod neighbours;
mod panorama;
mod rows;

use glam::DVec3;
use wide::f32x8;

use crate::lanes::LANES;
pub use bodies::BodyTree;
pub use distant::{Distant, FAR, Source};
pub use emitter::{Emitter, Shape};
pub use light::Light;
pub use panorama::{Band, Panorama};
use rows::Row;
pub use rows::{Choices, Places};

/// How a connection picks its light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// All lights alike.
    Uniform,
    /// In proportion to intensity.
    Intensity,
    /// In proportion to intensity over the distance from the start to the light's centre (Weber et al. 2017, Eq. 8).
    IntensityDistance,
}

/// How much brighter than its flux a light at infinity may be and still be what films are scaled by; our own sun is a
/// quarter of that.
const DAZZLING: f32 = 65_536.0;

/// Distances to a light's centre are not taken below this `[m]`, so that a start at the very centre has a finite share.
pub const LEAST_SELECTION_DISTANCE: f32 = 1e-9;

/// All lights of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Lights {
    emitters: Vec<Emitter>,
    lights: Vec<Light>,
    /// What kernels ask of emitters.
    rows: Vec<Row>,
    /// Whether none of them can hide another.
    clear: bool,
    /// Emitters that are disks or spheres; they come first.
    bodies: usize,
    /// Boxes around them, if they are many.
    tree: Option<BodyTree>,
    /// Emitters of the disks, spheres and meshes in the order in which they were given.
    given: Vec<core::ops::Range<u32>>,
    /// Those at infinity, of which each is one of the last emitters.
    distant: Vec<Distant>,
    /// Emitter of each triangle, `u32::MAX` where it does not shine; empty if none does.
    of_triangle: Vec<u32>,
    selection: Selection,
    /// What there is among the emitters: code for the rest is passed by.
    pub(crate) focused: bool,
    pub(crate) cones: bool,
    pub(crate) spheres: bool,
    pub(crate) double_sided: bool,
    /// Whether some light has several emitters.
    pub(crate) groups: bool,
}

impl Lights {
    /// Disks and spheres, among which connections choose by `selection`.
    ///
    /// # Panics
    /// If one is a triangle: these come in meshes.
    pub fn new(bodies: Vec<Emitter>, selection: Selection) -> Self {
        Self::with_meshes(bodies, Vec::new(), selection)
    }

    /// Disks and spheres, and the triangles of each mesh that shines; triangles of one mesh, and only these, are chosen
    /// together. Where meshes are many, neighbours are put together.
    ///
    /// # Panics
    /// If a body is a triangle, or a mesh has something else, or nothing.
    pub fn with_meshes(bodies: Vec<Emitter>, meshes: Vec<Vec<Emitter>>, selection: Selection) -> Self {
        assert!(bodies.iter().all(|emitter| emitter.shape != Shape::Triangle), "a triangle without a mesh");
        assert!(meshes.iter().all(|mesh| !mesh.is_empty()), "a mesh without triangles");
        assert!(meshes.iter().flatten().all(|emitter| emitter.shape == Shape::Triangle), "a mesh of something else");
        let count = bodies.len();
        let meshes = meshes::few(meshes);
        let (order, groups) = bodies::grouped(&bodies);
        let given = given(&order, &meshes);
        let (mut emitters, mut lights) = (Vec::new(), Vec::new());
        for pieces in groups.into_iter().chain(meshes) {
            let weights: Vec<f64> = pieces.iter().map(|piece| light::weight(piece, selection)).collect();
            let total: f64 = weights.iter().sum();
            let number = lights.len() as u32;
            lights.push(Light::new(&pieces, emitters.len() as u32, &weights));
            emitters.extend(pieces.into_iter().zip(weights).map(|(piece, weight)| Emitter {
                light: number,
                density: (f64::from(piece.density) * if total > 0.0 { weight / total } else { 1.0 }) as f32,
                ..piece
            }));
        }
        let selection = light::share_out(&mut lights, &emitters, selection);
        Self {
            bodies: count,
            tree: BodyTree::new(&emitters[..count]),
            given,
            distant: Vec::new(),
            of_triangle: of_triangle(&emitters),
            selection,
            focused: emitters.iter().any(|emitter| emitter.focused),
            cones: emitters.iter().any(|emitter| emitter.window[0] > 0.0),
            spheres: emitters.iter().any(|emitter| emitter.shape == Shape::Sphere),
            double_sided: emitters.iter().any(|emitter| emitter.double_sided),
            groups: lights.iter().any(|light| light.emitters.len() > 1),
            rows: Vec::new(),
            clear: false,
            emitters,
            lights,
        }
        .completed()
    }

    /// The same with what follows from its emitters.
    fn completed(mut self) -> Self {
        self.clear = fronts::are_clear(&self.emitters);
        let light = |emitter: &Emitter| (emitter.shape != Shape::Distant).then(|| self.light_of(emitter));
        self.rows = self.emitters.iter().map(|emitter| Row::new(emitter, light(emitter))).collect();
        self
    }

    /// The same, and lights at infinity, among which connections choose by `selection`.
    ///
    /// # Panics
    /// If there are some already.
    pub fn with_distant(mut self, sources: &[Source], selection: Selection) -> Self {
        assert!(self.distant.is_empty(), "lights at infinity come all at once");
        self.emitters.extend(sources.iter().map(|source| Emitter::distant(source.radiance())));
        self.distant = distant::place(sources, selection);
        self.completed()
    }

    /// The same without those that are not at infinity, and with `bodies` in their place.
    pub fn with_bodies(&self, bodies: Vec<Emitter>) -> Self {
        let distant = &self.emitters[self.emitters.len() - self.distant.len()..];
        let mut lights = Self::new(bodies, self.selection);
        lights.emitters.extend_from_slice(distant);
        Self { distant: self.distant.clone(), ..lights }.completed()
    }

    /// What connections choose among, but those to lights at infinity.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Lights at infinity, in the sequence of their emitters.
    pub fn distant(&self) -> &[Distant] {
        &self.distant
    }

    /// Whether there are lights at infinity.
    #[inline(always)]
    pub fn has_distant(&self) -> bool {
        !self.distant.is_empty()
    }

    /// Whether one of them has an image.
    #[inline(always)]
    pub fn has_panorama(&self) -> bool {
        self.distant.iter().any(|light| light.panorama.is_some())
    }

    /// Index of the first emitter at infinity.
    #[inline(always)]
    pub fn first_distant(&self) -> u32 {
        (self.emitters.len() - self.distant.len()) as u32
    }

    /// The light at infinity that `emitter` is, if it is one.
    #[inline(always)]
    pub fn distant_of(&self, emitter: u32) -> Option<&Distant> {
        self.distant.get(emitter.checked_sub(self.first_distant())? as usize)
    }

    /// Most emitters that a ray may meet at once: the sky and the suns in front of it add up.
    pub fn most_met(&self) -> usize {
        self.distant.len().max(1)
    }

    /// Whether all emitters are grey.
    pub fn are_grey(&self) -> bool {
        let grey = |emitter: &Emitter| emitter.radiance == [emitter.radiance[0]; 3];
        let images = self.distant.iter().filter_map(|light| light.panorama.as_ref());
        self.emitters.iter().all(grey) && images.into_iter().all(|image| image.is_grey())
    }

    /// All emitters, disks and spheres first, those at infinity last; candidates name them by their place here.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Largest radiance of any emitter in any channel [W/(m^2 sr)]; of a light at infinity no more than `DAZZLING`
    /// times its flux, as what small suns shine upon is that much darker than they are.
    pub fn largest_radiance(&self) -> f32 {
        let largest = |emitter: &Emitter| emitter.radiance.into_iter().fold(0.0, f32::max);
        let (near, far) = self.emitters.split_at(self.first_distant() as usize);
        let far =
            far.iter().zip(&self.distant).map(|(emitter, light)| largest(emitter).min(light.flux as f32 * DAZZLING));
        near.iter().map(largest).chain(far).fold(0.0, f32::max)
    }

    /// Disks and spheres.
    pub fn bodies(&self) -> &[Emitter] {
        &self.emitters[..self.bodies]
    }

    /// Boxes around the disks and spheres, if they are many.
    #[inline(always)]
    pub fn tree(&self) -> Option<&BodyTree> {
        self.tree.as_ref()
    }

    /// Emitters of every disk, sphere and mesh, in the order in which they were given; of many meshes, of clusters.
    pub fn given(&self) -> &[core::ops::Range<u32>] {
        &self.given
    }

    /// Middle of some emitters, as bright as they are `[m]`.
    pub fn center(&self, emitters: &core::ops::Range<u32>) -> DVec3 {
        meshes::bounds(&self.emitters[emitters.start as usize..emitters.end as usize]).0
    }

    /// Whether no light can come between another one and what that shines upon: there is only one, or they are disks
    /// with nothing in front of them.
    pub fn are_clear(&self) -> bool {
        self.clear
    }

    /// Whether surfaces shine.
    pub fn has_meshes(&self) -> bool {
        self.bodies + self.distant.len() < self.emitters.len()
    }

    /// Whether there are spheres.
    pub fn has_spheres(&self) -> bool {
        self.spheres
    }

    /// The emitter that a triangle is, if it shines.
    #[inline(always)]
    pub fn of_triangle(&self, triangle: u32) -> Option<u32> {
        self.of_triangle.get(triangle as usize).copied().filter(|emitter| *emitter != u32::MAX)
    }

    /// An emitter of a light for a random word.
    #[inline(always)]
    pub fn choose_emitter(&self, light: u32, word: u32) -> u32 {
        self.lights[light as usize].choose(word)
    }

    /// Shows the emitters to `digest`, in pieces.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        self.emitters.iter().for_each(|emitter| emitter.digest(digest));
        self.distant.iter().for_each(|light| light.digest(digest));
    }

    /// The rule in force: uniform where the others come to the same.
    pub fn selection(&self) -> Selection {
        self.selection
    }

    /// Whether probabilities depend on the start, so that a vertex's `light_sum` is defined.
    pub fn selection_depends_on_start(&self) -> bool {
        self.selection == Selection::IntensityDistance
    }

    /// One value of eight emitters.
    #[inline(always)]
    pub fn gather(&self, emitters: &[u32; LANES], value: impl Fn(&Emitter) -> f32) -> f32x8 {
        match self.emitters.as_slice() {
            [only] => f32x8::splat(value(only)),
            all => f32x8::new(emitters.map(|emitter| value(&all[emitter as usize]))),
        }
    }

    /// The light of an emitter.
    #[inline(always)]
    pub fn light_of(&self, emitter: &Emitter) -> &Light {
        &self.lights[emitter.light as usize]
    }
}

/// Emitters of the bodies that have been put in this `order`, and of the meshes behind them, as they were given.
fn given(order: &[u32], meshes: &[Vec<Emitter>]) -> Vec<core::ops::Range<u32>> {
    let mut given = vec![0..0; order.len()];
    for (emitter, body) in (0..).zip(order) {
        given[*body as usize] = emitter..emitter + 1;
    }
    let mut first = order.len() as u32;
    given.extend(meshes.iter().map(|mesh| {
        first += mesh.len() as u32;
        first - mesh.len() as u32..first
    }));
    given
}

/// The emitter of each triangle, up to the last that shines.
fn of_triangle(emitters: &[Emitter]) -> Vec<u32> {
    let shining = || emitters.iter().enumerate().filter(|(_, emitter)| emitter.shape == Shape::Triangle);
    let count = shining().map(|(_, emitter)| emitter.triangle as usize + 1).max().unwrap_or(0);
    let mut found = vec![u32::MAX; count];
    shining().for_each(|(index, emitter)| found[emitter.triangle as usize] = index as u32);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(at: f32, size: f32, index: u32, radiance: f32) -> Emitter {
        Emitter::triangle([[at, 0.0, 0.0], [at + size, 0.0, 0.0], [at, size, 0.0]], index, false, [radiance; 3])
    }

    #[test]
    fn triangles_of_a_mesh_have_one_density_where_they_shine_alike() {
        let disk = Emitter::disk(DVec3::Z, DVec3::Z, 0.5, [1.0; 3]);
        let mesh = vec![triangle(0.0, 1.0, 5, 2.0), triangle(3.0, 2.0, 2, 2.0)];
        let lights = Lights::with_meshes(vec![disk], vec![mesh], Selection::Intensity);
        assert_eq!(lights.lights().len(), 2);
        assert_eq!(lights.bodies().len(), 1);
        let [.., a, b] = lights.emitters() else { panic!("two triangles") };
        assert!((a.density - 0.4).abs() < 1e-6 && (b.density - 0.4).abs() < 1e-6, "one over the area of both");
        assert_eq!([5, 2, 0, 9].map(|index| lights.of_triangle(index)), [Some(1), Some(2), None, None]);
        let total = 5.0 + core::f32::consts::FRAC_PI_4;
        assert!((lights.lights()[1].share - 5.0 / total).abs() < 1e-6);
        let chosen = (0..1000).filter(|i| lights.choose_emitter(1, i * 4_294_967) == 1).count();
        assert!(chosen.abs_diff(200) < 3, "{chosen}");
    }

    #[test]
    fn brighter_triangles_are_chosen_more_often() {
        let mesh = vec![triangle(0.0, 1.0, 0, 1.0), triangle(3.0, 1.0, 1, 3.0)];
        let lights = Lights::with_meshes(Vec::new(), vec![mesh], Selection::Uniform);
        let [a, b] = lights.emitters() else { panic!("two triangles") };
        assert!((a.density - 0.5).abs() < 1e-6 && (b.density - 1.5).abs() < 1e-6);
    }
}
